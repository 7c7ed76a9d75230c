"""Pictures of the tidy table. Each is a function of the table and an Axes, and has no logic of its own."""

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK = {"best": "#0072B2", "median": "#D55E00", "spread": "#56B4E9", "text": "#404040"}
"""Colours that colour-blind people can tell apart (Okabe and Ito), and of unlike darkness in print."""


QUARTILES = np.array([0.25, 0.5, 0.75])


def fitness_curve(records: pd.DataFrame, ax: Axes | None = None, *, label: str = "") -> Axes:
    """Draw the best, the median and the middle half of each generation's fitness.

    Walks that do not count are left out of the middle, and can't be the best.

    Args:
        records: the tidy table of a run.
        ax: where to draw; a new figure if None.
        label: told before the lines' names, to tell several runs on one Axes apart.

    Returns:
        The Axes drawn on.
    """
    axes = ax or _new_axes()
    counted = records[records.verdict == "ok"].groupby("generation").fitness
    middle = counted.quantile(QUARTILES).unstack().reindex(columns=QUARTILES)
    best = counted.max()
    name = f"{label}: " if label else ""
    colour = INK["best"] if not axes.lines else None
    (line,) = axes.plot(best.index, best, lw=2.2, color=colour, label=f"{name}best", marker="o", markersize=3)
    shade = INK["median"] if colour else line.get_color()
    axes.plot(middle.index, middle[0.5], lw=1.4, ls="--", color=shade, label=f"{name}median")
    axes.fill_between(
        middle.index, middle[0.25], middle[0.75], color=shade, alpha=0.18, lw=0, label=f"{name}middle half"
    )
    unit = records.attrs.get("units", {}).get("fitness", "")
    axes.set_xlabel("generation")
    axes.set_ylabel(f"{records.attrs.get('fitness', 'fitness')}{f' [{unit}]' if unit else ''}")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.margins(x=0.01)
    axes.legend(frameon=False, loc="upper left")
    _quiet(axes)
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


def _quiet(axes: Axes) -> None:
    """Leave out the lines that carry nothing."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", lw=0.5, alpha=0.4)
    axes.tick_params(colors=INK["text"])
