"""The three slots for operators: what is called, with what, and what must come back."""

import inspect
from collections.abc import Callable
from contextlib import suppress
from copy import deepcopy
from typing import Any, TypeAlias

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from walkerlab.ga.crossover import Children
from walkerlab.ga.genes import Floats, Genes, Indices
from walkerlab.ga.user_functions import IN_A_RUN, OperatorError, Slot, ask, portrait

Select: TypeAlias = Callable[..., Indices]
"""``select(fitness, n_parents, *, rng)`` -> (n_parents,) indices into ``fitness``."""

Cross: TypeAlias = Callable[..., tuple[Floats, Indices]]
"""``cross(parents, fitness, n_children, *, rng)`` -> ``Children``; a keyword ``genes`` asks for the gene table."""

Mutate: TypeAlias = Callable[..., Floats]
"""``mutate(genomes, genes, *, rng)`` -> (n, n_genes)."""


SELECTION = Slot("selection", "select(fitness, n_parents, *, rng)", "fitness = fitness.copy()")
CROSSOVER = Slot("crossover", "cross(parents, fitness, n_children, *, rng)", "parents = parents.copy()")
MUTATION = Slot("mutation", "mutate(genomes, genes, *, rng)", "genomes = genomes.copy()")


def run_select(
    select: Select, fitness: Floats, n_parents: int, *, rng: Generator, seconds: float = IN_A_RUN
) -> Indices:
    """Call a selection and make sure of its answer.

    Args:
        select: the operator.
        fitness: (n,) finite.
        n_parents: how many parents to name; may be more than n.
        rng: its source of chance, of which it gets a copy, as of all arrays.
        seconds: that it may take.

    Returns:
        (n_parents,) indices into ``fitness``.

    Raises:
        OperatorError: if it answers with anything else, or does anything else that it must not.
    """
    who = SELECTION.who(select)
    answer = ask(SELECTION, select, lambda: select(_lent(fitness), n_parents, rng=deepcopy(rng)), seconds)
    chosen = _array(answer)
    if chosen.shape != (n_parents,):
        raise OperatorError(
            f"{who} must name n_parents = {n_parents} parents, an array of shape ({n_parents},); it returned "
            f"{portrait(answer)}",
            "Where too few are chosen, np.resize(chosen, n_parents) repeats them.",
        )
    return _indices(chosen, who, len(fitness), "the individuals in fitness")


def run_cross(
    cross: Cross,
    parents: Floats,
    fitness: Floats,
    n_children: int,
    *,
    genes: Genes,
    rng: Generator,
    seconds: float = IN_A_RUN,
) -> Children:
    """Call a crossover, with the gene table if it asks for one, and make sure of its answer.

    Args:
        cross: the operator.
        parents: (n_parents, n_genes).
        fitness: (n_parents,) finite.
        n_children: how many.
        genes: the gene table.
        rng: its source of chance, of which it gets a copy, as of all arrays.
        seconds: that it may take.

    Returns:
        Children: (n_children, n_genes) genomes and (n_children, k) parents.

    Raises:
        OperatorError: if it answers with anything else, or does anything else that it must not.
    """
    handed = {"genes": genes} if asks_for_genes(cross) else {}
    who = CROSSOVER.who(cross)

    def call() -> object:
        return cross(_lent(parents), _lent(fitness), n_children, rng=deepcopy(rng), **handed)

    answers = _pair(ask(CROSSOVER, cross, call, seconds), who)
    genomes = _genomes(answers[0], who, (n_children, parents.shape[1]), "(n_children, n_genes)")
    origins = _array(answers[1])
    if origins.ndim != 2 or len(origins) != n_children or not origins.size:
        raise OperatorError(
            f"{who} must say whose each child is, by an array of shape (n_children, k) = ({n_children}, k) with k "
            f"parents for each; it returned {portrait(answers[1])}",
            "With one parent for each child that is mothers[:, None], with two np.stack([mothers, fathers], axis=1).",
        )
    return Children(genomes, _indices(origins, who, len(parents), "the parents given"))


