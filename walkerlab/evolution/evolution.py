"""The wiring: settings become generation after generation, each tabulated and stored."""

import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any, ClassVar, Self

import numpy as np
import pandas as pd
from tqdm.auto import tqdm

from walkerlab.breeding import check_own_operators, generate_robot_population, lost_pressure, operators, slot_names
from walkerlab.evolution.rerating import Recorded, changed_operators, confirm_ratings, function_facts
from walkerlab.evolution.run import Run, check_storable, load, own_slots, with_functions
from walkerlab.ga.genes import Floats
from walkerlab.ga.loop import Population, first_population, next_population
from walkerlab.ga.user_functions import OperatorError
from walkerlab.genome.genome import Genome
from walkerlab.genome.repair import genes_of, repair
from walkerlab.readonly import ReadOnlyProperties
from walkerlab.runfile import provenance, records, store
from walkerlab.runfile.archive import Archive
from walkerlab.runfile.records import Individual, Walked
from walkerlab.runfile.store import DamagedError, RunFileError
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.model import SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import code_text, count, did_you_mean
from walkerlab.simulation import fitness, workers
from walkerlab.simulation.evaluation import evaluate
from walkerlab.simulation.pausable import Stopped
from walkerlab.simulation.validity import REJECTED
from walkerlab.system.files import shown
from walkerlab.system.interrupts import interrupts_held
from walkerlab.system.time_limit import effective_limit
from walkerlab.text.numbers import significant


@dataclass(frozen=True, eq=False)
class Generation:
    """One generation.

    Attributes:
        number: 0 for the random one.
    """

    number: int
    _table: pd.DataFrame

    @property
    def records(self) -> pd.DataFrame:
        """A copy of its part of the tidy table."""
        return records.copy_of(self._table)

    @property
    def champion(self) -> Individual:
        """The fittest of this generation."""
        return records.champion(self._table)


