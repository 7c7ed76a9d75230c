"""What our pictures look like whatever the user's style is, and how they can be read on the Axes of a user."""

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

REAL_TEXT: Any = {"svg.fonttype": "none", "pdf.fonttype": 42, "svg.hashsalt": "walkerlab"}
"""Text that can be searched and edited, and the same picture, byte for byte, every time."""

_LOOK = (
    *("axes.", "axes3d.", "figure.constrained_layout.", "font.s", "font.v", "font.w", "grid.", "hatch.", "image."),
    *("legend.", "lines.", "markers.", "mathtext.", "patch.", "path.", "text.", "xaxis.", "xtick.", "yaxis.", "ytick."),
)
_FONTS = ("font.serif", "font.sans-serif")  # which stay the user's, for a label may need them
_OURS: Any = {
    name: value for name, value in mpl.rcParamsDefault.items() if name.startswith(_LOOK) and name not in _FONTS
} | REAL_TEXT

_ONE_AT_A_TIME = RLock()  # the parameters are the whole process's

P = ParamSpec("P")


@contextmanager
def own_look() -> Generator[None]:
    """Draw as matplotlib does by default, whatever style the user has chosen; one thread at a time."""
    with _ONE_AT_A_TIME:
        before: Any = {name: mpl.rcParams[name] for name in _OURS}
        mpl.rcParams.update(_OURS)
        try:
            yield
        finally:
            mpl.rcParams.update({name: was for name, was in before.items() if mpl.rcParams[name] == _OURS[name]})


class OwnFigure(Figure):
    """A figure that keeps our look when it is drawn, which is when ticks are made."""

    def draw(self, renderer: Any) -> None:
        """Draw it."""
        with own_look():
            super().draw(renderer)

    def savefig(self, fname: Any, **options: Any) -> None:
        """Save it on its own ground, not on the style's."""
        ground: Any = {"facecolor": self.get_facecolor()}
        super().savefig(fname, **(ground | options))


def picture(draw: Callable[P, Axes]) -> Callable[P, Axes]:
    """Give a function that draws on ``ax`` our look where the figure is ours, and refuse Axes that it cannot use."""
    takes = signature(draw)

    @wraps(draw)
    def drawn(*args: P.args, **named: P.kwargs) -> Axes:
        ax: Any = takes.bind(*args, **named).arguments.get("ax")
        if ax is not None and getattr(ax, "name", "") != "rectilinear":
            given = type(ax).__name__
            raise TypeError(f"{draw.__name__} needs plain axes, as of figure.add_subplot(); got {given}")
        if ax is not None and not isinstance(ax.get_figure(root=True), OwnFigure):
            return draw(*args, **named)
        with own_look():
            return draw(*args, **named)

    return drawn


def ink(axes: Axes, strength: float = 1.0) -> tuple[float, float, float]:
    """Mix a colour that can be read on an Axes: 1 is that of its text, 0 that of its ground."""
    grounds: tuple[Any, ...] = (axes.get_facecolor(), axes.figure.get_facecolor(), "white")
    ground = np.array(next(one for one in map(to_rgba, grounds) if one[3] > 0)[:3])
    mixed = ground + strength * (np.array(to_rgba(axes.xaxis.label.get_color())[:3]) - ground)
    return tuple(mixed.clip(0, 1).tolist())


def new_axes(width: float = 7.2, height: float = 4.0) -> Axes:
    """Open a figure [inches] that a notebook shows below its cell, white whatever the notebook's theme is."""
    from matplotlib import pyplot

    look: dict[str, Any] = {"layout": "constrained", "facecolor": "white"}
    return pyplot.figure(FigureClass=OwnFigure, figsize=(width, height), **look).add_subplot()


def paper(width: float, height: float) -> Axes:
    """Open a figure [inches] of our look that nobody shows, for a page."""
    with own_look():
        return OwnFigure(figsize=(width, height), layout="constrained", facecolor="white", dpi=100).add_subplot()
