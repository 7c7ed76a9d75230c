"""Optimisers that can be compared with the genetic algorithm: random search, and user functions.

An optimiser is a function ``optimise(evaluate, settings, n_evaluations, *, rng)``. It calls ``evaluate`` with genomes,
as often and with as many genomes as it requires, and receives their fitness. Its return value is ignored. If it has a
parameter ``population``, it receives the genomes given for generation 0, shape (n, n_genes). ``evaluate`` ends the run
when ``n_evaluations`` genomes are evaluated, so that an endless loop is allowed:

    def hill_climber(evaluate, settings, n_evaluations, *, rng):
        genes = wl.gene_table(settings.robot)
        best = wl.Genome.random(settings.robot, rng=rng).values
        fitness = evaluate([best])[0]
        while True:
            tried = best + 0.05 * (genes.high - genes.low).to_numpy() * rng.normal(size=len(best))
            (result,) = evaluate([tried])
            if result >= fitness:
                best, fitness = tried, result
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any, TypeAlias

import numpy as np
import pandas as pd
from numpy.random import Generator
from numpy.typing import ArrayLike

from walkerlab.evolution.evolution import Recall
from walkerlab.evolution.forecast import n_walks
from walkerlab.evolution.founders import fit_genomes
from walkerlab.ga.genes import Floats
from walkerlab.genome.breeding import generate_robot_population
from walkerlab.genome.genome import Genome, read_genomes
from walkerlab.runfile.history import Founder
from walkerlab.runfile.records import EvaluationRow, name_fitness, tidy_table
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import function_name
from walkerlab.simulation import fitness
from walkerlab.simulation.evaluation import Evaluation
from walkerlab.system.randomness import random_stream

Evaluate: TypeAlias = Callable[[Sequence[Genome | str | ArrayLike] | Floats], Floats]
"""Function from genomes, texts of genomes or an array of shape (n, n_genes) to fitness, shape (n,)."""

Optimiser: TypeAlias = Callable[..., object]
"""Function ``optimise(evaluate, settings, n_evaluations, *, rng)``."""


class EvaluationsUsedError(Exception):
    """An optimiser has used all its evaluations; this ends its run."""


def random_search(
    evaluate: Evaluate,
    settings: Settings,
    n_evaluations: int,
    *,
    rng: Generator,  # noqa: ARG001
    population: Floats | None = None,
) -> None:
    """Evaluate random robots only, drawn like those of generation 0; the baseline for every optimiser.

    The first robots are those of generation 0 of a run with the same seed.

    Args:
        evaluate: Function from genomes to fitness.
        settings: Settings of the run.
        n_evaluations: Number of evaluations.
        rng: Random generator, unused; the robots use the random numbers of generation 0.
        population: Genomes that replace the first random ones, shape (n, n_genes).
    """
    genomes = generate_robot_population(settings.robot, n_evaluations, seed=settings.algorithm.seed)
    if population is not None:
        genomes[: len(population)] = population
    evaluate(genomes)


def run_optimiser(
    optimise: Optimiser,
    settings: Settings,
    walk: Callable[[Floats], Sequence[Evaluation]],
    recall: Recall,
    on_generation: Callable[[pd.DataFrame], None],
    founders: tuple[Founder, ...] = (),
) -> None:
    """Run an optimiser with as many evaluations as the genetic algorithm has in a run with these settings.

    Args:
        optimise: Optimiser.
        settings: Settings of the run.
        walk: Function that returns the evaluations of (n, n_genes) genomes.
        recall: Function that returns the known evaluations of genomes.
        on_generation: Function that is called with the table of as many robots as a generation of the genetic algorithm
            evaluates, and of those that remain at the end.
        founders: Genomes given for generation 0; the first contains the values of frozen genes.
    """
    rng = random_stream(settings.algorithm.seed, "search")
    evaluator = _Evaluator(settings, function_name(optimise), walk, recall, on_generation, founders)
    population = np.array([Genome.parse(founder.genome).values for founder in founders])
    keywords: dict[str, Any] = {"population": population} if founders else {}
    with suppress(EvaluationsUsedError):
        optimise(evaluator, settings, n_walks(settings), rng=rng, **keywords)
    evaluator.flush()


class _Evaluator:
    """Function that evaluates genomes for an optimiser, and passes complete generations on."""

    def __init__(
        self,
        settings: Settings,
        name: str,
        walk: Callable[[Floats], Sequence[Evaluation]],
        recall: Recall,
        on_generation: Callable[[pd.DataFrame], None],
        founders: tuple[Founder, ...],
    ) -> None:
        self._settings = settings
        self._founders = founders
        self._name = name
        self._walk = walk
        self._recall = recall
        self._on_generation = on_generation
        self._waiting: list[EvaluationRow] = []
        self._n_done = 0
        self._n_total = n_walks(settings)
        self._generation = 0

    def __call__(self, genomes: Sequence[Genome | str | ArrayLike] | Floats) -> Floats:
        """Return the fitness of genomes, shape (n,); ``-inf`` where a walk does not count.

        Raises:
            EvaluationsUsedError: If fewer evaluations are left.
        """
        robots = [genome.within(self._settings.robot) for genome in read_genomes(genomes)]
        if self._founders and robots:
            values = np.array([robot.values for robot in robots])
            robots = list(map(Genome, fit_genomes(values, self._settings, self._founders)))
        rated: list[float] = []
        while len(rated) < len(robots):
            n_free = min(self._generation_size - len(self._waiting), self._n_total - self._n_done)
            if not n_free:
                raise EvaluationsUsedError
            rows = self._evaluate(robots[len(rated) : len(rated) + n_free])
            rated += [row.fitness for row in rows]
            self._waiting += rows
            self._n_done += len(rows)
            if len(self._waiting) == self._generation_size:
                self.flush()
        return np.array(rated)

    @property
    def _generation_size(self) -> int:
        algorithm = self._settings.algorithm
        return algorithm.population_size - (algorithm.n_elites if self._generation else 0)

    def _evaluate(self, robots: list[Genome]) -> list[EvaluationRow]:
        texts = list(map(str, robots))
        known = self._recall(texts)
        new = {text: robot for text, robot in zip(texts, robots, strict=True) if text not in known}
        if new:
            evaluations = self._walk(np.array([robot.values for robot in new.values()]))
            known = known | {text: EvaluationRow.of(one, text) for text, one in zip(new, evaluations, strict=True)}
        return [known[text] for text in texts]

    def flush(self) -> None:
        """Pass the waiting robots on as a generation."""
        if not self._waiting:
            return
        n = len(self._waiting)
        columns: dict[str, Any] = {
            "generation": self._generation,
            "individual": np.arange(self._n_done - n, self._n_done),
            "born": self._generation,
            "parents": "",
            "operators": self._name,
            **dict(zip(EvaluationRow._fields, zip(*self._waiting, strict=True), strict=True)),
        }
        table = tidy_table(pd.DataFrame(columns))
        name_fitness(table, *fitness.name_and_unit(self._settings.algorithm.fitness))
        self._on_generation(table)
        self._waiting = []
        self._generation += 1