class Evolution(ReadOnlyProperties):
    """An evolution, one generation at a time: iterate over it, stop when you like, and go on later.

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
        """Check all that can be checked before any physics runs.

        Args:
            settings: of all four domains.
            path: Run file, created here with the settings; if None, nothing is left of the run once it is unused.
            executor: any ``concurrent.futures.Executor``; loky on all cores if None.
            on_walks: told how many more walks are done.
            **unknown: Rejected; single settings belong to ``settings``.

        Raises:
            TypeError: If an argument is of the wrong type, or its name is unknown.
            OperatorError: if an operator or fitness of the user's own does not do what its slot needs.
            SettingsError: if no run file can hold the settings.
            RuntimeError: if the executor is closed.
            RunFileError: if there is a file at ``path``, or none can be made there.
        """
        _reject_unknown("Evolution", unknown)
        require_settings(settings)
        check_own_operators(settings.algorithm, genes_of(settings.robot))
        fitness.check_own(settings.algorithm.fitness)
        workers.check_executor(executor)
        workers.check_open(executor)
        effective_limit(1.0)  # a wrong environment variable raises before the file is created
        check_storable(settings)
        self._settings = settings
        self._path = None if path is None else store.new_path(path)
        self._on_walks = on_walks
        self._archive = Archive.create(settings.model_dump(), self._path)  # all else is valid
        self._evaluate = partial(evaluate, settings=settings, executor=executor, on_done=on_walks)
        self._population: Population[Walked] | None = None
        self._functions, self._rated_since = function_facts(settings), 0
        self._is_warned = False
        self._guests, self._next_bred, self._breeding = list[Genome](), 0, Lock()

    @classmethod
    def _of(
        cls, run: Run, path: Path, settings: Settings, facts: Mapping[str, str], rerate: bool, **options: Any
    ) -> Self:
        """Take up a run where its table ends; ``facts`` are those of its last generation."""
        evolution = cls(settings, **options)
        evolution._path, table = path, run.records
        evolution._rated_since = run.rated_since
        if not table.empty:
            try:
                evolution._population = records.last_population(table)
                evolution._next_bred = evolution._population.generation + 1
            except ValueError as error:
                raise DamagedError(path, str(error)) from error
            if evolution.n_generations < settings.algorithm.generations:
                evolution._confirm_ratings(table, facts, rerate)
        if evolution._rated_since:
            evolution._functions[provenance.RATED_SINCE] = str(evolution._rated_since)
        current = table.loc[table.generation >= evolution._rated_since, :]  # older numbers are of another fitness
        evolution._archive = Archive.of(path, current, settings.model_dump())
        return evolution

    def _confirm_ratings(self, table: pd.DataFrame, facts: Mapping[str, str], rerate: bool) -> None:
        """Make sure that the last generation has the ratings of the fitness given."""
        assert self._path
        assert self._population
        is_elsewhere = bool(provenance.differences(facts, provenance.here()))
        recorded = Recorded(self._path, facts, is_elsewhere, has_fitness=bool(np.isfinite(table.fitness).any()))
        walk_again = partial(self._evaluate, on_done=lambda _: None)
        self._population, is_new = confirm_ratings(self._population, self.settings, recorded, walk_again, rerate=rerate)
        if is_new:
            self._rated_since = self.n_generations

    @property
    def settings(self) -> Settings:
        """The settings of the run."""
        return self._settings

    @property
    def path(self) -> Path | None:
        """The run file, or None."""
        return self._path

    @property
    def run(self) -> Run:
        """All that is done so far."""
        since = self._rated_since if self._rated_since < self.n_generations else 0  # none has new ratings yet
        return Run(self.settings, partial(self._archive.table, self.n_generations), self.path, since)

    @property
    def n_generations(self) -> int:
        """How many generations are done."""
        return 0 if self._population is None else self._population.generation + 1

    @property
    def _room(self) -> int:
        """How many children a generation has."""
        return self.settings.algorithm.population_size - self.settings.algorithm.n_elites

    def insert(self, genome: Genome | str) -> int:
        """Put a genome of your own into the next generation that is bred, in the place of a child.

        Args:
            genome: a genome or its text; brought within the limits.

        Returns:
            The number of that generation; the one that is walking has been bred already.

        Raises:
            GenomeError: if a text is no genome.
            ValueError: if there is no room for it, no generation yet that another could follow, or none to come.
        """
        genome = Genome.of(genome).within(self.settings.robot)
        algorithm = self.settings.algorithm
        with self._breeding:
            if self._population is None:
                raise ValueError("the first generation is random; let it walk, and put the gene into the next one")
            if self._next_bred >= algorithm.generations:
                raise ValueError(f"no generation is bred any more: generation {algorithm.generations - 1} is the last")
            if len(self._guests) >= self._room:
                raise ValueError(
                    f"the next generation has {self._room} places for children, and genes of yours have them all"
                )
            self._guests.append(genome)
            return self._next_bred

    def __iter__(self) -> Iterator[Generation]:
        """Yield each further generation once it is evaluated and stored, until the settings' number is reached."""
        algorithm = self.settings.algorithm
        while self._population is None or self._population.generation + 1 < algorithm.generations:
            try:
                population = self._next()
                table = records.tabulate(population, slot_names(algorithm))
                records.name_fitness(table, *fitness.label(algorithm.fitness))
                with interrupts_held():  # what is stored and what is in hand must not part
                    self._archive.add(table, self._functions)
                    self._population = population
            except Stopped:
                raise
            except Exception as error:
                self._keep(error)
                raise
            self._warn_once(population)
            yield Generation(population.generation, table)

    def _warn_once(self, population: Population[Walked]) -> None:
        """Warn if selection cannot tell the robots of a generation apart, once a run."""
        if self._is_warned:
            return
        if all(one.verdict == REJECTED for one in population.evaluations):
            why = (
                f"{population.evaluations[0].reason} for every robot, so that parents are random. Is a return missing?"
            )
        else:
            why = lost_pressure(population.fitness, self.settings.algorithm)
        if why:
            self._is_warned = True
            warnings.warn(f"In generation {population.generation}, {why}", stacklevel=2)

    def _keep(self, error: Exception) -> None:
        """Keep what is done in a file, and note on the error that ends the run where that is and how to go on."""
        if not self.n_generations and not self.path:
            return  # the caller has the settings, and there is nothing else
        try:
            path = self._archive.keep()
        except RunFileError as fault:
            error.add_note(str(fault))
            return
        done = f"What is done is kept in {shown(path)}: {count(self.n_generations, 'generation')}."
        if not self.n_generations:
            done = f"No generation was done; the settings are kept in {shown(path)}."
        error.kept = path  # type: ignore[attr-defined]
        error.add_note(f"{done} When the fault is fixed, resume with:\n    run = {self._resume_call(path)}")

    def _resume_call(self, path: Path) -> str:
        """Return the Python call that resumes the run."""
        own = "".join(f", {slot}={how}" for slot, how in own_slots(self.settings).items())
        return f"wl.resume({shown(path)!r}{own})"

    @property
    def unfinished(self) -> str:
        """What is kept of a run that was interrupted before its first generation was done, and how to resume it."""
        if not self.path:
            return "before the first generation was done; the run has no file, so nothing of it is kept"
        return (
            f"before the first generation was done; the settings are kept, resume with: {self._resume_call(self.path)}"
        )

    def _next(self) -> Population[Walked]:
        robot, algorithm = self.settings.robot, self.settings.algorithm
        if self._population is None:
            genomes = generate_robot_population(robot, algorithm.population_size, seed=algorithm.seed)
            self._next_bred = 1
            return first_population(genomes, self._walk)
        with self._breeding:
            guests, self._guests = self._guests[: self._room], self._guests[self._room :]
            self._next_bred = self._population.generation + 2
        try:
            return next_population(
                self._population,
                operators(algorithm),
                genes_of(robot),
                self._walk,
                repair=partial(repair, robot=robot),
                n_elites=algorithm.n_elites,
                seed=algorithm.seed,
                guests=np.array([genome.values for genome in guests]) if guests else None,
            )
        except BaseException:  # as Ctrl-C while they walk: it will be bred anew, and guests wait for that
            with self._breeding:
                self._guests, self._next_bred = guests + self._guests, self._population.generation + 1
            raise

    def _walk(self, genomes: Floats) -> list[Walked]:
        """Let each genome walk that has not walked before in this run; walks are repeatable, so once is enough."""
        texts = [str(Genome(values)) for values in genomes]
        known = self._archive.find(texts)
        fresh = {text: i for i, text in enumerate(texts) if text not in known}
        if fresh:
            rows = list(fresh.values())
            try:
                evaluations = self._evaluate(genomes[rows])
            except OperatorError as error:
                individual = rows[error.place] + (self._population.n_born if self._population else 0)
                error.where = f"for individual {individual} of generation {self.n_generations}"
                raise
            known |= {text: Walked.of(one, text) for text, one in zip(fresh, evaluations, strict=True)}
        if len(fresh) < len(texts):
            self._on_walks(len(texts) - len(fresh))
        return [known[text] for text in texts]


