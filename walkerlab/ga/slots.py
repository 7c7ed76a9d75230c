"""The three operator slots: how each operator is called, and how its result is checked.

An operator also receives each of the following that it accepts as a keyword, unless ``functools.partial`` has bound
it: ``generation``, the number of the generation being created; ``generations``, the number of generations of the run;
``genes``, the gene table (crossover operators); ``genomes``, the genomes of the individuals in ``fitness`` (selection
operators).
"""

import inspect
from collections.abc import Callable, Mapping
from contextlib import suppress
from copy import deepcopy
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from walkerlab.ga.crossover import Children
from walkerlab.ga.genes import Floats, Genes, Indices
from walkerlab.ga.user_functions import RUN_TIME_LIMIT, OperatorError, Slot, call_in_slot, describe_result

Select: TypeAlias = Callable[..., Indices]
"""``select(fitness, n_parents, *, rng)`` -> indices into ``fitness``, shape (n_parents,).

With a keyword ``genomes``, it also receives the genomes of the individuals in ``fitness``, shape (n, n_genes).
"""

Cross: TypeAlias = Callable[..., tuple[Floats, Indices]]
"""``cross(parents, fitness, n_children, *, rng)`` -> ``Children``; a keyword ``genes`` receives the gene table."""

Mutate: TypeAlias = Callable[..., Floats]
"""``mutate(genomes, genes, *, rng)`` -> genomes, shape (n, n_genes)."""


SELECTION_SLOT = Slot("selection", "select(fitness, n_parents, *, rng)", "fitness = fitness.copy()")
CROSSOVER_SLOT = Slot("crossover", "cross(parents, fitness, n_children, *, rng)", "parents = parents.copy()")
MUTATION_SLOT = Slot("mutation", "mutate(genomes, genes, *, rng)", "genomes = genomes.copy()")


def run_select(
    select: Select,
    fitness: Floats,
    n_parents: int,
    *,
    rng: Generator,
    offered: Mapping[str, object] = {},
    time_limit: float = RUN_TIME_LIMIT,
) -> Indices:
    """Call a selection operator and check what it returns.

    Args:
        select: Selection operator.
        fitness: Fitness of each individual, shape (n,); finite.
        n_parents: Number of parents to select; may be more than n.
        rng: Random generator; the operator receives copies of it and of all arrays.
        offered: Further arguments; the operator receives those that it accepts as keywords.
        time_limit: Time limit of a call, s.

    Returns:
        Indices into ``fitness``, shape (n_parents,).

    Raises:
        OperatorError: If the operator returns anything else, or breaks another rule for operators.
    """
    label = SELECTION_SLOT.label(select)
    keywords = _requested(select, offered)

    def call() -> object:
        return select(_read_only_copy(fitness), n_parents, rng=deepcopy(rng), **_read_only_copies(keywords))

    result = call_in_slot(SELECTION_SLOT, select, call, time_limit)
    selected = _as_array(result)
    if selected.shape != (n_parents,):
        raise OperatorError(
            f"{label} must return n_parents = {n_parents} parents, an array of shape ({n_parents},); it returned "
            f"{describe_result(result)}",
            "If it selects fewer, np.resize(selected, n_parents) repeats them.",
        )
    return _check_indices(selected, label, len(fitness), "the individuals in fitness")


def run_cross(
    cross: Cross,
    parents: Floats,
    fitness: Floats,
    n_children: int,
    *,
    rng: Generator,
    offered: Mapping[str, object] = {},
    time_limit: float = RUN_TIME_LIMIT,
) -> Children:
    """Call a crossover operator and check what it returns.

    Args:
        cross: Crossover operator.
        parents: Genomes of the parents, shape (n_parents, n_genes).
        fitness: Fitness of each parent, shape (n_parents,); finite.
        n_children: Number of children.
        rng: Random generator; the operator receives copies of it and of all arrays.
        offered: Further arguments; the operator receives those that it accepts as keywords.
        time_limit: Time limit of a call, s.

    Returns:
        Children, with genomes of shape (n_children, n_genes) and parents of shape (n_children, k).

    Raises:
        OperatorError: If the operator returns anything else, or breaks another rule for operators.
    """
    keywords = _requested(cross, offered)
    label = CROSSOVER_SLOT.label(cross)

    def call() -> object:
        return cross(_read_only_copy(parents), _read_only_copy(fitness), n_children, rng=deepcopy(rng), **keywords)

    children, parents_of_each = _check_pair(call_in_slot(CROSSOVER_SLOT, cross, call, time_limit), label)
    genomes = _check_genomes(children, label, (n_children, parents.shape[1]), "(n_children, n_genes)")
    indices = _as_array(parents_of_each)
    if indices.ndim != 2 or len(indices) != n_children or not indices.size:
        raise OperatorError(
            f"{label} must return the parents of each child, an array of shape (n_children, k) = ({n_children}, k) "
            f"for k parents each; it returned {describe_result(parents_of_each)}",
            "With one parent for each child, that is mothers[:, None]; with two, np.stack([mothers, fathers], axis=1).",
        )
    return Children(genomes, _check_indices(indices, label, len(parents), "the given parents"))


