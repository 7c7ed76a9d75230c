"""Checks of operators on a trial population, before any simulation."""

import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from walkerlab.ga.genes import Floats, Genes
from walkerlab.ga.slots import (
    CROSSOVER_SLOT,
    MUTATION_SLOT,
    SELECTION_SLOT,
    Cross,
    Mutate,
    Select,
    run_cross,
    run_mutate,
    run_select,
    unbound_keywords,
)
from walkerlab.ga.user_functions import CHECK_TIME_LIMIT, OperatorError, Slot, name_of
from walkerlab.system.randomness import random_stream

TRIAL_SIZE = 20
"""Number of individuals in the trial population."""

MIXED_FITNESS = np.array([-3.0, -3.0, -1.5, 0.0, 0.5, 0.5, 0.5, 2.0, 7.25, -0.25] * 2)  # negative and tied values
EQUAL_FITNESS = np.full(TRIAL_SIZE, -1.0)


TRIAL_GENERATIONS = 10
"""Number of generations of the trial run; operators are called as for its second and its last generation."""


def check_select(select: Select, genes: Genes | None = None) -> None:
    """Check that a selection operator works on a trial population.

    Args:
        select: ``select(fitness, n_parents, *, rng)``.
        genes: Gene table of the run, for selection operators with a keyword ``genomes``.

    Raises:
        OperatorError: If it does not; the message says what is expected, what it did, and how to fix it.
    """
    genomes = {} if genes is None else {"genomes": _trial_genomes(genes)}
    for fitness in (MIXED_FITNESS, EQUAL_FITNESS):
        for n_parents in (TRIAL_SIZE - 2, 10 * TRIAL_SIZE):  # also more parents than individuals, as if few count
            for offered in _trial_times(select):
                offered |= genomes
                _check_operator(SELECTION_SLOT, select, run_select, fitness, n_parents, offered=offered)


def check_cross(cross: Cross, genes: Genes) -> None:
    """Check that a crossover operator works on a trial population.

    Args:
        cross: ``cross(parents, fitness, n_children, *, rng)``.
        genes: Gene table of the run.

    Raises:
        OperatorError: If it does not; the message says what is expected, what it did, and how to fix it.
    """
    for fitness in (MIXED_FITNESS, EQUAL_FITNESS):
        for n_children in (TRIAL_SIZE, TRIAL_SIZE - 1):
            for offered in _trial_times(cross):
                offered |= {"genes": genes}
                arguments = (_trial_genomes(genes), fitness, n_children)
                _check_operator(CROSSOVER_SLOT, cross, run_cross, *arguments, offered=offered)


def check_mutate(mutate: Mutate, genes: Genes) -> None:
    """Check that a mutation operator works on a trial population.

    Args:
        mutate: ``mutate(genomes, genes, *, rng)``.
        genes: Gene table of the run.

    Raises:
        OperatorError: If it does not; the message says what is expected, what it did, and how to fix it.
    """
    for offered in _trial_times(mutate):
        _check_operator(MUTATION_SLOT, mutate, run_mutate, _trial_genomes(genes), genes, offered=offered)


def _trial_times(operator: Callable[..., Any]) -> list[dict[str, object]]:
    """Return the arguments about time for each trial: one trial, or two for an operator that depends on time."""
    times: list[dict[str, object]] = [
        {"generation": generation, "generations": TRIAL_GENERATIONS} for generation in (1, TRIAL_GENERATIONS - 1)
    ]
    return times if unbound_keywords(operator) & {"generation", "generations"} else times[:1]


def _trial_genomes(genes: Genes) -> Floats:
    """Return random genomes within the ranges, shape (TRIAL_SIZE, n_genes)."""
    values = genes.low + (genes.high - genes.low) * random_stream(0, "check").random((TRIAL_SIZE, len(genes)))
    return np.where(genes.is_count, np.rint(values), values)


def _check_operator(
    slot: Slot,
    operator: Callable[..., Any],
    run: Callable[..., Any],
    *arguments: object,
    offered: Mapping[str, object],
) -> None:
    """Call an operator twice with the same arguments and random numbers, and compare the results.

    Args:
        slot: Slot of the operator.
        operator: Operator to check.
        run: Function that calls the operator and checks its result.
        *arguments: Arguments of the operator.
        offered: Further arguments; the operator receives those that it accepts as keywords.

    Raises:
        OperatorError: If the operator cannot be called, fails a check, or returns two different results.
    """
    if not callable(operator):
        raise OperatorError(
            f"{slot.kind} {operator!r} must be a function, {slot.signature}; it is a {type(operator).__name__}"
        )
    _check_signature(operator, slot, arguments, offered)
    try:
        first, second = (
            run(operator, *arguments, rng=random_stream(0, "check", 1), offered=offered, time_limit=CHECK_TIME_LIMIT)
            for _ in range(2)
        )
        if not all(map(np.array_equal, first, second)):
            raise OperatorError(
                f"{slot.label(operator)} must return the same result for the same rng, or the run could not be "
                "repeated; it returned two different results",
                f"{slot.repeatability_advice} Do not store anything between calls.",
            )
    except OperatorError as error:
        fitness = "" if slot is MUTATION_SLOT else " with negative and equal fitness"
        error.context = f"when tried on a trial population of {TRIAL_SIZE} individuals{fitness}"
        raise


def _check_signature(
    operator: Callable[..., Any], slot: Slot, arguments: tuple[object, ...], offered: Mapping[str, object]
) -> None:
    """Check that a function accepts the arguments with which its slot calls it.

    Raises:
        OperatorError: If it does not.
    """
    try:
        signature = inspect.signature(operator)
    except ValueError:  # functions of C libraries may have no signature
        return
    names = unbound_keywords(operator)
    accepted = {name: value for name, value in offered.items() if name in names}
    try:
        signature.bind(*arguments, rng=None, **accepted)
    except TypeError as error:
        raise OperatorError(
            f"{slot.label(operator)} must be a function {slot.signature}; it is {name_of(operator)}{signature}: "
            f"{error}",
            "Give all other parameters a default, or bind them with functools.partial.",
        ) from error
