"""The wiring: settings become generation after generation, each tabulated and stored."""

import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any, Self

import numpy as np
import pandas as pd
from tqdm.auto import tqdm

from walkerlab import fitness, provenance, records, store, workers
from walkerlab.algorithm import check_own_operators, generate_robot_population, operators, slot_names
from walkerlab.archive import Archive
from walkerlab.evaluation import evaluate
from walkerlab.ga.loop import Population, first_population, next_population
from walkerlab.ga.own import OperatorError
from walkerlab.gate import Stopped
from walkerlab.genes import Floats
from walkerlab.genome import Genome
from walkerlab.interrupts import interrupts_held
from walkerlab.limits import genes_of, repair
from walkerlab.quantity import SettingsError, count
from walkerlab.records import Individual, Walked
from walkerlab.run import Run, load, own_slots, with_functions
from walkerlab.settings import Settings
from walkerlab.store import DamagedError, RunFileError


@dataclass(frozen=True, eq=False)
class Generation:
    """One generation: its number and its part of the tidy table."""

    number: int
    records: pd.DataFrame

    @property
    def champion(self) -> Individual:
        """The fittest of this generation."""
        return records.champion(self.records)


class Evolution:
    """An evolution, one generation at a time: iterate over it, stop when you like, and go on later.

    Iterate over it:

        for generation in wl.Evolution(settings):
            print(generation.number, generation.champion.fitness)
    """

    def __init__(
        self,
        settings: Settings,
        path: str | Path | None = None,
        executor: Executor | None = None,
        *,
        on_walks: Callable[[int], None] = lambda _: None,
    ) -> None:
        """Check all that can be checked before any physics runs.

        Args:
            settings: of all four domains.
            path: the run file, made with the first generation; without one, nothing is left of the run when it is
                no longer looked at.
            executor: any ``concurrent.futures.Executor``; loky on all cores if None.
            on_walks: told how many more walks are done.

        Raises:
            OperatorError: if an operator or fitness of the user's own does not do what its slot needs.
            RunFileError: if there is a file at ``path``, or none can be made there.
        """
        _require(settings)
        check_own_operators(settings.algorithm, genes_of(settings.robot))
        fitness.check_own(settings.algorithm.fitness)
        workers.check_executor(executor)
        self.settings = settings
        self.path = None if path is None else Path(path)
        if self.path:
            store.claim(self.path)
        self._archive, self._on_walks = Archive(self.path), on_walks
        self._evaluate = partial(evaluate, settings=settings, executor=executor, on_done=on_walks)
        self._population: Population[Walked] | None = None
        self._guests, self._next_bred, self._breeding = list[Genome](), 0, Lock()

    @classmethod
    def _of(cls, run: Run, path: Path, settings: Settings, **options: Any) -> Self:
        """Take up a run where its table ends."""
        evolution = cls(settings, **options)
        evolution.path = path
        evolution._archive = Archive.of(path, run.records, settings.model_dump())
        if not run.records.empty:
            try:
                evolution._population = records.last_population(run.records)
                evolution._next_bred = evolution._population.generation + 1
            except ValueError as error:
                raise DamagedError(path, str(error)) from error
        return evolution

    @property
    def run(self) -> Run:
        """All that is done so far."""
        return Run(self.settings, partial(self._archive.table, self.n_generations), self.path)

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
                    self._archive.add(table, self.settings.model_dump())
                    self._population = population
            except Stopped:
                raise
            except Exception as error:
                self._keep(error)
                raise
            yield Generation(population.generation, table)

    def _keep(self, error: Exception) -> None:
        """Keep what is done in a file, and note on the error that ends the run where that is and how to go on."""
        if not self.n_generations:
            return
        try:
            path = self._archive.keep()
        except RunFileError as fault:
            error.add_note(str(fault))
            return
        own = "".join(f", {slot}={how}" for slot, how in own_slots(self.settings).items())
        error.kept = path  # type: ignore[attr-defined]
        error.add_note(
            f"What is done is kept in {path}: {count(self.n_generations, 'generation')}. When the fault is mended, go "
            f"on with:\n    run = wl.resume({str(path)!r}{own})"
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
) -> Run:
    """Evolve walkers from a random first generation; Ctrl-C stops and keeps the generations that are done.

    Args:
        settings: of all four domains; the defaults if None.
        path: the run file to be made; without one, nothing is left of the run when it is no longer looked at.
        executor: any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: whether to show a bar.

    Returns:
        The run: ``.records``, ``.champion``, ``.lineage(individual)``.

    Raises:
        OperatorError: if a function of the user's own does not do what its slot needs.
        RunFileError: if there is a file at ``path``, or it cannot be written.
        WorkersLostError: if those who walk give no answer, or have no memory left.

    What is raised once a generation is done has a note that says in which file the run so far is kept, ``error.kept``:
    its own, or if it has none, ``kept.walk``.
    """
    settings = Settings() if settings is None else settings
    _require(settings)
    with _bar(settings, progress) as bar:
        return _finish(Evolution(settings, path, executor, on_walks=bar.update), bar)