def evolve(
    settings: Settings | None = None,
    path: str | Path | None = None,
    executor: Executor | None = None,
    progress: bool = True,
    **unknown: Any,
) -> Run:
    """Evolve walkers from a random first generation; Ctrl-C stops and keeps the generations that are done.

    If Ctrl-C comes before the first generation is done, it is raised; a run file keeps the settings all the same.

    Args:
        settings: of all four domains; the defaults if None.
        path: Run file, created before the first walk; if None, nothing is left of the run once it is unused.
        executor: any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: whether to show a bar.
        **unknown: Rejected; single settings belong to ``settings``.

    Returns:
        The run: ``.records``, ``.champion``, ``.lineage(individual)``.

    Warns:
        UserWarning: once a run, if one very low fitness takes the pressure from ``gradient`` selection, or the fitness
            function rejects every robot of a generation.

    Raises:
        OperatorError: if a function of the user's own does not do what its slot needs.
        RunFileError: if there is a file at ``path``, or it cannot be written.
        TypeError: If an argument is of the wrong type, or its name is unknown.
        WorkersLostError: if those who walk give no answer, or have no memory left.

    What is raised has a note that says in which file the run so far is kept, ``error.kept``: its own, or if it has none
    and a generation is done, ``kept.walk``.
    """
    _reject_unknown("evolve", unknown)
    settings = Settings() if settings is None else require_settings(settings)
    with _bar(settings, progress) as bar:
        return _finish(Evolution(settings, path, executor, on_walks=bar.update), bar)


