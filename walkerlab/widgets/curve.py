"""The fitness of one run or several, generation by generation: a picture that grows."""

import base64
import io
import math
from collections.abc import Mapping, Sequence
from itertools import count

import ipywidgets
import pandas as pd
from matplotlib.figure import Figure

from walkerlab import plots
from walkerlab.markup import Html, inline_svg, tag
from walkerlab.plots.style import COLUMNS
from walkerlab.snapshots import LIVE_STYLE, WHITE, HasSnapshot

SIZE = (6.4, 3.5)  # inches
MARGINS = {"left": 0.1, "right": 0.985, "bottom": 0.14}  # fixed, so that axes do not move as a curve grows
_NAMES = count()  # of all drawings, for no two on a page may share an id
LONGEST = 18  # characters of a name in the key; the list of runs has it whole
LINE = 0.055  # of the height, for each line of the key above the axes
SHEET = f"aspect-ratio: {SIZE[0]} / {SIZE[1]}; background: white; border-radius: 6px; color: #555; display: grid"
LIVE = tag("style", Html(LIVE_STYLE))
EMPTY = "margin: auto; padding: 0 10%; text-align: center"


class Curve(HasSnapshot, ipywidgets.HTML):
    """The fitness curves of runs on one picture."""

    title = "fitness curve"

    def __init__(self, runs: Mapping[str, pd.DataFrame] | None = None, n_generations: int = 1) -> None:
        """Draw the runs that there are, as ``draw`` does."""
        super().__init__(layout={"max_width": "720px", "width": "100%"})
        self.add_class("wl-curve")
        self.draw(runs or {}, n_generations)

    def draw(self, runs: Mapping[str, pd.DataFrame], n_generations: int = 1, looks: Sequence[int] = ()) -> None:
        """Draw them anew, on whatever thread: it is no picture of pyplot's.

        Args:
            runs: the table of each, by its name.
            n_generations: for how many there is to be room, so that a curve can grow without moving.
            looks: which of the colours and marks each gets, counted from 0; in their order if empty.
        """
        figure = Figure(figsize=SIZE)
        axes = figure.add_subplot()
        n_runs = sum(not table.empty for table in runs.values())
        n_lines = 2 * math.ceil(n_runs / COLUMNS) if n_runs > 1 else 1
        figure.subplots_adjust(**MARGINS, top=0.97 - LINE * n_lines)
        for look, (name, table) in zip(looks or range(len(runs)), runs.items(), strict=True):
            if not table.empty:
                plots.fitness_curve(table, axes, label=_brief(name) if n_runs > 1 else "", look=look)
                n_generations = max(n_generations, int(table.generation.max()) + 1)
        self._axes = axes
        if not plots.alt_text(axes):
            empty = tag("p", "Here the fitness curve will grow, generation by generation.", style=EMPTY)
            self.value = tag("div", empty, LIVE, style=SHEET)
            return
        axes.set_xlim(-0.02 * n_generations, 1.02 * max(1, n_generations - 1))
        file = io.StringIO()
        figure.savefig(file, format="svg")
        picture = inline_svg(file.getvalue(), f"curve{next(_NAMES)}", plots.alt_text(axes))
        self.value = tag("div", picture, LIVE, style=SHEET)

    def snapshot(self) -> Html:
        """Write the picture as static HTML: as PNG, the size of which does not grow with the curve."""
        axes = self._axes
        if not plots.alt_text(axes):
            return tag("p", "No generation was done yet.")
        file = io.BytesIO()
        figure = axes.get_figure(root=True)
        assert figure
        figure.savefig(file, format="png", dpi=100)
        url = f"data:image/png;base64,{base64.b64encode(file.getvalue()).decode()}"
        return tag("img", src=url, alt=plots.alt_text(axes), style=WHITE)


def _brief(name: str) -> str:
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"
