"""Plots of why a run improved: selection and variation in each generation, and the credit of the operators."""

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from walkerlab.analysis.credit import operator_credit as compare_with_parents
from walkerlab.analysis.price import TERMS, price_equation
from walkerlab.settings.choices import Choice, Crossover, Mutation
from walkerlab.settings.values import pluralize
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.captions import add_caption
from walkerlab.view.plots.operator_words import explain_operators
from walkerlab.view.plots.stages import mark_stages
from walkerlab.view.plots.style import (
    add_description,
    add_legend,
    annotate_no_data,
    escape_label,
    format_generation_axis,
    format_value_axis,
    require_quantity,
    style_axes,
)
from walkerlab.view.plots.tables import axis_label, format_value

MAX_BARS = 40
LEGEND_COLUMNS = 3
TERM_STYLES = {
    "selection": ("selection", "#0072B2", ""),
    "variation": ("crossover and mutation", "#E69F00", "////"),
    "failed_walks": ("failed walks", "#999999", "...."),
    "insertion": ("inserted by hand", "#CC79A7", "xxxx"),
}
"""Label, colour and hatching of each term of the split."""

MIN_SHARE = 0.005  # minimum size of a drawn term, as a fraction of the sum of the sizes of all terms


@styled_plot
def improvement(records: Any, ax: Axes | None = None, *, trait: str = "fitness") -> Axes:
    """Draw how much selection, and how much crossover and mutation, changed the mean of each generation.

    The terms are those of ``wl.analysis.price_equation``; they add up to the change. In a long run, each bar is the
    mean of several generations.

    Args:
        records: Table of a run, or the run.
        ax: Axes to draw on; if None, a new figure is created.
        trait: Numeric column: ``fitness``, or a trait such as ``body_length``.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table has no such column, or the Axes show another quantity.
    """
    split = price_equation(records, trait)
    axes = ax or new_axes(height=4.8)
    name, unit = str(split.attrs["trait"]), str(split.attrs["unit"])
    quantity = axis_label(f"change of the mean {name}", unit)
    require_quantity(axes, quantity)
    known: Any = split.dropna()
    size = math.ceil(len(split) / MAX_BARS) or 1
    axes.set_ylabel(escape_label(quantity))
    format_value_axis(axes)
    if known.empty:
        annotate_no_data(axes, "no two successive generations with walks that count")
        text = "There are no two successive generations with walks that count."
    else:
        shown = _large_terms(known)
        _draw_terms(axes, known, shown, size)
        text = _describe_terms(known, shown, name, unit)
    format_generation_axis(axes, max(2, len(split)))
    if size > 1:
        axes.set_xlabel(f"generation (each bar: mean of {size})")
    text += mark_stages(axes, split)
    add_legend(axes, LEGEND_COLUMNS)
    add_description(axes, "Why the mean changed", text, quantity)
    add_caption(
        axes,
        f"Why the mean {name} of the robots changes from each generation to the next. Selection (blue): the parents "
        "are fitter than the rest of their generation; crossover and mutation (orange, hatched): mixing the parents' "
        f"genes and changing some at random makes the children better or, usually, worse than their parents. {text}",
    )
    return axes


def _large_terms(split: pd.DataFrame) -> list[str]:
    """Return the terms that are large enough to draw."""
    sizes = split[[*TERMS]].abs().sum()
    return [term for term in TERM_STYLES if sizes[term] > MIN_SHARE * sizes.sum()]


