"""A plot of a slice of the fitness landscape; a click on a point plays the walk of its genome."""

from typing import Any

import numpy as np
import pandas as pd

from walkerlab.settings.settings import Settings
from walkerlab.view import plots
from walkerlab.view.plots.appearance import offscreen_axes
from walkerlab.view.plots.landscape import spell
from walkerlab.view.plots.tables import format_value
from walkerlab.widgets.clickable_plot import ClickablePlot

MAP_SIZE = (7.0, 5.2)  # inches
CURVE_SIZE = (7.0, 3.8)


class Landscape(ClickablePlot):
    """A slice of the fitness landscape and the replay of the walk of a selected point.

    Attributes:
        table: Table from ``wl.analysis.landscape``.
    """

    title = "landscape"

    def __init__(self, table: pd.DataFrame, settings: Settings | None = None) -> None:
        """Create the widget.

        Args:
            table: Table from ``wl.analysis.landscape``.
            settings: Settings of the replays; those of the table if None.

        Raises:
            ValueError: If the table is not from ``wl.analysis.landscape``.
        """
        self.table = table
        names: list[str] = table.attrs.get("genes", [])
        is_curve = len(names) == 1
        axes = plots.landscape(table, offscreen_axes(*(CURVE_SIZE if is_curve else MAP_SIZE)))
        counts = table.verdict == "ok"
        vertical = table.fitness.where(counts, axes.get_ylim()[0]) if is_curve else table[names[1]]
        units = table.attrs["units"]
        fittest = int(np.argmax(table.fitness.where(counts, -np.inf).to_numpy()))
        super().__init__(
            axes,
            np.stack([table[names[0]], vertical], axis=1),
            table.genome.tolist(),
            settings or table.attrs.get("settings") or Settings(),
            [_describe_walk(row, names, units, str(table.attrs["fitness"])) for row in table.to_dict("records")],
            name="Fitness landscape",
            buttons=[["Play the fittest walk", fittest], ["Play the walk of the genome itself", 0]],
            n_rows=1 if is_curve else int(table.loc[~table.is_centre, names[1]].nunique()),
            first=1,
        )


def _describe_walk(row: dict[Any, Any], names: list[str], units: dict[str, str], fitness: str) -> str:
    """Describe a walk by the values of the genes that vary, and its fitness or verdict."""
    parts = ["the genome itself"] if row["is_centre"] else []
    parts += [f"{spell(name)} {format_value(float(row[name]), units.get(name, ''))}" for name in names]
    result = f"{fitness} {format_value(float(row['fitness']), units.get('fitness', ''))}"
    return ", ".join([*parts, result if row["verdict"] == "ok" else str(row["verdict"])])
