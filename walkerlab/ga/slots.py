"""The three slots for operators: what is called, with what, and what must come back."""

import inspect
from collections.abc import Callable
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from walkerlab.ga.crossover import Children
from walkerlab.genes import Floats, Genes, Indices

Select: TypeAlias = Callable[..., Indices]
"""``select(fitness, n_parents, *, rng)`` -> (n_parents,) indices into ``fitness``."""

Cross: TypeAlias = Callable[..., tuple[Floats, Indices]]
"""``cross(parents, fitness, n_children, *, rng)`` -> ``Children``; a keyword ``genes`` asks for the gene table."""

Mutate: TypeAlias = Callable[..., Floats]
"""``mutate(genomes, genes, *, rng)`` -> (n, n_genes)."""


class OperatorError(ValueError):
    """An operator does not do what its slot needs; the message says which, what is expected, and the mend."""


def name_of(operator: Callable[..., object]) -> str:
    """Name a function as its author did, also where ``functools.partial`` has bound its parameters."""
    while isinstance(operator, partial):
        operator = operator.func
    return getattr(operator, "__name__", type(operator).__name__)


def run_select(select: Select, fitness: Floats, n_parents: int, *, rng: Generator) -> Indices:
    """Call a selection and make sure of its answer.

    Args:
        select: the operator.
        fitness: (n,) finite.
        n_parents: how many parents to name; may be more than n.
        rng: its source of chance.

    Returns:
        (n_parents,) indices into ``fitness``.

    Raises:
        OperatorError: if it answers with anything else.
    """
    answer = select(fitness, n_parents, rng=rng)
    chosen: NDArray[Any] = np.asarray(answer)
    who = f"selection {name_of(select)!r}"
    if chosen.shape != (n_parents,):
        raise OperatorError(
            f"{who} must name n_parents = {n_parents} parents, an array of shape ({n_parents},); it returned "
            f"{_portrait(answer)}. Where too few are chosen, np.resize(chosen, n_parents) repeats them."
        )
    return _indices(chosen, who, len(fitness), "the individuals in fitness")


def run_cross(
    cross: Cross, parents: Floats, fitness: Floats, n_children: int, *, genes: Genes, rng: Generator
) -> Children:
    """Call a crossover, with the gene table if it asks for one, and make sure of its answer.

    Args:
        cross: the operator.
        parents: (n_parents, n_genes).
        fitness: (n_parents,) finite.
        n_children: how many.
        genes: the gene table.
        rng: its source of chance.

    Returns:
        Children: (n_children, n_genes) genomes and (n_children, k) parents.

    Raises:
        OperatorError: if it answers with anything else.
    """
    handed = {"genes": genes} if asks_for_genes(cross) else {}
    who = f"crossover {name_of(cross)!r}"
    answers = _pair(cross(parents, fitness, n_children, rng=rng, **handed), who)
    genomes = _genomes(answers[0], who, (n_children, parents.shape[1]), "(n_children, n_genes)")
    origins: NDArray[Any] = np.asarray(answers[1])
    if origins.ndim != 2 or len(origins) != n_children or not origins.size:
        raise OperatorError(
            f"{who} must say whose each child is, by an array of shape (n_children, k) = ({n_children}, k) with k "
            f"parents for each; it returned {_portrait(answers[1])}. "
            "With one parent for each child that is mothers[:, None], with two np.stack([mothers, fathers], axis=1)."
        )
    return Children(genomes, _indices(origins, who, len(parents), "the parents given"))


def run_mutate(mutate: Mutate, genomes: Floats, genes: Genes, *, rng: Generator) -> Floats:
    """Call a mutation and make sure of its answer.

    Args:
        mutate: the operator.
        genomes: (n, n_genes).
        genes: the gene table.
        rng: its source of chance.

    Returns:
        (n, n_genes)

    Raises:
        OperatorError: if it answers with anything else.
    """
    answer = mutate(genomes, genes, rng=rng)
    return _genomes(answer, f"mutation {name_of(mutate)!r}", genomes.shape, "(n, n_genes)")


def asks_for_genes(cross: Cross) -> bool:
    """Say whether a crossover has a keyword ``genes``, and so wants the gene table."""
    try:
        return "genes" in inspect.signature(cross).parameters
    except ValueError:  # a function of a C library may not say what it takes
        return False


def _pair(answer: Any, who: str) -> tuple[object, object]:
    """Refuse what is not two things."""
    match answer:
        case [first, second]:  # a tuple or a list, but no array, of two
            return first, second
        case _:
            raise OperatorError(
                f"{who} must return two arrays, the children and the indices of their parents; it returned "
                f"{_portrait(answer)}. End it with: return children, parents_of_each."
            )


def _indices(indices: NDArray[Any], who: str, n: int, of: str) -> Indices:
    """Refuse what does not name some of ``n``."""
    if not np.issubdtype(indices.dtype, np.integer):
        raise OperatorError(
            f"{who} must name {of} by whole numbers, 0 to {n - 1}; it returned {_portrait(indices)}. "
            "np.flatnonzero(mask) turns a mask into places; np.argsort gives places, where np.sort gives values."
        )
    for outside in indices[(indices < 0) | (indices >= n)].flat:
        raise OperatorError(
            f"{who} must name {of} by whole numbers, 0 to {n - 1}; it returned {outside} among them. "
            "Draw from as many as it is given, as in rng.integers(len(fitness), size=n_parents)."
        )
    return indices.astype(np.intp)


def _genomes(answer: object, who: str, shape: tuple[int, ...], symbols: str) -> Floats:
    """Refuse what is not a table of finite numbers."""
    genomes: NDArray[Any] = np.asarray(answer)
    if genomes.shape != shape or not np.issubdtype(genomes.dtype, np.number):
        raise OperatorError(
            f"{who} must return genomes, numbers of shape {symbols} = {shape}; it returned {_portrait(answer)}. "
            "Each row is one individual, each column one gene; is a return missing, or an axis=0?"
        )
    for stray in genomes[~np.isfinite(genomes)]:
        raise OperatorError(
            f"{who} must return finite numbers; it returned {stray} among them. "
            "Look for a division by zero, or for a root or a logarithm of something negative."
        )
    return genomes.astype(np.float64)


def _portrait(answer: object) -> str:
    """Describe a wrong answer in a few words."""
    if answer is None:
        return "nothing (None)"
    if shape := getattr(answer, "shape", None):
        return f"an array of shape {shape}, {getattr(answer, 'dtype', '')}"
    return f"a {type(answer).__name__}: {answer!r:.60}"
