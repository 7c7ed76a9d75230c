"""Curves over the generations of a run: the fitness, and any other column of the table."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from walkerlab.settings.values import did_you_mean, pluralize
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.groups import best_so_far, draw_groups, read_groups
from walkerlab.view.plots.stages import mark_stages, with_current_fitness
from walkerlab.view.plots.style import (
    add_description,
    add_legend,
    annotate_no_data,
    count_plots,
    escape_label,
    format_generation_axis,
    format_value_axis,
    integer_locator,
    marker_stride,
    n_legend_columns,
    next_run_style,
    require_quantity,
)
from walkerlab.view.plots.tables import (
    UNKNOWN_FITNESS,
    axis_label,
    describe_change,
    describe_not_counted,
    fitness_label,
    require_same_fitness,
    require_table,
    unit_of,
)

QUARTILES = np.array([0.25, 0.5, 0.75])
IDENTIFIER_COLUMNS = ("generation", "individual", "born")  # numeric columns that are not traits
WALK_RESULTS = ("fitness", "distance", "velocity")
"""Columns that a walk determines; they are meaningless if the walk does not count."""
SINGLE_RUN_COLUMNS = 3  # number of columns in the legend of a single run
MAX_LARGE_MARKERS = 60  # number of generations above which the best robots have smaller markers


@styled_plot
def fitness_curve(records: Any, ax: Axes | None = None, *, label: str = "", look: int | None = None) -> Axes:
    """Draw the best (solid), the median (dashed) and the middle half of the fitness of each generation.

    Only walks that count are included. A dotted line marks the first generation with changed settings. If the
    fitness function was changed, only the generations with the current function are drawn. For several runs, the best
    fitness so far is drawn: for each condition the median over its runs, and their middle half.

    Args:
        records: Table of a run, or the run; a list of runs, a dict from names to runs or to lists of them, or an
            experiment.
        ax: Axes to draw on; if None, a new figure is created. Each run on the same Axes has its own colour and marker.
        label: Name of the run, which precedes the names of its lines in the legend.
        look: Number of the colour and marker, from 0; the next ones if None.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table contains several runs, or the Axes show another quantity.
    """
    title = "Fitness of each generation"
    if (groups := read_groups(records)) is not None:
        first = require_same_fitness(groups)
        axes = ax or new_axes()
        name = f"best {first.attrs.get('fitness', UNKNOWN_FITNESS)} so far"
        options = {"quantity": fitness_label(first), "unit": unit_of(first, "fitness"), "label": label}
        options["axis_label"] = axis_label(name, options["unit"])
        draw_groups(axes, groups, best_so_far, title=title, what=name, **options)
        return axes
    records = with_current_fitness(require_table(records, "verdict", "fitness"))
    axes = ax or new_axes()
    quantity = fitness_label(records)
    require_quantity(axes, quantity)
    counted: Any = records[records.verdict == "ok"]
    best = counted.groupby("generation").fitness.max()
    name = str(records.attrs.get("fitness", UNKNOWN_FITNESS))
    colour, marker = next_run_style(axes, title, look)
    n_generations = records.generation.nunique()
    prefix = f"{label}: " if label else ""
    line: dict[str, Any] = {"lw": 2, "color": colour, "marker": marker, "ms": 4, "markevery": marker_stride(len(best))}
    axes.plot(best.index, best, **line, label=escape_label(f"{prefix}best"))
    share = describe_not_counted(records)
    median = _draw_quartiles(axes, counted, "fitness", (colour, marker), prefix, share)
    if best.empty:
        annotate_no_data(axes, "no walk counted")
        text = f"{prefix}in {pluralize(n_generations, 'generation')}, no walk counted."
    else:
        unit = unit_of(records, "fitness")
        text = (
            f"{prefix}{name} over {pluralize(n_generations, 'generation')}: the best {describe_change(best, unit)}, "
            f"the median{share} {describe_change(median, unit)}."
        )
    text += mark_stages(axes, records)
    add_description(axes, title, text[0].upper() + text[1:], quantity)
    axes.set_ylabel(escape_label(quantity))
    format_value_axis(axes)
    format_generation_axis(axes, n_generations)
    add_legend(axes, n_legend_columns(count_plots(axes, title)) if label else SINGLE_RUN_COLUMNS)
    return axes


@styled_plot
def trait(records: Any, name: str, ax: Axes | None = None, *, label: str = "") -> Axes:
    """Draw a trait over the generations: its median (dashed), its middle half, and its value in the best robot.

    All robots are included, except for fitness, distance and velocity, which only walks that count can determine.
    The best robot is the one with the highest fitness, not the one with the highest trait. For several runs, the
    median of each generation is drawn: for each condition the median over its runs, and their middle half.

    Args:
        records: Table of a run, or the run; a list of runs, a dict from names to runs or to lists of them, or an
            experiment.
        name: Numeric column: ``body_length``, ``weight``, ``n_legs``, ``n_segments``, ``velocity`` …
        ax: Axes to draw on; if None, a new figure is created. Each run on the same Axes has its own colour and marker.
        label: Name of the run, which precedes the names of its lines in the legend.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table has no such numeric column; the message lists the columns. If the table contains
            several runs, or the Axes show another quantity.
    """
    groups = read_groups(records)
    records = require_table(records) if groups is None else next(iter(groups.values()))[0]
    numeric = [column for column in records.select_dtypes("number").columns if column not in IDENTIFIER_COLUMNS]
    if name not in numeric:
        guess = did_you_mean(name, numeric)
        raise ValueError(f"the table has no numeric column {name!r}; it has {', '.join(numeric)}.{guess}")
    require_table(records, "individual", "verdict", "fitness")
    if groups is not None:
        require_same_fitness(groups)
    axes = ax or new_axes()
    trait_name = {"n_legs": "number of legs", "n_segments": "number of segments"}.get(name, name.replace("_", " "))
    title = f"{trait_name[0].upper()}{trait_name[1:]} of each generation"
    unit = unit_of(records, name)
    quantity = fitness_label(records) if name == "fitness" else axis_label(trait_name, unit)
    if groups is not None:

        def median_of(table: pd.DataFrame) -> pd.Series:
            used = table[(table.verdict == "ok") & np.isfinite(table[name])] if name in WALK_RESULTS else table
            medians: Any = used.groupby("generation")[name].median()
            return medians.reindex(sorted(table.generation.unique()))

        of_each = f"median {quantity} of each generation"
        options = {"quantity": quantity, "unit": unit, "label": label, "axis_label": of_each}
        draw_groups(axes, groups, median_of, title=title, what=f"median {trait_name}", **options)
        return axes
    require_quantity(axes, quantity)
    counted: Any = records[records.verdict == "ok"]
    included: Any = counted if name in WALK_RESULTS else records
    included = included[np.isfinite(included[name])]
    fittest = counted.sort_values(["generation", "fitness", "individual"], ascending=[True, False, True])
    best = fittest.drop_duplicates("generation").set_index("generation")[name]
    colour, marker = next_run_style(axes, title)
    n_generations = records.generation.nunique()
    prefix = f"{label}: " if label else ""
    points: dict[str, Any] = {
        "marker": marker,
        "ms": 5 if len(best) <= MAX_LARGE_MARKERS else 3,
        "mfc": foreground_colour(axes, 0),
        "mec": colour,
        "ls": "",
    }
    axes.plot(best.index, best, **points, label=escape_label(f"{prefix}best robot"), zorder=3)
    share = describe_not_counted(records) if name in WALK_RESULTS else ""
    median = _draw_quartiles(axes, included, name, (colour, marker), prefix, share)
    if median.empty:
        annotate_no_data(axes, "no walk counted")
        text = f"{prefix}{trait_name}: no walk counted."
    else:
        of_best = f", the value of the best robot {describe_change(best, unit)}" if len(best) else ""
        over = f"over {pluralize(n_generations, 'generation')}"
        text = f"{prefix}{trait_name} {over}: the median{share} {describe_change(median, unit)}{of_best}."
    add_description(axes, title, text[0].upper() + text[1:], quantity)
    axes.set_ylabel(escape_label(quantity))
    format_value_axis(axes)
    if pd.api.types.is_integer_dtype(records[name]):
        axes.yaxis.set_major_locator(integer_locator())
    format_generation_axis(axes, n_generations)
    add_legend(axes, n_legend_columns(count_plots(axes, title)) if label else SINGLE_RUN_COLUMNS)
    return axes


def _draw_quartiles(
    axes: Axes, records: pd.DataFrame, name: str, style: tuple[str, str], prefix: str, share: str = ""
) -> pd.Series:
    """Draw the median and the middle half of a column over the generations.

    Args:
        axes: Axes to draw on.
        records: Rows to include.
        name: Column to draw.
        style: Colour and marker.
        prefix: Name of the run as it precedes the name of the line; "" for a single run.
        share: Share of the walks that are included, as text; "" if all are.

    Returns:
        The median of each generation.
    """
    colour, marker = style
    is_integer = pd.api.types.is_integer_dtype(records[name])
    interpolation = "lower" if is_integer else "linear"  # the median number of legs is a whole number
    grouped: Any = records.groupby("generation")[name].quantile(QUARTILES, interpolation=interpolation).unstack()
    quartiles = grouped.reindex(columns=QUARTILES)
    low, median, high = (quartiles[share] for share in QUARTILES)
    area_label = "" if prefix else "middle half"
    axes.fill_between(quartiles.index, low, high, color=colour, alpha=0.18, lw=0, label=area_label)
    line: dict[str, Any] = {"lw": 1.4, "ls": (0, (4, 2)), "color": colour, "label": escape_label(f"{prefix}median")}
    if share and not prefix:
        line["label"] = f"median{share}"
    axes.plot(median.index, median, **line, marker=marker, ms=2.5, markevery=marker_stride(len(median)))
    return median
