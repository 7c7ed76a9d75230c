"""The description of one robot: its body, the verdict on its walk, and its ancestors."""

from typing import Any

import pandas as pd

from walkerlab.runfile.records import INSERTED_BY_HAND, birth_rows, find_champion
from walkerlab.settings.values import pluralize
from walkerlab.simulation.validity import VERDICTS
from walkerlab.text.html import Html, details, facts, shown, table
from walkerlab.view import summary
from walkerlab.view.plots.tables import format_value

COUNTED = "ok"  # verdict on a walk that counts
MAX_PARENTS = 4  # parents that are listed


def robot_card(records: pd.DataFrame, individual: int) -> str:
    """Return the description of one robot of a run as HTML.

    Args:
        records: Table of the run.
        individual: Number of the robot.
    """
    row: Any = birth_rows(records).loc[individual]
    units = records.attrs.get("units", {})
    reason = "" if row.verdict == COUNTED else f" Details: {row.reason}."
    entries = [
        ("Born", f"in generation {row.born}, {_origin(row)}"),
        ("Verdict", f"{row.verdict}: {VERDICTS.get(row.verdict, '')}{reason}"),
        ("Walk", f"{format_value(row.distance, 'm')} forward, {format_value(row.velocity, 'm/s')}"),
        (
            "Body",
            f"{pluralize(row.n_segments, 'segment')}, {pluralize(row.n_legs, 'leg')}, "
            f"{format_value(row.weight, 'kg')}, "
            f"{format_value(row.body_length, 'm')} long",
        ),
    ]
    if row.verdict == COUNTED:
        entries.insert(1, ("Fitness", format_value(row.fitness, units.get("fitness", ""))))
    best = ", the champion so far" if individual == find_champion(records).individual else ""
    return shown(facts(f"Robot {individual}{best}", entries), _lineage(records, individual))


def _origin(row: Any) -> str:
    """Describe how a robot was made."""
    parents = row.parents.split()
    if not parents:
        return "made by hand" if row.operators == INSERTED_BY_HAND else "random"
    more = f" and {len(parents) - MAX_PARENTS} more" if len(parents) > MAX_PARENTS else ""
    return f"child of {', '.join(parents[:MAX_PARENTS])}{more}, by {row.operators.replace(' > ', ', ')}"


def _lineage(records: pd.DataFrame, individual: int) -> Html:
    """Return the line of descent of a robot as a table; empty if the robot has no parents."""
    line = summary.format_descent(records, individual)
    if len(line) < 2:
        return Html("")
    rows = [
        [f"… {skipped} more …", "", "", ""]
        if skipped
        else [ancestor.individual, ancestor.born, fitness, ancestor.operators]
        for ancestor, fitness, skipped in line
    ]
    lineage = table("Line of descent, through the fitter parent", ["robot", "born", "fitness", "made by"], rows)
    return details("Ancestors", lineage)
