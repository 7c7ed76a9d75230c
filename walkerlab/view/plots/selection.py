"""Plots of selection: the roulette wheel, the probabilities by rank, the pressure of operators, and the takeover."""

import textwrap
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes

from walkerlab.settings.choices import Selection
from walkerlab.settings.values import pluralize
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.captions import MIN_CHARACTERS, add_caption
from walkerlab.view.plots.operator_words import explain_operator
from walkerlab.view.plots.style import (
    RUN_COLOURS,
    SECONDARY_STRENGTH,
    add_description,
    add_legend,
    escape_label,
    integer_locator,
    style_axes,
)
from walkerlab.view.plots.tables import format_value, require_analysis

RANK_COLOURS = (0.05, 0.95)
"""Positions of the fittest and the least fit in the colour map, from dark to bright."""

MIN_LABELLED_PROBABILITY = 0.045  # minimum probability of a slice with a label
RING_WIDTH = 0.75  # as a share of the radius; thin slices cannot be distinguished near the centre
MAX_EDGED_SLICES = 100  # maximum number of slices with a white edge

LEGEND_SPACE = 1.25  # height of the axis as a multiple of the highest bar

MAX_NAME_LENGTH = 38  # maximum number of characters in a line beside the vertical axis
TITLE_CHARACTERS_PER_INCH = 13

MEASURE_LABELS = {
    "intensity": "selection intensity [standard deviations of the fitness]",
    "loss_of_diversity": "loss of diversity [share of the places among the parents]",
    "unselected": "never selected [share of the population]",
    "takeover": "takeover time [generations]",
    "best_lost": "best individual lost [share of the trials]",
}

PLAIN_MEASURES = {
    "intensity": "how much fitter the selected parents are than the whole population, on average; the unit is the "
    "standard deviation, the typical distance of a robot's fitness from the mean",
    "loss_of_diversity": "the share of the places among the parents that less fit robots lose to fitter ones",
    "unselected": "the share of the population that is never selected and has no children",
    "takeover": "the number of generations until all robots are copies of the best, if children are exact copies of "
    "their parents",
    "best_lost": "the share of the trials in which the best robot has no copy left in the end",
}
"""Each measure in plain words, for the caption."""

FALLING_MEASURES = ("takeover", "best_lost")
"""Measures that are smaller if selection is stronger."""


