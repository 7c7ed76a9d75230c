"""Curves and comparisons as numbers: ``wl.stats``."""

from typing import Any

import pandas as pd

from walkerlab.experiment.statistics import detectable_difference as detectable_difference
from walkerlab.experiment.statistics import difference_interval as difference_interval
from walkerlab.experiment.statistics import effect_size as effect_size
from walkerlab.experiment.statistics import effect_size_interval as effect_size_interval
from walkerlab.experiment.statistics import holm as holm
from walkerlab.experiment.statistics import median_interval as median_interval
from walkerlab.experiment.statistics import paired_test as paired_test
from walkerlab.experiment.statistics import power as power
from walkerlab.view.plots.genomes import diversity_by_generation
from walkerlab.view.plots.groups import best_so_far, read_groups
from walkerlab.view.plots.tables import require_table
from walkerlab.view.summary import generation_statistics


def curves(records: Any) -> pd.DataFrame:
    """Return the curves that the plots draw as a table, with a row for each generation of each run.

    Args:
        records: Table of a run, or the run; a list of runs, a dict from names to runs or to lists of them, or an
            experiment.

    Returns:
        Table with the columns ``generation``, ``best``, ``best_so_far``, ``upper_quartile``, ``median`` and
        ``lower_quartile`` (of the fitness of the walks that count), ``counted`` and ``robots`` (their numbers), and
        ``diversity``. With several runs, ``condition`` and ``seed``, or the position in the list, are in front.
    """
    groups = read_groups(records)
    if groups is None:
        return _curves_of_run(require_table(records, "verdict", "fitness", "genome"))
    tables: list[pd.DataFrame] = []
    for name, runs in groups.items():
        for position, run in enumerate(runs):
            table = _curves_of_run(run)
            table.insert(0, "condition", name)
            table.insert(1, "seed", run.seed.iloc[0] if "seed" in run else position)
            tables.append(table)
    return pd.concat(tables, ignore_index=True)


def _curves_of_run(records: pd.DataFrame) -> pd.DataFrame:
    table = generation_statistics(records)
    table.insert(2, "best_so_far", best_so_far(records).to_numpy())
    return table.assign(diversity=diversity_by_generation(records).to_numpy())
