"""The fitness of one run or several, generation by generation: a picture that grows."""

import base64
import io
import math
from collections.abc import Mapping, Sequence
from itertools import count
from typing import Any

import ipywidgets
import pandas as pd
from matplotlib.figure import Figure

from walkerlab.text.html import Html, inline_svg, tag
from walkerlab.view import plots
from walkerlab.view.plots.style import MAX_LEGEND_COLUMNS
from walkerlab.view.plots.tables import fitness_label
from walkerlab.view.snapshots import LIVE_STYLE, WHITE, HasSnapshot

SIZE = (6.4, 3.5)  # inches
MARGINS = {"left": 0.14, "right": 0.985, "bottom": 0.14}  # fixed, so that axes do not move as a curve grows
_NAMES = count()  # of all drawings, for no two on a page may share an id
LONGEST = 18  # characters of a name in the key; the list of runs has it whole
LINE = 0.055  # of the height, for each line of the key above the axes
LIVE = tag("style", Html(LIVE_STYLE))
EMPTY = "margin: auto; padding: 0 10%; text-align: center"


class Curve(HasSnapshot, ipywidgets.HTML):
    """The fitness curves of runs, with Axes for each measure of fitness."""

    title = "fitness curve"

    def __init__(self, runs: Mapping[str, pd.DataFrame] | None = None, n_generations: int = 1) -> None:
        """Draw the runs that there are, as ``draw`` does."""
        super().__init__(layout={"max_width": "720px", "width": "100%"})
        self.add_class("wl-curve")
        self.draw(runs or {}, n_generations)

    def draw(self, runs: Mapping[str, pd.DataFrame], n_generations: int = 1, looks: Sequence[int] = ()) -> None:
        """Draw them anew, on any thread: pyplot is not used. Runs that measure different things get Axes of their own.

        Args:
            runs: the table of each, by its name.
            n_generations: for how many there is to be room, so that a curve can grow without moving.
            looks: which of the colours and marks each gets, counted from 0; in their order if empty.
        """
        groups: dict[str, list[tuple[int, str, pd.DataFrame]]] = {}
        for look, (name, table) in zip(looks or range(len(runs)), runs.items(), strict=True):
            if not table.empty:
                groups.setdefault(fitness_label(table), []).append((look, _brief(name), table))
                n_generations = max(n_generations, int(table.generation.max()) + 1)
        self._figure, self._alt = None, ""
        if not groups:
            empty = tag("p", "Here the fitness curve will grow, generation by generation.", style=EMPTY)
            self.value = tag("div", empty, LIVE, style=_sheet(1))
            return
        figure = Figure(figsize=(SIZE[0], SIZE[1] * len(groups)))
        panels: Any = figure.subfigures(len(groups), 1, squeeze=False).ravel()
        n_runs = sum(map(len, groups.values()))
        words: list[str] = []
        for panel, group in zip(panels, groups.values(), strict=True):
            n_lines = 2 * math.ceil(len(group) / MAX_LEGEND_COLUMNS) if n_runs > 1 else 1
            panel.subplots_adjust(**MARGINS, top=0.97 - LINE * n_lines)
            axes = panel.add_subplot()
            for look, name, table in group:
                plots.fitness_curve(table, axes, label=name if n_runs > 1 else "", look=look)
            axes.set_xlim(-0.02 * n_generations, 1.02 * max(1, n_generations - 1))
            words.append(plots.alt_text(axes))
        file = io.StringIO()
        figure.savefig(file, format="svg")
        self._figure, self._alt = figure, " ".join(words)
        picture = inline_svg(file.getvalue(), f"curve{next(_NAMES)}", self._alt)
        self.value = tag("div", picture, LIVE, style=_sheet(len(groups)))

    def snapshot(self) -> Html:
        """Write the picture as static HTML: as PNG, the size of which does not grow with the curve."""
        if not self._figure:
            return tag("p", "No generation was done yet.")
        file = io.BytesIO()
        self._figure.savefig(file, format="png", dpi=100)
        url = f"data:image/png;base64,{base64.b64encode(file.getvalue()).decode()}"
        return tag("img", src=url, alt=self._alt, style=WHITE)


def _sheet(n_pictures: int) -> str:
    shape = f"aspect-ratio: {SIZE[0]} / {SIZE[1] * n_pictures}"
    return f"{shape}; background: white; border-radius: 6px; color: #555; display: grid"


def _brief(name: str) -> str:
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"