def run_mutate(mutate: Mutate, genomes: Floats, genes: Genes, *, rng: Generator, seconds: float = IN_A_RUN) -> Floats:
    """Call a mutation and make sure of its answer.

    Args:
        mutate: the operator.
        genomes: (n, n_genes).
        genes: the gene table.
        rng: its source of chance, of which it gets a copy, as of all arrays.
        seconds: that it may take.

    Returns:
        (n, n_genes)

    Raises:
        OperatorError: if it answers with anything else, or does anything else that it must not.
    """
    answer = ask(MUTATION, mutate, lambda: mutate(_lent(genomes), genes, rng=deepcopy(rng)), seconds)
    return _genomes(answer, MUTATION.who(mutate), genomes.shape, "(n, n_genes)")


def asks_for_genes(cross: Cross) -> bool:
    """Say whether a crossover has a keyword ``genes``, and so wants the gene table."""
    try:
        return "genes" in inspect.signature(cross).parameters
    except ValueError:  # a function of a C library may not say what it takes
        return False


def _lent(array: Floats) -> Floats:
    """Return a copy that cannot be written into."""
    copy = array.copy()
    copy.setflags(write=False)
    return copy


def _array(answer: object) -> NDArray[Any]:
    """Return an answer as an array; rows of different lengths are none."""
    try:
        return np.asarray(answer)
    except ValueError:
        return np.asarray(None)


def _pair(answer: Any, who: str) -> tuple[object, object]:
    """Refuse what is not two things."""
    match answer:
        case [first, second]:  # a tuple or a list, but no array, of two
            return first, second
        case _:
            raise OperatorError(
                f"{who} must return two arrays, the children and the indices of their parents; it returned "
                f"{portrait(answer)}",
                "End it with: return children, parents_of_each.",
            )


def _indices(indices: NDArray[Any], who: str, n: int, of: str) -> Indices:
    """Return indices as integers, also from whole floats; refuse what does not name some of ``n``."""
    if indices.dtype.kind == "f" and np.isfinite(indices).all() and (indices == np.rint(indices)).all():
        indices = np.clip(indices, -1, n).astype(np.intp)  # whatever is out of range stays so
    if not np.issubdtype(indices.dtype, np.integer):
        raise OperatorError(
            f"{who} must name {of} by whole numbers, 0 to {n - 1}; it returned {portrait(indices)}",
            "np.flatnonzero(mask) turns a mask into places; np.argsort gives places, where np.sort gives values.",
        )
    for outside in indices[(indices < 0) | (indices >= n)].flat:
        raise OperatorError(
            f"{who} must name {of} by whole numbers, 0 to {n - 1}; it returned {outside} among them",
            "Draw from as many as it is given, as in rng.integers(len(fitness), size=n_parents).",
        )
    return indices.astype(np.intp)


def _genomes(answer: object, who: str, shape: tuple[int, ...], symbols: str) -> Floats:
    """Refuse what is not a table of finite numbers."""
    genomes = _array(answer)
    if genomes.dtype.kind == "O":  # as of fractions, or of a table with columns of several types
        with suppress(TypeError, ValueError, OverflowError):
            genomes = genomes.astype(np.float64)
    if genomes.shape != shape or genomes.dtype.kind not in "iuf":
        raise OperatorError(
            f"{who} must return genomes, numbers of shape {symbols} = {shape}; it returned {portrait(answer)}",
            "Each row is one individual, each column one gene; is a return missing, or an axis=0?",
        )
    for stray in genomes[~np.isfinite(genomes)]:
        raise OperatorError(
            f"{who} must return finite numbers; it returned {stray} among them",
            "Look for a division by zero, or for a root or a logarithm of something negative.",
        )
    return genomes.astype(np.float64)
