"""Evolve one generation at a time: breed it, evaluate it, store it."""

import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
import pandas as pd

from walkerlab.breeding import (
    check_user_operators,
    describe_operators,
    explain_lost_pressure,
    generate_robot_population,
    resolve_operators,
)
from walkerlab.evolution.insertion import InsertedGenomes
from walkerlab.evolution.interruption import save_after
from walkerlab.evolution.rerating import Recorded, confirm_ratings, function_facts
from walkerlab.evolution.run import Run, RunProperties
from walkerlab.evolution.stored_functions import check_storable
from walkerlab.ga.genes import Floats
from walkerlab.ga.loop import first_population, next_population
from walkerlab.ga.population import Population
from walkerlab.ga.user_functions import OperatorError
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome
from walkerlab.genome.repair import repair
from walkerlab.runfile import paths, provenance, records
from walkerlab.runfile.archive import Archive
from walkerlab.runfile.opening import DamagedError
from walkerlab.runfile.records import EvaluationRow, Individual
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import code_text, did_you_mean
from walkerlab.simulation import fitness, workers
from walkerlab.simulation.evaluation import evaluate
from walkerlab.simulation.pausable import Stopped
from walkerlab.simulation.validity import REJECTED
from walkerlab.system.interrupts import interrupts_held
from walkerlab.system.time_limit import effective_limit


@dataclass(frozen=True, eq=False)
class Generation:
    """One evaluated generation.

    Attributes:
        number: Number of the generation; 0 is the initial random generation.
    """

    number: int
    _table: pd.DataFrame

    @property
    def records(self) -> pd.DataFrame:
        """Copy of the rows of this generation in the tidy table."""
        return records.copy_table(self._table)

    @property
    def champion(self) -> Individual:
        """Fittest robot of this generation."""
        return records.find_champion(self._table)


