"""Plot of the robots of a run under two fitness functions."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from walkerlab.settings.values import pluralize
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.captions import add_caption
from walkerlab.view.plots.style import (
    RUN_COLOURS,
    add_description,
    add_legend,
    annotate_no_data,
    escape_label,
    format_value_axis,
    style_axes,
)
from walkerlab.view.plots.tables import axis_label, require_analysis

TITLE = "The robots of a run under two fitness functions"
CHAMPION_COLOUR = "#D55E00"


@styled_plot
def rescoring(table: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw the fitness of each robot according to the fitness function of its run and another one.

    Args:
        table: Table from ``wl.analysis.rescore``.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table lacks a column.
    """
    table = require_analysis(table, "rescore", "individual", "fitness", "fitness_after", "rank", "rank_after")
    axes = ax or new_axes(height=4.8)
    before, after = (str(table.attrs.get(column, column)) for column in ("fitness", "fitness_after"))
    units: dict[str, str] = table.attrs.get("units", {})
    shown: Any = table[np.isfinite(table.fitness) & np.isfinite(table.fitness_after)]
    if shown.empty:
        annotate_no_data(axes, "no walk counts under both fitness functions")
    else:
        axes.plot(shown.fitness, shown.fitness_after, "o", ms=4, mew=0, alpha=0.45, color=RUN_COLOURS[0], label="robot")
        _mark_champions(axes, shown, before, after)
    axes.set_xlabel(escape_label(axis_label(f"{before}, the fitness of the run", units.get("fitness", ""))))
    axes.set_ylabel(escape_label(axis_label(f"{after}, the other fitness", units.get("fitness_after", ""))))
    axes.margins(0.06)
    format_value_axis(axes)
    style_axes(axes)
    axes.grid(axis="x", lw=0.5, alpha=0.4)
    add_legend(axes, 3)
    left_out = len(table) - len(shown)
    failed = f" {pluralize(left_out, 'robot')} without a walk that counts {'is' if left_out == 1 else 'are'} left out."
    text = f"{table.attrs.get('summary', '')}{failed if left_out else ''}"
    add_description(axes, TITLE, f"{pluralize(len(shown), 'robot')}, by {before} and by {after}. {text}")
    add_caption(
        axes,
        f"Would another robot have won if {after} had been the fitness instead of {before}? Each dot is a robot of the "
        f"finished run: further right, fitter by {before}; higher, fitter by {after}. If the dots lie on one rising "
        f"line, both rank the robots alike. Rank 1 is the fittest. {text} A run that had selected by {after} would "
        "have produced other robots.",
    )
    return axes


def _mark_champions(axes: Axes, shown: Any, before: str, after: str) -> None:
    """Mark the fittest robot according to each fitness function."""
    ring: dict[str, Any] = {"ls": "", "mec": foreground_colour(axes), "mew": 0.8, "zorder": 4}
    old, new = (shown.loc[shown[rank].idxmin()] for rank in ("rank", "rank_after"))
    if old.individual == new.individual:
        axes.plot(old.fitness, old.fitness_after, "*", ms=15, mfc=CHAMPION_COLOUR, **ring, label="fittest by both")
        return
    axes.plot(old.fitness, old.fitness_after, "*", ms=15, mfc=CHAMPION_COLOUR, **ring, label=f"fittest by {before}")
    axes.plot(new.fitness, new.fitness_after, "D", ms=8, mfc="#F0E442", **ring, label=f"fittest by {after}")