def resume(
    path: str | Path,
    generations: int | None = None,
    executor: Executor | None = None,
    progress: bool = True,
    **functions: Any,
) -> Run:
    """Go on with a run, to the very table that it would have had without the stop.

    Args:
        path: its run file, or the folder with it.
        generations: how many it shall have in all; as the settings say if None.
        executor: any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: whether to show a bar.
        **functions: the user's own functions, by slot, if the run was made with any: ``mutation=my_mutation``.

    Warns:
        UserWarning: if the run was made with other versions, or on another kind of processor.

    Raises:
        RunFileError: if there is no such file, it is not a run, or a function of the user's own was not given back,
            or another was given in its place.
        SettingsError: if ``generations`` is out of range.
    """
    run = with_functions(load(path), functions)
    path, done = store.locate(path), run.n_generations
    if changed := provenance.differences(store.read_facts(path)[1], provenance.here()):
        warnings.warn(
            f"{path} was made with {changed}. What is done stays as it is; what comes now can differ in its last "
            "digits from what it would have been there, and so can all that follows from it. The file says of each "
            "generation what it was made with.",
            stacklevel=2,
        )
    settings = run.settings if generations is None else run.settings.with_(generations=generations)
    if settings.algorithm.generations < done:
        raise SettingsError(f"{path} has {done} generations already; generations must be {done} or more, in all.")
    with _bar(settings, progress, done=done) as bar:
        evolution = Evolution._of(run, path, settings, executor=executor, on_walks=bar.update)
        del run  # its table is in the file, and need not be kept while it grows
        return _finish(evolution, bar)


def _require(settings: object) -> None:
    if not isinstance(settings, Settings):
        raise TypeError(f"an evolution is made from Settings, as in Settings().with_(generations=5); got {settings!r}")


def n_walks(settings: Settings, done: int = 0) -> int:
    """Count the walks that a run still takes, when so many of its generations are done; elites do not walk again."""
    algorithm = settings.algorithm
    children = algorithm.population_size - algorithm.n_elites
    first = 0 if done else algorithm.n_elites
    return first + max(0, algorithm.generations - done) * children


def _bar(settings: Settings, progress: bool, done: int = 0) -> Any:
    return tqdm(total=n_walks(settings, done), unit=" walks", disable=not progress, leave=True)


def _finish(evolution: Evolution, bar: Any) -> Run:
    """Run to the end, or to Ctrl-C, telling how it goes."""
    try:
        for generation in evolution:
            best = generation.champion.fitness
            bar.set_postfix_str(f"generation {generation.number}, best {best:.2f}")
    except KeyboardInterrupt:
        if not evolution.n_generations:
            raise KeyboardInterrupt("before the first generation was done, so there is nothing to keep") from None
    return evolution.run