def run_mutate(
    mutate: Mutate,
    genomes: Floats,
    genes: Genes,
    *,
    rng: Generator,
    offered: Mapping[str, object] = {},
    time_limit: float = RUN_TIME_LIMIT,
) -> Floats:
    """Call a mutation operator and check what it returns.

    Args:
        mutate: Mutation operator.
        genomes: Genomes, shape (n, n_genes).
        genes: Gene table.
        rng: Random generator; the operator receives copies of it and of all arrays.
        offered: Further arguments; the operator receives those that it accepts as keywords.
        time_limit: Time limit of a call, s.

    Returns:
        Mutated genomes, shape (n, n_genes).

    Raises:
        OperatorError: If the operator returns anything else, or breaks another rule for operators.
    """
    keywords = _requested(mutate, offered)

    def call() -> object:
        return mutate(_read_only_copy(genomes), genes, rng=deepcopy(rng), **keywords)

    result = call_in_slot(MUTATION_SLOT, mutate, call, time_limit)
    return _check_genomes(result, MUTATION_SLOT.label(mutate), genomes.shape, "(n, n_genes)")


def unbound_keywords(operator: Callable[..., object]) -> set[str]:
    """Return the parameters of an operator that are not bound by name; empty if it has no signature."""
    try:
        parameters = inspect.signature(operator).parameters
    except (TypeError, ValueError):  # functions of C libraries may have no signature
        return set()
    return parameters.keys() - (operator.keywords if isinstance(operator, partial) else {})


def _requested(operator: Callable[..., object], offered: Mapping[str, object]) -> dict[str, Any]:
    """Return the offered arguments that an operator accepts as keywords."""
    names = unbound_keywords(operator)
    return {name: value for name, value in offered.items() if name in names}


def _read_only_copies(keywords: Mapping[str, Any]) -> dict[str, Any]:
    """Return keyword arguments with a read-only copy of each array."""
    return {
        name: _read_only_copy(value) if isinstance(value, np.ndarray) else value for name, value in keywords.items()
    }


def _read_only_copy(array: Floats) -> Floats:
    copy = array.copy()
    copy.setflags(write=False)
    return copy


def _as_array(result: object) -> NDArray[Any]:
    """Convert a result to an array; ragged rows become a zero-dimensional array."""
    try:
        return np.asarray(result)
    except ValueError:
        return np.asarray(None)


def _check_pair(result: Any, label: str) -> tuple[object, object]:
    """Return the two elements of a pair.

    Raises:
        OperatorError: If the result is not a tuple or list of two elements.
    """
    match result:
        case [first, second]:  # does not match an array
            return first, second
        case _:
            raise OperatorError(
                f"{label} must return two arrays, the children and the indices of their parents; it returned "
                f"{describe_result(result)}",
                "Its last line should be: return children, parents_of_each.",
            )


def _check_indices(indices: NDArray[Any], label: str, n: int, meaning: str) -> Indices:
    """Return indices as integers; floats with whole values are converted.

    Args:
        indices: Indices that an operator returned.
        label: Label of the operator.
        n: Number of elements that the indices refer to.
        meaning: What the elements are, as worded in the message.

    Raises:
        OperatorError: If they are not whole numbers from 0 to n - 1.
    """
    requirement = f"{label} must return indices of {meaning}, whole numbers from 0 to {n - 1}"
    if indices.dtype.kind == "f" and np.isfinite(indices).all() and (indices == np.rint(indices)).all():
        indices = np.clip(indices, -1, n).astype(np.intp)  # an index out of range stays out of range
    if not np.issubdtype(indices.dtype, np.integer):
        raise OperatorError(
            f"{requirement}; it returned {describe_result(indices)}",
            "np.flatnonzero(mask) converts a mask to indices; np.argsort returns indices, and np.sort returns values.",
        )
    for outside in indices[(indices < 0) | (indices >= n)].flat:
        raise OperatorError(
            f"{requirement}; one of the values it returned is {outside}",
            "An index must be less than len(fitness), as in rng.integers(len(fitness), size=n_parents).",
        )
    return indices.astype(np.intp)


def _check_genomes(result: object, label: str, shape: tuple[int, ...], symbols: str) -> Floats:
    """Return genomes as floats.

    Args:
        result: Genomes that an operator returned.
        label: Label of the operator.
        shape: Expected shape.
        symbols: Expected shape in symbols, such as ``(n, n_genes)``.

    Raises:
        OperatorError: If they do not have this shape, or are not finite numbers.
    """
    genomes = _as_array(result)
    if genomes.dtype.kind == "O":  # such as fractions, or a table with columns of several types
        with suppress(TypeError, ValueError, OverflowError):
            genomes = genomes.astype(np.float64)
    if genomes.shape != shape or genomes.dtype.kind not in "iuf":
        raise OperatorError(
            f"{label} must return genomes as an array of numbers of shape {symbols} = {shape}; "
            f"it returned {describe_result(result)}",
            "Each row is one individual, each column one gene. Check for a missing return, or a missing axis=0.",
        )
    for value in genomes[~np.isfinite(genomes)]:
        raise OperatorError(
            f"{label} must return finite numbers; one of the values it returned is {value}",
            "Check for a division by zero, or a root or logarithm of a negative number.",
        )
    return genomes.astype(np.float64)
