"""Lines and areas as SVG text, in pixels: a point is drawn to a tenth of one, which is as fine as a screen is."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from walkerlab.genes import Floats, Indices
from walkerlab.markup import Html, tag

INK = "currentColor"
"""The colour of the text around a drawing, so that lines are seen on a light page and on a dark one."""


def drawing(size: tuple[float, float], said: str, *content: object, **look: Any) -> Html:
    """Put a drawing together: its size in pixels, and what is seen in words for those who cannot see it."""
    wide, high = (f"{side:g}" for side in size)
    look = {"class_": "wl-sketch", "width": wide, "height": high, "viewBox": f"0 0 {wide} {high}"} | look
    return tag("svg", *content, xmlns="http://www.w3.org/2000/svg", role="img", aria_label=said, **look)


def shape(outlines: Iterable[Floats], *, closed: bool = True, **look: Any) -> Html:
    """Draw any number of outlines, (k, 2) pixels each, as one element of one look."""
    end = "Z" if closed else ""
    return tag("path", d="".join(f"M{_points(outline)}{end}" for outline in outlines), **look)


def dashes(spots: Floats, long: float, **look: Any) -> Html:
    """Draw a level dash at each of (k, 2) spots; a dot, if it is no longer than its pen is thick."""
    return tag(
        "path",
        d="".join(f"M{x - long / 2:.1f},{y:.1f}h{long:g}" for x, y in spots.tolist()),
        stroke_linecap="round",
        **look,
    )


def text(words: object, x: float, y: float, **look: Any) -> Html:
    """Write words at a place."""
    return tag("text", words, x=f"{x:.1f}", y=f"{y:.1f}", **look)


def hue(colour: Sequence[float] | NDArray[Any]) -> str:
    """Write a colour, red, green and blue (and more, which is left out) of 0 to 1 each, as #rrggbb."""
    return "#" + "".join(f"{round(255 * float(part)):02x}" for part in np.clip(colour, 0, 1)[:3])


def blend(one: Sequence[float] | Floats, other: Sequence[float] | Floats, share: float) -> Floats:
    """Mix two colours: 0 is the one, 1 the other."""
    return np.asarray(one)[:3] * (1 - share) + np.asarray(other)[:3] * share


def _points(outline: Floats) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in outline.tolist())


def scattered(number: Indices, axis: int) -> Floats:
    """Return numbers of 0 to 1 that look drawn by chance, and are the same in every drawing."""
    return np.sin(number * (12.9898, 78.233)[axis] + axis) * 43758.5453 % 1
