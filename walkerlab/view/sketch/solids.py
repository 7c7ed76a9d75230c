"""Drawings of solid bodies: each an area of one colour with a thin edge; for a box, its visible faces."""

from collections.abc import Sequence
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.view.sketch.projection import Projection, face_brightness
from walkerlab.view.sketch.svg import draw_path, hex_colour, make_element
from walkerlab.world.geometry import ROPE_POINTS, UNIT_CUBE, convex_outline

EDGE_STYLE: dict[str, Any] = {"stroke": "#1a1a1a", "stroke_width": 0.6, "stroke_linejoin": "round"}


def draw_solids(parts: Sequence[tuple[Floats, Floats]], projection: Projection) -> Element:
    """Draw a robot and its loads, the most distant part first.

    Args:
        parts: Points and colour of each part, as returned by ``surface_points``.
        projection: Projection of the drawing.
    """
    back_to_front = sorted(parts, key=lambda part: -part[0][:, 1].mean())
    drawn = (_draw_solid(points, colour[:3], projection) for points, colour in back_to_front)
    return make_element("g", *drawn, class_="robot", **EDGE_STYLE)


def _draw_solid(points: Floats, colour: Floats, projection: Projection) -> Element:
    if len(points) == ROPE_POINTS:
        return draw_path([projection.project(points)], closed=False, stroke=hex_colour(colour), stroke_width=1.5)
    if len(points) == len(UNIT_CUBE):
        return draw_box(points, colour, projection)
    return draw_path([convex_outline(projection.project(points))], fill=hex_colour(colour))


def draw_box(corners: Floats, colour: Floats, projection: Projection) -> Element:
    """Draw the visible faces of a box.

    Args:
        corners: Four corners of each face [m], in the order of ``UNIT_CUBE``, shape (24, 3).
        colour: Colour of a level face, shape (3,).
        projection: Projection of the drawing.
    """
    faces = corners.reshape(-1, 4, 3)
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    is_visible = normals @ projection.to_viewer > 1e-9
    fills = colour * face_brightness(normals[is_visible])
    drawn = (
        draw_path([projection.project(face)], fill=hex_colour(fill))
        for face, fill in zip(faces[is_visible], fills, strict=True)
    )
    return make_element("g", *drawn)
