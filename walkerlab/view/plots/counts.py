"""Plot of the verdicts: how many walks counted in each generation, and why the others did not."""

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from walkerlab.settings.values import pluralize
from walkerlab.simulation.validity import VERDICTS
from walkerlab.view.plots.appearance import new_axes, styled_plot
from walkerlab.view.plots.style import (
    add_description,
    annotate_no_data,
    escape_label,
    format_generation_axis,
    integer_locator,
    require_quantity,
)
from walkerlab.view.plots.tables import require_table

COUNTED_STYLE = ("#BFE3D6", "")
"""Colour and hatching of the verdict ``ok``."""
VERDICT_STYLES = (
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
    ("#D55E00", "\\\\"),
    ("#999999", "--"),
    ("#CC79A7", "**"),
    ("#E69F00", "..."),
)
"""Colour and hatching of the verdicts after ``ok``, in the order of ``VERDICTS``; the same in all plots."""

MAX_BARS = 60
COUNTED_QUANTITY = "robots"


@styled_plot
def verdicts(records: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw how many walks of each generation count, and why the others do not.

    Elites are included in each generation in which they live. In a long run, each bar is the mean of several
    generations.

    Args:
        records: Table of a run, or the run.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.
    """
    records = require_table(records, "verdict")
    axes = ax or new_axes()
    require_quantity(axes, COUNTED_QUANTITY)
    counts: Any = pd.crosstab(records.generation, records.verdict)
    known = [verdict for verdict in VERDICTS if verdict in counts]
    unknown = [verdict for verdict in counts if verdict not in VERDICTS]
    counts = counts[[*known, *unknown]]
    add_description(axes, "Verdicts of each generation", _write_alt_text(counts), COUNTED_QUANTITY)
    generations_per_bar = 1
    if counts.empty:
        annotate_no_data(axes, "no robot has walked yet")
    else:
        counts = counts.reindex(range(counts.index[0], counts.index[-1] + 1))  # missing generations have no bar
        generations_per_bar = math.ceil(len(counts) / MAX_BARS)
        _draw_bars(axes, counts, generations_per_bar)
    axes.set_ylabel(COUNTED_QUANTITY)
    axes.yaxis.set_major_locator(integer_locator())
    format_generation_axis(axes, len(counts))
    if generations_per_bar > 1:
        axes.set_xlabel(f"generation (each bar: mean of {generations_per_bar})")
    axes.grid(visible=False)
    axes.margins(x=0, y=0.02)
    return axes


def _draw_bars(axes: Axes, counts: Any, generations_per_bar: int) -> None:
    """Draw stacked bars, each the mean of several generations.

    Args:
        axes: Axes to draw on.
        counts: Number of robots; a row for each generation and a column for each verdict.
        generations_per_bar: Number of generations in a bar.
    """
    generation = counts.index.to_numpy()
    edges = np.append(generation[::generations_per_bar], generation[-1] + 1) - 0.5
    means = counts.groupby(np.arange(len(counts)) // generations_per_bar).mean()
    bottom = np.zeros(len(edges) - 1)
    for verdict in means:
        colour, hatch = _verdict_style(str(verdict))
        top = bottom + means[verdict].to_numpy()
        style: dict[str, Any] = {"fc": colour, "hatch": hatch, "ec": "0.15", "lw": 0.5}
        label = "counts" if verdict == "ok" else escape_label(verdict)
        axes.stairs(top, edges, baseline=bottom, fill=True, **style, label=label, gid=f"verdict-{verdict}")
        bottom = np.nan_to_num(top)
    handles, labels = axes.get_legend_handles_labels()
    position: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.01, 1), "borderaxespad": 0.0}
    axes.legend(handles[::-1], labels[::-1], frameon=False, handleheight=1.6, **position)  # in the order of the stack


def _verdict_style(verdict: str) -> tuple[str, str]:
    """Return colour and hatching of a verdict; if it is not in ``VERDICTS``, those of the last verdict."""
    if verdict == "ok":
        return COUNTED_STYLE
    number = list(VERDICTS).index(verdict) - 1 if verdict in VERDICTS else -1
    return VERDICT_STYLES[number % len(VERDICT_STYLES)]


def _write_alt_text(counts: Any) -> str:
    """Write the alternative text: the share of counted walks, and the number of each other verdict."""
    if counts.empty:
        return "No robot has walked yet."
    n_robots = int(counts.to_numpy().sum())
    n_counted = counts["ok"].to_numpy() if "ok" in counts else np.zeros(len(counts))
    shares = n_counted / counts.to_numpy().sum(axis=1)
    n_by_verdict = {str(verdict): int(counts[verdict].sum()) for verdict in counts if verdict != "ok"}
    most_frequent_first = sorted(n_by_verdict, key=lambda verdict: -n_by_verdict[verdict])
    reasons = ", ".join(f"{verdict} ({n_by_verdict[verdict]} of {n_robots})" for verdict in most_frequent_first)
    return (
        f"Verdicts over {pluralize(len(counts), 'generation')}: {shares[0]:.0%} of the walks counted in the first "
        f"generation and {shares[-1]:.0%} in the last. {f'Other verdicts: {reasons}.' if reasons else 'All counted.'}"
    )
