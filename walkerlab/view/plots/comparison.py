"""Pictures of an experiment: the progress of each condition, and the result of each run."""

import io
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

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
MEDIAN_WIDTH = 0.28  # of half the line at the median, in conditions
MAX_HORIZONTAL_NAMES = 24  # characters of all names together, above which they are written at an angle


@styled_plot
def best_of_each_run(experiment: Any, ax: Axes | None = None) -> Axes:
    """Draw the best fitness of each run as a point, those of the same seed joined, and the median of each condition.

    Runs in which no walk counted are drawn at the lower edge, as crosses.

    Args:
        experiment: An experiment, or its table; or a dict from names to lists of runs in the order of the seeds.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.

    Raises:
        TypeError: If it is a single run.
    """
    groups = read_groups(experiment)
    if groups is None:
        raise TypeError("this plot compares runs; give it an experiment, or a dict from names to lists of runs")
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
    if len({len(values) for values in bests.values()}) == 1 and len(first) and finite.size:
        pairs = np.array(list(drawn.values()))
        if len(groups) > 1 and pairs.shape[1] <= MAX_PAIR_LINES:
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
    if not finite.size:
        annotate_no_data(axes, "no walk counted")
    is_long = sum(map(len, groups)) > MAX_HORIZONTAL_NAMES
    angle: dict[str, Any] = {"rotation": 25, "ha": "right", "rotation_mode": "anchor"} if is_long else {}
    axes.set_xticks(range(len(groups)), [escape_label(name) for name in groups], **angle)
    axes.set_xlim(-0.6, len(groups) - 0.4)
    axes.set_ylabel(escape_label(f"best {quantity} of each run"))
    format_value_axis(axes)
    style_axes(axes)
    axes.tick_params(axis="x", length=0)
    return axes


def draw_experiment(records: pd.DataFrame, *, on_screen: bool = True) -> Figure:
    """Draw an experiment: the best fitness so far of each condition, and the best fitness of each run.

    Args:
        records: Table of an experiment.
        on_screen: Whether pyplot manages the figure, so that a notebook shows it.

    Returns:
        The figure.
    """
    axes = new_axes(11, 4.4) if on_screen else offscreen_axes(11, 4.4)
    figure: Any = axes.figure
    axes.remove()
    with walkerlab_style():
        left, right = figure.subplots(1, 2, width_ratios=[3, 2])
    if records.empty:
        annotate_no_data(left, "no run has ended yet")
        right.remove()
        return figure
    fitness_curve(records, left)
    best_of_each_run(records, right)
    return figure


def figure_html(figure: Figure) -> Markup:
    """Return a figure as an element of a page, with its alternative text."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    alt = " ".join(filter(None, map(alt_text, figure.axes)))
    return inline_svg(buffer.getvalue(), "experiment", alt)


def _best(table: pd.DataFrame) -> float:
    counted = table.fitness[table.verdict == "ok"]
    return float(counted.max()) if len(counted) else -np.inf