@styled_plot
def roulette_wheel(table: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw the probabilities of selection as a roulette wheel: each individual is a slice, the fittest at the top.

    Args:
        table: Table from ``wl.analysis.selection_probabilities``.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table lacks a column.
    """
    table = require_analysis(table, "selection_probabilities", "rank", "probability").sort_values("rank")
    axes = ax or new_axes(width=5.2, height=5.6)
    shown: Any = table[table.probability > 0]
    wedge: dict[str, Any] = {"edgecolor": foreground_colour(axes, 0), "width": RING_WIDTH}
    wedge["linewidth"] = 0.8 if len(shown) <= MAX_EDGED_SLICES else 0
    colours = _rank_colours(shown["rank"], len(table))
    wedges: Any = axes.pie(
        shown.probability, startangle=90, counterclock=False, colors=colours, wedgeprops=wedge, normalize=True
    )[0]
    for each, rank, probability in zip(wedges, shown["rank"], shown.probability, strict=True):
        if probability >= MIN_LABELLED_PROBABILITY or rank == 1:
            angle = np.deg2rad((each.theta1 + each.theta2) / 2)
            x, y = 1.06 * np.cos(angle), 1.06 * np.sin(angle)
            side = "left" if x > 0.05 else "right" if x < -0.05 else "center"
            name = "the fittest" if rank == 1 else f"rank {rank}"
            axes.text(x, y, f"{name}: {probability:.1%}".replace("%", " %"), ha=side, va="center", size=8)
    axes.plot([0], [1.04], marker="v", ms=9, color=foreground_colour(axes), clip_on=False, zorder=4)
    axes.set(xlim=(-1.35, 1.35), ylim=(-1.12, 1.16))
    text = _describe_probabilities(table)
    add_description(axes, "Roulette wheel of selection", text)
    _add_title(axes, table)
    add_caption(
        axes,
        "How parents are chosen: the wheel is spun once for each parent, and the robot that stops at the black "
        "pointer is chosen. Each slice is one robot, as wide as its chance: the darkest one, right of the pointer, is "
        f"the fittest (best), and less fit ones follow clockwise. {text}",
    )
    return axes


@styled_plot
def selection_by_rank(table: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw the probability of selection of each individual as a bar, from the fittest to the least fit.

    Args:
        table: Table from ``wl.analysis.selection_probabilities``.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table lacks a column.
    """
    table = require_analysis(table, "selection_probabilities", "rank", "probability", "standard_error").sort_values(
        "rank"
    )
    axes = ax or new_axes(height=4.3)
    percent = 100 * table.probability
    axes.bar(table["rank"], percent, width=0.85, color=_rank_colours(table["rank"], len(table)))
    if not _is_exact(table):
        line: dict[str, Any] = {"fmt": "none", "ecolor": foreground_colour(axes, SECONDARY_STRENGTH), "elinewidth": 1}
        axes.errorbar(table["rank"], percent, yerr=100 * table.standard_error, **line)
    fair = 100 / len(table)
    axes.axhline(fair, color="#D55E00", lw=1.6, ls=(0, (5, 2)), label="equal chance for all")
    axes.set_xlabel("rank of the robot (1 = fittest)")
    axes.set_ylabel("chance of becoming the next parent [%]")
    axes.xaxis.set_major_locator(integer_locator())
    axes.set_xlim(0.3, len(table) + 0.7)
    axes.set_ylim(0, LEGEND_SPACE * max(fair, float(percent.max())))
    style_axes(axes)
    _add_title(axes, table)
    axes.legend(frameon=False, fontsize=9, loc="upper right")
    text = _describe_probabilities(table)
    add_description(axes, "Probability of selection by rank", text)
    add_caption(
        axes,
        "How likely each robot is to become a parent: each bar is one robot, the fittest (best) on the left. Robots "
        "above the dashed line are chosen more often than in a fair lottery; the steeper the bars fall, the stronger "
        f"the selection. {text}",
    )
    return axes


@styled_plot
def selection_pressure(table: pd.DataFrame, measure: str = "intensity", ax: Axes | None = None) -> Axes:
    """Draw one measure of several selection operators, measured and in theory.

    Args:
        table: Table from ``wl.analysis.measure_selection``.
        measure: ``intensity``, ``loss_of_diversity``, ``unselected``, ``takeover`` or ``best_lost``.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table lacks a column, or there is no such measure.
    """
    table = require_analysis(table, "measure_selection", "selection", "measure", "measured", "standard_error", "theory")
    if measure not in MEASURE_LABELS:
        raise ValueError(f"there is no measure {measure!r}; the measures are {', '.join(MEASURE_LABELS)}")
    rows: Any = table[table.measure == measure]
    axes = ax or new_axes(height=2.2 + 0.6 * len(rows))
    y = np.arange(len(rows))
    ink = foreground_colour(axes)
    has_theory = bool(rows.theory.notna().any())
    diamonds: dict[str, Any] = {"ls": "", "marker": "D", "ms": 13, "mfc": "none", "mec": ink, "mew": 1.4}
    axes.plot(rows.theory, y, **diamonds, label="theory" if has_theory else "_without theory")
    bars: dict[str, Any] = {
        "fmt": "o",
        "ms": 6,
        "color": RUN_COLOURS[0],
        "capsize": 3,
        "label": "measured",
    }
    axes.errorbar(rows.measured, y, xerr=rows.standard_error, **bars)
    axes.set_yticks(y, [_label_operator(name) for name in rows.selection], fontsize=7.5)
    axes.invert_yaxis()
    axes.margins(y=0.25)
    highest = max(1e-3, float(np.nanmax(rows[["measured", "theory"]].to_numpy(), initial=0)))
    axes.set_xlim(-0.04 * highest, 1.1 * highest)
    stronger = "← stronger selection" if measure in FALLING_MEASURES else "stronger selection →"
    axes.set_xlabel(f"{MEASURE_LABELS[measure]}\n{stronger}")
    style_axes(axes)
    axes.grid(axis="x", lw=0.5, alpha=0.4)
    add_legend(axes, 2)
    values = "; ".join(
        f"{row.selection} {format_value(row.measured, '')}"
        + (f" (theory {format_value(row.theory, '')})" if np.isfinite(row.theory) else "")
        for row in rows.itertuples()
    )
    add_description(axes, f"Selection pressure: {measure}", f"{MEASURE_LABELS[measure]}: {values}.")
    measured = "measured"
    if {"population_size", "n_populations"} <= table.attrs.keys():
        measured = (
            f"mean of {table.attrs['n_populations']} random populations of {table.attrs['population_size']} robots, "
            "with its standard error, often narrower than the dot"
        )
    unknown = ", ".join(rows.selection[rows.theory.isna()])
    without = f" (not known for {unknown})" if unknown else ""
    diamond = f"; diamond: what theory predicts{without}" if has_theory else ""
    add_caption(
        axes,
        f"How strongly each way of choosing parents favours fit robots. The number is {PLAIN_MEASURES[measure]}. "
        f"Dot: {measured}{diamond}.",
    )
    return axes


def _rank_colours(rank: Any, n: int) -> Any:
    """Return the colour of each rank, dark for the fittest."""
    low, high = RANK_COLOURS
    return colormaps["cividis"](low + (high - low) * (rank.to_numpy() - 1) / max(1, n - 1))


def _selection_of(table: pd.DataFrame) -> str:
    return str(table.attrs.get("selection", "unknown"))


def _label_operator(name: str) -> str:
    """Return the name of an operator and, below it, what it does."""
    meaning = textwrap.wrap(explain_operator(name, Selection), MAX_NAME_LENGTH)
    return escape_label("\n".join([name, *meaning]))


def _add_title(axes: Axes, table: pd.DataFrame) -> None:
    """Write the name of the operator above the Axes, and what it does."""
    name = _selection_of(table)
    meaning = explain_operator(name, Selection)
    title = f"selection: {name}" + (f" – {meaning}" if meaning else "")
    width = axes.get_window_extent().width / axes.figure.dpi
    lines = textwrap.fill(title, max(MIN_CHARACTERS, int(width * TITLE_CHARACTERS_PER_INCH)))
    axes.set_title(escape_label(lines), fontsize=10, loc="left")


def _is_exact(table: pd.DataFrame) -> bool:
    return bool((table.standard_error == 0).all())


def _describe_probabilities(table: pd.DataFrame) -> str:
    """Describe the probabilities in a sentence."""
    n = len(table)
    percent = 100 * float(table.probability.iloc[0])
    never = int((table.probability == 0).sum())
    how = "" if _is_exact(table) else " (estimated from repeated draws)"
    zero = f"; {pluralize(never, 'robot')} cannot be selected" if never else ""
    return (
        f"The fittest of {n} robots has a chance of {percent:.1f} % each time, {percent / 100 * n:.1f} times an equal "
        f"share{how}{zero}."
    )
