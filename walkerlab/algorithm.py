"""The algorithm's settings filled in: each slot's names become functions, with their parameters bound.

The functions at the end are the steps of one generation, under the names of the design of 2017.
"""

import inspect
from collections.abc import Callable
from functools import partial
from types import ModuleType
from typing import Any

import numpy as np
from numpy.random import Generator

from walkerlab.ga import check, crossover, mutation, selection
from walkerlab.ga.crossover import Children
from walkerlab.ga.loop import Operators, cross_in_turn, mutate_in_turn, select_in_turn
from walkerlab.genes import Floats, Genes, Indices
from walkerlab.genome import Genome
from walkerlab.limits import genes_of, repair
from walkerlab.quantity import Choice, function_name
from walkerlab.randomness import stream
from walkerlab.settings import Algorithm, Crossover, Mutation, Robot, Selection

Operator = Callable[..., Any]

ROOMS: dict[type[Choice], ModuleType] = {Selection: selection, Crossover: crossover, Mutation: mutation}
"""Where the functions of each kind live, each under the name of its choice."""


def operators(algorithm: Algorithm) -> Operators:
    """Turn the settings' slots into functions.

    An operator is given those of ``rate``, ``scale`` and ``favored`` that it takes as keywords and that are not
    bound already: so the sliders reach a student's own mutation as soon as it asks for them.
    """
    offered = {
        "rate": algorithm.mutation_rate,
        "scale": algorithm.mutation_scale,
        "favored": algorithm.favored_gene.name,
    }

    def function(operator: Choice | Operator) -> Operator:
        plain = getattr(ROOMS[type(operator)], operator.name) if isinstance(operator, Choice) else operator
        wanted = inspect.signature(plain).parameters
        bound = plain.keywords if isinstance(plain, partial) else {}
        given = {name: value for name, value in offered.items() if name in wanted and name not in bound}
        return partial(plain, **given) if given else plain

    slots = (algorithm.selection, algorithm.crossover, algorithm.mutation)
    select, cross, mutate = (tuple(map(function, in_turn(slot))) for slot in slots)
    return Operators(select=select, cross=cross, mutate=mutate)


def in_turn(slot: Any) -> tuple[Choice | Operator, ...]:
    """Return what fills a slot as a tuple, be it one operator or several."""
    return slot if isinstance(slot, tuple) else (slot,)


def slot_names(algorithm: Algorithm) -> str:
    """Name the operators behind a child: ``gradient > paired > randomized``; several in one slot joined by ``+``."""
    return " > ".join(
        "+".join(one.name if isinstance(one, Choice) else function_name(one) for one in in_turn(slot))
        for slot in (algorithm.selection, algorithm.crossover, algorithm.mutation)
    )


def check_own_operators(algorithm: Algorithm, genes: Genes) -> None:
    """Try each operator of the user's own once, before any physics runs.

    Raises:
        OperatorError: naming the operator, what was expected, what came, and the mend.
    """
    filled = operators(algorithm)
    slots: tuple[tuple[Any, tuple[Operator, ...], Callable[[Operator], None]], ...] = (
        (algorithm.selection, filled.select, lambda select: check.check_select(select)),
        (algorithm.crossover, filled.cross, lambda cross: check.check_cross(cross, genes)),
        (algorithm.mutation, filled.mutate, lambda mutate: check.check_mutate(mutate, genes)),
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
    """Draw the (size, n_genes) genomes of generation 0, each from a stream of its own."""
    return np.array([generate_robot_gene(robot, rng=stream(seed, "population", 0, i)).values for i in range(size)])


def select_from_population(fitness: Floats, n_parents: int, algorithm: Algorithm, *, generation: int) -> Indices:
    """Choose (n_parents,) indices into (n,) fitness, as this generation's step does."""
    return select_in_turn(operators(algorithm).select, fitness, n_parents, seed=algorithm.seed, generation=generation)


def crossover_population(
    parents: Floats, fitness: Floats, n_children: int, robot: Robot, algorithm: Algorithm, *, generation: int
) -> Children:
    """Cross (n_parents, n_genes) parents into children, with their parents' indices."""
    cross, genes = operators(algorithm).cross, genes_of(robot)
    return cross_in_turn(cross, parents, fitness, n_children, genes=genes, seed=algorithm.seed, generation=generation)


def mutate_population(genomes: Floats, robot: Robot, algorithm: Algorithm, *, generation: int) -> Floats:
    """Mutate (n, n_genes) genomes, and repair them so that every robot obeys the limits."""
    mutate, genes = operators(algorithm).mutate, genes_of(robot)
    return repair(mutate_in_turn(mutate, genomes, genes, seed=algorithm.seed, generation=generation), robot)
