"""A generation as a list for people: each robot in words and figures, sorted, and what is to be said of them all."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from walkerlab.judge import VERDICTS
from walkerlab.plots.style import unit_of, with_unit
from walkerlab.quantity import count
from walkerlab.records import BY_HAND

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
        digits: behind the point.
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
    digits = {name: column.digits for name, column in COLUMNS.items()} | {"fitness": _digits(records.fitness)}
    n = len(records)
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
        "rows": [_row(row, named or "fitness", unit, digits) for row in records.head(LISTED).to_dict("records")],
    }


def _digits(fitness: pd.Series) -> int:
    """How many digits behind the point give the largest of them three figures: the unit may be anything."""
    largest = fitness.abs()[np.isfinite(fitness)].max()
    return int(np.clip(2 - math.floor(math.log10(largest)), 0, 9)) if largest > 0 else 2


def _row(row: Mapping[Any, Any], named: str, unit: str, digits: Mapping[str, int]) -> dict[str, Any]:
    """Tell of one robot."""
    counts = row["verdict"] == "ok"
    own = OWN if row["operators"] == BY_HAND else ""
    kind = VOID if not counts else ELITE if row["born"] < row["generation"] else own
    cells = {name: row[name] if name == "verdict" else _figure(row[name], digits[name]) for name in COLUMNS}
    worth = f"{cells['fitness']} {unit}".rstrip() if counts else row["verdict"]
    return {
        "individual": row["individual"],
        "kind": kind,
        "sign": SIGNS[kind],
        "worth": worth,
        "says": _said(row, kind, f"{named} is {worth}"),
        "cells": list(cells.values()),
    }


def _figure(number: float, digits: int) -> str:
    return f"{number:z.{digits}f}".replace("-", MINUS) if np.isfinite(number) else "–"


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
