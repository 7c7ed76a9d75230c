"""Selection operators: ``select(fitness, n_parents, *, rng)`` returns the indices of the parents."""

import numpy as np
from numpy.random import Generator

from walkerlab.ga.genes import Floats, Indices

GRADIENT_OFFSET = 0.05
"""Offset of the weights of ``gradient``, as a fraction of the fitness range; it lets the least fit be selected too."""

MIN_PRESSURE = 1.03
"""Threshold for the ratio of the highest to the median probability.

Below it, selection hardly favours any individual.

In 200 generations of ordinary runs (10 runs on flat ground and stairs, 40 robots), the lowest ratio was 1.20.
"""


def gradient(fitness: Floats, n_parents: int, *, rng: Generator) -> Indices:
    """Select each individual with a probability that grows linearly with its lead over the lowest fitness.

    One individual that is far worse than all others removes most of the selection pressure, because probabilities
    depend on the distance to the worst: among individuals with fitness 1, 2, 3 and -1e6, each of the first three is
    selected with probability 0.33. ``evolve`` warns when this happens. ``rank``, ``tournament`` and ``top_half`` depend
    only on the order, and are not affected.

    Args:
        fitness: Fitness of each individual, shape (n,); higher is better, and may be negative.
        n_parents: Number of parents to select.
        rng: Random number generator.

    Returns:
        Indices into ``fitness``, shape (n_parents,).

    Raises:
        ValueError: If a fitness is NaN or infinite.
    """
    return rng.choice(len(fitness), size=n_parents, p=gradient_probabilities(fitness))


def gradient_probabilities(fitness: Floats) -> Floats:
    """Return each individual's probability in ``gradient``: w = f - min + 0.05 (max - min), normalised.

    Measuring from the worst individual instead of from zero (windowing: Grefenstette 1986, IEEE Trans. SMC 16(1)) makes
    the probabilities independent of the unit and the zero of fitness, so that negative fitness needs no special
    treatment. Its weakness is an outlier at the lower end, which makes all others nearly equal: see ``gradient`` and
    ``selection_pressure``.

    Args:
        fitness: Fitness of each individual, shape (n,); higher is better.

    Returns:
        Probabilities, shape (n,); equal if all individuals have the same fitness.

    Raises:
        ValueError: If a fitness is NaN or infinite; the message gives the individual.
    """
    require_finite(fitness)
    worst = np.min(fitness)
    best = np.max(fitness)
    if worst == best:
        return np.full(len(fitness), 1 / len(fitness))
    weights = (fitness - worst) / (best - worst) + GRADIENT_OFFSET
    return weights / weights.sum()


def selection_pressure(probabilities: Floats) -> float:
    """Return the selection pressure: the highest probability divided by the median probability; 1 if all are equal."""
    return float(np.max(probabilities) / np.median(probabilities))


def top_half(fitness: Floats, n_parents: int, *, rng: Generator) -> Indices:
    """Select parents from the better half of the population, each equally often (truncation selection).

    Args:
        fitness: Fitness of each individual, shape (n,); higher is better. Among equals, the first counts as better.
        n_parents: Number of parents to select; if it is not a multiple of the size of that half, the best are selected
            once more.
        rng: Random number generator; shuffles the parents.

    Returns:
        Indices into ``fitness``, shape (n_parents,).

    Raises:
        ValueError: If a fitness is NaN or infinite.
    """
    require_finite(fitness)
    best = np.argsort(-fitness, kind="stable")[: -(-len(fitness) // 2)]
    return rng.permutation(np.resize(best, n_parents))


def tournament(fitness: Floats, n_parents: int, *, size: int = 3, rng: Generator) -> Indices:
    """Select the best of a few individuals drawn with replacement (Goldberg & Deb 1991, FOGA 1).

    Args:
        fitness: Fitness of each individual, shape (n,); higher is better. Among equals, the one drawn first wins.
        n_parents: Number of parents to select, each by its own tournament.
        size: Number of individuals in each tournament; a larger one increases the selection pressure, and 1 removes it.
        rng: Random number generator.

    Returns:
        Indices into ``fitness``, shape (n_parents,).

    Raises:
        ValueError: If a fitness is NaN or infinite, or ``size`` is less than 1.
    """
    require_finite(fitness)
    if size < 1:
        raise ValueError(
            f"size is {size}; it must be 1 or more. It is the number of individuals that compete in each tournament."
        )
    entrants = rng.integers(len(fitness), size=(n_parents, size))
    winners = np.argmax(fitness[entrants], axis=1)
    return entrants[np.arange(n_parents), winners]


def rank(fitness: Floats, n_parents: int, *, pressure: float = 1.8, rng: Generator) -> Indices:
    """Select each individual with a probability that increases linearly with its rank.

    Args:
        fitness: Fitness of each individual, shape (n,); higher is better.
        n_parents: Number of parents to select.
        pressure: Probability of the best individual as a multiple of the average, 1 to 2.
        rng: Random number generator.

    Returns:
        Indices into ``fitness``, shape (n_parents,).

    Raises:
        ValueError: If a fitness is NaN or infinite, or ``pressure`` is not between 1 and 2.
    """
    return rng.choice(len(fitness), size=n_parents, p=rank_probabilities(fitness, pressure=pressure))


def rank_probabilities(fitness: Floats, *, pressure: float = 1.8) -> Floats:
    """Return each individual's probability in ``rank``: linear ranking (Baker 1985, ICGA 1).

    Args:
        fitness: Fitness of each individual, shape (n,); higher is better. Tied individuals share the mean of their
            ranks.
        pressure: Probability of the best individual as a multiple of the average, 1 to 2.

    Returns:
        Probabilities, shape (n,), from (2 - pressure) / n for the worst to pressure / n for the best.

    Raises:
        ValueError: If a fitness is NaN or infinite, or ``pressure`` is not between 1 and 2.
    """
    require_finite(fitness)
    if not 1 <= pressure <= 2:
        raise ValueError(
            f"pressure is {pressure}; it must be between 1 and 2. It is the probability of the best individual as a "
            "multiple of the average."
        )
    _, level, n_equal = np.unique(fitness, return_inverse=True, return_counts=True)
    ranks = (np.cumsum(n_equal) - (n_equal + 1) / 2)[level]  # 0 for the worst
    n = len(fitness)
    middle = (n - 1) / 2
    return (1 + (pressure - 1) * (ranks - middle) / max(middle, 1 / 2)) / n


def uniform(fitness: Floats, n_parents: int, *, rng: Generator) -> Indices:
    """Select every individual with the same probability: no selection pressure, a baseline for the others.

    Args:
        fitness: Fitness of each individual, shape (n,); only its length is used.
        n_parents: Number of parents to select.
        rng: Random number generator.

    Returns:
        Indices into ``fitness``, shape (n_parents,).
    """
    return rng.integers(len(fitness), size=n_parents)


def require_finite(fitness: Floats) -> None:
    """Check that every fitness is finite.

    Raises:
        ValueError: If a fitness is NaN or infinite; the message gives the index of the first such individual.
    """
    for i in np.flatnonzero(~np.isfinite(fitness)):
        raise ValueError(
            f"individual {i} has fitness {fitness[i]}; it must be a finite number, so that it can be compared with "
            "the others. Fix the fitness function, or leave that individual out."
        )
