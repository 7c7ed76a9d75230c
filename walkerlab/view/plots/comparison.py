"""Pictures of an experiment: the progress of each condition, and the result of each run."""

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from walkerlab.settings.values import pluralize
from walkerlab.text.html import inline_svg
from walkerlab.text.templates import Markup
from walkerlab.view.plots.appearance import foreground_colour, new_axes, offscreen_axes, styled_plot, walkerlab_style
from walkerlab.view.plots.curves import fitness_curve
from walkerlab.view.plots.groups import read_groups
from walkerlab.view.plots.style import (
    RUN_COLOURS,
    RUN_MARKERS,
    add_description,
    alt_text,
    annotate_no_data,
    escape_label,
    format_value_axis,
    require_quantity,
    style_axes,
)
from walkerlab.view.plots.tables import fitness_label, format_value, unit_of

TITLE = "Best fitness of each run"
MAX_PAIR_LINES = 40  # seeds, above which lines between pairs would hide the points
HEIGHT = 4.4  # height of a figure with one row of plots, in inches
ROW_HEIGHT = 3.6  # height of each of several rows, in inches
MEDIAN_WIDTH = 0.28  # of half the line at the median, in conditions
MAX_HORIZONTAL_NAMES = 44  # length of the longest name times the number of names, above which they are slanted


@styled_plot
def best_of_each_run(experiment: Any, ax: Axes | None = None) -> Axes:
    """Draw the best fitness of each run as a point, join points with the same seed, and mark each condition's median.

    Runs in which no walk counted are drawn at the lower edge, as crosses.

    Args:
        experiment: An experiment, or its table; or a dict from names to lists of runs in the order of the seeds.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.

    Raises:
        TypeError: If ``experiment`` is a single run.
    """
    groups = read_groups(experiment)
    if groups is None:
        raise TypeError("this plot compares runs; pass an experiment, or a dict from names to lists of runs")
    axes = ax or new_axes()
    first = next(iter(groups.values()))[0]
    quantity = fitness_label(first)
    unit = unit_of(first, "fitness")
    require_quantity(axes, quantity)
    bests = {name: np.array([_best(table) for table in tables]) for name, tables in groups.items()}
    finite = np.concatenate(list(bests.values()))
    finite = finite[np.isfinite(finite)]
    floor = float(finite.min() - 0.08 * (np.ptp(finite) or 1)) if finite.size else 0.0
    drawn = {name: np.where(np.isfinite(values), values, floor) for name, values in bests.items()}
    n_runs = {len(values) for values in bests.values()}
    has_pairs = len(groups) > 1 and len(n_runs) == 1 and max(n_runs) <= MAX_PAIR_LINES and finite.size > 0
    if has_pairs:
        pairs = np.array(list(drawn.values()))
        axes.plot(range(len(groups)), pairs, color=foreground_colour(axes, 0.35), lw=0.7, zorder=1)
    for number, (name, values) in enumerate(bests.items()):
        colour = RUN_COLOURS[number % len(RUN_COLOURS)]
        counted = np.isfinite(values)
        style: dict[str, Any] = {"ls": "", "color": colour, "ms": 6, "mec": "white", "mew": 0.6, "zorder": 2}
        marker = RUN_MARKERS[number % len(RUN_MARKERS)]
        axes.plot(np.full(counted.sum(), number), values[counted], marker=marker, **style)
        missing: dict[str, Any] = style | {"mec": colour, "mew": 1.5}
        axes.plot(np.full((~counted).sum(), number), np.full((~counted).sum(), floor), marker="x", **missing)
        median = float(np.median(values))
        if np.isfinite(median):
            ends = [number - MEDIAN_WIDTH, number + MEDIAN_WIDTH]
            axes.plot(ends, [median, median], color=foreground_colour(axes), lw=2.2, zorder=3)
        n_missing = int((~counted).sum())
        missing_text = f", in {n_missing} of them no walk counted" if n_missing else ""
        result = format_value(median, unit) if np.isfinite(median) else "no counted walk"
        runs = pluralize(len(values), "run")
        text = f"{name or 'Runs'}: the best fitness of {runs} has the median {result}{missing_text}."
        add_description(axes, TITLE, text, quantity)
    if finite.size:
        _explain_marks(axes, has_pairs=has_pairs)
    else:
        annotate_no_data(axes, "no walk counted")
    is_long = max(map(len, groups)) * len(groups) > MAX_HORIZONTAL_NAMES
    angle: dict[str, Any] = {"rotation": 25, "ha": "right", "rotation_mode": "anchor"} if is_long else {}
    axes.set_xticks(range(len(groups)), [escape_label(name) for name in groups], **angle)
    axes.set_xlim(-0.6, len(groups) - 0.4)
    axes.set_ylabel(escape_label(f"best {quantity} of each run"))
    format_value_axis(axes)
    style_axes(axes)
    axes.tick_params(axis="x", length=0)
    return axes


def draw_experiment(records: pd.DataFrame, groups: Sequence[Sequence[str]] = (), *, on_screen: bool = True) -> Figure:
    """Draw an experiment: the best fitness so far of each condition, and the best fitness of each run.

    Args:
        records: Table of an experiment.
        groups: Names of the conditions in each row of plots; if empty, all conditions are in one row.
        on_screen: Whether pyplot manages the figure, so that a notebook shows it.

    Returns:
        The figure.
    """
    shown = [[name for name in group if name in set(records.condition)] for group in groups]
    rows = [group for group in shown if group] or [list(records.condition.unique())]
    height = HEIGHT if len(rows) == 1 else ROW_HEIGHT * len(rows)
    axes = new_axes(11, height) if on_screen else offscreen_axes(11, height)
    figure: Any = axes.figure
    axes.remove()
    with walkerlab_style():
        grid = figure.subplots(len(rows), 2, width_ratios=[3, 2], squeeze=False)
    if records.empty:
        annotate_no_data(grid[0, 0], "no run has finished yet")
        grid[0, 1].remove()
        return figure
    for (left, right), group in zip(grid, rows, strict=True):
        table = records.loc[records.condition.isin(group), :]
        fitness_curve(table, left)
        best_of_each_run(table, right)
    return figure


def _explain_marks(axes: Axes, *, has_pairs: bool) -> None:
    """Add a legend that explains the points, the lines between them and the medians."""
    grey = foreground_colour(axes, 0.65)
    marks = [Line2D([], [], ls="", marker="o", ms=6, color=grey, label="a run")]
    if has_pairs:
        marks.append(Line2D([], [], lw=0.7, color=grey, label="the same seed"))
    marks.append(Line2D([], [], lw=2.2, color=foreground_colour(axes), label="median"))
    axes.legend(
        handles=marks, frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=3, borderaxespad=0.2, fontsize=9
    )


def figure_html(figure: Figure) -> Markup:
    """Return a figure as an element of a page, with its alternative text."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    alt = " ".join(filter(None, map(alt_text, figure.axes)))
    return inline_svg(buffer.getvalue(), "experiment", alt)


def _best(table: pd.DataFrame) -> float:
    counted = table.fitness[table.verdict == "ok"]
    return float(counted.max()) if len(counted) else -np.inf
