"""The description of one robot: its body, the verdict on its walk, the origin of its genes, and its ancestors."""

from typing import Any

import pandas as pd
import traitlets

from walkerlab.runfile.records import INSERTED_BY_HAND, birth_rows, find_champion
from walkerlab.settings.choices import Crossover, Mutation, Selection
from walkerlab.settings.values import pluralize
from walkerlab.simulation.validity import VERDICTS
from walkerlab.text.templates import Markup, render
from walkerlab.view import summary
from walkerlab.view.plots.tables import axis_label, format_value
from walkerlab.widgets.component import Component, load_script, load_style
from walkerlab.widgets.panel.origins import describe_origins

COUNTED = "ok"  # verdict on a walk that counts
OPERATORS = {"selection": Selection, "crossover": Crossover, "mutation": Mutation}  # choices of each kind of operator
OF_TWO_PARENTS = {each.name for each in Crossover} - {Crossover.randomized.name, Crossover.none.name}
MAX_PARENTS = 4  # maximum number of parents that are listed


class Card(Component):
    """The description of a robot; parts that the user opened stay open when the description changes.

    Attributes:
        value: Description as HTML.
    """

    title = "description of a robot"
    _esm = load_script("panel/card")
    _css = load_style("panel/card")
    value: Any = traitlets.Instance(Markup, ()).tag(sync=True)

    def set_state(self, sync_data: dict[str, Any]) -> None:
        """Ignore values from the browser, because the description becomes part of the notebook."""

    def snapshot(self) -> Markup:
        """Return the description."""
        return self.value


def robot_card(records: pd.DataFrame, individual: int, *, is_edited: bool = False) -> Markup:
    """Return the description of one robot of a run as HTML.

    Args:
        records: Table of the run.
        individual: Number of the robot.
        is_edited: Whether to say that this is the robot before the changes of the user.
    """
    births = birth_rows(records)
    row: Any = births.loc[individual]
    units = records.attrs.get("units", {})
    counts = row.verdict == COUNTED
    body = (
        f"{pluralize(row.n_segments, 'segment')}, {pluralize(row.n_legs, 'leg')}, {format_value(row.weight, 'kg')}, "
        f"{format_value(row.body_length, 'm')} long"
    )
    return render(
        "widgets/panel/card.html",
        number=individual,
        is_champion=individual == find_champion(records).individual,
        is_edited=is_edited,
        born=row.born,
        origin=_origin(row),
        fitness=format_value(row.fitness, units.get("fitness", "")) if counts else "",
        verdict=row.verdict,
        meaning=VERDICTS.get(row.verdict, ""),
        reason="" if counts else row.reason,
        distance=format_value(round(row.distance, 3), "m"),
        velocity=format_value(round(row.velocity, 3), "m/s"),
        body=body,
        origins=describe_origins(births, individual),
        operators=_explain_operators(str(row.operators)),
        ancestors=_ancestor_rows(records, individual),
        fitness_label=axis_label("fitness", units.get("fitness", "")),
    )


def _origin(row: Any) -> str:
    """Describe how a robot was produced."""
    parents = row.parents.split()
    if not parents:
        return "made by hand" if row.operators == INSERTED_BY_HAND else str(row.operators)
    more = f" and {len(parents) - MAX_PARENTS} more" if len(parents) > MAX_PARENTS else ""
    named = f"robot{'s' if len(parents) > 1 else ''} {', '.join(parents[:MAX_PARENTS])}{more}"
    if len(parents) == 1 and dict(_operator_pairs(str(row.operators))).get("crossover") in OF_TWO_PARENTS:
        named += ", drawn as both parents"
    return f"child of {named}, by {_name_operators(str(row.operators))}"


def _name_operators(operators: str) -> str:
    """Add the kind to each of three operators: ``tournament selection, uniform crossover, gaussian mutation``."""
    pairs = _operator_pairs(operators)
    return ", ".join(f"{name} {kind}" for kind, name in pairs) if pairs else operators.replace(" > ", ", ")


def _explain_operators(operators: str) -> list[tuple[str, str]]:
    """Return the kind, the name and the explanation of each of three operators, except of user functions."""
    return [
        (kind, f"{name}: {OPERATORS[kind][name].about}")
        for kind, name in _operator_pairs(operators)
        if name in OPERATORS[kind].__members__
    ]


def _operator_pairs(operators: str) -> list[tuple[str, str]]:
    """Return the kind and the name of each of three operators; empty if the robot was not made by three."""
    names = operators.split(" > ")
    return list(zip(OPERATORS, names, strict=True)) if len(names) == len(OPERATORS) else []


def _ancestor_rows(records: pd.DataFrame, individual: int) -> list[list[object]]:
    """Return the line of descent of a robot as cells of a table; empty if the robot has no parents."""
    line = summary.format_descent(records, individual)
    if len(line) < 2:
        return []
    return [
        ["…", "", "", f"{skipped} more"]
        if skipped
        else [ancestor.individual, ancestor.born, fitness, ancestor.operators]
        for ancestor, fitness, skipped in line
    ]
