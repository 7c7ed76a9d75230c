"""The ground as it is drawn: its surface from far to near, and the cut along its near edge."""

from collections.abc import Iterator
from itertools import groupby

import numpy as np

from walkerlab.choices import Structure
from walkerlab.entities.scenery import PATTERNS
from walkerlab.genes import Floats
from walkerlab.ground import ARENA_LENGTH, CELLS_PER_HILL, LANDING, TRENCH_DEPTH, gaps
from walkerlab.markup import Html
from walkerlab.settings import Terrain
from walkerlab.sketch.lens import lit
from walkerlab.sketch.pen import blend, dashes, hue, scattered, shape
from walkerlab.sketch.stage import Item, Stage, surface
from walkerlab.textures import MATERIALS

CELLS = 44  # of hills, along what is seen, at most
ROWS = 12  # of hills, from far to near, at most
EPS = 1e-6  # m to either side of an edge
SPECKS = 1500  # where all of the ground is speckled
BLACK = (0.0, 0.0, 0.0)


def ground(terrain: Terrain, stage: Stage) -> Iterator[Item]:
    """Draw the surface row by row, and last the cut along the near edge."""
    x, y = _cells(terrain, stage)
    for near, far in zip(y[:-1][::-1].tolist(), y[1:][::-1].tolist(), strict=True):
        corners, colours = _row(terrain, x, near, far)
        seen = stage.lens.at(corners[::-1])  # the right ones first: what is to the left hides them
        fills = map(hue, colours[::-1])
        for fill, some in groupby(zip(fills, seen, strict=True), key=lambda pair: pair[0]):
            yield far, shape([outline for _, outline in some], fill=fill, stroke=fill, stroke_width=0.6)
        yield far - EPS, _specks(terrain, stage, near, far)
    material = MATERIALS[terrain.texture]
    nearest = stage.sides[0]
    edge = stage.lens.at(surface(terrain, x, nearest))
    below = np.array([(edge[-1, 0], stage.size[1] + 1), (edge[0, 0], stage.size[1] + 1)])
    yield nearest, shape([np.concatenate([edge, below])], fill=hue(blend(material.dark, BLACK, 0.3)), class_="cut")
    look = {"fill": "none", "stroke": hue(blend(material.dark, BLACK, 0.55)), "stroke_width": 1.2}
    yield nearest, shape([edge], closed=False, **look)


def _cells(terrain: Terrain, stage: Stage) -> tuple[Floats, Floats]:
    """Return where the ground is divided: along the way, both sides of each edge; and across it, from near to far."""
    start, end = stage.reach
    sides, (near, far) = np.array(stage.sides), stage.sides
    along, across = PATTERNS[terrain.texture].square
    match terrain.structure:
        case Structure.stairs:
            edges = np.arange(LANDING, end, terrain.step_depth)
            return _both_sides(start, end, edges), sides
        case Structure.gaps:
            return _both_sides(start, end, gaps(terrain).ravel()), sides
        case Structure.rough:
            cell = max(terrain.hill_length / CELLS_PER_HILL, stage.width / CELLS)
            last = min(end, LANDING + ARENA_LENGTH)
            x = np.concatenate([[start], np.arange(LANDING, last, cell), [last, end]])
            return np.unique(x), np.linspace(near, far, 1 + min(ROWS, max(2, round(np.ptp(sides) / cell))))
        case _:
            return _multiples(start, end, along), _multiples(near, far, across)


def _both_sides(start: float, end: float, edges: Floats) -> Floats:
    inside = edges[(start < edges) & (edges < end)]
    return np.concatenate([[start], np.stack([inside - EPS, inside + EPS], axis=1).ravel(), [end]])


def _multiples(start: float, end: float, step: float) -> Floats:
    """Return the ends, and the multiples of a step between them."""
    inside = np.arange(np.floor(start / step) + 1, np.ceil(end / step)) * step
    return np.concatenate([[start], inside, [end]])


def _row(terrain: Terrain, x: Floats, near: float, far: float) -> tuple[Floats, Floats]:
    """Return (n, 4, 3) corners [m] and (n, 3) colours of the faces of one row of the ground, from left to right."""
    material, (along, across) = MATERIALS[terrain.texture], PATTERNS[terrain.texture].square
    front, back = surface(terrain, x, near), surface(terrain, x, far)
    corners = np.stack([front[:-1], front[1:], back[1:], back[:-1]], axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    middle = corners.mean(axis=1)
    if terrain.structure in (Structure.stairs, Structure.gaps):
        dark = np.arange(len(corners)) // 2 % 2 == 1
    else:
        dark = (np.floor(middle[:, 0] / along) + np.floor(middle[:, 1] / across)) % 2 == 1
    colours = np.where(dark[:, np.newaxis], material.dark, material.light)
    light = lit(normals)
    if terrain.structure == Structure.gaps:  # less light comes into a trench the deeper it is
        light = light * (1 + 0.9 * np.minimum(0.0, middle[:, 2:]) / TRENCH_DEPTH)
    return corners, np.clip(colours * light, 0, 1)


def _specks(terrain: Terrain, stage: Stage, near: float, far: float) -> Html:
    """Draw the grain of the ground, evenly strewn."""
    material, (start, end) = MATERIALS[terrain.texture], stage.reach
    number = np.arange(round(SPECKS * material.speckle_share))
    x = start + (end - start) * scattered(number, 0)
    y = stage.sides[0] + (stage.sides[1] - stage.sides[0]) * scattered(number, 1)
    here = (near <= y) & (y < far)
    spots = surface(terrain, x[here], y[here])
    spots = stage.lens.at(spots[spots[:, 2] > -EPS] if terrain.structure == Structure.gaps else spots)
    return dashes(spots, 2.4, stroke=hue(material.speckle), stroke_width=1.1)
