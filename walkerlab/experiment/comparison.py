"""Comparison of the conditions of an experiment: one row for each condition, one for each pair, and a sentence."""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd

from walkerlab.experiment import statistics
from walkerlab.experiment.conditions import Condition
from walkerlab.ga.genes import Floats
from walkerlab.ga.population import NOT_COUNTED

NEVER = np.inf
"""Number of evaluations of a run that did not reach the threshold."""


def best_fitness(table: pd.DataFrame) -> float:
    """Return the best fitness of a run; ``-inf`` if no walk counted."""
    counted = table.fitness[table.verdict == "ok"]
    return float(counted.max()) if len(counted) else NOT_COUNTED


def evaluations_to_reach(table: pd.DataFrame, threshold: float) -> float:
    """Return the number of robots evaluated until one reaches a fitness; ``inf`` if none does.

    Args:
        table: Tidy table of a run.
        threshold: Fitness to reach.
    """
    born = table[table.born == table.generation]
    reached = np.flatnonzero((born.fitness.to_numpy() >= threshold) & (born.verdict == "ok").to_numpy())
    return float(reached[0] + 1) if reached.size else NEVER


def compared_groups(conditions: Sequence[Condition]) -> list[list[int]]:
    """Return the groups of conditions that are compared with each other, as numbers of conditions.

    If there are several worlds with several conditions each, the conditions of each world are a group. Otherwise all
    are one group.

    Args:
        conditions: Conditions of the experiment.
    """
    worlds = [condition.world for condition in conditions]
    if not all(worlds.count(world) > 1 for world in worlds):
        return [list(range(len(conditions)))]
    firsts = [number for number, world in enumerate(worlds) if worlds.index(world) == number]
    return [[number for number, world in enumerate(worlds) if world == worlds[first]] for first in firsts]


def pairs_to_compare(conditions: Sequence[Condition], against: str | None = None) -> list[tuple[int, int]]:
    """Return the pairs of conditions to compare, as pairs of their numbers.

    Args:
        conditions: Conditions of the experiment.
        against: Name of the condition that all others are compared with; all pairs if None.

    Raises:
        ValueError: If there is no such condition.
    """
    names = [condition.name for condition in conditions]
    if against is not None and against not in names:
        raise ValueError(f"there is no condition {against!r}; the conditions are {', '.join(map(repr, names))}")
    return [
        (i, j) if against is None or names[i] != against else (j, i)
        for group in compared_groups(conditions)
        for i, j in combinations(group, 2)
        if against is None or against in (names[i], names[j])
    ]


def default_threshold(finals: Sequence[Floats]) -> float:
    """Return the lowest of the medians: the fitness that every condition reaches in half of its runs."""
    return float(min(np.median(values) for values in finals))


def tabulate_conditions(
    conditions: Sequence[Condition], tables: Sequence[Sequence[pd.DataFrame]], thresholds: Sequence[float]
) -> pd.DataFrame:
    """Return a row for each condition.

    Args:
        conditions: Conditions of the experiment.
        tables: Tables of the runs of each condition, in the order of the seeds.
        thresholds: Fitness to reach, for each condition.

    Returns:
        Table with the columns ``condition``, ``runs``, ``best`` (median of the best fitness of a run), ``best_low``
        and ``best_high`` (its interval), ``threshold``, ``reached`` (number of runs that reached it), ``evaluations``
        (median number of robots until then, ``inf`` if less than half of the runs reached it), ``budget`` (median
        number of robots of a run) and ``counted`` (share of walks that count).
    """
    rows: list[dict[str, Any]] = []
    for condition, of_condition, threshold in zip(conditions, tables, thresholds, strict=True):
        finals = np.array([best_fitness(table) for table in of_condition])
        low, high = statistics.median_interval(finals)
        evaluations = [evaluations_to_reach(table, threshold) for table in of_condition]
        born = [table[table.born == table.generation] for table in of_condition]
        rows.append(
            {
                "condition": condition.name,
                "runs": len(finals),
                "best": float(np.median(finals)),
                "best_low": low,
                "best_high": high,
                "threshold": threshold,
                "reached": int(np.isfinite(evaluations).sum()),
                "evaluations": _censored_median(evaluations),
                "budget": float(np.median([len(robots) for robots in born])),
                "counted": float(np.mean(np.concatenate([robots.verdict == "ok" for robots in born]))),
            }
        )
    return pd.DataFrame(rows)


def _censored_median(values: Sequence[float]) -> float:
    """Return the median; it is the upper middle value if that run did not reach the threshold."""
    ordered = sorted(values)
    upper = ordered[len(ordered) // 2]
    return upper if not np.isfinite(upper) else float(np.median(ordered))


def tabulate_comparisons(
    conditions: Sequence[Condition], finals: Sequence[Floats], pairs: Sequence[tuple[int, int]]
) -> pd.DataFrame:
    """Return a row for each pair of conditions.

    Args:
        conditions: Conditions of the experiment.
        finals: Best fitness of each run of each condition, in the order of the seeds.
        pairs: Numbers of the conditions of each pair.

    Returns:
        Table with the columns ``a``, ``b``, ``difference`` (of medians), ``low`` and ``high`` (its paired interval),
        ``a_better`` and ``b_better`` (numbers of seeds), ``a12``, ``a12_low`` and ``a12_high`` (effect size), ``p``,
        ``p_corrected`` (Holm) and ``detectable`` (smallest true difference that is found with a probability of 80 %).
    """
    rows: list[Mapping[str, Any]] = []
    for i, j in pairs:
        a, b = finals[i], finals[j]
        low, high = statistics.difference_interval(a, b)
        a12_low, a12_high = statistics.effect_size_interval(a, b)
        with np.errstate(invalid="ignore"):
            differences = a - b
            difference = float(np.median(a) - np.median(b))
        rows.append(
            {
                "a": conditions[i].name,
                "b": conditions[j].name,
                "difference": difference,
                "low": low,
                "high": high,
                "a_better": int((a > b).sum()),
                "b_better": int((b > a).sum()),
                "a12": statistics.effect_size(a, b),
                "a12_low": a12_low,
                "a12_high": a12_high,
                "p": statistics.paired_test(a, b),
                "detectable": statistics.detectable_difference(differences, len(pairs)),
            }
        )
    table = pd.DataFrame(rows)
    if rows:
        table.insert(len(table.columns) - 1, "p_corrected", statistics.holm(table["p"].tolist()))
    return table
