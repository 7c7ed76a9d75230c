"""Who breeds: ``select(fitness, n_parents, *, rng)`` names the parents of the next generation."""

import numpy as np
from numpy.random import Generator

from walkerlab.ga.genes import Floats, Indices

CONSOLATION = 0.05
"""What ``gradient`` grants the least fit, as a part of the distance between the worst and the best."""

MIN_PRESSURE = 1.03
"""Ratio of the highest probability to the median below which selection hardly prefers anyone.

In 200 generations of ordinary runs (10 runs on flat ground and stairs, 40 robots), the lowest ratio was 1.20.
"""


def gradient(fitness: Floats, n_parents: int, *, rng: Generator) -> Indices:
    """Let each individual breed with a chance that is proportional to its fitness.

    One individual that is far worse than all others takes most of the selection pressure away, for probabilities depend
    on the distance to the worst: of fitness 1, 2, 3 and -1e6, the first three are all chosen with probability 0.33.
    ``evolve`` warns where that happens. ``rank``, ``tournament`` and ``top_half`` depend on the order only, and are not
    affected.

    Args:
        fitness: (n,) higher is better; negative values are as good as any.
        n_parents: how many parents to name.
        rng: the only source of chance.

    Returns:
        (n_parents,) indices into ``fitness``.

    Raises:
        ValueError: if a fitness is NaN or infinite.
    """
    return rng.choice(len(fitness), size=n_parents, p=gradient_probabilities(fitness))


def gradient_probabilities(fitness: Floats) -> Floats:
    """Return each individual's chance in ``gradient``: w = f - min + 0.05 (max - min), made to sum to 1.

    Counting from the worst instead of from zero (windowing: Grefenstette 1986, IEEE Trans. SMC 16(1)) makes
    the chances the same in any unit and from any zero, so that a negative fitness is no special case. Its weakness is
    an outlier at the lower end, which makes all others nearly equal: see ``gradient`` and ``pressure``.

    Args:
        fitness: (n,) higher is better.

    Returns:
        (n,) chances; all the same where all are equally fit.

    Raises:
        ValueError: if a fitness is NaN or infinite; the message names the individual.
    """
    require_finite(fitness)
    worst, best = np.min(fitness), np.max(fitness)
    if worst == best:
        return np.full(len(fitness), 1 / len(fitness))
    weights = (fitness - worst) / (best - worst) + CONSOLATION
    return weights / weights.sum()


def pressure(probabilities: Floats) -> float:
    """Return the selection pressure: the highest of (n,) probabilities over their median, 1 if all are the same."""
    return float(np.max(probabilities) / np.median(probabilities))


def top_half(fitness: Floats, n_parents: int, *, rng: Generator) -> Indices:
    """Let the better half breed, each of its members equally often (truncation selection).

    Args:
        fitness: (n,) higher is better; of equals the earlier counts as the better.
        n_parents: how many parents to name; where it is no multiple of the half, the best are named once more.
        rng: shuffles their order; the only source of chance.

    Returns:
        (n_parents,) indices into ``fitness``.

    Raises:
        ValueError: if a fitness is NaN or infinite.
    """
    require_finite(fitness)
    best = np.argsort(-fitness, kind="stable")[: -(-len(fitness) // 2)]
    return rng.permutation(np.resize(best, n_parents))


def tournament(fitness: Floats, n_parents: int, *, size: int = 3, rng: Generator) -> Indices:
    """Let the best of a few, drawn with replacement, breed (Goldberg & Deb 1991, FOGA 1).

    Args:
        fitness: (n,) higher is better; of equals the one drawn first wins.
        n_parents: how many tournaments to hold.
        size: how many compete in each; more is a higher selection pressure, 1 is none.
        rng: the only source of chance.

    Returns:
        (n_parents,) indices into ``fitness``.

    Raises:
        ValueError: if a fitness is NaN or infinite, or ``size`` is under 1.
    """
    require_finite(fitness)
    if size < 1:
        raise ValueError(f"size is {size}; it must be 1 or more. It is how many compete in each tournament.")
    entrants = rng.integers(len(fitness), size=(n_parents, size))
    winners = np.argmax(fitness[entrants], axis=1)
    return entrants[np.arange(n_parents), winners]


def rank(fitness: Floats, n_parents: int, *, pressure: float = 1.8, rng: Generator) -> Indices:
    """Let each individual breed with a chance that rises evenly with its place, whatever the distances.

    Args:
        fitness: (n,) higher is better.
        n_parents: how many parents to name.
        pressure: how many times the average chance the best one has, 1 to 2.
        rng: the only source of chance.

    Returns:
        (n_parents,) indices into ``fitness``.

    Raises:
        ValueError: if a fitness is NaN or infinite, or ``pressure`` is outside 1 to 2.
    """
    return rng.choice(len(fitness), size=n_parents, p=rank_probabilities(fitness, pressure=pressure))


def rank_probabilities(fitness: Floats, *, pressure: float = 1.8) -> Floats:
    """Return each individual's chance in ``rank``: linear ranking (Baker 1985, ICGA 1).

    Args:
        fitness: (n,) higher is better; equals share the mean of their places.
        pressure: how many times the average chance the best one has, 1 to 2.

    Returns:
        (n,) chances, from (2 - pressure) / n for the worst to pressure / n for the best.

    Raises:
        ValueError: if a fitness is NaN or infinite, or ``pressure`` is outside 1 to 2.
    """
    require_finite(fitness)
    if not 1 <= pressure <= 2:
        raise ValueError(f"pressure is {pressure}; it must be 1 to 2. It is the best one's chance over the average.")
    _, level, n_equal = np.unique(fitness, return_inverse=True, return_counts=True)
    place = (np.cumsum(n_equal) - (n_equal + 1) / 2)[level]  # 0: the worst
    n = len(fitness)
    middle = (n - 1) / 2
    return (1 + (pressure - 1) * (place - middle) / max(middle, 1 / 2)) / n


def uniform(fitness: Floats, n_parents: int, *, rng: Generator) -> Indices:
    """Let chance alone decide: no selection pressure, the yardstick for all the others.

    Args:
        fitness: (n,) only its length matters.
        n_parents: how many parents to name.
        rng: the only source of chance.

    Returns:
        (n_parents,) indices into ``fitness``.
    """
    return rng.integers(len(fitness), size=n_parents)


def require_finite(fitness: Floats) -> None:
    """Refuse a fitness by which nobody can be compared.

    Raises:
        ValueError: if a fitness is NaN or infinite; the message names the first such individual by its index.
    """
    for i in np.flatnonzero(~np.isfinite(fitness)):
        raise ValueError(
            f"individual {i} has fitness {fitness[i]}; it must be a finite number, so that others can be "
            "compared with it. Mend the fitness function, or leave that individual out."
        )