def resume(
    path: str | Path,
    generations: int | None = None,
    executor: Executor | None = None,
    progress: bool = True,
    *,
    rerate: bool = False,
    **functions: Any,
) -> Run:
    """Go on with a run, to the very table that it would have had without the stop.

    Args:
        path: its run file, or the folder with it.
        generations: how many it shall have in all; as the settings say if None.
        executor: any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: whether to show a bar.
        rerate: Whether to continue from new ratings of the last generation where its fitness function has changed.
            Earlier generations keep their numbers, and the champion is taken from later ones.
        **functions: the user's own functions, by slot, if the run was made with any: ``mutation=my_mutation``.
            With a fitness among them, the last generation walks again, to see if it is rated as before.

    Warns:
        UserWarning: if the run was made with other versions, or on another kind of processor, or an operator's source
            has changed.

    Raises:
        RunFileError: if there is no such file, it is not a run, or a function of the user's own was not given back,
            or another was given in its place, or the fitness rates the last generation otherwise than the file.
        SettingsError: if ``generations`` is out of range.
    """
    run = with_functions(load(path), functions)
    path, done = store.locate(path), run.n_generations
    facts = store.read_facts(path)[1]
    if changed := provenance.differences(facts, provenance.here()):
        warnings.warn(
            f"{shown(path)} was made with {changed}. What is done stays as it is; what comes now can differ in its "
            "last digits from what it would have been there, and so can all that follows from it. The file says of "
            "each generation what it was made with.",
            stacklevel=2,
        )
    settings = run.settings if generations is None else run.settings.with_(generations=generations)
    if settings.algorithm.generations < done:
        raise SettingsError(
            f"{shown(path)} has {done} generations already; generations must be {done} or more, in all."
        )
    if changed := changed_operators(facts, function_facts(settings)):
        warnings.warn(
            f"{shown(path)} was made with another source of its {changed}. The run continues with the functions given; "
            "its file records for each generation which source it was made with.",
            stacklevel=2,
        )
    with _bar(settings, progress, done=done) as bar:
        evolution = Evolution._of(run, path, settings, facts, rerate, executor=executor, on_walks=bar.update)
        del run  # its table is in the file, and need not be kept while it grows
        return _finish(evolution, bar)


def _reject_unknown(function: str, unknown: dict[str, Any]) -> None:
    """Raise a TypeError if there are arguments of unknown names; of a setting, it says where that belongs."""
    for name, value in unknown.items():
        if name in Settings.places():
            belongs = f"wl.{function}(wl.Settings().with_({name}={code_text(value)}))"
            raise TypeError(f"{function} has no argument {name!r}, which is a setting: {belongs}")
        known = ("settings", "path", "executor", "progress" if function == "evolve" else "on_walks")
        raise TypeError(f"{function} has no argument {name!r}; it has {', '.join(known)}.{did_you_mean(name, known)}")


def n_walks(settings: Settings, done: int = 0) -> int:
    """Count the walks that a run still takes, when so many of its generations are done; elites do not walk again."""
    algorithm = settings.algorithm
    children = algorithm.population_size - algorithm.n_elites
    first = 0 if done else algorithm.n_elites
    return first + max(0, algorithm.generations - done) * children


def _bar(settings: Settings, progress: bool, done: int = 0) -> Any:
    total = n_walks(settings, done)
    return tqdm(total=total, unit=" walks", disable=not progress or not total, leave=True)


def _finish(evolution: Evolution, bar: Any) -> Run:
    """Run to the end, or to Ctrl-C, telling how it goes."""
    try:
        for generation in evolution:
            best = generation.champion
            reached = f"best {significant(best.fitness)}" if best.verdict == "ok" else "no walk counted"
            bar.set_postfix_str(f"generation {generation.number}, {reached}")
    except KeyboardInterrupt:
        if not evolution.n_generations:
            raise KeyboardInterrupt(evolution.unfinished) from None
    return evolution.run
