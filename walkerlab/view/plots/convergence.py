"""Plots of convergence, measured and in theory: the takeover by the best individual, and OneMax."""

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from walkerlab.settings.choices import Selection
from walkerlab.settings.values import pluralize
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.captions import add_caption
from walkerlab.view.plots.operator_words import explain_operator
from walkerlab.view.plots.style import (
    RUN_COLOURS,
    RUN_MARKERS,
    add_description,
    add_legend,
    annotate_no_data,
    escape_label,
    integer_locator,
    marker_stride,
    n_legend_columns,
    style_axes,
)
from walkerlab.view.plots.tables import require_analysis

THEORY_DASHES = ((0, (4, 1.5)), (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5)), (0, (8, 3)))
"""Dashes of the theory of each operator."""

MIN_WELL_MIXED_MATINGS = 3
"""Minimum number of matings in each generation of OneMax for which the theory of well-mixed bits holds."""


@styled_plot
def takeover(table: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw how copies of the best individual take over a population by selection alone, measured and in theory.

    Args:
        table: Table from ``wl.analysis.follow_takeover``.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table lacks a column.
    """
    table = require_analysis(
        table, "follow_takeover", "selection", "generation", "share", "lowest", "highest", "theory"
    )
    axes = ax or new_axes(height=4.6)
    times: list[str] = []
    handles: list[tuple[Line2D, ...]] = []
    labels: list[str] = []
    names: list[str] = list(dict.fromkeys(table.selection))
    for number, name in enumerate(names):
        rows: Any = table[table.selection == name]
        colour = RUN_COLOURS[number % len(RUN_COLOURS)]
        axes.fill_between(rows.generation, 100 * rows.lowest, 100 * rows.highest, color=colour, alpha=0.15, lw=0)
        line: dict[str, Any] = {"color": colour, "marker": RUN_MARKERS[number % len(RUN_MARKERS)], "ms": 5}
        every = marker_stride(len(rows))
        known = rows.theory.notna().any()
        drawn: list[Line2D] = axes.plot(rows.generation, 100 * rows.share, lw=2, markevery=every, **line)
        if known:
            dashes: dict[str, Any] = {"lw": 1.8, "ls": THEORY_DASHES[number % len(THEORY_DASHES)]}
            drawn += axes.plot(rows.generation, 100 * rows.theory, color=foreground_colour(axes, 0.8), **dashes)
        meaning = explain_operator(name, Selection)
        handles.append(tuple(drawn))
        labels.append(escape_label(f"{name}: {meaning}" if meaning else name))
        complete = rows[rows.share >= 1]
        times.append(f"{name} {int(complete.generation.iloc[0])}" if len(complete) else f"{name} never")
    if not table.share.notna().any():
        annotate_no_data(axes, "the best individual died out in every trial")
    axes.set_xlabel("generation")
    axes.set_ylabel("copies of the best robot [%]")
    axes.xaxis.set_major_locator(integer_locator())
    axes.set_ylim(0, 103)
    axes.set_xlim(left=0)
    style_axes(axes)
    above: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0, 1), "borderaxespad": 0.2, "handlelength": 4}
    axes.legend(handles, labels, frameon=False, fontsize=9, **above)
    text = f"Generations until all robots are copies of the best, in the slowest trial: {', '.join(times)}."
    add_description(axes, "Takeover by the best individual", text)
    n = table.attrs.get("population_size")
    size = f"the best of {n} robots fills the population" if n else "the best robot fills its population"
    no_theory = "" if table.theory.notna().any() else " (not known here)"
    trials = pluralize(table.attrs["n_trials"], "trial") if "n_trials" in table.attrs else "the trials"
    add_caption(
        axes,
        f"How fast {size} with its copies if children are exact copies of their parents; further left is stronger "
        f"selection. Coloured line: mean of {trials}; coloured area: from the slowest to the fastest trial; black "
        f"dashes: what theory predicts{no_theory}. {text}",
    )
    return axes


@styled_plot
def onemax(table: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw the mean fitness of strings of bits over the generations, with the curve that theory predicts.

    Args:
        table: Table from ``wl.analysis.evolve_onemax``.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table lacks a column.
    """
    table = require_analysis(
        table, "evolve_onemax", "selection", "seed", "generation", "mean_fitness", "theory", "theory_linked"
    )
    axes = ax or new_axes()
    names: list[str] = list(dict.fromkeys(table.selection))
    few_matings = table.attrs.get("n_matings", MIN_WELL_MIXED_MATINGS) < MIN_WELL_MIXED_MATINGS
    texts: list[str] = []
    for number, name in enumerate(names):
        rows: Any = table[table.selection == name]
        colour = RUN_COLOURS[number % len(RUN_COLOURS)]
        wide: Any = rows.pivot_table(index="generation", columns="seed", values="mean_fitness").ffill()
        line: dict[str, Any] = {"color": colour, "marker": RUN_MARKERS[number % len(RUN_MARKERS)], "ms": 5}
        axes.plot(wide.index, wide.mean(axis=1), lw=1.4, **line, label=escape_label(name))
        theory = rows.drop_duplicates("generation")
        axes.plot(theory.generation, theory.theory, lw=2, ls=(0, (2, 2)), color=foreground_colour(axes, 0.8))
        if few_matings:
            axes.plot(theory.generation, theory.theory_linked, lw=1, color=foreground_colour(axes, 0.8))
        last = rows.groupby("seed").generation.max().mean()
        reached = theory.generation[theory.theory >= theory.theory.max() - 1e-9]
        texts.append(f"{name}: {last:.1f} generations" + (f" (theory {reached.iloc[0]})" if len(reached) else ""))
    axes.plot([], [], lw=2, ls=(0, (2, 2)), color=foreground_colour(axes, 0.8), label="theory: well-mixed bits")
    if few_matings:
        axes.plot([], [], lw=1, color=foreground_colour(axes, 0.8), label="theory: linked bits")
    axes.set_xlabel("generation")
    axes.set_ylabel("mean number of ones")
    axes.xaxis.set_major_locator(integer_locator())
    axes.set_xlim(left=0)
    style_axes(axes)
    add_legend(axes, n_legend_columns(len(names) + 1))
    text = "; ".join(texts)
    linked = ""
    if few_matings:
        linked = (
            " With so few matings in each generation, the bits are not well mixed (linkage), and evolution is slower; "
            "the thin line takes this into account."
        )
    n_runs = table.seed.nunique()
    add_description(axes, "OneMax, measured and in theory", f"Time until all strings are identical: {text}.")
    add_caption(
        axes,
        f"Strings of {table.attrs.get('n_bits', 'some')} bits evolve instead of robots; their fitness is the number of "
        f"ones. With stronger selection, all bits become ones sooner; theory predicts this from the selection "
        f"intensity alone. Time until all strings are identical (mean of {pluralize(n_runs, 'run')}): {text}.{linked}",
    )
    return axes
