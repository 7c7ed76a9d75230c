"""The shape of the bare ground, as pure functions of the terrain settings.

x is 0 at the robot's foremost point at the start. Seen from above:

      -2 m       0    1 m                                  16 m          31 m
                       +---------------------------------------------------+ ...    y = 5 m
        +--------+-----+-------------------------------------+             |        y = 3 m
        | pieces       | stairs, hills, gaps; obstacles      |             | plateau
        +--------+-----+-------------------------------------+             |        y = -3 m
                       +---------------------------------------------------+ ...    y = -5 m

Texture pieces and obstacles end at the same x. A plane with neither of them has no edge.
"""

import math
from functools import lru_cache

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.settings.choices import Structure
from walkerlab.settings.terrain import PLACEMENT_AREA, Terrain
from walkerlab.system.randomness import random_stream

ARENA_LENGTH = 30.0  # m of stairs, hills or gaps after the landing
ARENA_WIDTH = 10.0  # m
PLATEAU_LENGTH = 300.0  # m of level ground after the arena, longer than any walk
LANDING_LENGTH = 1.0  # m of level ground without obstacles ahead of the robot's foremost point
FIELD_START = -2.0  # m, x of the first texture pieces; obstacles start after the landing
TRENCH_DEPTH = 0.5  # m, depth of a gap
CELLS_PER_HILL = 8  # cells of the height field per hill_length
N_WAVES = 6  # sine waves that add up to the hills


def slope(terrain: Terrain) -> float:
    """Return the pitch of the ground at the start, in rad; positive is uphill."""
    return math.radians(terrain.incline) if terrain.structure == Structure.incline else 0.0


def ground_height(terrain: Terrain, x: Floats, y: Floats | float = 0.0) -> Floats:
    """Return the height of the bare ground [m] at each x, y [m]; in a gap, the height of its bottom."""
    match terrain.structure:
        case Structure.stairs:
            return terrain.step_height * np.maximum(0.0, np.floor((x - LANDING_LENGTH) / terrain.step_depth) + 1)
        case Structure.gaps:
            start, end = gap_ranges(terrain).T
            index = np.clip(np.searchsorted(start, x, side="right") - 1, 0, len(start) - 1)
            return np.where((start[index] < x) & (x < end[index]), -TRENCH_DEPTH, 0.0)
        case Structure.rough:
            return _interpolate(hill_heights(terrain), x, np.broadcast_to(y, np.shape(x)))
        case _:
            return x * math.tan(slope(terrain))


def arena_bounds(terrain: Terrain) -> Floats:
    """Return the limits of the area in which a walk counts.

    Returns:
        Least and greatest x, y [m], shape (2, 2); infinite where the ground has no edge.
    """
    if terrain.structure in (Structure.stairs, Structure.rough, Structure.gaps):
        return np.array(
            [(-math.inf, -ARENA_WIDTH / 2), (LANDING_LENGTH + ARENA_LENGTH + PLATEAU_LENGTH / 2, ARENA_WIDTH / 2)]
        )
    if terrain.n_pieces or terrain.obstacle:  # so that a robot cannot score by walking around them
        return np.array([(-math.inf, -PLACEMENT_AREA[1] / 2), (math.inf, PLACEMENT_AREA[1] / 2)])
    return np.array([(-math.inf, -math.inf), (math.inf, math.inf)])


def level_stretches(terrain: Terrain) -> Floats:
    """Return the stretches of ground along the walking direction on which pieces and obstacles can be placed.

    A plane, a slope or hilly ground is one stretch. Each tread of the stairs is one, and so is the ground between
    two gaps.

    Returns:
        Start and end of each stretch in the walking direction [m], shape (n, 2).
    """
    start = FIELD_START
    end = FIELD_START + PLACEMENT_AREA[0]
    match terrain.structure:
        case Structure.stairs:
            edges = np.arange(LANDING_LENGTH, end + terrain.step_depth, terrain.step_depth)
            stretches = np.stack([np.concatenate([[start], edges[:-1]]), edges], axis=1)
        case Structure.gaps:
            gap_start, gap_end = gap_ranges(terrain).T
            stretches = np.stack([np.concatenate([[start], gap_end[:-1]]), gap_start], axis=1)
        case _:
            stretches = np.array([[start, end]])
    return np.minimum(stretches[stretches[:, 0] < end], end)


