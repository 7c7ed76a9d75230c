"""The Price equation: how much of the change of a generation's mean comes from selection, and how much from variation.

After Price 1970, Nature 227. It is an identity: the terms add up to the change exactly, whatever the operators are.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from walkerlab.ga.genes import Floats
from walkerlab.runfile.records import RECORD_COLUMNS, parent_numbers
from walkerlab.runfile.tables import require_table

TERMS = {
    "selection": "the parents differ from the mean of their generation, because fitter robots were selected",
    "failed_walks": "children whose walks do not count are left out, together with their parents' values",
    "variation": "children differ from the mean of their parents, because of crossover and mutation",
    "insertion": "genomes inserted by hand have no parents",
}
"""Each term of the split, and its meaning."""


def price_equation(records: Any, trait: str = "fitness") -> pd.DataFrame:
    """Split the change of the mean from each generation to the next into selection, variation and two smaller terms.

    A robot whose walk does not count has the fitness -inf, and is therefore left out of the means of its generation.
    Parents are always robots whose walks count. A child with several parents is attributed to each in equal parts; an
    elite has one parent, itself. Four terms add up to the change of the mean:

    - ``selection``: mean of the parents, each weighted by its children, minus the mean of their generation. This is the
      covariance of the trait and the number of children, divided by the mean number of children.
    - ``failed_walks``: change of the weighted mean of the parents if only children whose walks count are included.
    - ``variation``: mean difference between the counted children and the mean of their parents.
    - ``insertion``: change of the mean through genomes that were inserted by hand.

    In the first generation with changed settings, ``variation`` includes the effect of the settings. Generations rated
    by an earlier fitness function are left out.

    Args:
        records: Table of a run, or the run.
        trait: Numeric column: ``fitness``, or a trait such as ``body_length``.

    Returns:
        Table with a row for each generation but the first: ``generation``, ``mean_before`` (of the previous
        generation), ``mean`` (of this one), ``change``, and the terms. All are NaN if either of the two generations has
        no walk that counts. ``.attrs`` has the trait and its unit.

    Raises:
        ValueError: If the table has no such column, or a parent of a robot is not in the previous generation.
    """
    table = require_table(records, "individual", "born", "parents", "verdict", trait)
    if not pd.api.types.is_numeric_dtype(table[trait]):
        raise ValueError(
            f"the column {trait!r} is not numeric; the numeric columns are {', '.join(_numeric_columns(table))}"
        )
    since = max(table.attrs.get("rated_since", 0), table.attrs.get("fitness_since", 0))
    grouped: Any = table.loc[table.generation >= since, :].groupby("generation")
    generations: dict[int, pd.DataFrame] = {int(number): rows for number, rows in grouped}
    rows = [
        {"generation": number, **_split(generations[number - 1], generations[number], trait)}
        for number in generations
        if number - 1 in generations
    ]
    result = pd.DataFrame(rows, columns=["generation", "mean_before", "mean", "change", *TERMS])
    unit = table.attrs.get("units", {}).get(trait, RECORD_COLUMNS[trait][1] if trait in RECORD_COLUMNS else "")
    name = table.attrs.get("fitness", "fitness") if trait == "fitness" else trait.replace("_", " ")
    result.attrs = {"trait": name, "unit": unit, "stages": table.attrs.get("stages", {})}
    return result


def parents_of(rows: pd.DataFrame) -> list[tuple[int, ...]]:
    """Return the parents of each robot in the previous generation; an elite is its own parent."""
    numbers = zip(rows.individual.tolist(), rows.born.tolist(), rows.generation.tolist(), rows.parents, strict=True)
    return [
        (individual,) if born < generation else parent_numbers(parents)
        for individual, born, generation, parents in numbers
    ]


def mean_of_parents(rows: pd.DataFrame, values: Mapping[int, float]) -> Floats:
    """Return the mean value of the parents of each robot, shape (n,); NaN if it has no parents.

    Args:
        rows: Rows of one generation.
        values: Value of each robot of the previous generation, keyed by its number.

    Raises:
        ValueError: If a parent is not in the previous generation.
    """
    try:
        return np.array(
            [np.mean([values[each] for each in parents]) if parents else np.nan for parents in parents_of(rows)]
        )
    except KeyError as error:
        raise ValueError(
            f"robot {error.args[0]} is a parent of a robot of generation {rows.generation.iloc[0]}, but it is not in "
            "the previous generation. Pass the complete table of the run, run.records."
        ) from error


def _split(before: pd.DataFrame, after: pd.DataFrame, trait: str) -> dict[str, float]:
    """Return the means of two successive generations, their difference, and the terms of the difference."""
    values = dict(zip(before.individual.tolist(), before[trait].astype(np.float64).tolist(), strict=True))
    inherited = mean_of_parents(after, values)
    has_parents = np.isfinite(inherited)
    own = after[trait].to_numpy(dtype=np.float64)
    counts = (after.verdict == "ok").to_numpy()
    counted_before = before.loc[before.verdict == "ok", trait]
    if not len(counted_before) or not (has_parents & counts).any():
        return dict.fromkeys(("mean_before", "mean", "change", *TERMS), np.nan)
    mean_before = float(counted_before.mean())
    mean = float(own[counts].mean())
    mean_of_all_parents = float(inherited[has_parents].mean())
    mean_of_counted_parents = float(inherited[has_parents & counts].mean())
    mean_of_descendants = float(own[has_parents & counts].mean())
    return {
        "mean_before": mean_before,
        "mean": mean,
        "change": mean - mean_before,
        "selection": mean_of_all_parents - mean_before,
        "failed_walks": mean_of_counted_parents - mean_of_all_parents,
        "variation": mean_of_descendants - mean_of_counted_parents,
        "insertion": mean - mean_of_descendants,
    }


def _numeric_columns(table: pd.DataFrame) -> list[str]:
    identifiers = {"generation", "individual", "born"}
    return [str(name) for name in table.select_dtypes("number") if name not in identifiers]
