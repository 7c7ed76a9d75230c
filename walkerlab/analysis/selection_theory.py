"""Theory of selection: its effect on a large population, and how likely each individual is to become a parent.

All values for a large population follow from one curve: the share of the parents that come from the poorest fraction u
of the population. It is u if selection has no effect, and u² for tournaments of two.
"""

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.special import ndtr

from walkerlab.ga import selection
from walkerlab.ga.genes import Floats
from walkerlab.ga.slots import Select

NORMAL_GRID = np.linspace(-6.0, 6.0, 12_001)  # standard normal fitness; integrals have an error below 1e-6


class Curve(NamedTuple):
    """How a selection operator divides the parents among a large population.

    Attributes:
        share: Function from the poorest fraction of the population to its share of the parents.
        is_drawn: Whether each parent is drawn independently; otherwise every individual is selected exactly as often as
            the curve predicts.
    """

    share: Callable[[Floats], Floats]
    is_drawn: bool = True


def _tournament_curve(*, size: int = 3) -> Curve:
    return Curve(lambda fraction: fraction**size)


def _rank_curve(*, pressure: float = 1.8) -> Curve:
    return Curve(lambda fraction: (2 - pressure) * fraction + (pressure - 1) * fraction**2)


def _top_half_curve() -> Curve:
    return Curve(lambda fraction: np.maximum(0.0, 2 * fraction - 1), is_drawn=False)


def _uniform_curve() -> Curve:
    return Curve(lambda fraction: fraction)


_CURVES: Mapping[Any, Callable[..., Curve]] = {
    selection.tournament: _tournament_curve,
    selection.rank: _rank_curve,
    selection.top_half: _top_half_curve,
    selection.uniform: _uniform_curve,
}
"""Curves, keyed by operator. ``gradient`` has none, because its curve depends on the distribution of the fitness."""


def selection_curve(select: Select) -> Curve | None:
    """Return the curve of a selection operator; None if its theory is unknown.

    Args:
        select: Operator, with its parameters bound by ``functools.partial``.
    """
    return _lookup(_CURVES, select)


class Theory(NamedTuple):
    """Values of a selection operator for a large population with normally distributed fitness.

    Attributes:
        intensity: Mean fitness of the parents minus that of the population, in standard deviations of the population.
        variance: Variance of the parents' fitness, as a fraction of that of the population.
        loss_of_diversity: Share of the places among the parents that poorer individuals lose to fitter ones (Blickle &
            Thiele 1996, Evolutionary Computation 4(4)).
        unselected: Share of the population that is never selected if there are as many parents as individuals (Motoki
            2002, Evolutionary Computation 10(4)).
    """

    intensity: float
    variance: float
    loss_of_diversity: float
    unselected: float


def selection_theory(curve: Curve) -> Theory:
    """Compute the values of a selection operator for a large population with normally distributed fitness."""
    fraction = ndtr(NORMAL_GRID)
    middle = (NORMAL_GRID[1:] + NORMAL_GRID[:-1]) / 2
    share = curve.share(fraction)
    parents = np.diff(share)
    individuals = np.diff(fraction)
    copies = parents / individuals
    never = np.exp(-copies) if curve.is_drawn else np.maximum(0.0, 1 - copies)
    intensity = float(middle @ parents)
    return Theory(
        intensity=round(intensity, 12),  # exactly 0 for uniform selection
        variance=float(middle**2 @ parents) - intensity**2,
        loss_of_diversity=float((fraction - share).max()),
        unselected=float(never @ individuals),
    )


def takeover_theory(curve: Curve, population_size: int, max_generations: int) -> Floats:
    """Return the expected share of copies of the best individual in each generation, by selection alone.

    After Goldberg & Deb 1991, FOGA 1. In a tournament of k, the share of all others in the next generation is the k-th
    power of their share in this one.

    Args:
        curve: Curve of the operator.
        population_size: Number of individuals; a single one is the best in generation 0.
        max_generations: Number of generations after which the calculation ends.

    Returns:
        Share in generation 0, 1, … up to the first in which less than one individual is expected not to be a copy;
        shape (n,).
    """
    shares = [1 / population_size]
    while shares[-1] < 1 - 1 / population_size and len(shares) <= max_generations:
        others = np.array(1 - shares[-1])
        shares.append(1 - float(curve.share(others)))
    return np.array(shares)


# ---------------------------------------------------------------------------------- probabilities of each individual


def exact_probabilities(select: Select, fitness: Floats, n_parents: int) -> Floats | None:
    """Return each individual's probability of becoming a parent; None if there is no formula for the operator.

    Args:
        select: Operator, with its parameters bound by ``functools.partial``.
        fitness: Fitness of each individual, shape (n,); finite.
        n_parents: Number of parents that are selected together.

    Returns:
        Expected share of the parents, shape (n,).
    """
    return _lookup(_PROBABILITIES, select, fitness, n_parents)


def _gradient_probabilities(fitness: Floats, _n_parents: int) -> Floats:
    return selection.gradient_probabilities(fitness)


def _rank_probabilities(fitness: Floats, _n_parents: int, *, pressure: float = 1.8) -> Floats:
    return selection.rank_probabilities(fitness, pressure=pressure)


def _uniform_probabilities(fitness: Floats, _n_parents: int) -> Floats:
    return np.full(len(fitness), 1 / len(fitness))


def _top_half_probabilities(fitness: Floats, n_parents: int) -> Floats:
    best = np.argsort(-fitness, kind="stable")[: math.ceil(len(fitness) / 2)]
    return np.bincount(np.resize(best, n_parents), minlength=len(fitness)) / n_parents


def _tournament_probabilities(fitness: Floats, _n_parents: int, *, size: int = 3) -> Floats:
    """Return each individual's probability of winning a tournament; equally fit individuals are equally probable."""
    _, level, n_equal = np.unique(fitness, return_inverse=True, return_counts=True)
    below = np.concatenate([[0.0], np.cumsum(n_equal) / len(fitness)])
    return (np.diff(below**size) / n_equal)[level]


_PROBABILITIES: Mapping[Any, Callable[..., Floats]] = {
    selection.gradient: _gradient_probabilities,
    selection.rank: _rank_probabilities,
    selection.uniform: _uniform_probabilities,
    selection.top_half: _top_half_probabilities,
    selection.tournament: _tournament_probabilities,
}


def _lookup(formulas: Mapping[Any, Callable[..., Any]], select: Select, *arguments: object) -> Any:
    """Call the formula of an operator with its bound parameters; return None if there is no formula."""
    bound: dict[str, Any] = {}
    while isinstance(select, partial):
        if select.args:
            return None
        bound = select.keywords | bound
        select = select.func
    formula = formulas.get(select)
    return formula(*arguments, **bound) if formula else None
