"""Evolve one generation at a time: breed it, evaluate it, store it."""

import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Self, TypeAlias

import numpy as np
import pandas as pd

from walkerlab.evolution.arguments import reject_unknown_arguments
from walkerlab.evolution.founders import FirstPopulation, fit_genomes, place_founders, read_founders
from walkerlab.evolution.generation import Generation
from walkerlab.evolution.insertion import InsertedGenomes
from walkerlab.evolution.interruption import save_after
from walkerlab.evolution.lost_pressure import explain_random_selection
from walkerlab.evolution.rating import rate_children
from walkerlab.evolution.rerating import Recorded, confirm_ratings, function_facts, rate_again
from walkerlab.evolution.run import Run, RunProperties
from walkerlab.evolution.stages import Stage, changes_walks, record_history
from walkerlab.evolution.stopping import Improvement, Stop, find_stop_reason, require_stop
from walkerlab.evolution.stored_functions import check_storable
from walkerlab.ga.genes import Floats
from walkerlab.ga.loop import first_population, next_population
from walkerlab.ga.population import Population
from walkerlab.genome.breeding import (
    check_user_operators,
    describe_operators,
    generate_robot_population,
    resolve_operators,
)
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome
from walkerlab.runfile import paths, provenance, records
from walkerlab.runfile.archive import Archive
from walkerlab.runfile.history import History
from walkerlab.runfile.opening import DamagedError
from walkerlab.runfile.records import EvaluationRow
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.simulation import fitness, workers
from walkerlab.simulation.evaluation import Evaluation, evaluate
from walkerlab.simulation.pausable import Stopped
from walkerlab.system.interrupts import interrupts_held
from walkerlab.system.time_limit import effective_limit

Recall: TypeAlias = Callable[[list[str]], dict[str, EvaluationRow]]
"""Function that takes the texts of genomes and returns their known evaluations, keyed by text."""


