"""SVG elements with coordinates in pixels, rounded to a tenth of a pixel."""

from collections.abc import Iterable, Sequence
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats, Indices

TEXT_COLOUR = "currentColor"
"""Colour of the text around a drawing; lines of this colour are visible on both light and dark pages."""

HASH_FACTORS = (12.9898, 78.233)  # customary shader hash: fract(sin(x · factor) · 43758.5453)


def make_element(name: str, *children: Element, text: str | None = None, **attributes: object) -> Element:
    """Create an element.

    Args:
        name: Name of the element.
        children: Elements inside it.
        text: Text inside it.
        attributes: Attributes, such as ``class_="robot"`` or ``stroke_width=0.6``.
    """
    element = Element(name, {key.rstrip("_").replace("_", "-"): str(value) for key, value in attributes.items()})
    element.text = text
    element.extend(children)
    return element


def write_image(size: tuple[float, float], label: str, *content: Element, **attributes: Any) -> str:
    """Return the text of a complete SVG image.

    Args:
        size: Width and height [pixels].
        label: Description for screen readers.
        content: Elements of the image.
        attributes: Additional attributes of the ``svg`` element.
    """
    width, height = (f"{side:g}" for side in size)
    attributes = {
        "xmlns": "http://www.w3.org/2000/svg",
        "role": "img",
        "aria_label": label,
        "class_": "wl-sketch",
        "width": width,
        "height": height,
        "viewBox": f"0 0 {width} {height}",
    } | attributes
    image = make_element("svg", *content, **attributes)
    return ElementTree.tostring(image, encoding="unicode", short_empty_elements=False)


def draw_path(outlines: Iterable[Floats], *, closed: bool = True, **attributes: Any) -> Element:
    """Draw any number of outlines as one ``path`` element.

    Args:
        outlines: Corners of each outline [pixels], shape (k, 2).
        closed: Whether to join the last corner to the first.
        attributes: Attributes of the element.
    """
    end = "Z" if closed else ""
    return make_element("path", d="".join(f"M{_coordinates(outline)}{end}" for outline in outlines), **attributes)


def draw_dashes(centres: Floats, length: float, **attributes: Any) -> Element:
    """Draw a horizontal dash with round ends at each point; a dash shorter than its stroke width is a dot.

    Args:
        centres: Centres of the dashes [pixels], shape (k, 2).
        length: Length of each dash [pixels].
        attributes: Attributes of the element.
    """
    return make_element(
        "path",
        d="".join(f"M{x - length / 2:.1f},{y:.1f}h{length:g}" for x, y in centres.tolist()),
        stroke_linecap="round",
        **attributes,
    )


def draw_text(text: str, x: float, y: float, **attributes: Any) -> Element:
    """Draw text with its baseline at a point [pixels]."""
    return make_element("text", text=text, x=f"{x:.1f}", y=f"{y:.1f}", **attributes)


def hex_colour(colour: Sequence[float] | NDArray[Any]) -> str:
    """Return an RGB or RGBA colour with components from 0 to 1 as ``#rrggbb``; alpha is ignored."""
    return "#" + "".join(f"{round(255 * float(component)):02x}" for component in np.clip(colour, 0, 1)[:3])


def blend(first: Sequence[float] | Floats, second: Sequence[float] | Floats, share: float) -> Floats:
    """Mix two colours; a share of 0 gives the first, 1 the second."""
    return np.asarray(first)[:3] * (1 - share) + np.asarray(second)[:3] * share


def pseudo_random(indices: Indices, axis: int) -> Floats:
    """Return numbers from 0 to 1 that look random but are the same in every drawing.

    Args:
        indices: Index of each number, shape (n,).
        axis: 0 or 1; selects one of two independent sequences.
    """
    return np.sin(indices * HASH_FACTORS[axis] + axis) * 43758.5453 % 1


def _coordinates(outline: Floats) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in outline.tolist())
