"""A plot of a slice of the fitness landscape; a click on a point plays the walk of its genome."""

import io
from typing import Any

import ipywidgets
import numpy as np
import pandas as pd
import traitlets

from walkerlab.settings.settings import Settings
from walkerlab.text.html import data_url
from walkerlab.text.templates import Markup, render
from walkerlab.view import plots, sketch
from walkerlab.view.plots.appearance import offscreen_axes
from walkerlab.view.plots.landscape import spell
from walkerlab.view.plots.tables import format_value
from walkerlab.view.replay import Replay, replay
from walkerlab.view.replay.page import Frame
from walkerlab.view.snapshots import HasSnapshot
from walkerlab.widgets.component import Component, answer_on_requested_thread, load_script, load_style

MAP_SIZE = (7.0, 5.2)  # inches
CURVE_SIZE = (7.0, 3.8)
DPI = 100
POSTER_SIZE = (640, 360)  # pixels


class LandscapePicture(Component):
    """The plot of a landscape with points that can be selected by mouse or keyboard.

    Attributes:
        picture: Data URL of the plot.
        alt: Alternative text of the plot.
        points: Position of each walk in the picture, from the left and the top, as fractions of width and height.
        labels: Description of each walk.
        n_rows: Number of walks in a column of a map; 1 for a curve.
        best: Index of the fittest walk.
        selected: Index of the selected walk; 0 is the genome itself.
    """

    title = "landscape"
    _esm = load_script("landscape")
    _css = load_style("landscape")
    picture = traitlets.Unicode("").tag(sync=True)
    alt = traitlets.Unicode("").tag(sync=True)
    points = traitlets.List().tag(sync=True)
    labels = traitlets.List(traitlets.Unicode()).tag(sync=True)
    n_rows = traitlets.Int(1).tag(sync=True)
    best = traitlets.Int(0).tag(sync=True)
    selected = traitlets.Int(0).tag(sync=True)

    def snapshot(self) -> Markup:
        """Return the plot as static HTML."""
        return render("view/replay/frame.html", url=self.picture, alt=self.alt)


class Landscape(HasSnapshot, ipywidgets.Box):
    """A slice of the fitness landscape and the replay of the walk of a selected point.

    Attributes:
        table: Table from ``wl.analysis.landscape``.
        plot: Plot with the points.
        frame: Replay of the selected walk.
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
        self.plot = LandscapePicture(**_draw(table))
        self._settings: Settings = settings or table.attrs.get("settings") or Settings()
        self.frame = Frame()
        super().__init__([self.plot, self.frame])
        self.add_class("wl-landscape-area")
        self.frame.add_class("wl-frame")
        answer_on_requested_thread(self.frame)
        self._select(0)
        self.plot.on_msg(self._handle_message)

    def show(self, index: int) -> None:
        """Select a walk and play it.

        Args:
            index: Row of the table.

        Raises:
            IndexError: If the table has no such row.
        """
        self._select(index)
        self.frame.play()

    def snapshot(self) -> Markup:
        """Return the plot and the picture of the selected robot as static HTML."""
        return self.plot.snapshot() + self.frame.snapshot()

    def _select(self, index: int) -> None:
        """Select a walk, and show a picture of its robot; the walk is simulated when the user plays it."""
        if not 0 <= index < len(self.table):
            raise IndexError(f"there is no row {index}; index must be between 0 and {len(self.table) - 1}")
        self.plot.selected = index
        label = self.plot.labels[index]
        genome = str(self.table.genome.iloc[index])
        settings = self._settings
        svg = sketch.draw_robot(genome, settings.robot, size=POSTER_SIZE)

        def walk() -> Replay:
            return replay({label: genome}, settings)

        self.frame.set_replay(walk, data_url("image/svg+xml", svg.encode()), f"Replay of {label}. Press to play.")

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        match message:
            case {"walk": int(index)} if 0 <= index < len(self.table):
                self.show(index)
            case _:
                pass


def _draw(table: pd.DataFrame) -> dict[str, Any]:
    """Draw the plot and return the traits of its component."""
    names: list[str] = table.attrs.get("genes", [])
    axes = plots.landscape(table, offscreen_axes(*(CURVE_SIZE if len(names) == 1 else MAP_SIZE)))
    figure: Any = axes.figure
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=DPI)
    lowest = axes.get_ylim()[0]
    vertical = table.fitness.where(table.verdict == "ok", lowest) if len(names) == 1 else table[names[1]]
    pixels = axes.transData.transform(np.stack([table[names[0]], vertical], axis=1)) * (DPI / figure.dpi)
    width, height = figure.get_size_inches() * DPI
    units = table.attrs["units"]
    labels = [_describe_walk(row, names, units, str(table.attrs["fitness"])) for row in table.to_dict("records")]
    fitness = table.fitness.where(table.verdict == "ok", -np.inf).to_numpy()
    return {
        "picture": data_url("image/png", file.getvalue()),
        "alt": plots.alt_text(axes),
        "points": np.round(np.stack([pixels[:, 0] / width, 1 - pixels[:, 1] / height], axis=1), 5).tolist(),
        "labels": labels,
        "n_rows": int(table.loc[~table.is_centre, names[1]].nunique()) if len(names) == 2 else 1,
        "best": int(np.argmax(fitness)),
    }


def _describe_walk(row: dict[Any, Any], names: list[str], units: dict[str, str], fitness: str) -> str:
    """Describe a walk by the values of the genes that vary, and its fitness or verdict."""
    parts = ["the genome itself"] if row["is_centre"] else []
    parts += [f"{spell(name)} {format_value(float(row[name]), units.get(name, ''))}" for name in names]
    result = f"{fitness} {format_value(float(row['fitness']), units.get('fitness', ''))}"
    return ", ".join([*parts, result if row["verdict"] == "ok" else str(row["verdict"])])
