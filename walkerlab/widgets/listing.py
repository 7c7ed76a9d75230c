"""Descriptions of a generation for the population widget: sorted rows of formatted figures, and a summary."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from walkerlab.runfile.records import INSERTED_BY_HAND, find_champion
from walkerlab.settings.terms import explain_term
from walkerlab.settings.values import pluralize
from walkerlab.simulation.validity import VERDICTS
from walkerlab.text.numbers import format_fixed_column, format_significant_column, with_unit
from walkerlab.view.plots.tables import unit_of

MAX_LISTED = 300  # maximum number of robots that have a row in the table
MAX_DRAWN = 60  # maximum number of robots that have a picture
MINUS_SIGN = "\N{MINUS SIGN}"

ELITE = "elite"
INVALID = "invalid"
INSERTED = "inserted"
KIND_SIGNS = {ELITE: "★", INVALID: "⚠\N{VARIATION SELECTOR-15}", INSERTED: "✎", "": ""}
"""Symbols for the kinds of robots: elites, robots whose walks do not count, robots made by hand, and all others."""

VERDICT_NOTES = {"fragile": " (much worse from another start)"}
"""What follows a verdict whose name does not say what happened, keyed by verdict."""


@dataclass(frozen=True)
class Column:
    """A column of the table.

    Attributes:
        title: Heading.
        order: Description of the order when robots are sorted by this column.
        digits: Decimals, or more if the largest number is small; unused for fitness, which has significant digits.
        is_ascending: Whether the smallest value comes first.
    """

    title: str
    order: str
    digits: int = 0
    is_ascending: bool = False


SORT_COLUMNS = {
    "individual": Column("robot", "by number", is_ascending=True),
    "fitness": Column("fitness", "fittest first"),
    "distance": Column("distance", "farthest first", 2),
    "velocity": Column("velocity", "fastest first", 2),
    "n_legs": Column("legs", "most legs first"),
    "n_segments": Column("segments", "most segments first"),
    "weight": Column("weight", "heaviest first", 1),
    "body_length": Column("length", "longest first", 2),
    "verdict": Column("verdict", "not counted first"),
}
"""Columns of the table, keyed by name, in display order; robots can be sorted by each of them."""


def sort_robots(records: pd.DataFrame, column: str) -> pd.DataFrame:
    """Sort a generation by a column, and equal or missing values by fitness and number.

    Args:
        records: Rows of one generation.
        column: Name of a column of ``SORT_COLUMNS``.
    """
    key = records.verdict == "ok" if column == "verdict" else records[column]
    keys = pd.DataFrame({"key": key, "fitness": records.fitness, "individual": records.individual})
    ascending = [column == "verdict" or SORT_COLUMNS[column].is_ascending, False, True]
    return records.loc[keys.sort_values(list(keys), ascending=ascending, kind="stable").index]


def describe_generation(records: pd.DataFrame) -> dict[str, Any]:
    """Describe a generation as plain data for the browser.

    Args:
        records: Rows of one generation, in display order.

    Returns:
        ``title`` and ``warning`` of the generation; ``warning_about``, the meaning of the verdicts in the warning;
        ``n_drawn``, the largest number of pictures; ``drawn_note`` and ``listed_note``, which say that not all robots
        have a picture or a row; ``columns`` with key, title, explanation, unit and sort direction; ``rows`` with
        ``individual``, ``kind``, ``sign``, ``rank``, ``label``, ``description`` and ``cells``.
    """
    fitness_name = str(records.attrs.get("fitness", ""))
    unit = unit_of(records, "fitness")
    invalid = records[records.verdict != "ok"]
    n_elites = int((records.born < records.generation).sum())
    number = records.generation.iloc[0]
    elites = f", {KIND_SIGNS[ELITE]} {pluralize(n_elites, 'elite')} of generation {number - 1}" if n_elites else ""
    n_inserted = int((records.operators == INSERTED_BY_HAND).sum())
    inserted = f", {KIND_SIGNS[INSERTED]} {n_inserted} made by hand" if n_inserted else ""
    verdicts = invalid.verdict.value_counts()
    counted = ", ".join(f"{n} {verdict}{VERDICT_NOTES.get(str(verdict), '')}" for verdict, n in verdicts.items())
    n = len(records)
    listed = records.head(MAX_LISTED)
    shown = {name: column for name, column in SORT_COLUMNS.items() if name != fitness_name}  # each number once
    columns = [_format_cells(name, listed[name].tolist()) for name in shown]
    rows = zip(listed.to_dict("records"), zip(*columns, strict=True), strict=True)
    champion = find_champion(records)
    best = champion.individual if champion.verdict == "ok" else None
    return {
        "title": f"Generation {number}: {pluralize(n, 'robot')}{elites}{inserted}",
        "warning": f"{KIND_SIGNS[INVALID]} {len(invalid):,} not counted: {counted}" if len(invalid) else "",
        "warning_about": "\n".join(f"{verdict}: {VERDICTS.get(str(verdict), '')}" for verdict in verdicts.index),
        "n_drawn": MAX_DRAWN,
        "drawn_note": f"the first {MAX_DRAWN} of {n:,} are drawn" if n > MAX_DRAWN else "",
        "listed_note": f"the first {MAX_LISTED} of {n:,} are listed" if n > MAX_LISTED else "",
        "columns": [
            {
                "key": name,
                "title": f"fitness: {fitness_name}" if fitness_name and name == "fitness" else column.title,
                "about": explain_term(name),
                "unit": unit_of(records, name),
                "direction": "ascending" if column.is_ascending else "descending",
            }
            for name, column in shown.items()
        ],
        "rows": [
            _describe_row(row, cells, fitness_name or "fitness", unit, is_best=row["individual"] == best)
            for row, cells in rows
        ],
    }


def _format_cells(name: str, values: list[Any]) -> list[str]:
    """Format the values of a column."""
    if name == "verdict":
        return values
    digits = SORT_COLUMNS[name].digits
    if name == "fitness":
        texts = format_significant_column(values)
    elif digits:
        texts = format_fixed_column(values, digits)
    else:
        texts = map(str, values)
    return [text.replace("-", MINUS_SIGN) for text in texts]


def _describe_row(
    row: Mapping[Any, Any], cells: Sequence[str], fitness_name: str, unit: str, *, is_best: bool
) -> dict[str, Any]:
    """Describe one robot; ``is_best`` is whether it is the fittest of its generation."""
    counts = row["verdict"] == "ok"
    if not counts:
        kind = INVALID
    elif row["born"] < row["generation"]:
        kind = ELITE
    else:
        kind = INSERTED if row["operators"] == INSERTED_BY_HAND else ""
    label = with_unit(row["fitness"], unit).replace("-", MINUS_SIGN) if counts else row["verdict"]
    return {
        "individual": row["individual"],
        "kind": kind,
        "sign": KIND_SIGNS[kind],
        "rank": "best:" if is_best else "",
        "label": label,
        "description": _description(row, kind, f"{fitness_name} is {label}", is_best=is_best),
        "cells": list(cells),
    }


def _description(row: Mapping[Any, Any], kind: str, fitness: str, *, is_best: bool) -> str:
    """Describe one robot in a few sentences, which are also the alternative text of its picture."""
    body = (
        f"{pluralize(row['n_segments'], 'segment')}, {pluralize(row['n_legs'], 'leg')}, "
        f"{with_unit(row['weight'], 'kg')}, "
        f"{with_unit(row['body_length'], 'm')} long"
    )
    robot = f"Robot {row['individual']}: {body}."
    if kind == INVALID:
        reason = f" Details: {row['reason']}." if isinstance(row["reason"], str) and row["reason"] else ""
        return f"{robot} Not counted: {row['verdict']}. {VERDICTS.get(row['verdict'], '')}{reason}"
    best = " The best of its generation." if is_best else ""
    elite = f" An elite, unchanged since generation {row['born']}." if kind == ELITE else ""
    inserted = " Made by hand." if row["operators"] == INSERTED_BY_HAND else ""
    return f"{robot} Its {fitness}.{best}{elite}{inserted}"
