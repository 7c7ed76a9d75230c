"""Pictures of the tidy table, generation by generation."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from walkerlab.plots.style import RUNS, new_axes

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
    axes = ax or new_axes()
    counted = records[records.verdict == "ok"].groupby("generation").fitness
    middle = counted.quantile(QUARTILES).unstack().reindex(columns=QUARTILES)
    best = counted.max()
    name = f"{label}: " if label else ""
    colour = RUNS[len(axes.lines) // 2 % len(RUNS)]
    axes.plot(best.index, best, lw=2.2, color=colour, label=f"{name}best", marker="o", markersize=3)
    axes.plot(middle.index, middle[0.5], lw=1.4, ls="--", color=colour, label=f"{name}median", marker=".")
    half = "" if label else "middle half"
    axes.fill_between(middle.index, middle[0.25], middle[0.75], color=colour, alpha=0.15, lw=0, label=half)
    if best.empty:
        axes.text(0.5, 0.5, "no walk counted", transform=axes.transAxes, ha="center")
    unit = records.attrs.get("units", {}).get("fitness", "")
    axes.set_xlabel("generation")
    axes.set_ylabel(f"{records.attrs.get('fitness', 'fitness')}{f' [{unit}]' if unit else ''}")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.margins(x=0.01)
    columns = len(axes.lines) // 2 if label else 3  # a column for each of several runs
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=columns, borderaxespad=0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", lw=0.5, alpha=0.4)
    return axes
