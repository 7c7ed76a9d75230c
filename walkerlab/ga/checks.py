"""Try a new operator on a trial population before anything costly runs."""

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np

from walkerlab.ga.genes import Floats, Genes
from walkerlab.ga.slots import CROSSOVER, MUTATION, SELECTION, Cross, Mutate, Select, run_cross, run_mutate, run_select
from walkerlab.ga.user_functions import IN_A_CHECK, OperatorError, Slot, name_of
from walkerlab.randomness import stream

N = 20
"""Individuals in the trial population."""

NEGATIVE_AND_TIED = np.array([-3.0, -3.0, -1.5, 0.0, 0.5, 0.5, 0.5, 2.0, 7.25, -0.25] * 2)
EQUAL = np.full(N, -1.0)


def check_select(select: Select) -> None:
    """Make sure that a selection can be used.

    Args:
        select: ``select(fitness, n_parents, *, rng)``.

    Raises:
        OperatorError: if it cannot; the message names it, what is expected, what it did, and the mend.
    """
    for fitness in (NEGATIVE_AND_TIED, EQUAL):
        for n_parents in (N - 2, 10 * N):  # more than there are: so it is where some individuals do not count
            _check(SELECTION, select, run_select, fitness, n_parents)


def check_cross(cross: Cross, genes: Genes) -> None:
    """Make sure that a crossover can be used.

    Args:
        cross: ``cross(parents, fitness, n_children, *, rng)``.
        genes: the gene table of the genomes that it will get.

    Raises:
        OperatorError: if it cannot; the message names it, what is expected, what it did, and the mend.
    """
    for fitness in (NEGATIVE_AND_TIED, EQUAL):
        for n_children in (N, N - 1):
            _check(CROSSOVER, cross, run_cross, _toy(genes), fitness, n_children, genes=genes)


def check_mutate(mutate: Mutate, genes: Genes) -> None:
    """Make sure that a mutation can be used.

    Args:
        mutate: ``mutate(genomes, genes, *, rng)``.
        genes: the gene table of the genomes that it will get.

    Raises:
        OperatorError: if it cannot; the message names it, what is expected, what it did, and the mend.
    """
    _check(MUTATION, mutate, run_mutate, _toy(genes), genes)


def _toy(genes: Genes) -> Floats:
    values = genes.low + (genes.high - genes.low) * stream(0, "check").random((N, len(genes)))
    return np.where(genes.is_count, np.rint(values), values)


def _check(
    slot: Slot, operator: Callable[..., Any], run: Callable[..., Any], *arguments: object, **keywords: object
) -> None:
    """Call an operator twice with the same arguments and the same chance."""
    if not callable(operator):
        must = f"must be a function, {slot.signature}"
        raise OperatorError(f"{slot.kind} {operator!r} {must}; it is a {type(operator).__name__}")
    _check_signature(operator, slot, arguments, keywords)
    trial = f"a trial population of {N} individuals" + ("" if slot is MUTATION else " with negative and equal fitness")
    try:
        first, second = (
            run(operator, *arguments, rng=stream(0, "check", 1), seconds=IN_A_CHECK, **keywords) for _ in range(2)
        )
        if not all(map(np.array_equal, first, second)):
            must = "must give the same answer for the same rng, or no run can be repeated"
            raise OperatorError(
                f"{slot.who(operator)} {must}; it gave two", f"{slot.chance} And let it remember nothing."
            )
    except OperatorError as error:
        error.where = f"when tried on {trial}"
        raise


def _check_signature(
    operator: Callable[..., Any], slot: Slot, arguments: tuple[object, ...], keywords: dict[str, object]
) -> None:
    """Refuse a function that cannot be called as its slot calls it."""
    try:
        takes = inspect.signature(operator)
    except ValueError:  # a function of a C library may not say what it takes
        return
    handed = {name: value for name, value in keywords.items() if name in takes.parameters}
    try:
        takes.bind(*arguments, rng=None, **handed)
    except TypeError as error:
        raise OperatorError(
            f"{slot.who(operator)} must be a function {slot.signature}; it is {name_of(operator)}{takes}: {error}",
            "Other parameters need a default, or functools.partial to bind them.",
        ) from error
