"""Stages of a run in plots over its generations: where the settings were changed, and to what."""

import pandas as pd
from matplotlib.axes import Axes

from walkerlab.settings.values import truncate
from walkerlab.view.plots.appearance import foreground_colour
from walkerlab.view.plots.style import SECONDARY_STRENGTH, escape_label

FONT_SIZE = 8
BOTTOM = 0.03  # start of the text, as a fraction of the height of the Axes
TEXT_OFFSET = 4  # points between a boundary and its text


def with_current_fitness(records: pd.DataFrame) -> pd.DataFrame:
    """Return the generations whose fitness is the quantity that the table names."""
    return records.loc[records.generation >= records.attrs.get("fitness_since", 0), :]


def mark_stages(axes: Axes, records: pd.DataFrame) -> str:
    """Draw a dotted line before the first generation of each later stage, with the changed settings.

    Args:
        axes: Axes with the generations on the horizontal axis.
        records: Table of a run.

    Returns:
        Sentences about the stages for the alternative text; "" for a run with one stage.
    """
    stages: dict[int, str] = records.attrs.get("stages", {})
    colour = foreground_colour(axes, SECONDARY_STRENGTH)
    for first, changes in stages.items():
        axes.axvline(first - 0.5, color=colour, lw=1.2, ls=(0, (1, 2)), zorder=1)
        axes.annotate(
            escape_label(truncate(changes)), (first - 0.5, BOTTOM), xycoords=("data", "axes fraction"),
            xytext=(TEXT_OFFSET, 0), textcoords="offset points", rotation=90, va="bottom", ha="left", size=FONT_SIZE,
            color=colour, zorder=4, bbox={"fc": axes.get_facecolor(), "ec": "none", "alpha": 0.85, "pad": 1},
        )  # fmt: skip
    return "".join(f" New settings from generation {first} on: {changes}." for first, changes in stages.items())
