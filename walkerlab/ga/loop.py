"""Generation after generation: selection, crossover, mutation, repair, evaluation; the caller iterates."""

from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, Protocol, TypeVar

import numpy as np

from walkerlab.ga.crossover import Children
from walkerlab.ga.genes import Floats, Genes, Indices
from walkerlab.ga.selection import require_finite
from walkerlab.ga.slots import Cross, Mutate, Select, run_cross, run_mutate, run_select
from walkerlab.ga.user_functions import OperatorError
from walkerlab.randomness import stream
from walkerlab.readonly import ReadOnlyArrays

NOT_COUNTED = -np.inf
"""The fitness of an individual that does not count: it is hidden from selection and has no children."""


class Evaluated(Protocol):
    """Whatever is known of an individual; the genetic algorithm looks at its fitness only."""

    @property
    def fitness(self) -> float:
        """Higher is better; ``NOT_COUNTED`` if it does not count."""
        ...


Evaluation = TypeVar("Evaluation", bound=Evaluated)


@dataclass(frozen=True)
class Operators:
    """What fills each slot: one function, or several that are applied in turn.

    Attributes:
        select: each but the first selects among those that the one before chose.
        cross: each but the first crosses the children of the one before.
        mutate: each but the first mutates what the one before made.
    """

    select: tuple[Select, ...]
    cross: tuple[Cross, ...]
    mutate: tuple[Mutate, ...]

    def __post_init__(self) -> None:
        """Refuse an empty slot."""
        for slot, operators in vars(self).items():
            if not operators:
                raise ValueError(f"Operators.{slot} is empty; it must hold one function or more.")


@dataclass(frozen=True, eq=False)
class Population(ReadOnlyArrays, Generic[Evaluation]):
    """One generation, a row for each individual.

    Attributes:
        generation: 0 is the random one.
        genomes: (n, n_genes) read-only.
        individuals: (n,) read-only, each one's number; no two in a run are the same.
        born: (n,) read-only, the generation in which each was born; elites are older than their generation.
        parents: (n,) each one's parents, as their numbers in ascending order; none in generation 0.
        evaluations: (n,) what ``evaluate`` found out.
        n_born: how many have been born in the run so far; the next one's number.
    """

    generation: int
    genomes: Floats
    individuals: Indices
    born: Indices
    parents: tuple[tuple[int, ...], ...]
    evaluations: Sequence[Evaluation]
    n_born: int

    def __post_init__(self) -> None:
        """Make sure that all can be compared, and guard the arrays.

        Raises:
            ValueError: if a fitness is NaN or +inf.
        """
        for individual, fitness in zip(self.individuals, self.fitness, strict=True):
            if not fitness < np.inf:
                raise ValueError(
                    f"individual {individual} has fitness {fitness}; it must be a finite number, or -inf for an "
                    "individual that does not count. Mend the fitness function."
                )
        super().__post_init__()

    @cached_property
    def fitness(self) -> Floats:
        """(n,) higher is better; ``NOT_COUNTED`` where an individual does not count."""
        fitness = np.array([evaluation.fitness for evaluation in self.evaluations], dtype=np.float64)
        fitness.setflags(write=False)
        return fitness


def first_population(genomes: Floats, evaluate: Callable[[Floats], Sequence[Evaluation]]) -> Population[Evaluation]:
    """Evaluate generation 0.

    Args:
        genomes: (n, n_genes).
        evaluate: (n, n_genes) genomes to n results, each with a ``fitness``.

    Returns:
        A population without parents.

    Raises:
        ValueError: if results are missing, or a fitness is NaN or +inf.
    """
    n = len(genomes)
    return Population(
        generation=0,
        genomes=genomes.copy(),
        individuals=np.arange(n),
        born=np.zeros(n, dtype=np.intp),
        parents=((),) * n,
        evaluations=_evaluations(evaluate, genomes),
        n_born=n,
    )


