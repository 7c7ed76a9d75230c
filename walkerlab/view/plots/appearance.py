"""Figures in the style of walkerlab, regardless of the user's style, and colours that suit the user's Axes."""

from collections.abc import Callable, Generator
from contextlib import contextmanager
from functools import wraps
from inspect import signature
from threading import RLock
from typing import Any, ParamSpec

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

REPRODUCIBLE_TEXT: Any = {"svg.fonttype": "none", "pdf.fonttype": 42, "svg.hashsalt": "walkerlab"}
"""Parameters that keep text searchable and editable, and make the files of equal plots equal byte for byte."""

_STYLE_PREFIXES = (
    *("axes.", "axes3d.", "figure.constrained_layout.", "font.s", "font.v", "font.w", "grid.", "hatch.", "image."),
    *("legend.", "lines.", "markers.", "mathtext.", "patch.", "path.", "text.", "xaxis.", "xtick.", "yaxis.", "ytick."),
)
_FONT_LISTS = ("font.serif", "font.sans-serif")  # remain as the user has set them: labels may need these fonts
_STYLE: Any = {
    name: value
    for name, value in mpl.rcParamsDefault.items()
    if name.startswith(_STYLE_PREFIXES) and name not in _FONT_LISTS
} | REPRODUCIBLE_TEXT

_STYLE_LOCK = RLock()  # matplotlib has one set of parameters for all threads

P = ParamSpec("P")


@contextmanager
def walkerlab_style() -> Generator[None]:
    """Use the default style of matplotlib within the block, regardless of the user's style; one thread at a time."""
    with _STYLE_LOCK:
        before: Any = {name: mpl.rcParams[name] for name in _STYLE}
        mpl.rcParams.update(_STYLE)
        try:
            yield
        finally:
            unchanged = [name for name in before if mpl.rcParams[name] == _STYLE[name]]
            mpl.rcParams.update({name: before[name] for name in unchanged})


class StyledFigure(Figure):
    """Figure that is drawn in the style of walkerlab, including the ticks, which matplotlib creates while drawing."""

    def draw(self, renderer: Any) -> None:
        """Draw the figure in the style of walkerlab."""
        with walkerlab_style():
            super().draw(renderer)

    def savefig(self, fname: Any, **options: Any) -> None:
        """Save the figure with its own background colour rather than the current style's."""
        background: Any = {"facecolor": self.get_facecolor()}
        super().savefig(fname, **(background | options))


def styled_plot(draw: Callable[P, Axes]) -> Callable[P, Axes]:
    """Decorate a plotting function: check its argument ``ax``, and apply the style of walkerlab to new figures.

    Figures that the user has created keep the user's style.
    """
    parameters = signature(draw)

    @wraps(draw)
    def draw_styled(*args: P.args, **named: P.kwargs) -> Axes:
        ax: Any = parameters.bind(*args, **named).arguments.get("ax")
        if ax is not None and getattr(ax, "name", "") != "rectilinear":
            given = type(ax).__name__
            raise TypeError(f"{draw.__name__} requires plain Axes, as returned by figure.add_subplot(); got {given}")
        if ax is not None and not isinstance(ax.get_figure(root=True), StyledFigure):
            return draw(*args, **named)
        with walkerlab_style():
            return draw(*args, **named)

    return draw_styled


def foreground_colour(axes: Axes, strength: float = 1.0) -> tuple[float, float, float]:
    """Return a colour between the background colour and the text colour of an Axes.

    Args:
        axes: Axes to draw on.
        strength: 0 for the background colour, 1 for the text colour.
    """
    candidates: tuple[Any, ...] = (axes.get_facecolor(), axes.figure.get_facecolor(), "white")
    background = np.array(next(rgba for rgba in map(to_rgba, candidates) if rgba[3] > 0)[:3])
    text = np.array(to_rgba(axes.xaxis.label.get_color())[:3])
    mixed = background + strength * (text - background)
    return tuple(mixed.clip(0, 1).tolist())


def new_axes(width: float = 7.2, height: float = 4.0) -> Axes:
    """Create a pyplot figure, which a notebook shows below its cell; it is white in any notebook theme.

    Args:
        width: Width of the figure [inches].
        height: Height of the figure [inches].
    """
    from matplotlib import pyplot

    options: dict[str, Any] = {"layout": "constrained", "facecolor": "white"}
    return pyplot.figure(FigureClass=StyledFigure, figsize=(width, height), **options).add_subplot()


def offscreen_axes(width: float, height: float) -> Axes:
    """Create a figure in the style of walkerlab that pyplot does not manage, for files and pages.

    Args:
        width: Width of the figure [inches].
        height: Height of the figure [inches].
    """
    with walkerlab_style():
        return StyledFigure(figsize=(width, height), layout="constrained", facecolor="white", dpi=100).add_subplot()
