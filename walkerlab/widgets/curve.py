"""The fitness of one or several runs by generation, as a picture that is updated while they run."""

import io
import math
import re
from collections.abc import Mapping, Sequence
from itertools import count
from typing import Any

import ipywidgets
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from walkerlab.text.html import inline_svg
from walkerlab.text.templates import Markup, render
from walkerlab.view import plots
from walkerlab.view.plots.style import add_legend
from walkerlab.view.plots.tables import fitness_label
from walkerlab.view.snapshots import HasSnapshot, image_html

PICTURE_SIZE = (5.2, 2.9)  # inches
FIGURE_MARGINS = {"left": 0.13, "right": 0.985, "bottom": 0.17}  # fixed, so that axes do not move as a curve grows
N_LEGEND_COLUMNS = 2  # with several runs
MAX_LABEL_LENGTH = 16  # maximum length of a name in the legend, in characters
LEGEND_LINE_HEIGHT = 0.07  # height of a line of the legend, as a fraction of the picture's height
BEST = ": best"  # end of the label of the line of the best robots
_GREY_COLOUR = re.compile(r"#([0-9a-f]{2})\1\1")
_curve_ids = count()  # shared by all drawings, because IDs must be unique on a page


class Curve(HasSnapshot, ipywidgets.HTML):
    """The fitness curves of runs, with separate axes for each fitness function."""

    title = "fitness curve"

    def __init__(self, runs: Mapping[str, pd.DataFrame] | None = None, n_generations: int = 1) -> None:
        """Draw the curves.

        Args:
            runs: Table of each run, keyed by name; no runs if None.
            n_generations: Number of generations for which the axes have space.
        """
        super().__init__(layout={"max_width": "720px", "width": "100%"})
        self.add_class("wl-curve")
        self.draw(runs or {}, n_generations)

    def draw(self, runs: Mapping[str, pd.DataFrame], n_generations: int = 1, looks: Sequence[int] = ()) -> None:
        """Draw new curves; can be called from any thread, because pyplot is not used.

        Args:
            runs: Table of each run, keyed by name.
            n_generations: Number of generations for which the axes have space, so that a curve can grow without moving.
            looks: Index of the colour and marker of each run; in the order of the runs if empty.
        """
        groups: dict[str, list[tuple[int, str, pd.DataFrame]]] = {}
        for look, (name, table) in zip(looks or range(len(runs)), runs.items(), strict=True):
            if not table.empty:
                groups.setdefault(fitness_label(table), []).append((look, _shorten_text(name), table))
                n_generations = max(n_generations, int(table.generation.max()) + 1)
        self._figure = None
        self._alt = ""
        if not groups:
            self.value = _curve_html("", 1)
            return
        figure = Figure(figsize=(PICTURE_SIZE[0], PICTURE_SIZE[1] * len(groups)))
        panels: Any = figure.subfigures(len(groups), 1, squeeze=False).ravel()
        n_runs = sum(map(len, groups.values()))
        alternative_texts: list[str] = []
        for panel, group in zip(panels, groups.values(), strict=True):
            n_lines = math.ceil((len(group) + 1) / N_LEGEND_COLUMNS) if n_runs > 1 else 1
            panel.subplots_adjust(**FIGURE_MARGINS, top=0.97 - LEGEND_LINE_HEIGHT * n_lines)
            axes = panel.add_subplot()
            for look, name, table in group:
                plots.fitness_curve(table, axes, label=name if n_runs > 1 else "", look=look)
            if n_runs > 1:
                _shorten_legend(axes)
            axes.set_xlim(-0.02 * n_generations, 1.02 * max(1, n_generations - 1))
            alternative_texts.append(plots.alt_text(axes))
        file = io.StringIO()
        figure.savefig(file, format="svg", transparent=True)
        self._figure = figure
        self._alt = " ".join(alternative_texts)
        picture = inline_svg(_use_text_colour(file.getvalue()), f"curve{next(_curve_ids)}", self._alt)
        self.value = _curve_html(picture, len(groups))

    def snapshot(self) -> Markup:
        """Return the picture as static HTML: as PNG, whose size does not grow with the curve."""
        picture = ""
        if self._figure:
            file = io.BytesIO()
            self._figure.savefig(file, format="png", dpi=100)
            picture = image_html("image/png", file.getvalue(), self._alt)
        return render("widgets/curve_snapshot.html", picture=picture)


def _curve_html(picture: str, n_axes: int) -> Markup:
    """Return the picture in its frame, or a message if there is no picture."""
    return render("widgets/curve.html", picture=picture, width=PICTURE_SIZE[0], height=PICTURE_SIZE[1] * n_axes)


def _use_text_colour(svg: str) -> str:
    """Replace each grey in an SVG with a tint of the text colour, so that it is readable in a dark notebook."""
    return _GREY_COLOUR.sub(lambda found: _mix_text_colour(int(found[1], 16)), svg)


def _mix_text_colour(grey: int) -> str:
    if grey == 255:
        return "var(--jp-layout-color1, white)"  # the background
    return f"color-mix(in srgb, currentColor {100 * (255 - grey) / 255:.0f}%, transparent)"


def _shorten_legend(axes: Axes) -> None:
    """Replace the two entries of each run in a legend with its name, and explain once how medians are drawn."""
    for line, label in zip(*axes.get_legend_handles_labels(), strict=True):
        line.set_label(label.removesuffix(BEST) if label.endswith(BEST) else "_")
    axes.plot([], [], color="0.5", linestyle="--", label="dashed: median")
    add_legend(axes, N_LEGEND_COLUMNS)


def _shorten_text(name: str) -> str:
    return name if len(name) <= MAX_LABEL_LENGTH else f"{name[: MAX_LABEL_LENGTH - 1]}…"
