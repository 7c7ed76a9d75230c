"""Objects on the ground: the pieces of its texture and the loose obstacles."""

import math
from collections.abc import Iterator
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats
from walkerlab.settings.choices import Obstacle
from walkerlab.settings.terrain import Terrain
from walkerlab.view.sketch.projection import RAISED_VIEW, Projection
from walkerlab.view.sketch.solids import EDGE_STYLE, draw_box
from walkerlab.view.sketch.svg import draw_path, hex_colour, make_element
from walkerlab.view.sketch.window import DrawnItem, Window, ground_points
from walkerlab.world.entities.obstacle import LOG_ASPECT, OBSTACLE_COLOURS, ROCK_SHAPES, body_axes
from walkerlab.world.entities.scenery import HEARTWOOD_COLOUR, LID_COLOUR
from walkerlab.world.geometry import N_AROUND, UNIT_BALL, UNIT_CUBE, UNIT_RING, convex_outline
from walkerlab.world.materials import MATERIALS
from walkerlab.world.placement import PIECE_HEIGHT, compute_layout

N_SHADES = 3  # shades of the colour of texture pieces
N_DEPTH_BANDS = 12  # pieces in one band are drawn as one item
VIEW_MARGIN = 1.0  # m beyond the visible ground, to draw obstacles that are partly visible


def draw_pieces(terrain: Terrain, window: Window) -> Iterator[DrawnItem]:
    """Draw the visible pieces of the texture as flat domes."""
    bases = compute_layout(terrain).pieces
    shades = np.arange(len(bases)) % N_SHADES
    is_visible = _is_visible(bases, window)
    bases = bases[is_visible]
    shades = shades[is_visible]
    scale = window.projection.scale
    radius = terrain.texture_size / 2 * scale
    rise = PIECE_HEIGHT * terrain.texture_size * scale
    base_height = RAISED_VIEW[1, 1] * radius
    nearest, farthest = window.y_range
    bands = np.floor((bases[:, 1] - nearest) / (farthest - nearest) * N_DEPTH_BANDS)
    for band in np.unique(bands).tolist():
        band_y = nearest + (farthest - nearest) * band / N_DEPTH_BANDS
        for shade in range(N_SHADES):
            centres = window.projection.project(bases[(bands == band) & (shades == shade)])
            fill = np.clip(np.array(MATERIALS[terrain.texture].piece) * (0.88 + 0.12 * shade), 0, 1)
            domes = "".join(
                f"M{x - radius:.1f},{y:.1f}a{radius:.1f},{base_height + rise:.1f} 0 0 1 {2 * radius:.1f},0"
                f"a{radius:.1f},{base_height:.1f} 0 0 1 {-2 * radius:.1f},0"
                for x, y in centres.tolist()
            )
            style: dict[str, Any] = {
                "fill": hex_colour(fill),
                "stroke": "#000",
                "stroke_opacity": 0.25,
                "stroke_width": 0.5,
            }
            yield band_y, make_element("path", d=domes, **style)


def draw_obstacles(terrain: Terrain, window: Window) -> Iterator[DrawnItem]:
    """Draw the visible obstacles, each with its shadow."""
    layout = compute_layout(terrain)
    for index in np.flatnonzero(_is_visible(layout.obstacles, window)).tolist():
        number = index + 1  # as in the simulated world
        up = layout.obstacle_normals[index]
        size = float(layout.obstacle_sizes[index])
        x_axis, y_axis = body_axes(up, float(layout.obstacle_angles[index])).reshape(2, 3)
        corners = _unit_corners(terrain.obstacle, number) * size
        centre = layout.obstacles[index] - corners[:, 2].min() * up
        points = centre + corners @ np.stack([x_axis, y_axis, up])
        colour = np.array(OBSTACLE_COLOURS[terrain.obstacle]) * (1 + 0.12 * math.sin(2.4 * number))
        drawn = make_element(
            "g", *_draw_obstacle(terrain.obstacle, points, colour, size, window.projection), **EDGE_STYLE
        )
        yield float(points[:, 1].min()), make_element("g", draw_shadow(terrain, points, window), drawn)


def draw_shadow(terrain: Terrain, points: Floats, window: Window) -> Element:
    """Draw the shadow of a body on the ground vertically below it.

    Args:
        terrain: Terrain on which the shadow falls.
        points: Points [m] whose convex hull is the body, shape (k, 3).
        window: Visible section of the world.
    """
    shadow = window.projection.project(ground_points(terrain, points[:, 0], points[:, 1]))
    return draw_path([convex_outline(shadow)], fill="#000", fill_opacity=0.18)


def _is_visible(points: Floats, window: Window) -> NDArray[np.bool_]:
    """Return whether each point, (n, 3) [m], is on or close to the visible ground, shape (n,)."""
    start, end = window.x_range
    near, far = window.y_range
    x = points[:, 0]
    y = points[:, 1]
    return (near < y) & (y < far) & (start - VIEW_MARGIN < x) & (x < end + VIEW_MARGIN)


def _unit_corners(kind: Obstacle, number: int) -> Floats:
    """Return the corners (k, 3) of an obstacle of size 1 about its centre; for round obstacles, points on the surface.

    The points of a cylinder or log are the points of one end, then of the other.
    """
    match kind:
        case Obstacle.box:
            return 0.5 * UNIT_CUBE
        case Obstacle.cylinder:
            return _CYLINDER_ENDS * (0.4, 0.4, 0.5)
        case Obstacle.log:
            return (_CYLINDER_ENDS * (0.5, 0.5, LOG_ASPECT / 2))[:, [2, 1, 0]]
        case Obstacle.rock:
            return 0.5 * ROCK_SHAPES[number % len(ROCK_SHAPES)]
        case _:
            return 0.5 * UNIT_BALL


def _draw_obstacle(
    kind: Obstacle, points: Floats, colour: Floats, size: float, projection: Projection
) -> tuple[Element, ...]:
    """Draw the outline of one obstacle and the details of its kind.

    Args:
        kind: Kind of obstacle.
        points: Corners [m], in the order of ``_unit_corners``, shape (k, 3).
        colour: Colour, shape (3,).
        size: Size [m].
        projection: Projection of the drawing.
    """
    projected = projection.project(points)
    centre = projected.mean(axis=0)
    radius = size / 2 * projection.scale
    silhouette = draw_path([convex_outline(projected)], fill=hex_colour(colour))
    first_end, second_end = slice(None, N_AROUND), slice(N_AROUND, 2 * N_AROUND)
    match kind:
        case Obstacle.box:
            return (draw_box(points, colour, projection),)
        case Obstacle.cylinder:
            return silhouette, draw_path([projected[first_end]], fill=hex_colour(LID_COLOUR))
        case Obstacle.log:
            depth = points @ projection.to_viewer
            nearer_end = second_end if depth[first_end].mean() < depth[second_end].mean() else first_end
            return silhouette, draw_path([projected[nearer_end]], fill=hex_colour(HEARTWOOD_COLOUR))
        case Obstacle.rock:
            top = centre + 0.62 * (convex_outline(projected) - centre) - (0, 0.2 * radius)
            return silhouette, draw_path([top], fill="#fff", fill_opacity=0.16, stroke="none")
        case _:
            circle = draw_path([centre + radius * UNIT_RING[:, :2]], fill=hex_colour(colour))
            highlight = centre + radius * (0.25 * UNIT_RING[:, :2] + (0.3, -0.4))
            return circle, draw_path([highlight], fill="#fff", fill_opacity=0.5, stroke="none")


_CYLINDER_ENDS = np.concatenate([UNIT_RING + np.array([0, 0, z]) for z in (1, -1)])
