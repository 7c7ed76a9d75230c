"""An experiment: the runs of several conditions with several seeds, and what they show."""

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from walkerlab.evolution.run import Run
from walkerlab.experiment.comparison import (
    best_fitness,
    compared_groups,
    default_threshold,
    pairs_to_compare,
    tabulate_comparisons,
    tabulate_conditions,
)
from walkerlab.experiment.conditions import Condition
from walkerlab.experiment.sentence import describe
from walkerlab.experiment.summary import Summary
from walkerlab.runfile import experiments, paths, records
from walkerlab.runfile.experiments import StoredRun
from walkerlab.runfile.missing_functions import remember_walks
from walkerlab.runfile.opening import RunFileError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.simulation import fitness
from walkerlab.system.files import display_path


class Experiment:
    """Runs of several conditions with several seeds; read-only."""

    def __init__(
        self,
        conditions: Sequence[Condition],
        seeds: Sequence[int],
        runs: dict[tuple[int, int], StoredRun],
        path: Path | None = None,
    ) -> None:
        """Combine the plan and the runs.

        Args:
            conditions: Conditions of the experiment.
            seeds: Seeds of the runs of each condition.
            runs: Runs that have generations, keyed by the number of the condition and the seed.
            path: File of the experiment, or None.
        """
        self._conditions = list(conditions)
        self._seeds = list(seeds)
        self._runs = runs
        self._path = path

    @property
    def plan(self) -> tuple[Condition, ...]:
        """Conditions, with their optimisers and first populations."""
        return tuple(self._conditions)

    @property
    def conditions(self) -> dict[str, Settings]:
        """Settings of each condition, keyed by name; each run has a different seed."""
        return {condition.name: condition.settings for condition in self._conditions}

    @property
    def compared(self) -> list[list[str]]:
        """Names of the conditions that are compared with each other: those of each world, or all."""
        return [[self._conditions[number].name for number in group] for group in compared_groups(self._conditions)]

    @property
    def seeds(self) -> list[int]:
        """Seeds of the runs of each condition."""
        return list(self._seeds)

    @property
    def complete_seeds(self) -> list[int]:
        """Seeds whose runs have ended in all conditions; only these are compared."""
        numbers = range(len(self._conditions))
        return [seed for seed in self._seeds if all(self._is_finished(number, seed) for number in numbers)]

    @property
    def path(self) -> Path | None:
        """File of the experiment, or None."""
        return self._path

    @property
    def records(self) -> pd.DataFrame:
        """Copy of the tidy table of all runs that have ended, with the columns ``condition`` and ``seed`` in front."""
        return records.copy_table(self._records)

    @cached_property
    def _records(self) -> pd.DataFrame:
        tables: list[pd.DataFrame] = []
        for number, condition in enumerate(self._conditions):
            for seed in self._seeds:
                if self._is_finished(number, seed):
                    table = records.copy_table(self._runs[number, seed].table)
                    table.insert(0, "condition", condition.name)
                    table.insert(1, "seed", seed)
                    tables.append(table)
        empty = records.tidy_table(pd.DataFrame(columns=list(records.RECORD_COLUMNS)))
        units = empty.attrs
        if not tables:
            empty.insert(0, "condition", "")
            empty.insert(1, "seed", 0)
        joined = pd.concat(tables, ignore_index=True) if tables else empty
        joined.attrs = units
        records.name_fitness(joined, *self._fitness)
        return joined

    def run(self, condition: str, seed: int) -> Run:
        """Return one run.

        Args:
            condition: Name of its condition.
            seed: Its seed.

        Raises:
            ValueError: If there is no such run, or none of its generations is complete.
        """
        names = list(self.conditions)
        if condition not in names or seed not in self._seeds:
            raise ValueError(
                f"there is no run of condition {condition!r} with seed {seed!r}; the conditions are "
                f"{', '.join(map(repr, names))}, the seeds {', '.join(map(str, self._seeds))}"
            )
        number = names.index(condition)
        if (number, seed) not in self._runs:
            raise ValueError(f"no generation of condition {condition!r} with seed {seed} is complete yet")
        settings = self._conditions[number].for_seed(seed)
        table = self._runs[number, seed].table
        remember_walks(settings, table)
        return Run(settings, table, founders=self._conditions[number].founders)

    def best(self, condition: str | None = None) -> Run:
        """Return the run with the fittest robot, which is its ``.champion``.

        The best of many runs says little about a condition: it is the luckiest.

        Args:
            condition: Name of the condition; all if None.

        Raises:
            ValueError: If no run has finished, or there is no such condition.
        """
        places = [(number, seed) for number, seed in self._runs if self._is_finished(number, seed)]
        if condition is not None:
            if condition not in self.conditions:
                raise ValueError(
                    f"there is no condition {condition!r}; the conditions are {', '.join(map(repr, self.conditions))}"
                )
            places = [place for place in places if self._conditions[place[0]].name == condition]
        if not places:
            raise ValueError("no run has finished yet, so there is no best one")
        number, seed = max(places, key=lambda place: best_fitness(self._runs[place].table))
        return self.run(self._conditions[number].name, seed)

    def summary(self, threshold: float | None = None, against: str | None = None) -> Summary:
        """Compare the conditions by the best fitness of each run; only seeds whose runs have all ended count.

        Args:
            threshold: Fitness to reach, for the number of robots until then; if None, the lowest median of the
                conditions that are compared with each other.
            against: Name of the condition that all others are compared with; if None, all pairs are compared. With
                fewer comparisons, smaller differences can be found.

        Raises:
            ValueError: If there is no such condition.
        """
        pairs = pairs_to_compare(self._conditions, against)
        seeds = self.complete_seeds
        name, unit = self._fitness
        label = f"{name} [{unit}]" if unit else name
        if not seeds:
            empty = pd.DataFrame()
            return Summary(describe(empty, empty, 0, name, unit), empty, empty, 0, label)
        tables = [[self._runs[number, seed].table for seed in seeds] for number in range(len(self._conditions))]
        finals = [np.array([best_fitness(table) for table in of_condition]) for of_condition in tables]
        thresholds = [
            default_threshold([finals[number], *(finals[other] for other in _partners(pairs, number))])
            if threshold is None
            else float(threshold)
            for number in range(len(finals))
        ]
        conditions = tabulate_conditions(self._conditions, tables, thresholds)
        comparisons = tabulate_comparisons(self._conditions, finals, pairs)
        return Summary(
            describe(comparisons, conditions, len(seeds), name, unit), conditions, comparisons, len(seeds), label
        )

    def plot(self) -> Any:
        """Draw the best fitness so far of each condition, and the result of each run; return the matplotlib figure."""
        from walkerlab.view.plots.comparison import draw_experiment  # here because matplotlib is slow to import

        return draw_experiment(self.records, self.compared)

    def report(self, folder: str | Path) -> Path:
        """Write a report: a self-contained page, the pictures and all tables.

        Args:
            folder: Folder for ``report.html``, ``records.csv``, ``pictures`` and ``tables``; created if it does not
                exist. An earlier report there is replaced.

        Returns:
            Path of ``report.html``.

        Raises:
            ValueError: If no seed is complete yet.
            OSError: If a file cannot be written.
        """
        from walkerlab.experiment.report import save_report

        return save_report(self, folder)

    def __repr__(self) -> str:
        """Summarise the experiment in a line."""
        file = f", in {display_path(self.path)}" if self.path else ""
        conditions = pluralize(len(self._conditions), "condition")
        return f"Experiment({conditions}, {pluralize(len(self._seeds), 'seed')}, {self.status or 'complete'}{file})"

    @property
    def status(self) -> str:
        """How many runs are missing, and how to continue; "" if the experiment is complete."""
        total = len(self._conditions) * len(self._seeds)
        n_finished = sum(run.is_finished for run in self._runs.values())
        if n_finished == total:
            return ""
        how = (
            "to continue, repeat the call with the same path"
            if self.path
            else "it has no file, so it cannot be continued"
        )
        return f"{n_finished} of {total} runs have ended; {how}"

    def _repr_html_(self) -> str:
        from walkerlab.experiment.report import experiment_html

        return experiment_html(self)

    @property
    def _fitness(self) -> tuple[str, str]:
        return fitness.name_and_unit(self._conditions[0].settings.algorithm.fitness)

    def _is_finished(self, number: int, seed: int) -> bool:
        return (number, seed) in self._runs and self._runs[number, seed].is_finished