def _draw_terms(axes: Axes, split: pd.DataFrame, terms: list[str], size: int) -> None:
    """Draw stacked bars, upward for gains and downward for losses, and the line of their sum."""
    groups: Any = split.groupby((split.generation - split.generation.min()) // size)
    means = groups[[*TERMS, "change"]].mean()
    x = split.generation.min() + means.index.to_numpy() * size + (size - 1) / 2
    ink = foreground_colour(axes)
    up = np.zeros(len(means))
    down = np.zeros(len(means))
    for term in terms:
        label, colour, hatch = TERM_STYLES[term]
        height = means[term].to_numpy()
        bottom = np.where(height >= 0, up, down)
        style: dict[str, Any] = {"color": colour, "hatch": hatch, "edgecolor": ink, "linewidth": 0.5}
        axes.bar(x, height, bottom=bottom, width=0.84 * size, label=label, **style)
        up += np.maximum(height, 0)
        down += np.minimum(height, 0)
    axes.axhline(0, color=ink, lw=0.8)
    line: dict[str, Any] = {"color": ink, "lw": 1.8, "marker": "o", "ms": 4, "mfc": foreground_colour(axes, 0)}
    axes.plot(x, means.change, **line, label="sum: the measured change")


def _describe_terms(split: pd.DataFrame, terms: list[str], name: str, unit: str) -> str:
    """Describe the mean of each term over the generations."""
    means: Any = split[[*TERMS, "change"]].mean()

    def signed(value: float) -> str:
        return f"{'+' if value > 0 else ''}{format_value(float(value), unit)}"

    parts = ", ".join(f"{TERM_STYLES[term][0]} {signed(means[term])}" for term in terms)
    return (
        f"On average over {pluralize(len(split), 'generation')}, the mean {name} changed by {signed(means.change)} per "
        f"generation: {parts}."
    )


@styled_plot
def operator_credit(records: Any, ax: Axes | None = None) -> Axes:
    """Draw how often the children of each pair of crossover and mutation are fitter than all of their parents.

    The numbers are those of ``wl.analysis.operator_credit``.

    Args:
        records: Table of a run, or the run; an experiment, or its table.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.
    """
    credit: Any = compare_with_parents(records)
    axes = ax or new_axes(height=2.5 + 0.55 * max(1, len(credit)))
    names = [f"crossover {row.crossover}\nmutation {row.mutation}" for row in credit.itertuples()]
    unit = str(credit.attrs["unit"])
    y = np.arange(len(credit))
    ink = foreground_colour(axes)
    axes.barh(y, 100 * credit.better, height=0.6, color="#56B4E9", edgecolor=ink, linewidth=0.6)
    axes.errorbar(100 * credit.better, y, xerr=100 * credit.better_error, fmt="none", ecolor=ink, capsize=3)
    highest = float((100 * (credit.better + credit.better_error)).max()) if len(credit) else 1.0
    for position, row in enumerate(credit.itertuples()):
        end = 100 * (row.better + row.better_error) + 0.02 * highest
        gain = f"mean gain {format_value(row.mean_gain, unit)}" if np.isfinite(row.mean_gain) else "no walk counts"
        axes.text(end, position, f"{gain}\n{row.children} children", va="center", ha="left", size=8)
    if credit.empty:
        annotate_no_data(axes, "no robot has parents yet")
    axes.set_yticks(y, [escape_label(name) for name in names])
    axes.set_ylim(len(credit) - 0.4, -0.6)
    axes.set_xlim(0, 1.35 * max(highest, 0.1))
    axes.set_xlabel("children fitter than their fittest parent [%]")
    style_axes(axes)
    axes.grid(visible=False)
    fitness = str(credit.attrs["fitness"])
    text = "; ".join(
        f"{name}: {100 * row.better:.1f} % of {row.children} children are fitter than their fittest parent, mean gain "
        f"{format_value(row.mean_gain, unit)}, best gain {format_value(row.best_gain, unit)}"
        for name, row in zip((name.replace("\n", ", ") for name in names), credit.itertuples(), strict=True)
    )
    add_description(axes, "Credit of the operators", f"{text or 'No robot has parents yet'}.")
    add_caption(
        axes,
        "How many of the children are fitter than all of their parents (black line: standard error). Mean gain: "
        f"{fitness} of a child minus the mean of its parents; it is usually below 0, and progress comes from the few "
        f"children that are better.{_explain_pairs(credit)}",
    )
    return axes


def _explain_pairs(credit: pd.DataFrame) -> str:
    """Return a sentence with a clause about each crossover and mutation, with a space in front; "" without clauses."""
    kinds: tuple[tuple[str, type[Choice]], ...] = (("crossover", Crossover), ("mutation", Mutation))
    clauses = [f"{word} {each}" for word, kind in kinds for each in explain_operators(credit[word].unique(), kind)]
    text = "; ".join(clauses)
    return f" {text[0].upper()}{text[1:]}." if text else ""
