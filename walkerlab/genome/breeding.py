"""The steps of one generation, and the operators named in an algorithm's settings, with their parameters bound.

The public functions at the end keep the names that they had in the original version of 2017.
"""

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
from walkerlab.ga.operators import Operators, cross_in_turn, mutate_in_turn, select_in_turn
from walkerlab.ga.population import fitness_for_comparison
from walkerlab.ga.selection import require_finite
from walkerlab.ga.slots import unbound_keywords
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome, read_genomes
from walkerlab.genome.repair import repair
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.arguments import require_algorithm, require_count
from walkerlab.settings.choices import Choice, Crossover, Mutation, Selection
from walkerlab.settings.robot import Robot
from walkerlab.settings.values import function_name, short_repr
from walkerlab.system.randomness import random_stream

GENERATION_MEANING = "the number of the generation being created"

Operator = Callable[..., Any]

Individuals: TypeAlias = Iterable[Genome | str | ArrayLike]
"""Genomes, their text forms, or an array of shape (n, n_genes)."""

OPERATOR_MODULES: dict[type[Choice], ModuleType] = {
    Selection: selection,
    Crossover: crossover,
    Mutation: mutation,
}
"""Module of each kind of operator; each function has the same name as the enumeration member that selects it."""


def resolve_operators(algorithm: Algorithm) -> Operators:
    """Return the functions in each slot of an algorithm.

    If a mutation operator accepts ``rate``, ``scale`` or ``favored`` as a keyword that is not yet bound, that keyword
    is bound to the value in the settings. The settings therefore also control user functions with these keywords.
    """
    require_algorithm(algorithm)
    mutation_settings = {
        "rate": algorithm.mutation_rate,
        "scale": algorithm.mutation_scale,
        "favored": algorithm.favored_gene.name,
    }

    def resolve(operator: Choice | Operator) -> Operator:
        return getattr(OPERATOR_MODULES[type(operator)], operator.name) if isinstance(operator, Choice) else operator

    def bind_settings(mutate: Operator) -> Operator:
        keywords = unbound_keywords(mutate)
        values = {name: value for name, value in mutation_settings.items() if name in keywords}
        return partial(mutate, **values) if values else mutate

    slots = (algorithm.selection, algorithm.crossover, algorithm.mutation)
    select, cross, mutate = (tuple(map(resolve, slot_entries(slot))) for slot in slots)
    return Operators(select=select, cross=cross, mutate=tuple(map(bind_settings, mutate)))


def slot_entries(slot: Any) -> tuple[Choice | Operator, ...]:
    """Return the operators in a slot as a tuple, whether the setting holds one or several."""
    return slot if isinstance(slot, tuple) else (slot,)


def describe_operators(algorithm: Algorithm) -> str:
    """Return the names of all operators: ``gradient > paired > randomized``, joined by ``+`` within a slot."""
    return " > ".join(
        "+".join(entry.name if isinstance(entry, Choice) else function_name(entry) for entry in slot_entries(slot))
        for slot in (algorithm.selection, algorithm.crossover, algorithm.mutation)
    )


def check_user_operators(algorithm: Algorithm, genes: Genes) -> None:
    """Check each user operator of an algorithm on a trial population, before any simulation.

    Raises:
        OperatorError: If an operator fails; the message says which one, what is expected, what it did, and how to fix
            it.
    """
    resolved = resolve_operators(algorithm)
    slots: tuple[tuple[Any, tuple[Operator, ...], Callable[[Operator], None]], ...] = (
        (algorithm.selection, resolved.select, lambda select: checks.check_select(select, genes)),
        (algorithm.crossover, resolved.cross, lambda cross: checks.check_cross(cross, genes)),
        (algorithm.mutation, resolved.mutate, lambda mutate: checks.check_mutate(mutate, genes)),
    )
    for slot, functions, check in slots:
        for entry, function in zip(slot_entries(slot), functions, strict=True):
            if not isinstance(entry, Choice):
                check(function)


# ------------------------------------------------------------------------------------------ the steps of a generation


def generate_robot_gene(robot: Robot, *, rng: Generator) -> Genome:
    """Return a random genome within the limits.

    Args:
        robot: Limits of the robots.
        rng: Random number generator.
    """
    return Genome.random(robot, rng=rng)


def generate_robot_population(robot: Robot, size: int, *, seed: int) -> Floats:
    """Return the genomes of generation 0, each from its own random generator.

    Args:
        robot: Limits of the robots.
        size: Number of genomes.
        seed: Seed of the run.

    Returns:
        Genomes, shape (size, n_genes).

    Raises:
        ValueError: If ``size`` is less than 1.
    """
    size = require_count(size, "size", "the number of robots in the population")
    seed = require_count(seed, "seed", "the seed of the random generator", low=0)
    return np.array(
        [generate_robot_gene(robot, rng=random_stream(seed, "population", 0, i)).values for i in range(size)]
    )