def load_experiment(path: str | Path) -> Experiment:
    """Read an experiment from its file; ``wl.compare`` with the same conditions continues it.

    Args:
        path: File of the experiment.

    Raises:
        RunFileError: If the file does not exist, is not an experiment, or is damaged.
    """
    located = paths.locate_run_file(path)
    _, stored = experiments.read(located)
    try:
        conditions = [Condition.from_plain(plain) for plain in stored.conditions]
        seeds = [Settings().with_(seed=seed).algorithm.seed for seed in stored.seeds]
        if len({condition.name for condition in conditions}) < len(conditions):
            raise ValueError("two of its conditions have the same name")
        if not conditions or any(
            number not in range(len(conditions)) or seed not in seeds for number, seed in stored.runs
        ):
            raise ValueError("it has a run that is not in its plan")
    except (AttributeError, KeyError, TypeError, ValueError, RecursionError) as error:
        raise RunFileError(
            f"{display_path(located)} is damaged: {error}. Delete it and repeat the experiment."
        ) from error
    return Experiment(conditions, seeds, stored.runs, located)


def _partners(pairs: Sequence[tuple[int, int]], number: int) -> list[Any]:
    """Return the numbers of the conditions that a condition is compared with."""
    return [j if i == number else i for i, j in pairs if number in (i, j)]
