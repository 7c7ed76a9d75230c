"""The individuals of one generation: genomes, numbers, parents and evaluations."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, Protocol, TypeVar

import numpy as np

from walkerlab.ga.genes import Floats, Indices
from walkerlab.system.readonly import ReadOnlyArrays

NOT_COUNTED = -np.inf
"""Fitness of an individual that does not count: it is excluded from selection and has no children."""


class Evaluated(Protocol):
    """Result of the evaluation of one individual; the genetic algorithm uses its fitness only."""

    @property
    def fitness(self) -> float:
        """Fitness; higher is better, ``NOT_COUNTED`` if the individual does not count."""
        ...


EvaluationT = TypeVar("EvaluationT", bound=Evaluated)


def fitness_for_comparison(fitness: Floats) -> Floats:
    """Return fitness with 0 in place of ``NOT_COUNTED``, as operators receive it."""
    return np.where(fitness == NOT_COUNTED, 0.0, fitness)


@dataclass(frozen=True, eq=False)
class Population(ReadOnlyArrays, Generic[EvaluationT]):
    """One generation, with a row for each individual.

    Attributes:
        generation: Number of the generation; 0 is the initial random generation.
        genomes: Genomes, shape (n, n_genes), read-only.
        individuals: Number of each individual, unique within a run, shape (n,), read-only.
        born: Generation in which each individual was born, shape (n,), read-only; elites are older than their
            generation.
        parents: Numbers of each individual's parents in ascending order, n tuples; empty in generation 0.
        evaluations: Result of ``evaluate`` for each individual, n of them.
        n_born: Number of individuals born in the run so far; the number of the next individual.
    """

    generation: int
    genomes: Floats
    individuals: Indices
    born: Indices
    parents: tuple[tuple[int, ...], ...]
    evaluations: Sequence[EvaluationT]
    n_born: int

    def __post_init__(self) -> None:
        """Check that every fitness can be compared, and make the arrays read-only.

        Raises:
            ValueError: If a fitness is NaN or +inf.
        """
        for individual, fitness in zip(self.individuals, self.fitness, strict=True):
            if not fitness < np.inf:
                raise ValueError(
                    f"individual {individual} has fitness {fitness}; it must be a finite number, or -inf for an "
                    "individual that does not count. Fix the fitness function."
                )
        super().__post_init__()

    @cached_property
    def fitness(self) -> Floats:
        """Fitness, shape (n,); higher is better, ``NOT_COUNTED`` where an individual does not count."""
        fitness = np.array([evaluation.fitness for evaluation in self.evaluations], dtype=np.float64)
        fitness.setflags(write=False)
        return fitness