def gap_ranges(terrain: Terrain) -> Floats:
    """Return the start and end of each gap in the walking direction [m], shape (n, 2)."""
    period = terrain.gap_width + terrain.gap_distance
    return LANDING_LENGTH + np.array(
        [(i * period, i * period + terrain.gap_width) for i in range(int(ARENA_LENGTH / period))]
    )


@lru_cache(maxsize=16)
def hill_heights(terrain: Terrain) -> Floats:
    """Generate the hills of rough ground from its seed.

    The hills are a sum of sine waves in random directions, each with a wavelength of about ``hill_length``.

    Returns:
        Heights [m] of the arena, from the landing on, shape (n_y, n_x); empty for any other structure.
    """
    if terrain.structure != Structure.rough:
        return np.empty((0, 0))
    rng = random_stream(terrain.seed, "terrain", 0)
    cell = terrain.hill_length / CELLS_PER_HILL
    x = np.linspace(0, ARENA_LENGTH, round(ARENA_LENGTH / cell) + 1)
    y = np.linspace(-ARENA_WIDTH / 2, ARENA_WIDTH / 2, round(ARENA_WIDTH / cell) + 1)[:, np.newaxis]
    waves = np.zeros((len(y), len(x)))
    directions = rng.permutation(np.arange(N_WAVES) * math.pi / N_WAVES)
    stretches = rng.uniform(0.8, 1.25, N_WAVES)
    phases = rng.uniform(0, math.tau, N_WAVES)
    for direction, stretch, phase in zip(directions, stretches, phases, strict=True):
        wave_number = math.tau / (stretch * terrain.hill_length)
        waves += np.sin(wave_number * (x * math.cos(direction) + y * math.sin(direction)) + phase)
    # Fade to level ground at both ends of the arena.
    waves = (waves - waves.min()) * np.clip(np.minimum(x, ARENA_LENGTH - x) / terrain.hill_length, 0, 1)
    heights = terrain.hill_height * waves / waves.max()
    heights.setflags(write=False)
    return heights


def _interpolate(heights: Floats, x: Floats, y: Floats) -> Floats:
    """Interpolate the height field as MuJoCo does, with two triangles per cell; return 0 outside it."""
    n_y, n_x = heights.shape
    column = np.clip((x - LANDING_LENGTH) / ARENA_LENGTH * (n_x - 1), 0, n_x - 1.000001)
    row = np.clip((y / ARENA_WIDTH + 0.5) * (n_y - 1), 0, n_y - 1.000001)
    i, j = row.astype(np.intp), column.astype(np.intp)
    u, v = row - i, column - j
    corner = np.where(u < v, heights[i, j + 1], heights[i + 1, j])
    return (1 - np.maximum(u, v)) * heights[i, j] + np.abs(u - v) * corner + np.minimum(u, v) * heights[i + 1, j + 1]


def project_onto_ground(terrain: Terrain, spots: Floats, step: Floats | float = 0.02) -> tuple[Floats, Floats]:
    """Return the points of the ground at the given spots, and its normals there.

    Args:
        terrain: Terrain settings.
        spots: Positions along and across the walking direction [m], shape (n, 2).
        step: Distance [m] over which the slope of hilly ground is averaged; one value or shape (n,).

    Returns:
        Points on the ground [m], shape (n, 3), and unit normals, shape (n, 3).
    """
    along, across = spots.T
    pitch = slope(terrain)
    x = along * math.cos(pitch)
    # The offset keeps a spot at the edge of a tread on that tread despite rounding.
    points = np.stack([x, across, ground_height(terrain, x + 1e-9, across)], axis=1)
    if terrain.structure == Structure.rough:
        slope_x = (ground_height(terrain, x + step, across) - ground_height(terrain, x - step, across)) / (2 * step)
        slope_y = (ground_height(terrain, x, across + step) - ground_height(terrain, x, across - step)) / (2 * step)
        normals = np.stack([-slope_x, -slope_y, np.ones_like(x)], axis=1)
        return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return points, np.tile([-math.sin(pitch), 0.0, math.cos(pitch)], (len(spots), 1))
