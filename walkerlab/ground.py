"""The shape of the ground, as pure functions of the settings; what lies on it is for ``layout``.

x is 0 at the robot's foremost point at its start. Seen from above, along the way:

      -2 m       0    1 m                                  16 m          31 m
                       +---------------------------------------------------+ ...    y = 5 m
        +--------+-----+-------------------------------------+             |        y = 3 m
        | pieces       | stairs, hills, gaps; obstacles      |             | plateau
        +--------+-----+-------------------------------------+             |        y = -3 m
                       +---------------------------------------------------+ ...    y = -5 m

Pieces lie as far as obstacles do; on a plane without either, there is no edge.
"""

import math
from functools import lru_cache

import numpy as np

from walkerlab.choices import Structure
from walkerlab.genes import Floats
from walkerlab.randomness import stream
from walkerlab.settings import FIELD, Terrain

ARENA_LENGTH = 30.0  # m of stairs, hills or gaps ahead of the landing
ARENA_WIDTH = 10.0  # m
PLATEAU = 300.0  # m of level ground after them, more than anyone walks
LANDING = 1.0  # m of level and empty ground ahead of the robot's foremost point
FIELD_START = -2.0  # m, where the first pieces lie; obstacles lie beyond the landing
TRENCH = 0.5  # m, depth of a gap
CELLS_OF_A_HILL = 8  # of the height field's cells for each hill_length


def slope(terrain: Terrain) -> float:
    """Return the pitch of the ground at the start, in rad; positive is uphill."""
    return math.radians(terrain.incline) if terrain.structure == Structure.incline else 0.0


def height(terrain: Terrain, x: Floats, y: Floats | float = 0.0) -> Floats:
    """Return the height of the bare ground [m] at each x, y [m]; of a trench, that of its bottom."""
    match terrain.structure:
        case Structure.stairs:
            return terrain.step_height * np.maximum(0.0, np.floor((x - LANDING) / terrain.step_depth) + 1)
        case Structure.gaps:
            start, end = gaps(terrain).T
            number = np.clip(np.searchsorted(start, x, side="right") - 1, 0, len(start) - 1)
            return np.where((start[number] < x) & (x < end[number]), -TRENCH, 0.0)
        case Structure.rough:
            return _interpolate(hills(terrain), x, np.broadcast_to(y, np.shape(x)))
        case _:
            return x * math.tan(slope(terrain))


def bounds(terrain: Terrain) -> Floats:
    """Return the least and the greatest x and y [m] of the ground that is built, (2, 2); a bare plane has no end."""
    if terrain.structure in (Structure.stairs, Structure.rough, Structure.gaps):
        return np.array([(-math.inf, -ARENA_WIDTH / 2), (LANDING + ARENA_LENGTH + PLATEAU / 2, ARENA_WIDTH / 2)])
    if terrain.n_pieces or terrain.obstacle:  # to walk round what is strewn is no art
        return np.array([(-math.inf, -FIELD[1] / 2), (math.inf, FIELD[1] / 2)])
    return np.array([(-math.inf, -math.inf), (math.inf, math.inf)])


def levels(terrain: Terrain) -> Floats:
    """Return where each stretch of ground that pieces and obstacles can lie on begins and ends along the way [m].

    Returns:
        (n, 2): a plane, a slope and hills are one stretch; a tread is one, and so is the ground between two gaps.
    """
    start, end = FIELD_START, FIELD_START + FIELD[0]
    match terrain.structure:
        case Structure.stairs:
            edges = np.arange(LANDING, end + terrain.step_depth, terrain.step_depth)
            stretches = np.stack([np.concatenate([[start], edges[:-1]]), edges], axis=1)
        case Structure.gaps:
            begin, until = gaps(terrain).T
            stretches = np.stack([np.concatenate([[start], until[:-1]]), begin], axis=1)
        case _:
            stretches = np.array([[start, end]])
    return np.minimum(stretches[stretches[:, 0] < end], end)


def gaps(terrain: Terrain) -> Floats:
    """Return the (n, 2) start and end of each trench along the way [m]."""
    period = terrain.gap_width + terrain.gap_distance
    return LANDING + np.array([(i * period, i * period + terrain.gap_width) for i in range(int(ARENA_LENGTH / period))])


@lru_cache(maxsize=16)
def hills(terrain: Terrain) -> Floats:
    """Draw the hills of a rough ground by its seed: waves of about its ``hill_length`` in random directions, summed.

    Returns:
        (n_y, n_x) heights [m], from the landing on, the arena's length and width; empty for any other ground.
    """
    if terrain.structure != Structure.rough:
        return np.empty((0, 0))
    rng, cell = stream(terrain.seed, "terrain", 0), terrain.hill_length / CELLS_OF_A_HILL
    x = np.linspace(0, ARENA_LENGTH, round(ARENA_LENGTH / cell) + 1)
    y = np.linspace(-ARENA_WIDTH / 2, ARENA_WIDTH / 2, round(ARENA_WIDTH / cell) + 1)[:, np.newaxis]
    waves = np.zeros((len(y), len(x)))
    for turn, stretch, phase in zip(
        rng.permutation(np.arange(6) * math.pi / 6), rng.uniform(0.8, 1.25, 6), rng.uniform(0, math.tau, 6), strict=True
    ):
        number = math.tau / (stretch * terrain.hill_length)
        waves += np.sin(number * (x * math.cos(turn) + y * math.sin(turn)) + phase)
    waves = (waves - waves.min()) * np.clip(np.minimum(x, ARENA_LENGTH - x) / terrain.hill_length, 0, 1)
    heights = terrain.hill_height * waves / waves.max()
    heights.setflags(write=False)
    return heights


def _interpolate(heights: Floats, x: Floats, y: Floats) -> Floats:
    """Read the height field between its points, as MuJoCo does: each cell is two triangles; 0 off it."""
    n_y, n_x = heights.shape
    column = np.clip((x - LANDING) / ARENA_LENGTH * (n_x - 1), 0, n_x - 1.000001)
    row = np.clip((y / ARENA_WIDTH + 0.5) * (n_y - 1), 0, n_y - 1.000001)
    i, j = row.astype(np.intp), column.astype(np.intp)
    u, v = row - i, column - j
    corner = np.where(u < v, heights[i, j + 1], heights[i + 1, j])
    return (1 - np.maximum(u, v)) * heights[i, j] + np.abs(u - v) * corner + np.minimum(u, v) * heights[i + 1, j + 1]


def onto(terrain: Terrain, spots: Floats, step: Floats | float = 0.02) -> tuple[Floats, Floats]:
    """Put (n, 2) spots along and across the way onto the ground.

    Returns:
        (n, 3) where they are; (n, 3) which way the ground faces there, on the whole, within a step [m] around.
    """
    along, across = spots.T
    pitch = slope(terrain)
    x = along * math.cos(pitch)
    # Just inside an edge, floats must not fall off it.
    points = np.stack([x, across, height(terrain, x + 1e-9, across)], axis=1)
    if terrain.structure == Structure.rough:
        up_x = (height(terrain, x + step, across) - height(terrain, x - step, across)) / (2 * step)
        up_y = (height(terrain, x, across + step) - height(terrain, x, across - step)) / (2 * step)
        normals = np.stack([-up_x, -up_y, np.ones_like(x)], axis=1)
        return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return points, np.tile([-math.sin(pitch), 0.0, math.cos(pitch)], (len(spots), 1))
