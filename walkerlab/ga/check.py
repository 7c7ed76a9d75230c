"""Try a new operator on a toy population before anything costly runs."""

import inspect
import traceback
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from walkerlab.ga.slots import Cross, Mutate, OperatorError, Select, name_of, run_cross, run_mutate, run_select
from walkerlab.genes import Floats, Genes
from walkerlab.randomness import stream

N = 20
"""Individuals in the toy population."""

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
            _check("selection", "select(fitness, n_parents, *, rng)", select, run_select, (fitness,), n_parents)


def check_cross(cross: Cross, genes: Genes) -> None:
    """Make sure that a crossover can be used.

    Args:
        cross: ``cross(parents, fitness, n_children, *, rng)``.
        genes: the gene table of the genomes that it will get.

    Raises:
        OperatorError: if it cannot; the message names it, what is expected, what it did, and the mend.
    """
    signature = "cross(parents, fitness, n_children, *, rng)"
    for fitness in (NEGATIVE_AND_TIED, EQUAL):
        for n_children in (N, N - 1):
            _check("crossover", signature, cross, run_cross, (_toy(genes), fitness), n_children, genes=genes)


def check_mutate(mutate: Mutate, genes: Genes) -> None:
    """Make sure that a mutation can be used.

    Args:
        mutate: ``mutate(genomes, genes, *, rng)``.
        genes: the gene table of the genomes that it will get.

    Raises:
        OperatorError: if it cannot; the message names it, what is expected, what it did, and the mend.
    """
    _check("mutation", "mutate(genomes, genes, *, rng)", mutate, run_mutate, (_toy(genes),), genes)


def _toy(genes: Genes) -> Floats:
    values = genes.low + (genes.high - genes.low) * stream(0, "check").random((N, len(genes)))
    return np.where(genes.is_count, np.rint(values), values)


def _check(
    slot: str,
    signature: str,
    operator: Callable[..., Any],
    run: Callable[..., Any],
    arrays: tuple[Floats, ...],
    *others: object,
    **keywords: object,
) -> None:
    """Call an operator twice with the same arguments and the same chance."""
    if not callable(operator):
        raise OperatorError(f"{slot} {operator!r} must be a function, {signature}; it is a {type(operator).__name__}.")
    who = f"{slot} {name_of(operator)!r}"
    _check_signature(operator, who, signature, (*arrays, *others), keywords)

    answers: list[tuple[Any, ...]] = []
    for _ in range(2):
        given = [array.copy() for array in arrays]
        try:
            answer: Any = run(operator, *given, *others, rng=stream(0, "check", 1), **keywords)
        except OperatorError:
            raise
        except Exception as error:
            toy = "a toy population" if slot == "mutation" else "a toy population with negative and equal fitness"
            raise OperatorError(
                f"{who} raised {type(error).__name__}: {error}{_line_of(error, operator)}, when tried on {toy}. "
                "It must work on every population."
            ) from error
        if not all(map(np.array_equal, arrays, given)):
            raise OperatorError(
                f"{who} must leave what it is given as it was; it wrote into its arguments. Let it work on a copy, "
                "as in genomes = genomes.copy(); +=, sort and shuffle write in place."
            )
        answers.append(tuple(answer) if slot == "crossover" else (answer,))
    if not all(map(np.array_equal, *answers)):
        raise OperatorError(
            f"{who} must give the same answer for the same rng, or no run can be repeated; it gave two. Let all its "
            "chance come from rng, as in rng.random(), rng.integers(n) or rng.choice(n), not from random or np.random."
        )


def _line_of(error: Exception, operator: Callable[..., Any]) -> str:
    """Say which line of the operator raised an error, counted as in its file or notebook cell."""
    own = getattr(inspect.unwrap(operator.func if isinstance(operator, partial) else operator), "__code__", None)
    lines = [line for frame, line in traceback.walk_tb(error.__traceback__) if frame.f_code is own]
    return f" (line {lines[-1]})" if lines else ""


def _check_signature(
    operator: Callable[..., Any], who: str, signature: str, arguments: tuple[object, ...], keywords: dict[str, object]
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
            f"{who} must be a function {signature}; it is {name_of(operator)}{takes}: {error}. "
            "Other parameters need a default, or functools.partial to bind them."
        ) from error
