"""Rate the robots of a finished run with another fitness function, and compare the ranks."""

from collections.abc import Callable
from concurrent.futures import Executor
from typing import Any, Protocol

import numpy as np
import pandas as pd

from walkerlab.ga.genes import Floats, Indices
from walkerlab.ga.population import NOT_COUNTED
from walkerlab.runfile.tables import require_table
from walkerlab.settings.choices import Fitness, Guard
from walkerlab.settings.settings import Settings
from walkerlab.simulation.evaluation import evaluate
from walkerlab.simulation.fitness import check_user_function, name_and_unit
from walkerlab.simulation.validity import REJECTED

RECORDED = (Fitness.distance, Fitness.velocity)
"""Fitness functions whose values a run records for every walk."""


class HasRecords(Protocol):
    """A run: its settings and its table."""

    @property
    def settings(self) -> Settings:
        """Settings of the run."""
        ...

    @property
    def records(self) -> pd.DataFrame:
        """Table of the run."""
        ...


def rescore(
    run: HasRecords,
    fitness: str | Fitness | Callable[..., Any],
    executor: Executor | None = None,
    *,
    on_done: Callable[[int], None] = lambda _: None,
) -> pd.DataFrame:
    """Rate all robots of a run with another fitness function, and compare their ranks before and after.

    Distance and velocity are recorded for every walk, so they require no new walks. For any other fitness function,
    each robot walks again with the settings of the run. The same holds for all fitness functions if the run has several
    starts, because only the poorest walk is recorded. Only robots that evolved are rated; a run with the other fitness
    function would have produced other robots.

    Args:
        run: Finished run. If its settings or its fitness were changed, only robots since the last change are rated.
        fitness: Other fitness function: a name, a ``Fitness``, or a function of a rollout.
        executor: Executor for new walks; loky on all cores if None.
        on_done: Function called after each task with the number of robots that have newly walked again.

    Returns:
        Table with a row for each robot, in the order of the new ranks: ``individual``, ``generation`` (of its birth),
        ``verdict``, ``verdict_after``, ``fitness``, ``fitness_after``, ``rank`` and ``rank_after`` (1 is the fittest;
        of equals, the first-born is first) and ``genome``. ``.attrs`` has the names and units of both (``fitness``,
        ``fitness_after``, ``units``), the ``source`` of the new ratings (``recorded columns`` or ``new walks``), and
        the ``summary``, a sentence about the two champions.

    Raises:
        OperatorError: If the fitness function fails.
        SettingsError: If there is no fitness of this name.
        ValueError: If the run has no robots.
    """
    records = require_table(run.records, "individual", "born", "fitness", "verdict", "distance", "velocity", "genome")
    settings = run.settings.with_(fitness=fitness)
    other: Any = settings.algorithm.fitness
    check_user_function(settings)
    since = max(records.attrs.get("rated_since", 0), *records.attrs.get("stages", {}), 0)
    table = records.loc[records.generation >= since, :].drop_duplicates("individual", keep="last")
    if table.empty:
        raise ValueError("no robot has walked yet, so there is nothing to rate again")
    if other in RECORDED and settings.simulation.n_starts == 1:
        source = "recorded columns"
        verdicts = table.verdict.replace([REJECTED, Guard.fragile.name], "ok").tolist()  # these walks are valid
        after = np.where(np.array(verdicts) == "ok", table[other.name].to_numpy(), NOT_COUNTED)
    else:
        source = "new walks"
        evaluations = evaluate(table.genome.tolist(), settings, executor, on_done=on_done)
        verdicts = [evaluation.verdict for evaluation in evaluations]
        after = np.array([evaluation.fitness for evaluation in evaluations])
    columns = {
        "individual": table.individual.to_numpy(),
        "generation": table.born.to_numpy(),
        "verdict": table.verdict.to_numpy(),
        "verdict_after": verdicts,
        "fitness": table.fitness.to_numpy(),
        "fitness_after": after,
    }
    result = pd.DataFrame(columns | {"genome": table.genome.to_numpy()}).sort_values("individual", kind="stable")
    result.insert(6, "rank", _ranks(result.fitness.to_numpy()))
    result.insert(7, "rank_after", _ranks(result.fitness_after.to_numpy()))
    result = result.sort_values("rank_after", ignore_index=True)
    before, unit_before = name_and_unit(run.settings.algorithm.fitness)
    name, unit = name_and_unit(other)
    result.attrs = {"fitness": before, "fitness_after": name, "source": source}
    result.attrs["units"] = {"fitness": unit_before, "fitness_after": unit}
    result.attrs["summary"] = _summarise(result)
    return result


def _ranks(fitness: Floats) -> Indices:
    """Return the rank of each robot, 1 for the fittest; equal robots are ranked in their order."""
    ranks = np.empty(len(fitness), dtype=np.intp)
    ranks[np.argsort(-fitness, kind="stable")] = np.arange(1, len(fitness) + 1)
    return ranks


def _summarise(table: pd.DataFrame) -> str:
    """Describe the champions by both fitness functions in one or two sentences."""
    before, after = table.attrs["fitness"], table.attrs["fitness_after"]
    old = table.loc[table["rank"].idxmin()]
    new = table.iloc[0]
    if not np.isfinite(new.fitness_after):
        return f"No walk counts when rated by {after}."
    if old.individual == new.individual:
        return f"Robot {new.individual} is the champion by {before} and by {after}."
    return (
        f"The champion by {before} is robot {old.individual}, rank {old.rank_after} of {len(table)} by {after}. The "
        f"champion by {after} is robot {new.individual}, rank {new['rank']} by {before}."
    )
