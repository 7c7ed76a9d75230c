"""A generation as a list for people: each robot in words and figures, sorted, and what is to be said of them all."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from walkerlab.runfile.records import BY_HAND
from walkerlab.settings.values import count
from walkerlab.simulation.validity import VERDICTS
from walkerlab.text.numbers import fixed_column, significant_column, with_unit
from walkerlab.view.plots.style import unit_of

LISTED = 300  # robots at most that have a row in the table
DRAWN = 60  # robots at most that have a picture
MINUS = "\N{MINUS SIGN}"

ELITE, VOID, OWN = "elite", "void", "own"
SIGNS = {ELITE: "★", VOID: "⚠\N{VARIATION SELECTOR-15}", OWN: "✎", "": ""}
"""What tells the kinds of robots apart without colour: elites, those whose walks do not count, those made by hand."""


@dataclass(frozen=True)
class Column:
    """A column of the list.

    Attributes:
        title: what stands over it.
        first: who comes first when it is sorted by this column, in words.
        digits: behind the point, or more where the largest number is small; those of a fitness follow its size.
        rising: whether the least comes first.
    """

    title: str
    first: str
    digits: int = 0
    rising: bool = False


COLUMNS = {
    "individual": Column("robot", "by number", rising=True),
    "fitness": Column("fitness", "fittest first"),
    "distance": Column("distance", "farthest first", 2),
    "velocity": Column("velocity", "fastest first", 2),
    "n_legs": Column("legs", "most legs first"),
    "n_segments": Column("segments", "most segments first"),
    "weight": Column("weight", "heaviest first", 1),
    "body_length": Column("length", "longest first", 2),
    "verdict": Column("verdict", "not counted first"),
}
"""What is told of each robot, in this order; the list can be sorted by each of them."""


def order(records: pd.DataFrame, column: str) -> pd.DataFrame:
    """Sort a generation by a column; among equals, and among those that do not count, by fitness and number."""
    counted = records.verdict == "ok"
    key = counted if column == "verdict" else records[column]
    keys = pd.DataFrame({"key": key, "fitness": records.fitness, "individual": records.individual})
    rising = [column == "verdict" or COLUMNS[column].rising, False, True]
    return records.loc[keys.sort_values(list(keys), ascending=rising, kind="stable").index]


def roster(records: pd.DataFrame) -> dict[str, Any]:
    """Tell of a generation.

    Args:
        records: its rows of the tidy table, in the order in which they are to be listed.

    Returns:
        ``title`` and ``warning``; how many are ``drawn``, and words where these, or those in the table, are not all;
        ``columns`` with key, title, unit, and how they are sorted; ``rows`` with ``individual``, ``kind``, ``sign``,
        ``worth``, ``says`` and ``cells``.
    """
    named = str(records.attrs.get("fitness", ""))
    unit = unit_of(records, "fitness")
    void, n_elites = records[records.verdict != "ok"], int((records.born < records.generation).sum())
    elites = f", {SIGNS[ELITE]} {count(n_elites, 'elite')}" if n_elites else ""
    n_own = int((records.operators == BY_HAND).sum())
    made = f", {SIGNS[OWN]} {n_own} made by hand" if n_own else ""
    kinds = ", ".join(f"{n} {verdict}" for verdict, n in void.verdict.value_counts().items())
    n, listed = len(records), records.head(LISTED)
    columns = [_cells(name, listed[name].tolist()) for name in COLUMNS]
    rows = zip(listed.to_dict("records"), zip(*columns, strict=True), strict=True)
    return {
        "title": f"Generation {records.generation.iloc[0]}: {count(n, 'robot')}{elites}{made}",
        "warning": f"{SIGNS[VOID]} {len(void):,} not counted: {kinds}" if len(void) else "",
        "drawn": DRAWN,
        "some_drawn": f"the first {DRAWN} of {n:,} are drawn" if n > DRAWN else "",
        "some_listed": f"the first {LISTED} of {n:,} are listed" if n > LISTED else "",
        "columns": [
            {
                "key": name,
                "title": f"fitness: {named}" if named and name == "fitness" else column.title,
                "unit": unit_of(records, name),
                "sorts": "ascending" if column.rising else "descending",
            }
            for name, column in COLUMNS.items()
        ],
        "rows": [_row(row, cells, named or "fitness", unit) for row, cells in rows],
    }


def _cells(name: str, column: list[Any]) -> list[str]:
    """Write the cells of a column."""
    if name == "verdict":
        return column
    digits = COLUMNS[name].digits
    if name == "fitness":
        texts = significant_column(column)
    elif digits:
        texts = fixed_column(column, digits)
    else:
        texts = map(str, column)
    return [text.replace("-", MINUS) for text in texts]


def _row(row: Mapping[Any, Any], cells: Sequence[str], named: str, unit: str) -> dict[str, Any]:
    """Tell of one robot."""
    counts = row["verdict"] == "ok"
    own = OWN if row["operators"] == BY_HAND else ""
    kind = VOID if not counts else ELITE if row["born"] < row["generation"] else own
    worth = with_unit(row["fitness"], unit).replace("-", MINUS) if counts else row["verdict"]
    return {
        "individual": row["individual"],
        "kind": kind,
        "sign": SIGNS[kind],
        "worth": worth,
        "says": _said(row, kind, f"{named} is {worth}"),
        "cells": list(cells),
    }


def _said(row: Mapping[Any, Any], kind: str, worth: str) -> str:
    """Tell of one robot in a sentence or two, which is also what those hear who do not see its picture."""
    body = (
        f"{count(row['n_segments'], 'segment')}, {count(row['n_legs'], 'leg')}, {with_unit(row['weight'], 'kg')}, "
        f"{with_unit(row['body_length'], 'm')} long"
    )
    who = f"Robot {row['individual']}: {body}."
    if kind == VOID:
        reason = f" That is, {row['reason']}." if isinstance(row["reason"], str) and row["reason"] else ""
        return f"{who} Not counted: {row['verdict']}. {VERDICTS.get(row['verdict'], '')}{reason}"
    lives = f" An elite, which lives on unchanged since generation {row['born']}." if kind == ELITE else ""
    own = " Made by hand." if row["operators"] == BY_HAND else ""
    return f"{who} Its {worth}.{lives}{own}"
