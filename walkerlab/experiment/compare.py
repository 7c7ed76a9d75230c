"""Run an experiment: each condition with each seed, stored generation by generation, so that it can be interrupted."""

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from contextlib import closing, nullcontext
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
from tqdm.auto import tqdm

from walkerlab.evolution.evolution import Evolution, Recall
from walkerlab.evolution.forecast import describe_duration, estimate_seconds, n_walks
from walkerlab.evolution.founders import FirstPopulation
from walkerlab.experiment.conditions import Condition, grid, read_conditions, read_seeds
from walkerlab.experiment.continuation import check_continuation
from walkerlab.experiment.experiment import Experiment
from walkerlab.experiment.optimisers import Optimiser, run_optimiser
from walkerlab.runfile import experiments, paths, store
from walkerlab.runfile.experiments import StoredExperiment, StoredRun
from walkerlab.runfile.opening import RunFile, RunFileError
from walkerlab.runfile.records import EvaluationRow, birth_rows
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.simulation import workers
from walkerlab.simulation.evaluation import evaluate
from walkerlab.system.files import display_path
from walkerlab.system.interrupts import interrupts_held


def compare(
    conditions: Mapping[str, Settings | Optimiser | tuple[Optimiser, Settings]],
    seeds: Iterable[int] = range(10),
    path: str | Path | None = None,
    executor: Executor | None = None,
    progress: bool = True,
    *,
    population: FirstPopulation | Mapping[str, FirstPopulation] | None = None,
) -> Experiment:
    """Run each condition with each seed, and return the experiment, which compares them.

    Runs with the same seed are paired: they have the same first generation, if the limits of the robots are the same,
    and the same random numbers for every operator that does not differ. All conditions are run with
    one seed before the next, so that an interrupted experiment has complete pairs. Ctrl-C stops the experiment, which
    is returned with the runs that have ended.

    The same call with the same ``path`` continues an interrupted experiment; its table becomes the same as that of an
    uninterrupted experiment. It can also add seeds.

    Args:
        conditions: Settings, keyed by the name of the condition; they may differ in everything but the fitness. An
            optimiser such as ``wl.random_search``, or your own function (see ``walkerlab.experiment.optimisers``), is
            another condition, with the settings of the others or, as ``(optimiser, settings)``, with its own. It is
            given as many evaluations as the genetic algorithm.
        seeds: Seeds of the runs; they replace the seeds of the settings.
        path: File of the experiment; if None, the experiment is discarded when it is no longer referenced.
        executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: Whether to show a forecast of the duration and a progress bar.
        population: First individuals of generation 0 of all conditions, as for ``wl.evolve``; or a dict from names of
            conditions to the first individuals of each. Conditions with ``frozen`` genes require it.

    Returns:
        The experiment: ``.records``, ``.summary()``, ``.plot()``, ``.best()``, ``.report(folder)``.

    Warns:
        UserWarning: If seeds are added to an experiment that was complete.

    Raises:
        TypeError: If an argument is of the wrong type.
        SettingsError: If conditions cannot be compared, or a seed is not valid.
        ValueError: If ``population`` is not valid.
        OperatorError: If a user function does not do what its slot requires.
        RunFileError: If the file is not an experiment, contains a different one, or cannot be used.
    """
    planned = read_conditions(conditions, population)
    wanted = read_seeds(seeds)
    workers.check_executor(executor)
    workers.check_open(executor)
    file: RunFile = store.open_temporary() if path is None else paths.new_path(path)
    with nullcontext() if isinstance(file, Path) else closing(file):
        return _run_experiment(file, planned, wanted, executor, progress)


def sweep(
    settings: Settings,
    *,
    seeds: Iterable[int] = range(10),
    path: str | Path | None = None,
    executor: Executor | None = None,
    progress: bool = True,
    population: FirstPopulation | None = None,
    **values: Any,
) -> Experiment:
    """Compare all combinations of the values of some settings: ``wl.sweep(s, mutation_rate=[0.02, 0.3])``.

    Args:
        settings: Settings that all conditions share.
        seeds: Seeds of the runs of each condition.
        path: File of the experiment; the same call continues it.
        executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: Whether to show a forecast of the duration and a progress bar.
        population: First individuals of generation 0 of all conditions, as for ``compare``.
        **values: Lists of values of single settings; each combination is a condition, such as
            ``mutation_rate=0.02, n_elites=0``.

    Returns:
        The experiment, as ``compare`` returns it.

    Raises:
        TypeError: If the values of a setting are not a list.
        SettingsError: If a name or a value is not valid, or two conditions are equal.
        RunFileError: If the file is not an experiment, contains a different one, or cannot be used.
    """
    return compare(grid(settings, values), seeds, path, executor, progress, population=population)


