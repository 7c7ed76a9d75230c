"""OneMax: the genetic algorithm on bits instead of robots, where theory predicts how fast a population converges.

The fitness of a string of bits is its number of ones. Without mutation, selection with intensity I raises the share p
of ones by I √(p (1 - p) / L) in each generation, so that p = (1 + sin(I t / √L)) / 2, and all L bits are ones after
(π / 2) √L / I generations (Mühlenbein & Schlierkamp-Voosen 1993, Evolutionary Computation 1(1); Thierens & Goldberg
1994, PPSN III). This assumes a large population, in which crossover has mixed the bits of all parents thoroughly.
"""

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.random import Generator

from walkerlab.analysis.selection import curve_of, read_selections
from walkerlab.analysis.selection_theory import Theory, selection_theory
from walkerlab.ga import crossover
from walkerlab.ga.crossover import Children
from walkerlab.ga.genes import Floats, Genes
from walkerlab.ga.loop import first_population, next_population
from walkerlab.ga.operators import Operators
from walkerlab.settings.arguments import require_count
from walkerlab.system.randomness import random_stream

MAX_GENERATIONS = 1000  # generations after which a run ends even if the population has not converged


class _Count(NamedTuple):
    """Evaluation of a string of bits."""

    fitness: float


def evolve_onemax(
    selections: Any,
    *,
    n_bits: int = 100,
    population_size: int = 400,
    n_matings: int = 3,
    seeds: Iterable[int] = range(5),
) -> pd.DataFrame:
    """Evolve strings of bits with uniform crossover and no mutation until all are identical, and compare with theory.

    Args:
        selections: Selection operator, in any form that ``Algorithm.selection`` accepts; to compare several, a list or
            a dict from names to operators.
        n_bits: Number of bits, L.
        population_size: Number of strings; 4 L is enough. In a small population, some bits become zero in all strings
            by chance, which theory ignores.
        n_matings: Number of times that all strings exchange bits with random partners in each generation. Theory
            assumes many; 3 are almost as good. With 1, the population needs up to a fifth more generations, because
            good bits occur together less often (linkage), so that the fitness varies less: see ``theory_linked``.
        seeds: Seed of each run.

    Returns:
        Table with a row for each operator, seed and generation: ``selection``, ``seed``, ``generation``,
        ``mean_fitness``, ``best_fitness``, ``theory`` (mean fitness for many matings; NaN if the intensity is unknown)
        and ``theory_linked`` (for the given number of matings).

    Raises:
        OperatorError: If a user function fails.
        ValueError: If a number is too small.
    """
    n_bits = require_count(n_bits, "n_bits", "the number of bits")
    population_size = require_count(population_size, "population_size", "the number of strings", low=2)
    n_matings = require_count(n_matings, "n_matings", "the number of matings in each generation")
    seeds = list(seeds)
    tables: list[pd.DataFrame] = []
    intensities: dict[str, float] = {}
    for name, select in read_selections(selections).items():
        curve = curve_of(select)
        theory = None if curve is None else selection_theory(curve)
        intensities[name] = math.nan if theory is None else theory.intensity
        operators = Operators(select=select, cross=(_mate_at_random,) * n_matings, mutate=(_keep,))
        for seed in seeds:
            table = pd.DataFrame(_evolve_bits(operators, n_bits, population_size, seed), columns=["mean", "best"])
            generation = np.arange(len(table))
            linked = np.nan if theory is None else _linked_theory(theory, n_bits, n_matings, len(table))
            columns = {"selection": name, "seed": seed, "generation": generation}
            columns |= {"mean_fitness": table["mean"], "best_fitness": table["best"]}
            columns |= {"theory": onemax_theory(intensities[name], n_bits, generation), "theory_linked": linked}
            tables.append(pd.DataFrame(columns))
    table = pd.concat(tables, ignore_index=True)
    table.attrs = {"n_bits": n_bits, "population_size": population_size, "n_matings": n_matings}
    table.attrs["intensity"] = intensities
    return table


