"""The algorithm's settings filled in: each slot's names become functions, with their parameters bound.

The functions at the end are the steps of one generation, under the names of the design of 2017.
"""

import inspect
from collections.abc import Callable, Iterable
from functools import partial
from types import ModuleType
from typing import Any, TypeAlias

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from walkerlab.ga import checks, crossover, mutation, selection
from walkerlab.ga.crossover import Children
from walkerlab.ga.genes import Floats, Genes, Indices
from walkerlab.ga.loop import NOT_COUNTED, Operators, cross_in_turn, mutate_in_turn, select_in_turn
from walkerlab.ga.selection import require_finite
from walkerlab.genome.genome import Genome, read_genomes
from walkerlab.genome.repair import genes_of, repair
from walkerlab.randomness import stream
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.arguments import require_algorithm, require_count
from walkerlab.settings.choices import Choice, Crossover, Mutation, Selection
from walkerlab.settings.robot import Robot
from walkerlab.settings.values import brief, function_name

MIN_COUNTED = 8  # individuals, below which chance alone can put the median close to the best

Operator = Callable[..., Any]

Individuals: TypeAlias = Iterable[Genome | str | ArrayLike]
"""Genomes, their texts, or an (n, n_genes) array."""

ROOMS: dict[type[Choice], ModuleType] = {Selection: selection, Crossover: crossover, Mutation: mutation}
"""Where the functions of each kind live, each under the name of its choice."""


def operators(algorithm: Algorithm) -> Operators:
    """Turn the settings' slots into functions.

    A mutation is given those of ``rate``, ``scale`` and ``favored`` that it takes as keywords and that are not bound
    already: so the sliders reach a student's own as soon as it asks for them.
    """
    require_algorithm(algorithm)
    offered = {
        "rate": algorithm.mutation_rate,
        "scale": algorithm.mutation_scale,
        "favored": algorithm.favored_gene.name,
    }

    def function(operator: Choice | Operator) -> Operator:
        return getattr(ROOMS[type(operator)], operator.name) if isinstance(operator, Choice) else operator

    def with_sliders(mutate: Operator) -> Operator:
        wanted = _open_keywords(mutate)
        given = {name: value for name, value in offered.items() if name in wanted}
        return partial(mutate, **given) if given else mutate

    slots = (algorithm.selection, algorithm.crossover, algorithm.mutation)
    select, cross, mutate = (tuple(map(function, in_turn(slot))) for slot in slots)
    return Operators(select=select, cross=cross, mutate=tuple(map(with_sliders, mutate)))


def _open_keywords(operator: Operator) -> set[str]:
    """Name the keywords that an operator takes and that are not bound already; none if it does not say."""
    try:
        wanted = inspect.signature(operator).parameters
    except (TypeError, ValueError):  # whatever is wrong with it, the check knows the words
        return set()
    return wanted.keys() - (operator.keywords if isinstance(operator, partial) else {})


def in_turn(slot: Any) -> tuple[Choice | Operator, ...]:
    """Return what fills a slot as a tuple, be it one operator or several."""
    return slot if isinstance(slot, tuple) else (slot,)


def slot_names(algorithm: Algorithm) -> str:
    """Name the operators behind a child: ``gradient > paired > randomized``; several in one slot joined by ``+``."""
    return " > ".join(
        "+".join(one.name if isinstance(one, Choice) else function_name(one) for one in in_turn(slot))
        for slot in (algorithm.selection, algorithm.crossover, algorithm.mutation)
    )


def lost_pressure(fitness: Floats, algorithm: Algorithm) -> str:
    """Explain why ``gradient`` hardly prefers the best of a generation, and how to fix it; "" if it does prefer it.

    The measure is ``selection.pressure``: the pressure counts as lost below ``MIN_PRESSURE``, although the best and the
    median fitness differ.

    Args:
        fitness: Fitness of each individual of a generation, shape (n,).
        algorithm: Settings of the algorithm.
    """
    counted = fitness[fitness != NOT_COUNTED]
    if operators(algorithm).select[0] is not selection.gradient or len(counted) < MIN_COUNTED:
        return ""
    worst, median, best = np.quantile(counted, [0, 0.5, 1])
    pressure = selection.pressure(selection.gradient_probabilities(counted))
    if pressure >= selection.MIN_PRESSURE or np.isclose(median, best):
        return ""
    return (
        f"the lowest fitness, {worst:g}, is so far below the others that gradient selection hardly prefers the best "
        f"robot: its fitness is {best:g} and the median {median:g}, yet it is selected only {pressure - 1:.2%} more "
        'often than the median robot. Select by order instead, with settings.with_(selection="rank"), or limit the '
        "fitness from below."
    )


