"""The operators of an algorithm, one or several in each slot, applied in turn, each with its own random generator."""

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from walkerlab.ga.crossover import Children
from walkerlab.ga.genes import Floats, Genes, Indices
from walkerlab.ga.population import NOT_COUNTED, fitness_for_comparison
from walkerlab.ga.selection import require_finite
from walkerlab.ga.slots import Cross, Mutate, Select, run_cross, run_mutate, run_select
from walkerlab.ga.user_functions import OperatorError
from walkerlab.system.randomness import random_stream


@dataclass(frozen=True)
class Operators:
    """Operators in each slot: one function, or several that are applied in turn.

    Attributes:
        select: Selection operators; each but the first selects among the individuals that the previous one selected.
        cross: Crossover operators; each but the first crosses the children of the previous one.
        mutate: Mutation operators; each but the first mutates the result of the previous one.
    """

    select: tuple[Select, ...]
    cross: tuple[Cross, ...]
    mutate: tuple[Mutate, ...]

    def __post_init__(self) -> None:
        """Check that no slot is empty.

        Raises:
            ValueError: If a slot is empty.
        """
        for slot, operators in vars(self).items():
            if not operators:
                raise ValueError(f"Operators.{slot} is empty; it must contain at least one function.")


def select_in_turn(
    operators: Sequence[Select],
    fitness: Floats,
    n_parents: int,
    *,
    seed: int,
    generation: int,
    generations: int | None = None,
    genomes: Floats | None = None,
) -> Indices:
    """Apply selection operators in turn, each to the individuals that the previous one selected.

    Args:
        operators: Selection operators, in their order.
        fitness: Fitness of each individual, shape (n,); values ``NOT_COUNTED`` are excluded, unless all are.
        n_parents: Number of parents that each operator returns.
        seed: Seed of the run.
        generation: Number of the generation being created.
        generations: Number of generations of the run, for operators with this keyword.
        genomes: Genome of each individual, shape (n, n_genes), for operators with this keyword.

    Returns:
        Indices into ``fitness``, shape (n_parents,).

    Raises:
        OperatorError: If an operator fails.
        ValueError: If a fitness is NaN or +inf.
    """
    comparable = fitness_for_comparison(fitness)
    require_finite(comparable)
    selected = np.flatnonzero(fitness != NOT_COUNTED)
    if not len(selected):
        selected = np.arange(len(fitness))
    for position, select in enumerate(operators):
        with _operator_stream("selection", seed, generation, position) as rng:
            offered = _known(generation=generation, generations=generations)
            if genomes is not None:
                offered["genomes"] = genomes[selected]
            selected = selected[run_select(select, comparable[selected], n_parents, rng=rng, offered=offered)]
    return selected


def cross_in_turn(
    operators: Sequence[Cross],
    parents: Floats,
    fitness: Floats,
    n_children: int,
    *,
    genes: Genes,
    seed: int,
    generation: int,
    generations: int | None = None,
) -> Children:
    """Apply crossover operators in turn, each to the children of the previous one, with their parents' mean fitness.

    Args:
        operators: Crossover operators, in their order; all but the last produce as many children as there are parents.
        parents: Genomes of the parents, shape (n_parents, n_genes).
        fitness: Fitness of each parent, shape (n_parents,); finite.
        n_children: Number of children that the last operator produces.
        genes: Gene table.
        seed: Seed of the run.
        generation: Number of the generation being created.
        generations: Number of generations of the run, for operators with this keyword.

    Returns:
        Children, with indices into ``parents`` even after several crossovers.

    Raises:
        OperatorError: If an operator fails.
    """
    children = Children(parents, np.arange(len(parents))[:, None])
    offered = _known(genes=genes, generation=generation, generations=generations)
    for position, cross in enumerate(operators):
        is_last = position == len(operators) - 1
        n = n_children if is_last else len(parents)
        with _operator_stream("crossover", seed, generation, position) as rng:
            genomes, direct_parents = run_cross(cross, children.genomes, fitness, n, rng=rng, offered=offered)
        children = Children(genomes, children.parents[direct_parents].reshape(n, -1))
        fitness = fitness[direct_parents].mean(axis=1)
    return children


def mutate_in_turn(
    operators: Sequence[Mutate],
    genomes: Floats,
    genes: Genes,
    *,
    seed: int,
    generation: int,
    generations: int | None = None,
) -> Floats:
    """Apply mutation operators in turn.

    Args:
        operators: Mutation operators, in their order.
        genomes: Genomes, shape (n, n_genes).
        genes: Gene table.
        seed: Seed of the run.
        generation: Number of the generation being created.
        generations: Number of generations of the run, for operators with this keyword.

    Returns:
        Mutated genomes, shape (n, n_genes).

    Raises:
        OperatorError: If an operator fails.
    """
    offered = _known(generation=generation, generations=generations)
    for position, mutate in enumerate(operators):
        with _operator_stream("mutation", seed, generation, position) as rng:
            genomes = run_mutate(mutate, genomes, genes, rng=rng, offered=offered)
    return genomes


def _known(**values: object) -> dict[str, object]:
    """Return the arguments that are not None."""
    return {name: value for name, value in values.items() if value is not None}


@contextmanager
def _operator_stream(
    slot: str, seed: int, generation: int, position: int
) -> Generator[np.random.Generator, None, None]:
    """Yield the random generator of one operator; add the generation number to an OperatorError."""
    try:
        yield random_stream(seed, slot, generation, position)
    except OperatorError as error:
        error.context = f"while making generation {generation}"
        raise
