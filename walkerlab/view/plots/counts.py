"""How many walks counted, and why the others did not."""

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from walkerlab.settings.values import count
from walkerlab.simulation.validity import VERDICTS
from walkerlab.view.plots.appearance import new_axes, picture
from walkerlab.view.plots.style import (
    describe,
    literal,
    nothing,
    over_generations,
    require_measure,
    round_steps,
    table_of,
)

COUNTED = ("#BFE3D6", "")
LOOKS = (
    ("#F0E442", "///"),
    ("#56B4E9", "\\\\\\"),
    ("#E69F00", "xxx"),
    ("#CC79A7", "---"),
    ("#FFFFFF", "|||"),
    ("#D55E00", "//"),
    ("#999999", "+++"),
    ("#56B4E9", ".."),
    ("#F0E442", "xx"),
    ("#E69F00", "oo"),
    ("#FFFFFF", "++"),
    ("#CC79A7", "**"),
)
"""Colour and hatching of the verdicts after ``ok``, in the order of ``VERDICTS``: each looks the same everywhere."""

MOST_BARS = 60
ROBOTS = "robots"


@picture
def verdicts(records: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw how many robots of each generation walked so that it counts, and why the walks of others do not.

    Elites are counted in each generation in which they live. Of a long run, a bar is the mean of a few generations.

    Args:
        records: the tidy table of a run, or the run.
        ax: where to draw; a new figure if None.

    Returns:
        The Axes drawn on.
    """
    records = table_of(records, "verdict")
    axes = ax or new_axes()
    require_measure(axes, ROBOTS)
    table: Any = pd.crosstab(records.generation, records.verdict)
    known = [verdict for verdict in VERDICTS if verdict in table]
    table = table[[*known, *(verdict for verdict in table if verdict not in VERDICTS)]]
    describe(axes, "Verdicts of each generation", _in_words(table), ROBOTS)
    together = 1
    if table.empty:
        nothing(axes, "no robot has walked yet")
    else:
        table = table.reindex(range(table.index[0], table.index[-1] + 1))  # what is not there leaves a gap
        together = math.ceil(len(table) / MOST_BARS)
        _stack(axes, table, together)
    axes.set_ylabel(ROBOTS)
    axes.yaxis.set_major_locator(round_steps())
    over_generations(axes, len(table))
    if together > 1:
        axes.set_xlabel(f"generation; each bar is the mean of {together}")
    axes.grid(visible=False)
    axes.margins(x=0, y=0.02)
    return axes


def _stack(axes: Axes, table: Any, together: int) -> None:
    """Stack the columns of a table of counts, the mean of so many generations at a time."""
    generation = table.index.to_numpy()
    edges = np.append(generation[::together], generation[-1] + 1) - 0.5
    means = table.groupby(np.arange(len(table)) // together).mean()
    below = np.zeros(len(edges) - 1)
    for verdict in means:
        colour, hatch = COUNTED if verdict == "ok" else LOOKS[_place(str(verdict)) % len(LOOKS)]
        top = below + means[verdict].to_numpy()
        look: dict[str, Any] = {"fc": colour, "hatch": hatch, "ec": "0.15", "lw": 0.5}
        said = "counts" if verdict == "ok" else literal(verdict)
        axes.stairs(top, edges, baseline=below, fill=True, **look, label=said, gid=f"verdict-{verdict}")
        below = np.nan_to_num(top)
    handles, labels = axes.get_legend_handles_labels()  # in the order in which they are stacked
    place: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.01, 1), "borderaxespad": 0.0}
    axes.legend(handles[::-1], labels[::-1], frameon=False, handleheight=1.6, **place)


def _place(verdict: str) -> int:
    """Return which of our verdicts it is, ``ok`` aside; -1 for one that is not ours."""
    return list(VERDICTS).index(verdict) - 1 if verdict in VERDICTS else -1


def _in_words(table: Any) -> str:
    if table.empty:
        return "No robot has walked yet."
    total = int(table.to_numpy().sum())
    counted = table["ok"].to_numpy() if "ok" in table else np.zeros(len(table))
    shares = counted / table.to_numpy().sum(axis=1)
    others = {str(verdict): int(table[verdict].sum()) for verdict in table if verdict != "ok"}
    worst_first = sorted(others, key=lambda verdict: -others[verdict])
    why = ", ".join(f"{verdict} ({others[verdict]} of {total})" for verdict in worst_first)
    return (
        f"Of the robots of {count(len(table), 'generation')}, {shares[0]:.0%} counted in the first and "
        f"{shares[-1]:.0%} in the last. {f'The others did not: {why}.' if why else 'No walk was void.'}"
    )
