"""Saved results of an experiment: the champion of each run of three conditions with twelve seeds, for lesson 07.

    python -m walkerlab.lessons.saved_results data/runs/results.csv

runs the experiment and replaces the table; it has about 19,000 walks. An interrupted experiment continues if the
command is repeated. The table is stored instead of the run file of the experiment, which is 600 times as large.
"""

import sys
from pathlib import Path
from typing import Any

import pandas as pd

from walkerlab.experiment.compare import compare
from walkerlab.experiment.experiment import Experiment
from walkerlab.experiment.optimisers import random_search
from walkerlab.runfile.records import birth_rows
from walkerlab.settings.settings import Settings
from walkerlab.system.package_files import find_package_file

FILE = "data/runs/results.csv"
SEEDS = range(12)
CHANGES: dict[str, Any] = {"population_size": 24, "generations": 24, "duration": 5.0}
"""Settings of the experiment that differ from the defaults, as arguments of ``Settings.with_``."""


def saved_results() -> pd.DataFrame:
    """Return the best robot of each run of an experiment that was run before the lesson.

    Returns:
        Table with a row for each run: ``condition`` ("evolution", "macro" or "random search"), ``seed``, ``walks``
        (number of robots that walked), ``fitness`` (of the best robot, in m) and its ``genome``. ``.attrs`` contains
        the ``settings``.
    """
    table = pd.read_csv(find_package_file(FILE))
    table.attrs["settings"] = Settings().with_(**CHANGES)
    return table


def run_experiment(path: Path) -> Experiment:
    """Run the experiment, or continue it.

    Args:
        path: File of the experiment.
    """
    base = Settings().with_(**CHANGES)
    conditions: dict[str, Any] = {
        "evolution": base,
        "macro": base.with_(mutation="macro"),
        "random search": (random_search, base),
    }
    return compare(conditions, SEEDS, path, progress=False)


def tabulate(experiment: Experiment) -> pd.DataFrame:
    """Return the champion of each run of an experiment; the columns are those of ``saved_results``."""
    rows: list[dict[str, Any]] = []
    for condition in experiment.conditions:
        for seed in experiment.seeds:
            run = experiment.run(condition, seed)
            n_walks = len(birth_rows(run.records))
            champion = run.champion
            rows.append(
                {
                    "condition": condition,
                    "seed": seed,
                    "walks": n_walks,
                    "fitness": round(champion.fitness, 4),
                    "genome": str(champion.genome),
                }
            )
    return pd.DataFrame(rows)


if __name__ == "__main__":
    file = Path(sys.argv[1])
    tabulate(run_experiment(file.with_suffix(".walk"))).to_csv(file, index=False)