class Evolution(RunProperties):
    """An evolution that yields one generation at a time; it can be stopped and continued.

    Iterate over it:

        for generation in wl.Evolution(settings):
            print(generation.number, generation.champion.fitness)
    """

    INSTEAD: ClassVar = {
        "settings": "An evolution keeps its settings, which its file records. To evolve with other settings, start a "
        "new evolution: wl.Evolution(evolution.settings.with_(...)). To continue a run that has a file with more "
        "generations or other settings, resume it: wl.resume(path, generations=..., structure=...).",
        "path": "The generations so far are stored there. Copy that file to store the run elsewhere.",
    }

    def __init__(
        self,
        settings: Settings,
        path: str | Path | None = None,
        executor: Executor | None = None,
        *,
        on_walks: Callable[[int], None] = lambda _: None,
        on_rated: Callable[[int, Evaluation], None] = lambda *_: None,
        stop: Stop | None = None,
        population: FirstPopulation | None = None,
        recall: Recall | None = None,
        **unknown: Any,
    ) -> None:
        """Check the arguments and create the run file, without any simulation.

        Args:
            settings: Complete settings of the run.
            path: Run file to create; if None, the run is discarded when it is no longer referenced.
            executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
            on_walks: Function that is called with the number of newly finished walks.
            on_rated: Function that is called with the index of each robot, among those that walk, and its evaluation.
            stop: Conditions under which the iteration stops before the last generation.
            population: First individuals of generation 0, as for ``evolve``.
            recall: Function that returns known evaluations, keyed by genome text; its caller stores the generations.
            **unknown: Rejected; individual settings belong in ``settings``.

        Raises:
            TypeError: If an argument is of the wrong type, or its name is unknown.
            OperatorError: If a user function does not do what its slot requires.
            SettingsError: If the settings cannot be stored in a run file, or freeze genes without a population.
            ValueError: If ``population`` has no genomes or too many, or one is not valid.
            RuntimeError: If the executor is closed.
            RunFileError: If ``path`` exists already or cannot be created.
        """
        reject_unknown_arguments("Evolution", unknown)
        require_settings(settings)
        check_user_operators(settings.algorithm, build_genes(settings.robot))
        fitness.check_user_function(settings)
        workers.check_executor(executor)
        workers.check_open(executor)
        effective_limit(1.0)  # fails before the file is created if WALKERLAB_PATIENCE is invalid
        check_storable(settings)
        self._settings = settings
        self._path = None if path is None else paths.new_path(path)
        self._on_walks = on_walks
        self._stop = require_stop(stop)
        self._stop_reason = ""
        self._best_before = -np.inf
        self._founders = read_founders(population, settings)
        self._stages = (Stage(0, settings),)
        self._recall = recall
        self._archive = Archive.create(settings.model_dump(), self._path, History(self._founders))  # after all checks
        self._evaluate = partial(evaluate, settings=settings, executor=executor, on_done=on_walks, on_rated=on_rated)
        self._population: Population[EvaluationRow] | None = None
        self._functions = function_facts(settings)
        self._rated_since = 0
        self._has_warned = False
        self._inserted = InsertedGenomes(settings.algorithm)
        self._origins = {number: founder.origin for number, founder in enumerate(self._founders)}

    @classmethod
    def continue_run(
        cls, run: Run, path: Path, stages: tuple[Stage, ...], facts: Mapping[str, str], rerate: bool, **options: Any
    ) -> Self:
        """Return an evolution that continues a stored run after its last generation.

        Args:
            run: Loaded run, with its user functions.
            path: Its run file.
            stages: Stages of the run; the last has the settings for further generations.
            facts: Provenance of the last generation.
            rerate: Whether to continue from new ratings of the last generation if they differ from the stored ones.
            **options: Keyword arguments of ``Evolution``.

        Raises:
            RunFileError: If the ratings differ and ``rerate`` is false, or the file is damaged.
        """
        settings = stages[-1].settings
        evolution = cls(settings, population=run.founders or None, **options)
        evolution._stages = stages
        table = run.records
        evolution._path = path
        evolution._rated_since = run.rated_since
        if not table.empty:
            try:
                evolution._population = records.last_population(table)
                evolution._inserted.set_next_generation(evolution.n_generations)
                evolution._remember_origins(table)
            except ValueError as error:
                raise DamagedError(path, str(error)) from error
            if evolution.n_generations < settings.algorithm.generations:
                evolution._confirm_ratings(table, facts, rerate)
            rated = table.fitness[table.generation >= evolution._rated_since]
            evolution._best_before = max([*rated, *evolution._population.fitness])
        if evolution._rated_since:
            evolution._functions[provenance.RATED_SINCE] = str(evolution._rated_since)
        current = table.loc[table.generation >= evolution._rated_since, :]  # older ratings come from another function
        history = record_history(stages, evolution._founders)
        evolution._archive = Archive.resume(path, current, settings.model_dump(), history)
        return evolution

    def _confirm_ratings(self, table: pd.DataFrame, facts: Mapping[str, str], rerate: bool) -> None:
        """Make sure that the last generation is rated under the current settings by the current fitness function."""
        assert self._path
        assert self._population
        is_elsewhere = bool(provenance.describe_differences(facts, provenance.current_facts()))
        recorded = Recorded(self._path, facts, is_elsewhere, has_fitness=bool(np.isfinite(table.fitness).any()))
        walk_again = partial(self._evaluate, on_done=lambda _: None, on_rated=lambda *_: None)
        stage = self._stages[-1]
        if stage.first == self.n_generations and changes_walks(stage.changes):
            self._population = rate_again(self._population, self.settings, walk_again)
            self._rated_since = self.n_generations
            return
        self._population, is_new = confirm_ratings(self._population, self.settings, recorded, walk_again, rerate=rerate)
        if is_new:
            self._rated_since = self.n_generations

    @property
    def run(self) -> Run:
        """The run so far."""
        has_new_ratings = self._rated_since < self.n_generations
        since = self._rated_since if has_new_ratings else 0
        table = partial(self._archive.table, self.n_generations)
        return Run(self.settings, table, self.path, since, self._stop_reason, self._stages, self._founders)

    @property
    def n_generations(self) -> int:
        """Number of completed generations."""
        return 0 if self._population is None else self._population.generation + 1

    @property
    def inserted_genomes(self) -> list[Genome]:
        """Inserted genomes that are not in a completed generation yet."""
        return self._inserted.waiting

    def insert(self, genome: Genome | str) -> int:
        """Insert a genome into the next generation to be bred, in place of a child.

        Args:
            genome: Genome or its text; its genes are clipped to the limits of the settings.

        Returns:
            Number of the generation into which the genome will be inserted: if a generation is currently being
            evaluated, the one after that.

        Raises:
            GenomeError: If a string is not a valid genome.
            ValueError: If there is no room for the genome, no generation has been completed yet, or the run is
                complete.
        """
        values = Genome.of(genome).within(self.settings.robot).values
        return self._inserted.add(Genome(fit_genomes(values[np.newaxis], self.settings, self._founders)[0]))

    def __iter__(self) -> Iterator[Generation]:
        """Yield each new generation once it is stored, up to the last one or until a condition of ``stop`` is met."""
        algorithm = self.settings.algorithm
        began = time.monotonic()
        improvement = Improvement(self._best_before)
        while self.n_generations < algorithm.generations:
            try:
                population = self._breed()
                table = records.tabulate_generation(population, describe_operators(algorithm), self._origins)
                records.name_fitness(table, *fitness.name_and_unit(algorithm.fitness))
                improvement = improvement.after(float(population.fitness.max()))
                reason = find_stop_reason(self._stop, improvement, time.monotonic() - began)
                facts = self._functions | ({provenance.STOPPED: reason} if reason else {})
                with interrupts_held():  # so that the file and this object always agree
                    self._archive.add(table, facts)
                    self._population = population
                    self._stop_reason = reason
                    self._best_before = improvement.best
                    self._remember_origins(table)
                    self._inserted.set_next_generation(population.generation + 1)
            except Stopped:
                raise
            except Exception as error:
                if (self.n_generations or self.path) and not self._recall:
                    self.save_run_after(error)
                raise
            self._warn_once(population)
            yield Generation(population.generation, table)
            if reason:
                return

    def save_run_after(self, error: Exception) -> None:
        """Make sure that the run is in a named file, and add a note to an error that says how to resume it."""
        save_after(error, self._archive, self.settings, self.n_generations)

    def _remember_origins(self, table: pd.DataFrame) -> None:
        """Remember how each individual of the last generation of a table was made, for those that become elites."""
        last = table.loc[table.generation == table.generation.max(), :]
        self._origins = dict(zip(last.individual.tolist(), last.operators.tolist(), strict=True))

    def _warn_once(self, population: Population[EvaluationRow]) -> None:
        """Warn, at most once per run, if selection cannot distinguish the robots of a generation."""
        if not self._has_warned and (problem := explain_random_selection(population, self.settings.algorithm)):
            self._has_warned = True
            warnings.warn(f"In generation {population.generation}, {problem}", stacklevel=2)

    def _breed(self) -> Population[EvaluationRow]:
        """Return the next generation, evaluated."""
        robot = self.settings.robot
        algorithm = self.settings.algorithm
        if self._population is None:
            genomes = generate_robot_population(robot, algorithm.population_size, seed=algorithm.seed)
            return first_population(place_founders(genomes, self.settings, self._founders), self._evaluate_new)
        with self._inserted.taking_for(self.n_generations) as inserted:
            return next_population(
                self._population,
                resolve_operators(algorithm),
                build_genes(robot),
                self._evaluate_new,
                repair=partial(fit_genomes, settings=self.settings, founders=self._founders),
                n_elites=algorithm.n_elites,
                seed=algorithm.seed,
                generations=algorithm.generations,
                inserted=np.array([genome.values for genome in inserted]) if inserted else None,
            )

    def _evaluate_new(self, genomes: Floats) -> list[EvaluationRow]:
        """Evaluate (n, n_genes) genomes; duplicates, and genomes already evaluated, are not simulated."""
        texts = [str(Genome(values)) for values in genomes]
        known = self._archive.find(texts) | (self._recall(texts) if self._recall else {})
        rated = rate_children(genomes, texts, known, self._population, self.settings, self._evaluate)
        n_new = len({*texts} - known.keys())
        if n_new < len(texts):
            self._on_walks(len(texts) - n_new)
        return [rated[text] for text in texts]
