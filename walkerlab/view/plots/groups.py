"""Several runs in one plot: grouped by condition, with each group drawn as its median and its middle half."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, cast

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties

from walkerlab.settings.values import pluralize
from walkerlab.view.plots.stages import with_current_fitness
from walkerlab.view.plots.style import (
    add_description,
    add_legend,
    annotate_no_data,
    count_plots,
    escape_label,
    format_generation_axis,
    format_value_axis,
    marker_stride,
    n_legend_columns,
    next_run_style,
    require_quantity,
)
from walkerlab.view.plots.tables import describe_change, require_table

Groups = dict[str, list[pd.DataFrame]]
"""Tables of the runs of each condition, keyed by its name; the key is "" if there is only one condition."""

QUARTILES = (0.25, 0.5, 0.75)
DASHES = ("-", (0, (5, 1.5)), (0, (5, 1.2, 1.2, 1.2)), (0, (1.5, 1)))
"""Line styles of successive conditions, which distinguish them in black and white."""


def read_groups(given: Any) -> Groups | None:
    """Return the runs of each condition, or None for a single run.

    Args:
        given: A run or its table; a list of runs; a dict from names to runs or to lists of them; an experiment, or its
            table.

    Raises:
        TypeError: If it contains something else.
        ValueError: If there is no run.
    """
    if isinstance(given, Mapping):
        entries = cast(Mapping[Any, Any], given)
        groups = {str(name): _read_runs(entry) for name, entry in entries.items()}
    elif isinstance(given, list | tuple):
        groups = {"": _read_runs(given)}
    else:
        table = getattr(given, "records", given)
        if not isinstance(table, pd.DataFrame) or not {"condition", "seed"} <= {*table.columns}:
            return None
        groups = {str(name): _by_seed(rows) for name, rows in table.groupby("condition", sort=False)}
    if not groups or not all(groups.values()):
        raise ValueError("there is no run to draw; a list, or each value of a dict, must contain at least one run")
    return groups


def _read_runs(given: Any) -> list[pd.DataFrame]:
    entries = cast(Sequence[Any], given) if isinstance(given, list | tuple) else [given]
    tables: list[pd.DataFrame] = []
    for entry in entries:
        table = getattr(entry, "records", entry)
        if isinstance(table, pd.DataFrame) and {"condition", "seed"} <= {*table.columns}:
            raise TypeError("an experiment cannot be one of several runs; draw it alone, or use a part of its table")
        tables.append(require_table(table))
    return tables


def _by_seed(rows: pd.DataFrame) -> list[pd.DataFrame]:
    return [require_table(table) for _, table in rows.groupby("seed", sort=False)]


def draw_groups(
    axes: Axes,
    groups: Groups,
    compute: Callable[[pd.DataFrame], pd.Series],
    *,
    title: str,
    what: str,
    quantity: str,
    unit: str = "",
    label: str = "",
    axis_label: str = "",
) -> None:
    """Draw the median of each condition over its runs, and the middle half of the runs, over the generations.

    Only the generations that all runs of a condition have are drawn, and of these, those in which more than half of the
    runs have a value.

    Args:
        axes: Axes to draw on.
        groups: Runs of each condition.
        compute: Function that returns a value for each generation of a run; NaN or ``-inf`` if there is none.
        title: Title of the kind of plot.
        what: The value, as a noun phrase.
        quantity: Quantity on the vertical axis, with its unit.
        unit: Unit of the value.
        label: Text that precedes the names of the conditions.
        axis_label: Label of the vertical axis; the quantity if empty.
    """
    require_quantity(axes, quantity)
    n_generations = 1
    n_runs: set[int] = set()
    for name, tables in groups.items():
        full_name = ": ".join(filter(None, [label, name]))
        dashes: Any = DASHES[count_plots(axes, title) % len(DASHES)]
        colour, marker = next_run_style(axes, title)
        values = pd.concat([compute(table) for table in tables], axis=1, join="inner").sort_index()
        quartiles = _quartiles(values)
        median: Any = quartiles[0.5].dropna()
        n_generations = max(n_generations, len(values))
        n_runs.add(len(tables))
        if len(tables) > 1:
            area_label = "" if full_name else "middle half of the runs"
            band = quartiles[[0.25, 0.75]]
            axes.fill_between(band.index, band[0.25], band[0.75], color=colour, alpha=0.15, lw=0, label=area_label)
            axes.plot(band.index, band, color=colour, lw=0.6, ls=dashes, alpha=0.6, zorder=1.5)
        shown = full_name or f"median of {pluralize(len(tables), 'run')}"
        style: dict[str, Any] = {"lw": 2, "ls": dashes, "color": colour, "marker": marker, "ms": 4}
        axes.plot(median.index, median, **style, markevery=marker_stride(len(median)), label=escape_label(shown))
        runs = pluralize(len(tables), "run")
        change = f"the median {describe_change(median, unit)}" if len(median) else "no walk counted"
        over = f"over {pluralize(len(values), 'generation')} of {runs}"
        add_description(axes, title, f"{full_name or 'Runs'}: {what} {over}: {change}.", quantity)
    if not any(np.isfinite(np.asarray(line.get_ydata(), dtype=np.float64)).any() for line in axes.lines):
        annotate_no_data(axes, "no walk counted")
    axes.set_ylabel(escape_label(axis_label or quantity))
    format_value_axis(axes)
    format_generation_axis(axes, n_generations)
    add_legend(axes, n_legend_columns(count_plots(axes, title)))
    legend = axes.get_legend()
    if legend and max(n_runs) > 1 and (label or any(groups)):
        each = f" of {max(n_runs)} runs" if len(n_runs) == 1 else " of the runs"
        legend.set_title(f"lines: median{each}; areas: their middle half", FontProperties(size=9))
        legend.set_alignment("left")


def _quartiles(values: pd.DataFrame) -> pd.DataFrame:
    """Return the quartiles of each row; a missing value counts as lower than any other."""
    numbers = values.fillna(-np.inf).to_numpy(dtype=np.float64)
    if not numbers.size:
        return pd.DataFrame(columns=list(QUARTILES), index=values.index, dtype=np.float64)
    with np.errstate(invalid="ignore"):
        found = np.quantile(numbers, QUARTILES, axis=1)
    return pd.DataFrame(np.where(np.isfinite(found), found, np.nan).T, index=values.index, columns=list(QUARTILES))


def best_so_far(table: pd.DataFrame) -> pd.Series:
    """Return the best fitness up to each generation, indexed by generation; ``-inf`` until a walk counts.

    It starts again at the last generation from which the walks or their fitness function are different. Generations of
    an earlier fitness function have ``-inf``.
    """
    generations = pd.Index(sorted(table.generation.unique()), name="generation")
    current = with_current_fitness(table)
    best = current[current.verdict == "ok"].groupby("generation").fitness.max()
    is_rated_now = generations >= table.attrs.get("rated_since", 0)
    return best.reindex(generations, fill_value=-np.inf).groupby(is_rated_now).cummax()
