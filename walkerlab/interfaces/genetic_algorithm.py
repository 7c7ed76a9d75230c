"""The genetic algorithm as ask and tell: the caller evaluates each generation."""

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np
import pandas as pd

from walkerlab.evolution.founders import FirstPopulation, fit_genomes, place_founders, read_founders
from walkerlab.evolution.rating import retest_best
from walkerlab.evolution.run import Run
from walkerlab.ga.genes import Floats
from walkerlab.ga.loop import find_elites, first_population, next_population
from walkerlab.ga.population import NOT_COUNTED, Population
from walkerlab.genome.breeding import (
    check_user_operators,
    describe_operators,
    generate_robot_population,
    resolve_operators,
)
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome
from walkerlab.genome.phenotype import express
from walkerlab.interfaces.saving import save_generations
from walkerlab.runfile.records import EvaluationRow, copy_table, name_fitness, tabulate_generation, tidy_table
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import short_repr
from walkerlab.simulation import fitness
from walkerlab.simulation.evaluation import Evaluation, evaluate
from walkerlab.simulation.fitness import as_number
from walkerlab.simulation.validity import REJECTED

_NOT_EVALUATED = EvaluationRow(0.0, "ok", "", 0.0, 0.0, 0, 0, 0.0, 0.0, "")


