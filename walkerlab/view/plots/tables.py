"""Tables for plots: checks before drawing, and the names, units and numbers that a plot shows."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from walkerlab.runfile.records import RECORD_COLUMNS
from walkerlab.runfile.tables import require_table as require_table
from walkerlab.text.numbers import format_significant

UNKNOWN_FITNESS = "fitness"  # name of the fitness if the table does not name its fitness function


def require_analysis(table: Any, source: str, *columns: str) -> pd.DataFrame:
    """Return a table of ``wl.analysis`` after checking its columns.

    Raises:
        ValueError: If ``table`` is not a table, or lacks a column; the message names the function that returns it.
    """
    if not isinstance(table, pd.DataFrame) or not {*columns} <= {*table.columns}:
        found = f"the columns {', '.join(map(str, table.columns))}" if isinstance(table, pd.DataFrame) else type(table)
        raise ValueError(f"this plot needs the table that wl.analysis.{source}(…) returns; got {found}")
    return table


def require_same_fitness(groups: Mapping[str, Sequence[pd.DataFrame]]) -> pd.DataFrame:
    """Return the first of several tables, after checking that all have the same fitness.

    Raises:
        ValueError: If two tables have a different fitness.
    """
    tables = [require_table(table, "verdict", "fitness") for of_group in groups.values() for table in of_group]
    labels = list(dict.fromkeys(map(fitness_label, tables)))
    if len(labels) > 1:
        raise ValueError(
            f"these runs have different fitness, {labels[0]!r} and {labels[1]!r}, which cannot share a vertical axis. "
            "Draw them on separate Axes, as in: figure, (left, right) = plt.subplots(1, 2)"
        )
    return tables[0]


def describe_not_counted(records: pd.DataFrame) -> str:
    """Describe the share of the robots whose walks do not count: `` (14 % not counted)``; "" if all count."""
    share = float((records.verdict != "ok").mean()) if len(records) else 0.0
    if share == 0:
        return ""
    percent = min(99, max(1, round(100 * share))) if share < 1 else 100
    return f" ({percent} % not counted)"


def unit_of(records: pd.DataFrame, column: str) -> str:
    """Return the unit of a column, "" if it has none; a table from a CSV file has lost the unit of its fitness."""
    default = RECORD_COLUMNS[column][1] if column in RECORD_COLUMNS else ""
    return str(records.attrs.get("units", {}).get(column, default))


def fitness_label(records: pd.DataFrame) -> str:
    """Return the name of the fitness of a table with its unit: ``distance [m]``."""
    return axis_label(str(records.attrs.get("fitness", UNKNOWN_FITNESS)), unit_of(records, "fitness"))


def axis_label(name: str, unit: str) -> str:
    """Return the label of an axis, with the unit in brackets: ``distance [m]``."""
    return f"{name} [{unit}]" if unit else name


def format_value(value: float, unit: str) -> str:
    """Format a number with three significant figures, no trailing zeros, a true minus sign, and its unit."""
    digits, _, power = format_significant(value).partition("e")
    if "." in digits:
        digits = digits.rstrip("0").rstrip(".")
    number = f"{digits}e{power}" if power else digits
    return f"{number.replace('-', '−')}{f' {unit}' if unit else ''}"


def describe_change(values: pd.Series, unit: str) -> str:
    """Describe the change of a series from its first to its last value: ``rises from 1 m to 2 m``."""
    first = format_value(float(values.iloc[0]), unit)
    last = format_value(float(values.iloc[-1]), unit)
    if first == last:
        return f"stays at {first}" if values.nunique() == 1 else f"begins and ends at {first}"
    return f"{'rises' if values.iloc[-1] > values.iloc[0] else 'falls'} from {first} to {last}"