class Evolution(RunProperties):
    """An evolution that yields one generation at a time; it can be stopped and continued.

    Iterate over it:

        for generation in wl.Evolution(settings):
            print(generation.number, generation.champion.fitness)
    """

    INSTEAD: ClassVar = {
        "settings": "All generations of a run are made with the same settings, which its file records. To evolve with "
        "other settings, start a new evolution: wl.Evolution(evolution.settings.with_(...)). To add generations to a "
        "run that has a file, resume it: wl.resume(path, generations=...).",
        "path": "The generations so far are stored there. Copy that file to store the run elsewhere.",
    }

    def __init__(
        self,
        settings: Settings,
        path: str | Path | None = None,
        executor: Executor | None = None,
        *,
        on_walks: Callable[[int], None] = lambda _: None,
        **unknown: Any,
    ) -> None:
        """Check the arguments and create the run file, without any simulation.

        Args:
            settings: Complete settings of the run.
            path: Run file to create; if None, the run is discarded when it is no longer referenced.
            executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
            on_walks: Function that is called with the number of newly finished walks.
            **unknown: Rejected; individual settings belong in ``settings``.

        Raises:
            TypeError: If an argument is of the wrong type, or its name is unknown.
            OperatorError: If a user function does not do what its slot requires.
            SettingsError: If the settings cannot be stored in a run file.
            RuntimeError: If the executor is closed.
            RunFileError: If ``path`` exists already or cannot be created.
        """
        reject_unknown_arguments("Evolution", unknown)
        require_settings(settings)
        check_user_operators(settings.algorithm, build_genes(settings.robot))
        fitness.check_user_function(settings.algorithm.fitness)
        workers.check_executor(executor)
        workers.check_open(executor)
        effective_limit(1.0)  # fails before the file is created if WALKERLAB_PATIENCE is invalid
        check_storable(settings)
        self._settings = settings
        self._path = None if path is None else paths.new_path(path)
        self._on_walks = on_walks
        self._archive = Archive.create(settings.model_dump(), self._path)  # after all checks
        self._evaluate = partial(evaluate, settings=settings, executor=executor, on_done=on_walks)
        self._population: Population[EvaluationRow] | None = None
        self._functions = function_facts(settings)
        self._rated_since = 0
        self._has_warned = False
        self._inserted = InsertedGenomes(settings.algorithm)

    @classmethod
    def continue_run(
        cls, run: Run, path: Path, settings: Settings, facts: Mapping[str, str], rerate: bool, **options: Any
    ) -> Self:
        """Return an evolution that continues a stored run after its last generation.

        Args:
            run: Loaded run, with its user functions.
            path: Its run file.
            settings: Settings of the run, perhaps with more generations.
            facts: Provenance of the last generation.
            rerate: Whether to continue from new ratings of the last generation if they differ from the stored ones.
            **options: Keyword arguments of ``Evolution``.

        Raises:
            RunFileError: If the ratings differ and ``rerate`` is false, or the file is damaged.
        """
        evolution = cls(settings, **options)
        table = run.records
        evolution._path = path
        evolution._rated_since = run.rated_since
        if not table.empty:
            try:
                evolution._population = records.last_population(table)
                evolution._inserted.set_next_generation(evolution.n_generations)
            except ValueError as error:
                raise DamagedError(path, str(error)) from error
            if evolution.n_generations < settings.algorithm.generations:
                evolution._confirm_ratings(table, facts, rerate)
        if evolution._rated_since:
            evolution._functions[provenance.RATED_SINCE] = str(evolution._rated_since)
        current = table.loc[table.generation >= evolution._rated_since, :]  # older ratings come from another function
        evolution._archive = Archive.resume(path, current, settings.model_dump())
        return evolution

    def _confirm_ratings(self, table: pd.DataFrame, facts: Mapping[str, str], rerate: bool) -> None:
        """Make sure that the last generation has been rated by the current fitness function."""
        assert self._path
        assert self._population
        is_elsewhere = bool(provenance.describe_differences(facts, provenance.current_facts()))
        recorded = Recorded(self._path, facts, is_elsewhere, has_fitness=bool(np.isfinite(table.fitness).any()))
        walk_again = partial(self._evaluate, on_done=lambda _: None)
        self._population, is_new = confirm_ratings(self._population, self.settings, recorded, walk_again, rerate=rerate)
        if is_new:
            self._rated_since = self.n_generations

    @property
    def run(self) -> Run:
        """The run so far."""
        has_new_ratings = self._rated_since < self.n_generations
        since = self._rated_since if has_new_ratings else 0
        return Run(self.settings, partial(self._archive.table, self.n_generations), self.path, since)

    @property
    def n_generations(self) -> int:
        """Number of completed generations."""
        return 0 if self._population is None else self._population.generation + 1

    def insert(self, genome: Genome | str) -> int:
        """Insert a genome into the next generation to be bred, in place of a child.

        Args:
            genome: Genome or its text; its genes are clipped to the limits of the settings.

        Returns:
            Number of the generation into which the genome will be inserted: if a generation is currently being
            evaluated, the one after that.

        Raises:
            GenomeError: If a text is not a valid genome.
            ValueError: If there is no room for the genome, no generation has been completed yet, or the run is
                complete.
        """
        return self._inserted.add(Genome.of(genome).within(self.settings.robot))

    def __iter__(self) -> Iterator[Generation]:
        """Yield each further generation once it is evaluated and stored, up to the number in the settings."""
        algorithm = self.settings.algorithm
        while self.n_generations < algorithm.generations:
            try:
                population = self._breed()
                table = records.tabulate_generation(population, describe_operators(algorithm))
                records.name_fitness(table, *fitness.name_and_unit(algorithm.fitness))
                with interrupts_held():  # so that the file and this object always agree
                    self._archive.add(table, self._functions)
                    self._population = population
                    self._inserted.set_next_generation(population.generation + 1)
            except Stopped:
                raise
            except Exception as error:
                if self.n_generations or self.path:
                    save_after(error, self._archive, self.settings, self.n_generations)
                raise
            self._warn_once(population)
            yield Generation(population.generation, table)

    def _warn_once(self, population: Population[EvaluationRow]) -> None:
        """Warn, at most once per run, if selection cannot distinguish the robots of a generation."""
        if self._has_warned:
            return
        if all(walked.verdict == REJECTED for walked in population.evaluations):
            cause = population.evaluations[0].reason
            advice = "Check that the function ends with a return statement."
            problem = f"{cause} for every robot, so parents are chosen at random. {advice}"
        else:
            problem = explain_lost_pressure(population.fitness, self.settings.algorithm)
        if problem:
            self._has_warned = True
            warnings.warn(f"In generation {population.generation}, {problem}", stacklevel=2)

    def _breed(self) -> Population[EvaluationRow]:
        """Return the next generation, evaluated."""
        robot = self.settings.robot
        algorithm = self.settings.algorithm
        if self._population is None:
            genomes = generate_robot_population(robot, algorithm.population_size, seed=algorithm.seed)
            return first_population(genomes, self._evaluate_new)
        with self._inserted.taking_for(self.n_generations) as inserted:
            return next_population(
                self._population,
                resolve_operators(algorithm),
                build_genes(robot),
                self._evaluate_new,
                repair=partial(repair, robot=robot),
                n_elites=algorithm.n_elites,
                seed=algorithm.seed,
                inserted=np.array([genome.values for genome in inserted]) if inserted else None,
            )

    def _evaluate_new(self, genomes: Floats) -> list[EvaluationRow]:
        """Evaluate (n, n_genes) genomes; duplicates, and genomes already evaluated in the run, are not simulated."""
        texts = [str(Genome(values)) for values in genomes]
        known = self._archive.find(texts)
        new = {text: row for row, text in enumerate(texts) if text not in known}
        if new:
            rows = list(new.values())
            try:
                evaluations = self._evaluate(genomes[rows])
            except OperatorError as error:
                individual = rows[error.robot_index] + (self._population.n_born if self._population else 0)
                error.context = f"for individual {individual} of generation {self.n_generations}"
                raise
            known |= {text: EvaluationRow.of(one, text) for text, one in zip(new, evaluations, strict=True)}
        if len(new) < len(texts):
            self._on_walks(len(texts) - len(new))
        return [known[text] for text in texts]


def reject_unknown_arguments(function: str, unknown: dict[str, Any]) -> None:
    """Raise a TypeError for unknown arguments; if one is a setting, the message shows where to put it.

    Args:
        function: Name of the function that was called, ``evolve`` or ``Evolution``.
        unknown: Arguments that it does not have, by name.
    """
    for name, value in unknown.items():
        if name in Settings.field_locations():
            call = f"wl.{function}(wl.Settings().with_({name}={code_text(value)}))"
            raise TypeError(f"{name!r} is a setting, not an argument of {function}. Use: {call}")
        known = ("settings", "path", "executor", "progress" if function == "evolve" else "on_walks")
        raise TypeError(
            f"{function} has no argument {name!r}; its arguments are {', '.join(known)}.{did_you_mean(name, known)}"
        )
