"""Check that a table is the table of one run, before it is drawn or analysed."""

from typing import Any

import pandas as pd


def require_table(records: Any, *columns: str) -> pd.DataFrame:
    """Return the table of a run after checking it.

    Args:
        records: Table of a run, or the run.
        *columns: Required columns besides ``generation``.

    Raises:
        TypeError: If ``records`` is neither a table nor a run.
        ValueError: If the table lacks a column, or contains several runs.
    """
    table = getattr(records, "records", records)
    if not isinstance(table, pd.DataFrame):
        raise TypeError(f"records must be a run or its table, run.records; got a {type(records).__name__}")
    if missing := [name for name in ("generation", *columns) if name not in table]:
        raise ValueError(
            f"the table has no column {' and no column '.join(map(repr, missing))}; it has "
            f"{', '.join(map(str, table.columns)) or 'no columns'}. The complete table of a run is run.records."
        )
    if "individual" in table and (repeated := table.duplicated(["generation", "individual"])).any():
        row = table.loc[repeated, :].iloc[0]
        raise ValueError(
            f"this table has robot {row.individual} of generation {row.generation} more than once, so it contains "
            "several runs. Pass the runs as a list instead: wl.plots.fitness_curve([run_a, run_b]), which draws their "
            'median, or as a dict: wl.plots.fitness_curve({"a": run_a, "b": run_b}), which draws each of them'
        )
    return table
