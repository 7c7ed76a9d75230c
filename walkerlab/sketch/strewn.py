"""What is strewn over the ground, as it is drawn: the pieces of its texture, and what lies about."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from walkerlab.choices import Obstacle
from walkerlab.entities.obstacle import COLOURS, LOG_ASPECT, ROCKS, body_axes
from walkerlab.entities.scenery import HEARTWOOD_COLOUR, LID_COLOUR
from walkerlab.genes import Floats
from walkerlab.layout import PIECE_HEIGHT, compute_layout
from walkerlab.markup import Html, tag
from walkerlab.settings import Terrain
from walkerlab.shapes import BALL, CUBE, N_AROUND, RING, outline
from walkerlab.sketch.lens import RAISED, Lens
from walkerlab.sketch.pen import hue, shape
from walkerlab.sketch.solids import EDGE, box
from walkerlab.sketch.stage import Item, Stage, surface
from walkerlab.textures import MATERIALS

SHADES = 3  # of the pieces of a texture
BANDS = 12  # from far to near, in which pieces are drawn


def pieces(terrain: Terrain, stage: Stage) -> Iterator[Item]:
    """Draw the pieces of the texture that are in sight."""
    spots = compute_layout(terrain).pieces
    shades = np.arange(len(spots)) % SHADES
    seen = _in_sight(spots, stage)
    spots, shades = spots[seen], shades[seen]
    radius, rise = terrain.texture_size / 2 * stage.lens.scale, PIECE_HEIGHT * terrain.texture_size * stage.lens.scale
    flat = RAISED[1, 1] * radius
    nearest, farthest = stage.sides
    bands = np.floor((spots[:, 1] - nearest) / (farthest - nearest) * BANDS)
    for band in np.unique(bands).tolist():
        near = nearest + (farthest - nearest) * band / BANDS
        for number in range(SHADES):
            some = stage.lens.at(spots[(bands == band) & (shades == number)])
            fill = np.clip(np.array(MATERIALS[terrain.texture].piece) * (0.88 + 0.12 * number), 0, 1)
            domes = "".join(
                f"M{x - radius:.1f},{y:.1f}a{radius:.1f},{flat + rise:.1f} 0 0 1 {2 * radius:.1f},0"
                f"a{radius:.1f},{flat:.1f} 0 0 1 {-2 * radius:.1f},0"
                for x, y in some.tolist()
            )
            yield near, tag("path", d=domes, fill=hue(fill), stroke="#000", stroke_opacity=0.25, stroke_width=0.5)


def obstacles(terrain: Terrain, stage: Stage) -> Iterator[Item]:
    """Draw what lies about in sight, each with its shadow."""
    layout = compute_layout(terrain)
    for number in np.flatnonzero(_in_sight(layout.obstacles, stage)).tolist():
        up, size = layout.obstacle_normals[number], float(layout.obstacle_sizes[number])
        frame = body_axes(up, float(layout.obstacle_angles[number])).reshape(2, 3)
        turn = np.stack([*frame, up])
        corners = _corners(terrain.obstacle, number + 1) * size
        low = corners[:, 2].min()
        middle = layout.obstacles[number] - low * up
        points = middle + corners @ turn
        colour = np.array(COLOURS[terrain.obstacle]) * (1 + 0.12 * math.sin(2.4 * (number + 1)))
        drawn = tag("g", *_drawn(terrain.obstacle, points, colour, size, stage.lens), **EDGE)
        yield float(points[:, 1].min()), tag("g", shadow(terrain, points, stage), drawn)


def shadow(terrain: Terrain, points: Floats, stage: Stage) -> Html:
    """Draw what a thing takes of the light from above, on the ground below it."""
    dropped = stage.lens.at(surface(terrain, points[:, 0], points[:, 1]))
    return shape([outline(dropped)], fill="#000", fill_opacity=0.18)


def _in_sight(spots: Floats, stage: Stage) -> NDArray[np.bool_]:
    start, end = stage.reach
    return (
        (stage.sides[0] < spots[:, 1])
        & (spots[:, 1] < stage.sides[1])
        & (start - 1 < spots[:, 0])
        & (spots[:, 0] < end + 1)
    )


def _corners(kind: Obstacle, number: int) -> Floats:
    """Return the (k, 3) corners of an obstacle of size 1 about its middle; those of both ends of what is round."""
    match kind:
        case Obstacle.box:
            return 0.5 * CUBE
        case Obstacle.cylinder:
            return _ENDS * (0.4, 0.4, 0.5)
        case Obstacle.log:
            return (_ENDS * (0.5, 0.5, LOG_ASPECT / 2))[:, [2, 1, 0]]
        case Obstacle.rock:
            return 0.5 * ROCKS[number % len(ROCKS)]
        case _:
            return 0.5 * BALL


def _drawn(kind: Obstacle, points: Floats, colour: Floats, size: float, lens: Lens) -> tuple[Html, ...]:
    """Draw one obstacle by its corners [m]: its outline, and what else tells it from others."""
    seen = lens.at(points)
    middle, radius = seen.mean(axis=0), size / 2 * lens.scale
    whole = shape([outline(seen)], fill=hue(colour))
    match kind:
        case Obstacle.box:
            return (box(points, colour, lens),)
        case Obstacle.cylinder:
            return whole, shape([seen[:N_AROUND]], fill=hue(LID_COLOUR))
        case Obstacle.log:
            nearer = int(points[:N_AROUND].mean(axis=0) @ lens.eye < points[N_AROUND:].mean(axis=0) @ lens.eye)
            return whole, shape([seen[nearer * N_AROUND :][:N_AROUND]], fill=hue(HEARTWOOD_COLOUR))
        case Obstacle.rock:
            top = middle + 0.62 * (outline(seen) - middle) - (0, 0.2 * radius)
            return whole, shape([top], fill="#fff", fill_opacity=0.16, stroke="none")
        case _:
            round_ = shape([middle + radius * RING[:, :2]], fill=hue(colour))
            glint = middle + radius * (0.25 * RING[:, :2] + (0.3, -0.4))
            return round_, shape([glint], fill="#fff", fill_opacity=0.5, stroke="none")


_ENDS = np.concatenate([RING + np.array([0, 0, end]) for end in (1, -1)])