def onemax_theory(intensity: float, n_bits: int, generation: Any) -> Floats:
    """Return the mean fitness that theory predicts if generation 0 is random; see the docstring of this module.

    Args:
        intensity: Selection intensity.
        n_bits: Number of bits.
        generation: Numbers of generations, any shape.
    """
    angle = np.minimum(intensity * np.asarray(generation, dtype=np.float64) / math.sqrt(n_bits), math.pi / 2)
    return n_bits * (1 + np.sin(angle)) / 2


def onemax_times(table: pd.DataFrame) -> pd.DataFrame:
    """Return the number of generations until all strings are identical, measured and in theory.

    Args:
        table: Table from ``evolve_onemax``.

    Returns:
        Table with a row for each operator: ``selection``, ``generations`` (mean over the seeds), ``lowest`` and
        ``highest`` over the seeds, ``theory``, which is (π / 2) √L / I, and ``ratio``, the mean divided by theory.
    """
    scale = math.pi / 2 * math.sqrt(table.attrs["n_bits"])
    rows: list[dict[str, object]] = []
    for name, times in read_times(table).items():
        theory = scale / table.attrs["intensity"][name]
        row = {"selection": name, "generations": times.mean(), "lowest": times.min(), "highest": times.max()}
        rows.append(row | {"theory": theory, "ratio": times.mean() / theory})
    return pd.DataFrame(rows)


def read_times(table: pd.DataFrame) -> dict[str, Floats]:
    """Return the last generation of each run of ``evolve_onemax``, keyed by operator."""
    last: Any = table.groupby(["selection", "seed"], sort=False).generation.max()
    return {str(name): times.to_numpy(dtype=np.float64) for name, times in last.groupby("selection", sort=False)}


def _evolve_bits(operators: Operators, n_bits: int, population_size: int, seed: int) -> list[tuple[float, float]]:
    """Evolve strings until all are identical; return the mean and the best fitness of each generation."""
    bits = tuple(f"bit{i}" for i in range(n_bits))
    texts = ("",) * n_bits
    genes = Genes(bits, texts, ("count",) * n_bits, texts, np.zeros(n_bits), np.ones(n_bits))
    rng = random_stream(seed, "analysis", 3)
    population = first_population(rng.integers(2, size=(population_size, n_bits)).astype(np.float64), _count_ones)
    history = [(float(population.fitness.mean()), float(population.fitness.max()))]
    while np.ptp(population.genomes, axis=0).any() and len(history) <= MAX_GENERATIONS:
        population = next_population(
            population, operators, genes, _count_ones, repair=lambda genomes: genomes, n_elites=0, seed=seed
        )
        history.append((float(population.fitness.mean()), float(population.fitness.max())))
    return history


def _count_ones(genomes: Floats) -> list[_Count]:
    return [_Count(fitness) for fitness in genomes.sum(axis=1).tolist()]


def _mate_at_random(parents: Floats, fitness: Floats, n_children: int, *, rng: Generator) -> Children:
    """Apply uniform crossover to couples of random partners."""
    order = rng.permutation(len(parents))
    children = crossover.uniform(parents[order], fitness[order], n_children, rng=rng)
    return Children(children.genomes, order[children.parents])


def _keep(genomes: Floats, genes: Genes, *, rng: Generator) -> Floats:  # noqa: ARG001
    """Return the genomes without mutation."""
    return genomes


def _linked_theory(theory: Theory, n_bits: int, n_matings: int, n_generations: int) -> Floats:
    """Return the mean fitness that theory predicts for each generation if few matings mix the bits incompletely.

    Selection reduces the variance of the fitness by the share 1 - ``theory.variance``: good bits occur together
    less often (Bulmer 1971, American Naturalist 105). Each mating halves this linkage.
    """
    share = 0.5
    linkage = 0.0
    means = [n_bits * share]
    for _ in range(n_generations - 1):
        variance = max(0.0, n_bits * share * (1 - share) + linkage)
        share = min(1.0, share + theory.intensity * math.sqrt(variance) / n_bits)
        linkage = (linkage - (1 - theory.variance) * variance) / 2**n_matings
        means.append(n_bits * share)
    return np.array(means)
