"""How every picture looks: its colours, its Axes and how it is saved."""

from typing import TYPE_CHECKING

from matplotlib.axes import Axes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RUNS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Colours of runs, in turn: those of Okabe and Ito that are dark enough for a line on white."""


def save(axes: Axes, *paths: str) -> None:
    """Save the figure of an Axes; text stays text in SVG, so that it can be searched and edited."""
    import matplotlib as mpl

    figure: Figure = axes.figure  # type: ignore[assignment]
    with mpl.rc_context({"svg.fonttype": "none"}):
        for path in paths:
            figure.savefig(path, dpi=150)


def new_axes() -> Axes:
    """Open a figure that a notebook shows below its cell."""
    from matplotlib import pyplot

    return pyplot.figure(figsize=(7.2, 4.0), layout="constrained").add_subplot()
