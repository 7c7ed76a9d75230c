"""A plot with a point for each of several robots; a click on a point plays the walk of its robot."""

import io
from collections.abc import Sequence
from typing import Any

import ipywidgets
import numpy as np
import traitlets
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from walkerlab.ga.genes import Floats
from walkerlab.genome.genome import Genome, HasGenome, read_genomes
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize, short_repr
from walkerlab.text.html import data_url
from walkerlab.text.numbers import format_significant
from walkerlab.text.templates import Markup, render
from walkerlab.view import plots, sketch
from walkerlab.view.replay import Replay, replay
from walkerlab.view.replay.page import Frame
from walkerlab.view.snapshots import HasSnapshot
from walkerlab.widgets.component import Component, answer_on_requested_thread, load_script, load_style

DPI = 100
POSTER_SIZE = (640, 360)  # pixels


class PlotPicture(Component):
    """A plot with points that can be selected by mouse or keyboard.

    Attributes:
        picture: Data URL of the plot.
        alt: Alternative text of the plot.
        name: Name of the plot for screen readers.
        points: Position of each walk in the picture, from the left and the top, as fractions of width and height.
        labels: Description of each walk.
        buttons: Texts of buttons, each with the index of the walk that it plays.
        n_rows: Number of walks in a column of a grid; 1 for other plots.
        first: First walk that the arrow keys select.
        selected: Index of the selected walk.
    """

    title = "plot"
    _esm = load_script("clickable_plot")
    _css = load_style("clickable_plot")
    picture = traitlets.Unicode("").tag(sync=True)
    alt = traitlets.Unicode("").tag(sync=True)
    name = traitlets.Unicode("Plot").tag(sync=True)
    points = traitlets.List().tag(sync=True)
    labels = traitlets.List(traitlets.Unicode()).tag(sync=True)
    buttons = traitlets.List().tag(sync=True)
    n_rows = traitlets.Int(1).tag(sync=True)
    first = traitlets.Int(0).tag(sync=True)
    selected = traitlets.Int(0).tag(sync=True)

    def snapshot(self) -> Markup:
        """Return the plot as static HTML."""
        return render("view/replay/frame.html", url=self.picture, alt=self.alt)


class ClickablePlot(HasSnapshot, ipywidgets.Box):
    """A plot in which each point is a robot, and the replay of the walk of the selected robot.

        _, axes = plt.subplots()
        axes.plot(speed, power, "o")
        wl.widgets.ClickablePlot(axes, np.stack([speed, power], axis=1), robots, settings)

    Attributes:
        plot: Plot with the points.
        frame: Replay of the selected walk.
        genomes: Genome of each robot.
    """

    title = "plot"

    def __init__(
        self,
        axes: Axes,
        points: ArrayLike,
        genomes: Sequence[Genome | str | ArrayLike | HasGenome] | Floats,
        settings: Settings,
        labels: Sequence[str] | None = None,
        **traits: Any,
    ) -> None:
        """Create the widget.

        Args:
            axes: Axes of a plot; its figure is shown as it is now.
            points: Position of each robot on the Axes, in the units of the plot, shape (n, 2).
            genomes: Genomes, their texts, robots, or an array of shape (n, n_genes).
            settings: Settings of the replays.
            labels: Description of each robot; if None, its position.
            **traits: Further traits of the plot.

        Raises:
            GenomeError: If a text is not a valid genome.
            TypeError: If ``axes`` or ``settings`` is of another type.
            ValueError: If there are no robots, or the numbers of robots, points and labels differ.
        """
        if not isinstance(axes, Axes):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise TypeError(f"axes must be the Axes of a plot, such as plt.gca(); got {short_repr(axes)}")
        self._settings = require_settings(settings)
        self.genomes = tuple(read_genomes(genomes))
        positions = np.asarray(points, dtype=np.float64)
        n = len(self.genomes)
        if not n or positions.shape != (n, 2):
            raise ValueError(
                f"points must have the shape (n, 2), one for each of the {pluralize(n, 'robot')}; got {positions.shape}"
            )
        texts = [", ".join(map(format_significant, point)) for point in positions] if labels is None else list(labels)
        if len(texts) != n:
            raise ValueError(f"there must be a label for each of the {pluralize(n, 'robot')}; got {len(texts)}")
        drawn = draw_picture(axes, positions)
        self.plot = PlotPicture(**{**drawn, "labels": texts, **traits})
        self.frame = Frame()
        super().__init__([self.plot, self.frame])
        self.add_class("wl-clickable-area")
        self.frame.add_class("wl-frame")
        answer_on_requested_thread(self.frame)
        self._select(0)
        self.plot.on_msg(self._handle_message)

    def show(self, index: int) -> None:
        """Select a robot and play its walk.

        Args:
            index: Index of the robot.

        Raises:
            IndexError: If there is no such robot.
        """
        self._select(index)
        self.frame.play()

    def snapshot(self) -> Markup:
        """Return the plot and the picture of the selected robot as static HTML."""
        return self.plot.snapshot() + self.frame.snapshot()

    def _select(self, index: int) -> None:
        """Select a robot, and show a picture of it; the walk is simulated when the user plays it."""
        if not 0 <= index < len(self.genomes):
            raise IndexError(f"there is no robot {index}; index must be between 0 and {len(self.genomes) - 1}")
        self.plot.selected = index
        label = self.plot.labels[index]
        genome = str(self.genomes[index])
        settings = self._settings
        svg = sketch.draw_robot(genome, settings.robot, size=POSTER_SIZE)

        def walk() -> Replay:
            return replay({label: genome}, settings)

        self.frame.set_replay(walk, data_url("image/svg+xml", svg.encode()), f"Replay of {label}. Press to play.")

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        match message:
            case {"walk": int(index)} if 0 <= index < len(self.genomes):
                self.show(index)
            case _:
                pass


def draw_picture(axes: Axes, positions: Floats) -> dict[str, Any]:
    """Draw the figure of a plot, and return the picture, its alternative text and the positions of points in it.

    Args:
        axes: Axes of the plot.
        positions: Positions on the Axes, in the units of the plot, shape (n, 2).
    """
    figure: Any = axes.figure
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=DPI, bbox_inches=None)
    pixels = axes.transData.transform(positions) * (DPI / figure.dpi)
    width, height = figure.get_size_inches() * DPI
    described = f"{axes.get_title() or 'Plot'}: {axes.get_ylabel()} against {axes.get_xlabel()}, with a point for each "
    return {
        "picture": data_url("image/png", file.getvalue()),
        "alt": plots.alt_text(axes) or f"{described}of {pluralize(len(positions), 'robot')}.",
        "points": np.round(np.stack([pixels[:, 0] / width, 1 - pixels[:, 1] / height], axis=1), 5).tolist(),
    }
