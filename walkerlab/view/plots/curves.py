"""Pictures of the tidy table, generation by generation."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from walkerlab.settings.values import count, did_you_mean
from walkerlab.view.plots.appearance import ink, new_axes, picture
from walkerlab.view.plots.style import (
    UNKNOWN_FITNESS,
    columns_of,
    course,
    describe,
    fitness_measure,
    key,
    label_values,
    literal,
    n_drawn,
    next_look,
    nothing,
    over_generations,
    require_measure,
    round_steps,
    some,
    table_of,
    unit_of,
    with_brackets,
)

QUARTILES = np.array([0.25, 0.5, 0.75])
NUMBERS = ("generation", "individual", "born")  # columns that count robots, and measure none
WALKED = ("fitness", "distance", "velocity")
"""What a walk brings forth: of those that do not count, it means nothing."""


@picture
def fitness_curve(records: pd.DataFrame, ax: Axes | None = None, *, label: str = "", look: int | None = None) -> Axes:
    """Draw the best (solid), the median (dashed) and the middle half of each generation's fitness.

    Walks that do not count are left out of the middle, and can't be the best.

    Args:
        records: the tidy table of a run, or the run.
        ax: where to draw; a new figure if None. Several runs on one Axes get a colour and a mark each.
        label: told before the lines' names, to tell several runs apart.
        look: which of the colours and marks it gets, counted from 0; the next one if None.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: if the table is that of several runs, or the Axes show another measure.
    """
    records = table_of(records, "verdict", "fitness")
    axes = ax or new_axes()
    title, measure = "Fitness of each generation", fitness_measure(records)
    require_measure(axes, measure)
    counted: Any = records[records.verdict == "ok"]
    best = counted.groupby("generation").fitness.max()
    name = str(records.attrs.get("fitness", UNKNOWN_FITNESS))
    (colour, mark), n_generations = next_look(axes, title, look), records.generation.nunique()
    before = f"{label}: " if label else ""
    line: dict[str, Any] = {"lw": 2, "color": colour, "marker": mark, "ms": 4, "markevery": some(len(best))}
    axes.plot(best.index, best, **line, label=literal(f"{before}best"))
    middle = _middle(axes, counted, "fitness", (colour, mark), before)
    if best.empty:
        nothing(axes, "no walk counted")
        text = f"{before}in {count(n_generations, 'generation')}, no walk counted."
    else:
        unit = unit_of(records, "fitness")
        text = (
            f"{before}{name} over {count(n_generations, 'generation')}: the best {course(best, unit)}, "
            f"the median {course(middle, unit)}."
        )
    describe(axes, title, text[0].upper() + text[1:], measure)
    axes.set_ylabel(literal(measure))
    label_values(axes)
    over_generations(axes, n_generations)
    key(axes, columns_of(n_drawn(axes, title)) if label else 3)
    return axes


@picture
def trait(records: pd.DataFrame, name: str, ax: Axes | None = None, *, label: str = "") -> Axes:
    """Draw how a trait changes: its median (dashed), its middle half, and the best robot of each generation.

    All robots are looked at; but what a walk brought forth (fitness, distance, velocity) is that of walks that count.
    The best robot is the one of the highest fitness, not of the highest trait.

    Args:
        records: the tidy table of a run, or the run.
        name: a column of numbers: ``body_length``, ``weight``, ``n_legs``, ``n_segments``, ``velocity`` …
        ax: where to draw; a new figure if None. Several runs on one Axes get a colour and a mark each.
        label: told before the lines' names, to tell several runs apart.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: if there is no such column of numbers; the message lists those that there are. If the table is that
            of several runs, or the Axes show another measure.
    """
    records = table_of(records)
    numeric = [column for column in records.select_dtypes("number").columns if column not in NUMBERS]
    if name not in numeric:
        guess = did_you_mean(name, numeric)
        raise ValueError(f"the table has no column of numbers called {name!r}; it has {', '.join(numeric)}.{guess}")
    table_of(records, "individual", "verdict", "fitness")
    axes = ax or new_axes()
    said = {"n_legs": "number of legs", "n_segments": "number of segments"}.get(name, name.replace("_", " "))
    title, unit = f"{said[0].upper()}{said[1:]} of each generation", unit_of(records, name)
    measure = fitness_measure(records) if name == "fitness" else with_brackets(said, unit)
    require_measure(axes, measure)
    counted: Any = records[records.verdict == "ok"]
    known: Any = counted if name in WALKED else records
    known = known[np.isfinite(known[name])]
    fittest = counted.sort_values(["generation", "fitness", "individual"], ascending=[True, False, True])
    best = fittest.drop_duplicates("generation").set_index("generation")[name]
    (colour, mark), n_generations = next_look(axes, title), records.generation.nunique()
    before = f"{label}: " if label else ""
    marks: dict[str, Any] = {
        "marker": mark,
        "ms": 5 if len(best) <= 60 else 3,
        "mfc": ink(axes, 0),
        "mec": colour,
        "ls": "",
    }
    axes.plot(best.index, best, **marks, label=literal(f"{before}best robot"), zorder=3)
    middle = _middle(axes, known, name, (colour, mark), before)
    if middle.empty:
        nothing(axes, "no walk counted")
        text = f"{before}{said}: no walk counted."
    else:
        of_best = f", that of the best robot {course(best, unit)}" if len(best) else ""
        text = f"{before}{said} over {count(n_generations, 'generation')}: the median {course(middle, unit)}{of_best}."
    describe(axes, title, text[0].upper() + text[1:], measure)
    axes.set_ylabel(literal(measure))
    label_values(axes)
    if pd.api.types.is_integer_dtype(records[name]):
        axes.yaxis.set_major_locator(round_steps())
    over_generations(axes, n_generations)
    key(axes, columns_of(n_drawn(axes, title)) if label else 3)
    return axes


def _middle(axes: Axes, records: pd.DataFrame, name: str, look: tuple[str, str], before: str) -> pd.Series:
    """Draw median and middle half of a column in a colour, with a mark; return the median of each generation."""
    colour, mark = look
    counts = pd.api.types.is_integer_dtype(records[name])  # of which no robot has two and a half
    between = "lower" if counts else "linear"
    grouped: Any = records.groupby("generation")[name].quantile(QUARTILES, interpolation=between).unstack()
    quartiles = grouped.reindex(columns=QUARTILES)
    low, median, high = (quartiles[share] for share in QUARTILES)
    axes.fill_between(quartiles.index, low, high, color=colour, alpha=0.18, lw=0, label="" if before else "middle half")
    line: dict[str, Any] = {"lw": 1.4, "ls": (0, (4, 2)), "color": colour, "label": literal(f"{before}median")}
    axes.plot(median.index, median, **line, marker=mark, ms=2.5, markevery=some(len(median)))
    return median
