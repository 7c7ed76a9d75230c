"""Pictures of the tidy table. Each is a function of the table and an Axes, and has no logic of its own."""

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RUNS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Colours of runs, in turn: those of Okabe and Ito that are dark enough for a line on white."""

QUARTILES = np.array([0.25, 0.5, 0.75])


def fitness_curve(records: pd.DataFrame, ax: Axes | None = None, *, label: str = "") -> Axes:
    """Draw the best (solid), the median (dashed) and the middle half of each generation's fitness.

    Walks that do not count are left out of the middle, and can't be the best.

    Args:
        records: the tidy table of a run.
        ax: where to draw; a new figure if None. Several runs on one Axes get a colour each.
        label: told before the lines' names, to tell several runs apart.

    Returns:
        The Axes drawn on.
    """
    axes = ax or _new_axes()
    counted = records[records.verdict == "ok"].groupby("generation").fitness
    middle = counted.quantile(QUARTILES).unstack().reindex(columns=QUARTILES)
    best = counted.max()
    name = f"{label}: " if label else ""
    colour = RUNS[len(axes.lines) // 2 % len(RUNS)]
    axes.plot(best.index, best, lw=2.2, color=colour, label=f"{name}best")
    axes.plot(middle.index, middle[0.5], lw=1.4, ls="--", color=colour, label=f"{name}median")
    half = "" if label else "middle half"
    axes.fill_between(middle.index, middle[0.25], middle[0.75], color=colour, alpha=0.15, lw=0, label=half)
    unit = records.attrs.get("units", {}).get("fitness", "")
    axes.set_xlabel("generation")
    axes.set_ylabel(f"{records.attrs.get('fitness', 'fitness')}{f' [{unit}]' if unit else ''}")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.margins(x=0.01)
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=3, borderaxespad=0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", lw=0.5, alpha=0.4)
    return axes


def save(axes: Axes, *paths: str) -> None:
    """Save the figure of an Axes; text stays text in SVG, so that it can be searched and edited."""
    import matplotlib as mpl

    figure: Figure = axes.figure  # type: ignore[assignment]
    with mpl.rc_context({"svg.fonttype": "none"}):
        for path in paths:
            figure.savefig(path, dpi=150)


def _new_axes() -> Axes:
    """Open a figure that a notebook shows below its cell."""
    from matplotlib import pyplot

    return pyplot.figure(figsize=(7.2, 4.0), layout="constrained").add_subplot()