class GeneticAlgorithm:
    """The genetic algorithm of ``wl.evolve``; the caller evaluates each generation.

        algorithm = wl.GeneticAlgorithm(settings)
        while not algorithm.is_finished:
            genomes = algorithm.ask()                              # (n, n_genes)
            algorithm.tell(wl.evaluate(genomes, settings))

    Evaluated in this way, its table equals that of ``wl.evolve(settings)``. The genomes can also be rated by anything
    else: ``tell`` accepts a fitness for each of them.
    """

    def __init__(
        self, settings: Settings, *, population: FirstPopulation | None = None, executor: Executor | None = None
    ) -> None:
        """Check the arguments, without any simulation.

        Args:
            settings: Complete settings of the run.
            population: First individuals of generation 0, as for ``evolve``.
            executor: Executor with which ``tell`` tests the best robots from other starts, as ``evolve`` does; loky on
                all cores if None.

        Raises:
            OperatorError: If a user function does not do what its slot requires.
            SettingsError: If the settings freeze genes, and there is no population.
            TypeError: If an argument is of the wrong type.
            ValueError: If ``population`` has no genomes or too many, or one is not valid.
        """
        self.settings = require_settings(settings)
        check_user_operators(settings.algorithm, build_genes(settings.robot))
        fitness.check_user_function(settings)
        self._founders = read_founders(population, settings)
        self._evaluate = partial(evaluate, settings=settings, executor=executor)
        self._population: Population[EvaluationRow] | None = None
        self._asked: Population[EvaluationRow] | None = None
        self._origins = {number: founder.origin for number, founder in enumerate(self._founders)}
        self._known: dict[str, EvaluationRow] = {}
        self._tables: list[pd.DataFrame] = []

    @property
    def n_generations(self) -> int:
        """Number of generations that are evaluated."""
        return len(self._tables)

    @property
    def is_finished(self) -> bool:
        """Whether all generations of the settings are evaluated; more are allowed."""
        return self.n_generations >= self.settings.algorithm.generations

    def ask(self) -> Floats:
        """Return the genomes of the next generation that are to be evaluated, shape (n, n_genes), within the limits.

        Elites are not among them. Until ``tell``, each call returns the same genomes.
        """
        if self._asked is None:
            self._asked = self._breed()
        return self._asked.genomes[self._n_elites :].copy()

    def tell(self, evaluations: Sequence[Evaluation] | Sequence[float] | Floats) -> None:
        """Continue with the evaluations of the genomes that ``ask`` returned.

        Args:
            evaluations: Evaluations from ``wl.evaluate``, or a fitness for each genome, in their order. Robots with an
                evaluation that would be elites are tested from other starts, as in ``evolve``.

        Raises:
            RuntimeError: If no genomes were asked for.
            TypeError: If an evaluation is neither an ``Evaluation`` nor a number.
            ValueError: If the number is wrong, or a fitness is NaN or +inf.
        """
        if self._asked is None:
            raise RuntimeError("no genomes are waiting for an evaluation; call ask() first")
        asked = self._asked
        new = [Genome(values) for values in asked.genomes[self._n_elites :]]
        if np.ndim(cast(Any, evaluations)) != 1 or len(evaluations) != len(new):
            raise ValueError(
                f"tell got evaluations of shape {np.shape(cast(Any, evaluations))} for {len(new)} genomes; give one "
                "for each, in their order"
            )
        rows = [_row_of(robot, one) for robot, one in zip(new, cast(Sequence[Any], evaluations), strict=True)]
        elites = list(asked.evaluations[: self._n_elites])
        if all(isinstance(one, Evaluation) for one in cast(Sequence[Any], evaluations)):
            rated = {row.genome: row for row in elites}
            rated |= {row.genome: self._known.get(row.genome, row) for row in rows}
            passed = [row.genome for row in elites]
            rated = retest_best(rated, passed, self.settings, self._evaluate, asked.generation)
            rows = [rated[row.genome] for row in rows]
            self._known |= rated
        population = replace(asked, evaluations=[*elites, *rows])
        table = tabulate_generation(population, describe_operators(self.settings.algorithm), self._origins)
        name_fitness(table, *fitness.name_and_unit(self.settings.algorithm.fitness))
        self._origins = dict(zip(table.individual.tolist(), table.operators.tolist(), strict=True))
        self._tables.append(table)
        self._population = population
        self._asked = None

    @property
    def run(self) -> Run:
        """The run so far, in memory; empty before the first generation."""
        joined = pd.concat(self._tables, ignore_index=True) if self._tables else pd.DataFrame()
        return Run(self.settings, copy_table(tidy_table(joined)), founders=self._founders)

    def save(self, path: str | Path) -> Run:
        """Save the run so far in a file, which ``wl.resume`` continues.

        Args:
            path: Run file to create.

        Raises:
            RunFileError: If the file exists already or cannot be created.
            ValueError: If no generation is evaluated yet.
        """
        if not self._tables:
            raise ValueError("no generation is evaluated yet; call ask() and tell() first")
        return save_generations(self._tables, self.settings, path, self._founders)

    @property
    def _n_elites(self) -> int:
        return len(find_elites(self._population.fitness, self.settings.algorithm.n_elites)) if self._population else 0

    def _breed(self) -> Population[EvaluationRow]:
        """Return the next generation, whose new robots are not yet evaluated."""
        algorithm = self.settings.algorithm
        if self._population is None:
            genomes = generate_robot_population(self.settings.robot, algorithm.population_size, seed=algorithm.seed)
            return first_population(place_founders(genomes, self.settings, self._founders), _defer)
        return next_population(
            self._population,
            resolve_operators(algorithm),
            build_genes(self.settings.robot),
            _defer,
            repair=partial(fit_genomes, settings=self.settings, founders=self._founders),
            n_elites=algorithm.n_elites,
            seed=algorithm.seed,
            generations=algorithm.generations,
        )


def _defer(genomes: Floats) -> list[EvaluationRow]:
    """Return placeholders, which ``tell`` replaces."""
    return [_NOT_EVALUATED] * len(genomes)


def _row_of(robot: Genome, evaluation: Evaluation | float) -> EvaluationRow:
    """Return the evaluation of a robot as a row; distance and velocity are NaN if only its fitness is known."""
    if isinstance(evaluation, Evaluation):
        return EvaluationRow.of(evaluation, str(robot))
    rating = as_number(evaluation)
    if rating is None:
        raise TypeError(f"an evaluation must be an Evaluation or a number; got {short_repr(evaluation)}")
    body = express(robot)
    return EvaluationRow(
        fitness=rating,
        verdict=REJECTED if rating == NOT_COUNTED else "ok",
        reason="the caller rated it -inf" if rating == NOT_COUNTED else "",
        distance=np.nan,
        velocity=np.nan,
        n_segments=len(body.segments),
        n_legs=body.n_legs,
        weight=body.weight,
        body_length=body.body_length,
        genome=str(robot),
    )
