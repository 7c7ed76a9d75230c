"""Plots of selection: the roulette wheel, the probabilities by rank, the pressure of operators, and the takeover."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes

from walkerlab.settings.choices import Selection
from walkerlab.settings.values import pluralize
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.captions import add_caption
from walkerlab.view.plots.operator_words import explain_operators
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

MEASURE_LABELS = {
    "intensity": "selection intensity [standard deviations of the fitness]",
    "loss_of_diversity": "loss of diversity [share of the places among the parents]",
    "unselected": "never selected [share of the population]",
    "takeover": "takeover time [generations]",
    "best_lost": "best individual lost [share of the trials]",
}

PLAIN_MEASURES = {
    "intensity": "The number tells how much fitter the selected parents are than the whole population, on average. "
    "Its unit is the standard deviation, the typical distance of a robot's fitness from the mean.",
    "loss_of_diversity": "The number is the share of the places among the parents that poorer individuals lose to "
    "fitter ones.",
    "unselected": "The number is the share of the population that is never selected, so that it has no children.",
    "takeover": "The number of generations until all individuals are copies of the best, without crossover and "
    "mutation.",
    "best_lost": "The number is the share of the trials in which the best individual had no copy left.",
}
"""Each measure in whole sentences, for the caption."""

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
    axes.set_title(f"selection: {escape_label(_selection_of(table))}", fontsize=10, loc="left")
    add_caption(
        axes,
        "How parents are chosen: the wheel is spun once for each parent, and the robot on which the black pointer "
        "stops becomes a parent. Each slice is one robot, and its share of the wheel is its probability. The darkest "
        f"slice, to the right of the pointer, is the fittest robot; less fit ones follow clockwise. {text}"
        f"{explain_operators([_selection_of(table)], Selection)}",
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
    axes.set_ylabel("chance to be the next parent [%]")
    axes.xaxis.set_major_locator(integer_locator())
    axes.set_xlim(0.3, len(table) + 0.7)
    axes.set_ylim(0, LEGEND_SPACE * max(fair, float(percent.max())))
    style_axes(axes)
    axes.set_title(f"selection: {escape_label(_selection_of(table))}", fontsize=10, loc="left")
    axes.legend(frameon=False, fontsize=9, loc="upper right")
    text = _describe_probabilities(table)
    add_description(axes, "Probability of selection by rank", text)
    add_caption(
        axes,
        "How probably each robot becomes a parent. Each bar is one robot, the fittest on the left. A bar above the "
        "dashed line is a robot that selection favours. The faster the bars fall, the stronger the selection. "
        f"{text}{explain_operators([_selection_of(table)], Selection)}",
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
    axes = ax or new_axes(height=2.6 + 0.42 * len(rows))
    y = np.arange(len(rows))
    ink = foreground_colour(axes)
    axes.plot(rows.theory, y, ls="", marker="D", ms=13, mfc="none", mec=ink, mew=1.4, label="predicted by theory")
    bars: dict[str, Any] = {
        "fmt": "o",
        "ms": 6,
        "color": RUN_COLOURS[0],
        "capsize": 3,
        "label": "measured",
    }
    axes.errorbar(rows.measured, y, xerr=rows.standard_error, **bars)
    axes.set_yticks(y, [escape_label(name) for name in rows.selection])
    axes.invert_yaxis()
    axes.margins(y=0.25)
    highest = max(1e-3, float(np.nanmax(rows[["measured", "theory"]].to_numpy(), initial=0)))
    axes.set_xlim(-0.04 * highest, 1.1 * highest)
    axes.set_xlabel(MEASURE_LABELS[measure])
    style_axes(axes)
    axes.grid(axis="x", lw=0.5, alpha=0.4)
    add_legend(axes, 2)
    values = "; ".join(
        f"{row.selection} {format_value(row.measured, '')}"
        + (f" (theory {format_value(row.theory, '')})" if np.isfinite(row.theory) else "")
        for row in rows.itertuples()
    )
    add_description(axes, f"Selection pressure: {measure}", f"{MEASURE_LABELS[measure]}: {values}.")
    stronger = "left" if measure in FALLING_MEASURES else "right"
    populations = ""
    if {"population_size", "n_populations"} <= table.attrs.keys():
        populations = (
            f"Each dot: mean of {table.attrs['n_populations']} random populations of "
            f"{table.attrs['population_size']} individuals; its bar: the uncertainty of the mean (standard error), "
            "often narrower than the dot. "
        )
    unknown = " No theory is known for operators without a diamond; their result can depend on the fitness values."
    add_caption(
        axes,
        f"How strongly each operator selects. {PLAIN_MEASURES[measure]} Further {stronger} means stronger selection; "
        f"a dot inside its diamond agrees with theory. {populations}"
        f"{explain_operators(rows.selection, Selection).lstrip()}"
        f"{unknown if rows.theory.isna().any() and rows.theory.notna().any() else ''}",
    )
    return axes


def _rank_colours(rank: Any, n: int) -> Any:
    """Return the colour of each rank, dark for the fittest."""
    low, high = RANK_COLOURS
    return colormaps["cividis"](low + (high - low) * (rank.to_numpy() - 1) / max(1, n - 1))


def _selection_of(table: pd.DataFrame) -> str:
    return str(table.attrs.get("selection", "unknown"))


def _is_exact(table: pd.DataFrame) -> bool:
    return bool((table.standard_error == 0).all())


def _describe_probabilities(table: pd.DataFrame) -> str:
    """Describe the probabilities in two sentences."""
    n = len(table)
    percent = 100 * float(table.probability.iloc[0])
    never = int((table.probability == 0).sum())
    how = "" if _is_exact(table) else " (estimated from repeated draws)"
    zero = f" {pluralize(never, 'robot')} cannot be selected." if never else ""
    return (
        f"The fittest of {n} robots has a chance of {percent:.1f} % each time, {percent / 100 * n:.1f} times an equal "
        f"share{how}.{zero}"
    )
