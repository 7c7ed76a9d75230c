"""The card of a robot: what it is, what the judge said of its walk, and from whom it descends."""

from typing import Any

import pandas as pd

from walkerlab.runfile.records import BY_HAND, births, champion
from walkerlab.settings.values import count
from walkerlab.simulation.validity import VERDICTS
from walkerlab.text.html import Html, details, facts, shown, table
from walkerlab.view import summary
from walkerlab.view.plots.style import with_unit

COUNTS = "ok"
SOME = 4  # parents that are named


def card(records: pd.DataFrame, individual: int) -> str:
    """Write the card of one robot of a run.

    Args:
        records: the tidy table of the run.
        individual: its number.
    """
    row: Any = births(records).loc[individual]
    units = records.attrs.get("units", {})
    does_not = "" if row.verdict == COUNTS else f" That is, {row.reason}."
    known = [
        ("Born", f"in generation {row.born}, {_made(row)}"),
        ("Verdict", f"{row.verdict}: {VERDICTS.get(row.verdict, '')}{does_not}"),
        ("Walk", f"{with_unit(row.distance, 'm')} forward, {with_unit(row.velocity, 'm/s')}"),
        (
            "Body",
            f"{count(row.n_segments, 'segment')}, {count(row.n_legs, 'leg')}, {with_unit(row.weight, 'kg')}, "
            f"{with_unit(row.body_length, 'm')} long",
        ),
    ]
    if row.verdict == COUNTS:
        known.insert(1, ("Fitness", with_unit(row.fitness, units.get("fitness", ""))))
    best = ", the champion so far" if individual == champion(records).individual else ""
    return shown(facts(f"Robot {individual}{best}", known), _line(records, individual))


def _made(row: Any) -> str:
    """Say how a robot came to be."""
    parents = row.parents.split()
    if not parents:
        return "made by hand" if row.operators == BY_HAND else "drawn by chance"
    more = f" and {len(parents) - SOME} more" if len(parents) > SOME else ""
    return f"child of {', '.join(parents[:SOME])}{more}, by {row.operators.replace(' > ', ', ')}"


def _line(records: pd.DataFrame, individual: int) -> Html:
    line = summary.line_of_descent(records, individual)
    if len(line) < 2:
        return Html("")
    rows = [
        [f"… {skipped} more …", "", "", ""] if skipped else [one.individual, one.born, fitness, one.operators]
        for one, fitness, skipped in line
    ]
    lineage = table("Line of descent, through the fitter parent", ["robot", "born", "fitness", "made by"], rows)
    return details("Its ancestors", lineage)
