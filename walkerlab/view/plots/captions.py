"""Captions below plots: a few sentences that explain how to read the plot, with its main numbers."""

import textwrap
from typing import Any

from matplotlib.axes import Axes

from walkerlab.view.plots.appearance import foreground_colour
from walkerlab.view.plots.style import SECONDARY_STRENGTH, escape_label

FONT_SIZE = 9  # points
MEAN_CHARACTER_WIDTH = 0.54  # as a fraction of the font size
MIN_CHARACTERS = 30  # minimum number of characters in a line
GAP = 8  # points between the plot and its caption
POINTS_PER_INCH = 72


def add_caption(axes: Axes, text: str) -> None:
    """Write a caption below the label of the horizontal axis, or below the Axes if it has no label.

    Args:
        axes: Axes with the finished plot.
        text: Caption; it is wrapped at the width of the Axes.
    """
    figure = axes.get_figure(root=True)
    if figure is not None and (engine := figure.get_layout_engine()):
        engine.execute(figure)  # the labels of the vertical axis decide how wide the Axes is
    width = axes.get_window_extent().width / axes.figure.dpi * POINTS_PER_INCH
    n_characters = max(MIN_CHARACTERS, int(width / (MEAN_CHARACTER_WIDTH * FONT_SIZE)))
    below: Any = axes.xaxis.label if axes.get_xlabel() else axes.transAxes
    axes.annotate(
        textwrap.fill(escape_label(text).replace(" %", "\N{NO-BREAK SPACE}%"), n_characters),
        (0, 0),
        xycoords=(axes.transAxes, below),
        xytext=(0, -GAP),
        textcoords="offset points",
        va="top",
        ha="left",
        size=FONT_SIZE,
        color=foreground_colour(axes, SECONDARY_STRENGTH),
        annotation_clip=False,
    )