def _run_experiment(
    file: RunFile, planned: list[Condition], seeds: list[int], executor: Executor | None, progress: bool
) -> Experiment:
    """Carry out the missing runs of an experiment, and return the experiment as stored in its file."""
    plain = [condition.to_plain() for condition in planned]
    if isinstance(file, Path) and file.exists():
        experiment_id, stored = experiments.read(file)
        all_seeds = check_continuation(file, stored, planned, seeds)
        if all_seeds != stored.seeds:
            experiments.write_seeds(file, experiment_id, all_seeds)
    else:
        experiment_id = experiments.create(file, plain, seeds)
        stored = StoredExperiment(plain, seeds, {})
        all_seeds = seeds
    work = [
        (number, seed)
        for seed in all_seeds
        for number in range(len(planned))
        if not (run := stored.runs.get((number, seed))) or not run.is_finished
    ]
    if progress and work:
        print(_describe_plan([planned[number].settings for number, _ in work]), flush=True)
    n_remaining = sum(n_walks(planned[number].settings) for number, _ in work)
    try:
        with tqdm(total=n_remaining, unit=" walks", disable=not progress or not work) as bar:
            for place in work:
                number, seed = place
                condition = planned[number]
                bar.set_postfix_str(f"seed {seed}, {condition.name}")
                storage = _Storage(file, experiment_id, place, condition, stored.runs.get(place))
                _run(condition, seed, executor, bar.update, storage)
    except KeyboardInterrupt:
        pass  # the generations that are done are stored
    except Exception as error:
        _add_note(error, file)
        raise
    _, stored = experiments.read(file)
    return Experiment(planned, all_seeds, stored.runs, file if isinstance(file, Path) else None)


def _describe_plan(settings: list[Settings]) -> str:
    """Describe the runs that remain, and forecast their duration.

    Args:
        settings: Settings of each remaining run.
    """
    seconds = {id(one): estimate_seconds(one) for one in {id(one): one for one in settings}.values()}
    n_remaining = sum(map(n_walks, settings))
    duration = describe_duration(sum(seconds[id(one)] for one in settings))
    cores = pluralize(workers.n_cores(), "core")
    runs = pluralize(len(settings), "run")
    return f"{runs}, {pluralize(n_remaining, 'walk')}: {duration} on {cores}. Ctrl-C stops early."


class _Storage:
    """Storage of one run: it returns stored evaluations, and stores the generations that are new."""

    def __init__(
        self, file: RunFile, experiment_id: str, place: tuple[int, int], condition: Condition, stored: StoredRun | None
    ) -> None:
        self._file = file
        self._experiment_id = experiment_id
        self._place = place
        self._condition = condition
        self._facts = condition.function_facts()
        self._stored = stored.table if stored else None
        self._known: dict[str, EvaluationRow] = {}
        if stored is not None:
            columns = list(EvaluationRow._fields)
            rows = birth_rows(stored.table)[columns].itertuples(index=False, name=None)
            self._known = {row[-1]: EvaluationRow._make(row) for row in rows}
        self._n_generations = 0

    def recall(self, texts: list[str]) -> dict[str, EvaluationRow]:
        """Return the stored evaluations, keyed by the text of their genomes."""
        return {text: self._known[text] for text in texts if text in self._known}

    def add(self, table: pd.DataFrame) -> None:
        """Store a generation, or check that it is the stored one.

        Raises:
            RunFileError: If it differs from the stored one.
        """
        number = self._n_generations
        if self._stored is not None and number <= self._stored.generation.max():
            stored = self._stored.loc[self._stored.generation == number, :].reset_index(drop=True)
            if not stored.equals(table.reset_index(drop=True)):
                raise RunFileError(
                    f"generation {number} of condition {self._condition.name!r}, seed {self._place[1]}, differs "
                    f"from the one in {display_path(self._file)}: one of your functions has changed, or draws random "
                    "numbers from a source other than rng. Repeat the experiment with another file."
                )
        else:
            with interrupts_held():
                experiments.append(self._file, self._experiment_id, self._place, table, self._facts)
        self._n_generations += 1

    def finish(self) -> None:
        """Record that the run has ended."""
        experiments.finish(self._file, self._experiment_id, self._place, self._n_generations)


def _run(
    condition: Condition, seed: int, executor: Executor | None, on_walks: Callable[[int], Any], storage: _Storage
) -> None:
    """Run a condition with a seed; evaluations that are stored are not repeated."""
    settings = condition.for_seed(seed)
    recall: Recall = storage.recall
    if condition.function is None:
        for generation in Evolution(
            settings, None, executor, on_walks=on_walks, recall=recall, population=condition.founders or None
        ):
            storage.add(generation.records)
    else:
        walk = partial(evaluate, settings=settings, executor=executor, on_done=on_walks)
        run_optimiser(condition.function, settings, walk, recall, storage.add, condition.founders)
    storage.finish()


def _add_note(error: Exception, file: RunFile) -> None:
    """Add a note to an error that says where the experiment is stored; a temporary file is saved first."""
    try:
        path = file if isinstance(file, Path) else store.save_temporary(file)
    except RunFileError as problem:
        error.add_note(str(problem))
        return
    error.saved_path = path  # type: ignore[attr-defined]
    error.add_note(
        f"The experiment so far is saved in {display_path(path)}. Fix the error, then continue the experiment with "
        f"the same call and path={display_path(path)!r}."
    )
