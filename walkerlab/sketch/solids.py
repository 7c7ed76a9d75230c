"""Solid bodies as they are drawn: an area of one colour with a thin edge, and a box by the sides that are seen."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from walkerlab.genes import Floats
from walkerlab.markup import Html, tag
from walkerlab.shapes import CUBE, ROPE_POINTS, outline
from walkerlab.sketch.lens import Lens, lit
from walkerlab.sketch.pen import hue, shape

EDGE: dict[str, Any] = {"stroke": "#1a1a1a", "stroke_width": 0.6, "stroke_linejoin": "round"}


def figure(parts: Sequence[tuple[Floats, Floats]], lens: Lens) -> Html:
    """Draw a robot and its loads, the far side first.

    Args:
        parts: as ``skins`` lays them out.
        lens: how they are seen.
    """
    ordered = sorted(parts, key=lambda part: -part[0][:, 1].mean())
    return tag("g", *(_part(points, colour[:3], lens) for points, colour in ordered), class_="robot", **EDGE)


def _part(points: Floats, colour: Floats, lens: Lens) -> Html:
    if len(points) == ROPE_POINTS:
        return shape([lens.at(points)], closed=False, stroke=hue(colour), stroke_width=1.5)
    if len(points) == len(CUBE):
        return box(points, colour, lens)
    return shape([outline(lens.at(points))], fill=hue(colour))


def box(corners: Floats, colour: Floats, lens: Lens) -> Html:
    """Draw a box.

    Args:
        corners: (24, 3) four of each side, as in ``CUBE`` [m].
        colour: (3,) of its top.
        lens: how it is seen.
    """
    sides = corners.reshape(-1, 4, 3)
    normals = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    seen = normals @ lens.eye > 1e-9
    fills = colour * lit(normals[seen])
    return tag("g", *(shape([lens.at(side)], fill=hue(fill)) for side, fill in zip(sides[seen], fills, strict=True)))
