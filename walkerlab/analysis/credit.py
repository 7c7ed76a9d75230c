"""Credit of the operators: how often, and by how much, their children are fitter than their parents."""

import math
from typing import Any

import numpy as np
import pandas as pd

from walkerlab.analysis.price import parents_of
from walkerlab.runfile.tables import require_table

SEPARATOR = " > "  # between selection, crossover and mutation in the column ``operators``


def operator_credit(records: Any) -> pd.DataFrame:
    """Compare the children of each pair of crossover and mutation with their parents.

    Elites, random genomes and genomes inserted by hand are left out. A child whose walk does not count is never
    better, and is left out of the gains, because its fitness is -inf. Generations rated by an earlier fitness function
    are left out, too.

    Args:
        records: Run, experiment, or the table of either. To combine several runs, pass an experiment.

    Returns:
        Table with a row for each pair of operators, most children first: ``crossover``, ``mutation``, ``children``,
        ``counted`` (children whose walks count), ``better`` (share of all children that are fitter than their fitter
        parent), ``better_error`` (its standard error), ``mean_gain`` (fitness of the counted children minus the mean of
        their parents), ``gain_error`` (its standard error) and ``best_gain`` (highest fitness of a child minus that of
        its fitter parent).

    Raises:
        ValueError: If a parent of a robot is not in the previous generation.
    """
    table = getattr(records, "records", records)
    columns = ("individual", "born", "parents", "operators", "fitness", "verdict")
    if isinstance(table, pd.DataFrame) and {"condition", "seed"} <= {*table.columns}:
        runs = [require_table(run, *columns) for _, run in table.groupby(["condition", "seed"], sort=False)]
    else:
        runs = [require_table(table, *columns)]
    children = pd.concat([_compare_with_parents(run) for run in runs], ignore_index=True)
    pairs: Any = children.groupby(["crossover", "mutation"], sort=False)
    rows = [
        {"crossover": crossover, "mutation": mutation, **_summarise_children(group)}
        for (crossover, mutation), group in pairs
    ]
    names = ("children", "counted", "better", "better_error", "mean_gain", "gain_error", "best_gain")
    result = pd.DataFrame(rows, columns=["crossover", "mutation", *names])
    result = result.sort_values("children", ascending=False, kind="stable", ignore_index=True)
    attrs = runs[0].attrs if runs else {}
    result.attrs = {"fitness": attrs.get("fitness", "fitness"), "unit": attrs.get("units", {}).get("fitness", "")}
    return result


def _compare_with_parents(table: pd.DataFrame) -> pd.DataFrame:
    """Return the fitness of each child of a run, with the mean and the highest fitness of its parents."""
    since = max(table.attrs.get("rated_since", 0), table.attrs.get("fitness_since", 0))
    previous: dict[int, float] = {}
    rows: list[tuple[str, str, float, float, float]] = []
    generations: Any = table.loc[table.generation >= since, :].groupby("generation")
    for number, generation in generations:
        if previous:
            children: pd.DataFrame = generation[generation.born == number]
            made = zip(children.operators, children.fitness.tolist(), parents_of(children), strict=True)
            rows += [
                (*operators.split(SEPARATOR)[1:], fitness, *_summarise_parents(parents, previous))
                for operators, fitness, parents in made
                if parents
            ]
        previous = dict(zip(generation.individual.tolist(), generation.fitness.tolist(), strict=True))
    return pd.DataFrame(rows, columns=["crossover", "mutation", "fitness", "mean_of_parents", "better_parent"])


def _summarise_parents(parents: tuple[int, ...], fitness: dict[int, float]) -> tuple[float, float]:
    """Return the mean and the highest fitness of parents.

    Raises:
        ValueError: If a parent is not in the previous generation.
    """
    if missing := [number for number in parents if number not in fitness]:
        raise ValueError(
            f"robot {missing[0]} is a parent, but it is not in the generation before its child. Pass the complete "
            "table of the run, run.records."
        )
    values = [fitness[number] for number in parents]
    return sum(values) / len(values), max(values)


def _summarise_children(children: pd.DataFrame) -> dict[str, float]:
    """Return the results of the children of one pair of operators."""
    n = len(children)
    is_better = (children.fitness > children.better_parent).to_numpy()
    counted = children[np.isfinite(children.fitness) & np.isfinite(children.mean_of_parents)]
    gain = (counted.fitness - counted.mean_of_parents).to_numpy(dtype=np.float64)
    lead = (counted.fitness - counted.better_parent).to_numpy(dtype=np.float64)
    share = float(is_better.mean())
    return {
        "children": n,
        "counted": int(np.isfinite(children.fitness).sum()),
        "better": share,
        "better_error": math.sqrt(share * (1 - share) / n),
        "mean_gain": float(gain.mean()) if len(gain) else math.nan,
        "gain_error": float(gain.std(ddof=1)) / math.sqrt(len(gain)) if len(gain) > 1 else math.nan,
        "best_gain": float(lead.max()) if len(lead) else math.nan,
    }
