"""The ground: its surface row by row from far to near, and its section along the near edge."""

from collections.abc import Iterator
from itertools import groupby
from xml.etree.ElementTree import Element

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.settings.choices import Structure
from walkerlab.settings.terrain import Terrain
from walkerlab.view.sketch.projection import face_brightness
from walkerlab.view.sketch.svg import blend, draw_dashes, draw_path, hex_colour, pseudo_random
from walkerlab.view.sketch.window import DrawnItem, Window, ground_points
from walkerlab.world.entities.scenery import GROUND_PATTERNS
from walkerlab.world.heights import ARENA_LENGTH, CELLS_PER_HILL, LANDING_LENGTH, TRENCH_DEPTH, gap_ranges
from walkerlab.world.materials import MATERIALS

MAX_HILL_COLUMNS = 44  # maximum number of faces along the visible ground
MAX_HILL_ROWS = 12  # maximum number of faces from near to far
EPSILON = 1e-6  # m; to either side of an edge, and between items at the same depth
MAX_SPECKLES = 1500  # number on ground that is completely speckled
BLACK = (0.0, 0.0, 0.0)


def draw_ground(terrain: Terrain, window: Window) -> Iterator[DrawnItem]:
    """Draw the surface row by row, then the section along the near edge."""
    x, y = _grid(terrain, window)
    for near, far in zip(y[:-1][::-1].tolist(), y[1:][::-1].tolist(), strict=True):
        corners, colours = _row_faces(terrain, x, near, far)
        outlines = window.projection.project(corners[::-1])  # from right to left: faces hide those to their right
        fills = map(hex_colour, colours[::-1])
        for fill, faces in groupby(zip(fills, outlines, strict=True), key=lambda pair: pair[0]):
            yield far, draw_path([outline for _, outline in faces], fill=fill, stroke=fill, stroke_width=0.6)
        yield far - EPSILON, _draw_speckles(terrain, window, near, far)
    material = MATERIALS[terrain.texture]
    nearest = window.y_range[0]
    edge = window.projection.project(ground_points(terrain, x, nearest))
    bottom = window.size[1] + 1
    section = np.concatenate([edge, [(edge[-1, 0], bottom), (edge[0, 0], bottom)]])
    yield nearest, draw_path([section], fill=hex_colour(blend(material.dark, BLACK, 0.3)), class_="section")
    edge_colour = hex_colour(blend(material.dark, BLACK, 0.55))
    yield nearest, draw_path([edge], closed=False, fill="none", stroke=edge_colour, stroke_width=1.2)


def _grid(terrain: Terrain, window: Window) -> tuple[Floats, Floats]:
    """Return the x and the y [m] at which the ground is divided into faces, ascending.

    At the edges of steps and gaps, x has a value on either side.
    """
    start, end = window.x_range
    near, far = window.y_range
    square_length, square_width = GROUND_PATTERNS[terrain.texture].square
    match terrain.structure:
        case Structure.stairs:
            edges = np.arange(LANDING_LENGTH, end, terrain.step_depth)
            return _both_sides(start, end, edges), np.array([near, far])
        case Structure.gaps:
            return _both_sides(start, end, gap_ranges(terrain).ravel()), np.array([near, far])
        case Structure.rough:
            cell = max(terrain.hill_length / CELLS_PER_HILL, window.width_m / MAX_HILL_COLUMNS)
            last = min(end, LANDING_LENGTH + ARENA_LENGTH)
            x = np.concatenate([[start], np.arange(LANDING_LENGTH, last, cell), [last, end]])
            n_rows = min(MAX_HILL_ROWS, max(2, round((far - near) / cell)))
            return np.unique(x), np.linspace(near, far, n_rows + 1)
        case _:
            return _multiples_between(start, end, square_length), _multiples_between(near, far, square_width)


def _both_sides(start: float, end: float, edges: Floats) -> Floats:
    """Return both ends, and a point before and after each edge between them."""
    inside = edges[(start < edges) & (edges < end)]
    return np.concatenate([[start], np.stack([inside - EPSILON, inside + EPSILON], axis=1).ravel(), [end]])


def _multiples_between(start: float, end: float, step: float) -> Floats:
    """Return both ends, and the multiples of a step between them."""
    inside = np.arange(np.floor(start / step) + 1, np.ceil(end / step)) * step
    return np.concatenate([[start], inside, [end]])


def _row_faces(terrain: Terrain, x: Floats, near: float, far: float) -> tuple[Floats, Floats]:
    """Return the faces of one row of the ground, from left to right.

    Returns:
        Corners of each face [m], shape (n, 4, 3), and its colour, shape (n, 3).
    """
    material = MATERIALS[terrain.texture]
    square_length, square_width = GROUND_PATTERNS[terrain.texture].square
    front = ground_points(terrain, x, near)
    back = ground_points(terrain, x, far)
    corners = np.stack([front[:-1], front[1:], back[1:], back[:-1]], axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    centres = corners.mean(axis=1)
    if terrain.structure in (Structure.stairs, Structure.gaps):
        is_dark = np.arange(len(corners)) // 2 % 2 == 1
    else:
        is_dark = (np.floor(centres[:, 0] / square_length) + np.floor(centres[:, 1] / square_width)) % 2 == 1
    colours = np.where(is_dark[:, np.newaxis], material.dark, material.light)
    light = face_brightness(normals)
    if terrain.structure == Structure.gaps:  # deeper faces receive less light
        light = light * (1 + 0.9 * np.minimum(0.0, centres[:, 2:]) / TRENCH_DEPTH)
    return corners, np.clip(colours * light, 0, 1)


def _draw_speckles(terrain: Terrain, window: Window, near: float, far: float) -> Element:
    """Draw the evenly distributed speckles of the ground between two y [m]."""
    material = MATERIALS[terrain.texture]
    start, end = window.x_range
    nearest, farthest = window.y_range
    indices = np.arange(round(MAX_SPECKLES * material.speckle_share))
    x = start + (end - start) * pseudo_random(indices, 0)
    y = nearest + (farthest - nearest) * pseudo_random(indices, 1)
    is_here = (near <= y) & (y < far)
    points = ground_points(terrain, x[is_here], y[is_here])
    if terrain.structure == Structure.gaps:
        points = points[points[:, 2] > -EPSILON]
    centres = window.projection.project(points)
    return draw_dashes(centres, 2.4, stroke=hex_colour(material.speckle), stroke_width=1.1)