def next_population(
    population: Population[Evaluation],
    operators: Operators,
    genes: Genes,
    evaluate: Callable[[Floats], Sequence[Evaluation]],
    *,
    repair: Callable[[Floats], Floats],
    n_elites: int,
    seed: int,
    guests: Floats | None = None,
) -> Population[Evaluation]:
    """Breed and evaluate one more generation of the same size.

    Args:
        population: the generation before.
        operators: what fills each slot.
        genes: the gene table.
        evaluate: (n_children, n_genes) genomes to as many results; it never sees an elite again.
        repair: brings (n_children, n_genes) mutated genomes back within all limits.
        n_elites: how many of the best are carried over unchanged, with all that is known of them; fewer, if
            fewer count.
        seed: the run's seed; each operator draws from a stream of its own.
        guests: (n_guests, n_genes) of nobody's breeding, which take the places of the last children.

    Returns:
        The elites, best first, then the children, then the guests, who have no parents.

    Raises:
        OperatorError: if an operator goes wrong.
        ValueError: if ``n_elites`` leaves no room for a child, there are more guests than children, results are
            missing, or a fitness is NaN or +inf.
    """
    n = len(population.genomes)
    if not 0 <= n_elites < n:
        raise ValueError(
            f"n_elites is {n_elites}; it must be 0 to {n - 1}, so that at least one of the {n} is a child. "
            "It is how many of the best are carried over unchanged."
        )
    generation = population.generation + 1
    best = np.argsort(-population.fitness, kind="stable")[:n_elites]
    elites: list[int] = best[population.fitness[best] != NOT_COUNTED].tolist()
    n_children = n - len(elites)

    chosen = select_in_turn(
        operators.select, population.fitness, n_children + n_children % 2, seed=seed, generation=generation
    )
    crossed = cross_in_turn(
        operators.cross,
        population.genomes[chosen],
        np.where(population.fitness == NOT_COUNTED, 0.0, population.fitness)[chosen],
        n_children,
        genes=genes,
        seed=seed,
        generation=generation,
    )
    mutated = mutate_in_turn(operators.mutate, crossed.genomes, genes, seed=seed, generation=generation)
    guests = np.empty((0, len(genes))) if guests is None else guests
    n_bred = n_children - len(guests)
    if n_bred < 0:
        raise ValueError(f"{len(guests)} genomes are to be put into a generation of {n_children} children")
    children = np.concatenate([repair(mutated)[:n_bred], guests])

    origins: list[list[int]] = population.individuals[chosen][crossed.parents[:n_bred]].tolist()
    parents = [tuple(sorted(set(row))) for row in origins] + [()] * len(guests)
    return Population(
        generation=generation,
        genomes=np.concatenate([population.genomes[elites], children]),
        individuals=np.concatenate([population.individuals[elites], population.n_born + np.arange(n_children)]),
        born=np.concatenate([population.born[elites], np.full(n_children, generation)]),
        parents=(*(population.parents[i] for i in elites), *parents),
        evaluations=[*(population.evaluations[i] for i in elites), *_evaluations(evaluate, children)],
        n_born=population.n_born + n_children,
    )


def select_in_turn(
    operators: Sequence[Select], fitness: Floats, n_parents: int, *, seed: int, generation: int
) -> Indices:
    """Select, then select again among those chosen, and so on.

    Args:
        operators: the selections, in their order.
        fitness: (n,) those ``NOT_COUNTED`` are hidden; if none counts, all are selected from as equals.
        n_parents: how many parents each of them names.
        seed: the run's seed.
        generation: the generation that is being made.

    Returns:
        (n_parents,) indices into ``fitness``.

    Raises:
        OperatorError: if an operator goes wrong.
        ValueError: if a fitness is NaN or +inf.
    """
    counted = np.where(fitness == NOT_COUNTED, 0.0, fitness)
    require_finite(counted)
    chosen = np.flatnonzero(fitness != NOT_COUNTED)
    if not len(chosen):
        chosen = np.arange(len(fitness))
    for place, select in enumerate(operators):
        with _turn("selection", seed, generation, place) as rng:
            chosen = chosen[run_select(select, counted[chosen], n_parents, rng=rng)]
    return chosen


def cross_in_turn(
    operators: Sequence[Cross],
    parents: Floats,
    fitness: Floats,
    n_children: int,
    *,
    genes: Genes,
    seed: int,
    generation: int,
) -> Children:
    """Cross, then cross the children, and so on; a child is expected to be as fit as its parents' mean.

    Args:
        operators: the crossovers, in their order; all but the last make as many children as there are parents.
        parents: (n_parents, n_genes).
        fitness: (n_parents,) finite.
        n_children: how many the last of them makes.
        genes: the gene table, for those that ask for it.
        seed: the run's seed.
        generation: the generation that is being made.

    Returns:
        Children, with indices into ``parents`` however often they were crossed.

    Raises:
        OperatorError: if an operator goes wrong.
    """
    children = Children(parents, np.arange(len(parents))[:, None])
    for place, cross in enumerate(operators):
        is_last = place == len(operators) - 1
        n = n_children if is_last else len(parents)
        with _turn("crossover", seed, generation, place) as rng:
            genomes, origins = run_cross(cross, children.genomes, fitness, n, genes=genes, rng=rng)
        children = Children(genomes, children.parents[origins].reshape(n, -1))
        fitness = fitness[origins].mean(axis=1)
    return children


def mutate_in_turn(operators: Sequence[Mutate], genomes: Floats, genes: Genes, *, seed: int, generation: int) -> Floats:
    """Mutate, then mutate again, and so on.

    Args:
        operators: the mutations, in their order.
        genomes: (n, n_genes).
        genes: the gene table.
        seed: the run's seed.
        generation: the generation that is being made.

    Returns:
        (n, n_genes)

    Raises:
        OperatorError: if an operator goes wrong.
    """
    for place, mutate in enumerate(operators):
        with _turn("mutation", seed, generation, place) as rng:
            genomes = run_mutate(mutate, genomes, genes, rng=rng)
    return genomes


def _evaluations(evaluate: Callable[[Floats], Sequence[Evaluation]], genomes: Floats) -> Sequence[Evaluation]:
    """Evaluate a copy, which may be written into, and make sure that no result is missing."""
    evaluations = evaluate(genomes.copy())
    if len(evaluations) != len(genomes):
        raise ValueError(
            f"evaluate returned {len(evaluations)} results where {len(genomes)} were due; "
            "it must return one for each genome, in the order given."
        )
    return evaluations


@contextmanager
def _turn(slot: str, seed: int, generation: int, place: int) -> Generator[np.random.Generator, None, None]:
    """Lend one operator its own stream, and say when it was if it goes wrong."""
    try:
        yield stream(seed, slot, generation, place)
    except OperatorError as error:
        error.where = f"while making generation {generation}"
        raise