def select_from_population(
    fitness: ArrayLike,
    n_parents: int,
    algorithm: Algorithm,
    *,
    generation: int,
    genomes: Individuals | None = None,
) -> Indices:
    """Select parents with the algorithm's selection operators.

    Args:
        fitness: Fitness of each individual, shape (n,); higher is better, -inf for an individual that does not count.
        n_parents: Number of parents to select.
        algorithm: Settings of the algorithm.
        generation: Number of the generation being created, which determines the random numbers.
        genomes: Genome of each individual, all of the same length; required by selection
            operators with a keyword ``genomes``.

    Returns:
        Indices into ``fitness``, shape (n_parents,).

    Raises:
        ValueError: If ``fitness`` is empty or not a row of numbers, or contains NaN or +inf; or if the number of
            genomes differs from the number of fitness values.
    """
    select = resolve_operators(algorithm).select
    values = _as_fitness(fitness)
    if not len(values):
        raise ValueError("fitness is empty; it must contain a number for each individual that can be selected")
    require_count(n_parents, "n_parents", "the number of parents to select")
    require_count(generation, "generation", GENERATION_MEANING, low=0)
    table = None if genomes is None else np.array([genome.values for genome in read_genomes(genomes)])
    if table is not None and len(table) != len(values):
        raise ValueError(f"genomes must have one genome for each fitness, {len(values)}; got {len(table)}")
    return select_in_turn(
        select,
        values,
        n_parents,
        seed=algorithm.seed,
        generation=generation,
        generations=algorithm.generations,
        genomes=table,
    )


def crossover_population(
    parents: Individuals, fitness: ArrayLike, n_children: int, robot: Robot, algorithm: Algorithm, *, generation: int
) -> Children:
    """Produce children with the algorithm's crossover operators.

    Args:
        parents: Genomes of the parents.
        fitness: Fitness of each parent, shape (n_parents,); -inf (does not count) is treated as 0.
        n_children: Number of children.
        robot: Limits of the robots.
        algorithm: Settings of the algorithm.
        generation: Number of the generation being created; it determines the random numbers.

    Returns:
        Children, with the indices of their parents.

    Raises:
        ValueError: If the number of fitness values differs from the number of parents, or a value is NaN or +inf.
    """
    cross = resolve_operators(algorithm).cross
    genes = build_genes(robot)
    genomes = _as_table(parents, robot)
    fitness = _as_fitness(fitness)
    if not len(genomes):
        raise ValueError("parents is empty; it must have at least one genome")
    require_count(n_children, "n_children", "the number of children")
    require_count(generation, "generation", GENERATION_MEANING, low=0)
    if fitness.shape != (len(genomes),):
        raise ValueError(
            f"fitness must have the shape ({len(genomes)},), one number for each parent; got {fitness.shape}. "
            "For selected parents, that is fitness[selected]."
        )
    comparable = fitness_for_comparison(fitness)
    require_finite(comparable)
    return cross_in_turn(
        cross,
        genomes,
        comparable,
        n_children,
        genes=genes,
        seed=algorithm.seed,
        generation=generation,
        generations=algorithm.generations,
    )


def mutate_population(genomes: Individuals, robot: Robot, algorithm: Algorithm, *, generation: int) -> Floats:
    """Mutate genomes with the algorithm's mutation operators, and repair them to bring every robot within the limits.

    Args:
        genomes: Genomes to mutate.
        robot: Limits of the robots.
        algorithm: Settings of the algorithm.
        generation: Number of the generation being created; it determines the random numbers.

    Returns:
        Mutated genomes, shape (n, n_genes).
    """
    mutate = resolve_operators(algorithm).mutate
    genes = build_genes(robot)
    table = _as_table(genomes, robot)
    require_count(generation, "generation", GENERATION_MEANING, low=0)
    mutated = mutate_in_turn(
        mutate, table, genes, seed=algorithm.seed, generation=generation, generations=algorithm.generations
    )
    return repair(mutated, robot)


def _as_fitness(given: ArrayLike) -> Floats:
    """Return fitness as an (n,) array of floats.

    Raises:
        ValueError: If it is not a row of numbers.
    """
    try:
        fitness = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        fitness = np.empty(())
    if fitness.ndim != 1:
        raise ValueError(f"fitness must be a row of numbers, one for each individual; got {short_repr(given)}")
    return fitness


def _as_table(genomes: Individuals, robot: Robot) -> Floats:
    """Return genomes as an array of shape (n, n_genes).

    Raises:
        ValueError: If a genome has the wrong length; the message explains how to fix it.
    """
    rows = [genome.values for genome in read_genomes(genomes)]
    n_genes = len(build_genes(robot))
    for i, row in enumerate(rows):
        if len(row) != n_genes:
            raise ValueError(
                f"genome {i} has {len(row)} genes; for these limits it must have {n_genes}. Use genome.within(robot)."
            )
    return np.array(rows).reshape(-1, n_genes)
