"""The fitness of one run or several, generation by generation: a picture that grows."""

import io
from collections.abc import Mapping, Sequence
from itertools import count

import ipywidgets
import pandas as pd
from matplotlib.figure import Figure

from walkerlab import plots
from walkerlab.markup import inline_svg, tag

SIZE = (6.4, 3.5)  # inches
MARGINS = {"left": 0.1, "right": 0.985, "bottom": 0.14, "top": 0.86}  # fixed, so that axes do not move as a curve grows


class Curve(ipywidgets.HTML):
    """The fitness curves of runs on one picture."""

    def __init__(self, runs: Mapping[str, pd.DataFrame] | None = None, n_generations: int = 1) -> None:
        """Draw the runs that there are, as ``draw`` does."""
        super().__init__()
        self.add_class("wl-curve")
        self._names = count()
        self.draw(runs or {}, n_generations)

    def draw(self, runs: Mapping[str, pd.DataFrame], n_generations: int = 1, looks: Sequence[int] = ()) -> None:
        """Draw them anew, on whatever thread: it is no picture of pyplot's.

        Args:
            runs: the table of each, by its name.
            n_generations: for how many there is to be room, so that a curve can grow without moving.
            looks: which of the colours and marks each gets, counted from 0; in their order if empty.
        """
        figure = Figure(figsize=SIZE)
        figure.subplots_adjust(**MARGINS)
        axes = figure.add_subplot()
        several = sum(not table.empty for table in runs.values()) > 1
        for look, (name, table) in zip(looks or range(len(runs)), runs.items(), strict=True):
            if not table.empty:
                plots.fitness_curve(table, axes, label=name if several else "", look=look)
                n_generations = max(n_generations, int(table.generation.max()) + 1)
        if not plots.alt_text(axes):
            self.value = tag("p", "Here the fitness curve will grow, generation by generation.", class_="empty")
            return
        axes.set_xlim(-0.02 * n_generations, 1.02 * max(1, n_generations - 1))
        file = io.StringIO()
        figure.savefig(file, format="svg")
        self.value = inline_svg(file.getvalue(), f"curve{next(self._names)}", plots.alt_text(axes))