def check_own_operators(algorithm: Algorithm, genes: Genes) -> None:
    """Try each operator of the user's own once, before any physics runs.

    Raises:
        OperatorError: naming the operator, what was expected, what came, and the mend.
    """
    filled = operators(algorithm)
    slots: tuple[tuple[Any, tuple[Operator, ...], Callable[[Operator], None]], ...] = (
        (algorithm.selection, filled.select, lambda select: checks.check_select(select)),
        (algorithm.crossover, filled.cross, lambda cross: checks.check_cross(cross, genes)),
        (algorithm.mutation, filled.mutate, lambda mutate: checks.check_mutate(mutate, genes)),
    )
    for given, made, try_out in slots:
        for choice, function in zip(in_turn(given), made, strict=True):
            if not isinstance(choice, Choice):
                try_out(function)


# -------------------------------------------------------------------------------------- the steps, one by one


def generate_robot_gene(robot: Robot, *, rng: Generator) -> Genome:
    """Draw one random genome within the limits."""
    return Genome.random(robot, rng=rng)


def generate_robot_population(robot: Robot, size: int, *, seed: int) -> Floats:
    """Draw the (size, n_genes) genomes of generation 0, each from a stream of its own.

    Raises:
        ValueError: if ``size`` is under 1.
    """
    size = require_count(size, "size", "how many robots the population has")
    seed = require_count(seed, "seed", "the seed of the random generator", low=0)
    return np.array([generate_robot_gene(robot, rng=stream(seed, "population", 0, i)).values for i in range(size)])


def select_from_population(fitness: ArrayLike, n_parents: int, algorithm: Algorithm, *, generation: int) -> Indices:
    """Choose (n_parents,) indices into (n,) fitness, as this generation's step does."""
    select, numbers = operators(algorithm).select, _fitness(fitness)
    if not len(numbers):
        raise ValueError("fitness is empty; it must have a number for each individual to select from")
    require_count(n_parents, "n_parents", "how many parents to select")
    require_count(generation, "generation", "the number of the generation that is being made", low=0)
    return select_in_turn(select, numbers, n_parents, seed=algorithm.seed, generation=generation)


def crossover_population(
    parents: Individuals, fitness: ArrayLike, n_children: int, robot: Robot, algorithm: Algorithm, *, generation: int
) -> Children:
    """Cross parents, whose (n_parents,) fitness is given, into children, with their parents' indices.

    Raises:
        ValueError: if there is not one fitness for each parent, or one is NaN or +inf.
    """
    cross, genes, table = operators(algorithm).cross, genes_of(robot), _table(parents, robot)
    fitness = _fitness(fitness)
    if not len(table):
        raise ValueError("parents is empty; it must have one genome or more")
    require_count(n_children, "n_children", "how many children to make")
    require_count(generation, "generation", "the number of the generation that is being made", low=0)
    if fitness.shape != (len(table),):
        raise ValueError(
            f"fitness must have the shape ({len(table)},), a number for each of the parents; got {fitness.shape}. "
            "Of those that were chosen it is fitness[chosen]."
        )
    counted = np.where(fitness == NOT_COUNTED, 0.0, fitness)
    require_finite(counted)
    return cross_in_turn(cross, table, counted, n_children, genes=genes, seed=algorithm.seed, generation=generation)


def mutate_population(genomes: Individuals, robot: Robot, algorithm: Algorithm, *, generation: int) -> Floats:
    """Mutate genomes, and repair them so that every robot obeys the limits: (n, n_genes)."""
    mutate, genes, table = operators(algorithm).mutate, genes_of(robot), _table(genomes, robot)
    require_count(generation, "generation", "the number of the generation that is being made", low=0)
    return repair(mutate_in_turn(mutate, table, genes, seed=algorithm.seed, generation=generation), robot)


def _fitness(given: ArrayLike) -> Floats:
    """Return fitness as an (n,) array of floats.

    Raises:
        ValueError: If it is not a row of numbers.
    """
    try:
        fitness = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        fitness = np.empty(())
    if fitness.ndim != 1:
        raise ValueError(f"fitness must be a row of numbers, one for each individual; got {brief(given)}")
    return fitness


def _table(genomes: Individuals, robot: Robot) -> Floats:
    """Return genomes as an (n, n_genes) array, or say of the first that has another length how to mend it."""
    rows, n_genes = [genome.values for genome in read_genomes(genomes)], len(genes_of(robot))
    for i, row in enumerate(rows):
        if len(row) != n_genes:
            raise ValueError(
                f"genome {i} has {len(row)} genes; for these limits it must have {n_genes}. "
                "genome.within(robot) brings it there."
            )
    return np.array(rows).reshape(-1, n_genes)
