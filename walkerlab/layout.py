"""The lie of the land: its shape as pure functions of the settings, and where everything on it is.

    along the way, from above                     x = 0: the robot's foremost point at its start

      -2 m       0    1 m                                  16 m
        +--------+-----+-------------------------------------+   y = 3 m
        | pieces | pieces, obstacles, stairs, hills, gaps    |
        +--------+-----+-------------------------------------+   y = -3 m

Pieces and obstacles are strewn by the terrain's own seed: the same ground for every robot of a run.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.random import Generator

from walkerlab.choices import Obstacle, Structure
from walkerlab.genes import Floats
from walkerlab.randomness import stream
from walkerlab.settings import FIELD, MAX_PIECES, REACH, SPREAD, Terrain

ARENA_LENGTH = 30.0  # m of stairs, hills or gaps ahead of the landing
ARENA_WIDTH = 10.0  # m
PLATEAU = 300.0  # m of level ground after them, more than anyone walks
LANDING = 1.0  # m of level and empty ground ahead of the robot's foremost point
FIELD_START = -2.0  # m, where the first pieces lie; obstacles lie beyond the landing
TRENCH = 0.5  # m, depth of a gap
PIECE_HEIGHT = 0.25  # of a piece's width: a flat dome

CELLS_OF_A_HILL = 8  # of the height field's cells for each hill_length
RASTER = 6  # cells of the raster for each width of a piece, with which its coverage is counted
THROWS = 400  # for each obstacle; what finds no room then is left out
PROBE = 0.01  # m between the places at which hills under an obstacle are looked at, or closer
MAX_RASTER = 2e6  # cells of all; where pieces are so small that there would be more, these are coarser


@dataclass(frozen=True, eq=False)
class Layout:
    """Where everything on a ground is, in m.

    Attributes:
        hills: (n_y, n_x) heights of a rough ground, from the landing on, the arena's length and width; empty elsewhere.
        pieces: (n, 3) where each piece of texture sits on the ground: the middle of its base.
        normals: (n, 3) which way the ground faces there.
        obstacles: (n, 3) where each obstacle stands on the ground.
        upright: (n, 3) which way the ground faces there.
        turns: (n,) how far each is turned about that, rad.
        sizes: (n,) how wide each is.
    """

    hills: Floats
    pieces: Floats
    normals: Floats
    obstacles: Floats
    upright: Floats
    turns: Floats
    sizes: Floats


@lru_cache(maxsize=16)
def lay_out(terrain: Terrain) -> Layout:
    """Strew pieces and obstacles over a ground, by its seed."""
    pieces, normals = _onto(terrain, _strew_pieces(terrain, stream(terrain.seed, "terrain", 1)))
    spots, turns, sizes = _strew_obstacles(terrain, stream(terrain.seed, "terrain", 2))
    reaches = REACH[terrain.obstacle] * sizes
    obstacles, upright = _onto(terrain, spots, reaches)
    radius, sunk = dome(terrain)
    for spot, up, reach in zip(obstacles, upright, reaches, strict=True):
        spot += _lift(terrain, spot, up, reach, pieces - sunk * normals, radius) * up
    return Layout(_hills(terrain), pieces, normals, obstacles, upright, turns, sizes)


def dome(terrain: Terrain) -> tuple[float, float]:
    """Return the radius [m] of the ball of which a piece is the tip, and how deep [m] its middle is in the ground."""
    half, rise = terrain.texture_size / 2, PIECE_HEIGHT * terrain.texture_size
    radius = (half**2 + rise**2) / (2 * rise)
    return radius, radius - rise


# ------------------------------------------------------------------------------------------- the shape of the ground


def slope(terrain: Terrain) -> float:
    """Return the pitch of the ground at the start, in rad; positive is uphill."""
    return math.radians(terrain.incline) if terrain.structure == Structure.incline else 0.0


def height(terrain: Terrain, x: Floats, y: Floats | float = 0.0) -> Floats:
    """Return the height of the bare ground [m] at each x, y [m]; of a trench, that of its bottom."""
    match terrain.structure:
        case Structure.stairs:
            return terrain.step_height * np.maximum(0.0, np.floor((x - LANDING) / terrain.step_depth) + 1)
        case Structure.gaps:
            start, end = _gaps(terrain).T
            number = np.clip(np.searchsorted(start, x, side="right") - 1, 0, len(start) - 1)
            return np.where((start[number] < x) & (x < end[number]), -TRENCH, 0.0)
        case Structure.rough:
            return _interpolate(_hills(terrain), x, np.broadcast_to(y, np.shape(x)))
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
            gaps = _gaps(terrain)
            stretches = np.stack([np.concatenate([[start], gaps[:-1, 1]]), gaps[:, 0]], axis=1)
        case _:
            stretches = np.array([[start, end]])
    return np.minimum(stretches[stretches[:, 0] < end], end)


def _gaps(terrain: Terrain) -> Floats:
    """Return the (n, 2) start and end of each trench along the way [m]."""
    period = terrain.gap_width + terrain.gap_distance
    return LANDING + np.array([(i * period, i * period + terrain.gap_width) for i in range(int(ARENA_LENGTH / period))])


@lru_cache(maxsize=16)
def _hills(terrain: Terrain) -> Floats:
    """Draw the hills of a rough ground: waves of about its ``hill_length`` in random directions, summed."""
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


def _interpolate(hills: Floats, x: Floats, y: Floats) -> Floats:
    """Read the height field between its points, as MuJoCo does: each cell is two triangles; 0 off it."""
    n_y, n_x = hills.shape
    column = np.clip((x - LANDING) / ARENA_LENGTH * (n_x - 1), 0, n_x - 1.000001)
    row = np.clip((y / ARENA_WIDTH + 0.5) * (n_y - 1), 0, n_y - 1.000001)
    i, j = row.astype(np.intp), column.astype(np.intp)
    u, v = row - i, column - j
    corner = np.where(u < v, hills[i, j + 1], hills[i + 1, j])
    return (1 - np.maximum(u, v)) * hills[i, j] + np.abs(u - v) * corner + np.minimum(u, v) * hills[i + 1, j + 1]


def _onto(terrain: Terrain, spots: Floats, step: Floats | float = 0.02) -> tuple[Floats, Floats]:
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


def _lift(terrain: Terrain, spot: Floats, up: Floats, reach: float, balls: Floats, radius: float) -> float:
    """Return how far [m] a round plate of this reach must rise to lie on top of the hills and the pieces under it."""
    lift = 0.0
    if terrain.structure == Structure.rough:
        grid = np.linspace(-1.2 * reach, 1.2 * reach, 2 * math.ceil(max(10, 1.2 * reach / PROBE)) + 1)
        x, y = (values.ravel() for values in np.meshgrid(spot[0] + grid, spot[1] + grid))
        rise, off = _above(np.stack([x, y, height(terrain, x, y)], axis=1) - spot, up)
        lift = PROBE / 5 + float(np.max(rise, where=off <= reach, initial=lift))
    if len(balls):
        rise, off = _above(balls - spot, up)
        beyond = np.minimum(np.maximum(0.0, off - reach), radius)
        lift = float(np.max(rise + np.sqrt(radius**2 - beyond**2), where=beyond < radius, initial=lift))
    return lift


def _above(points: Floats, up: Floats) -> tuple[Floats, Floats]:
    """Return how far (n, 3) points are along an axis, and how far off it, (n,) each."""
    rise = points @ up
    return rise, np.linalg.norm(points - rise[:, np.newaxis] * up, axis=1)


# --------------------------------------------------------------------------------------------------- what lies on it


def _strew_pieces(terrain: Terrain, rng: Generator) -> Floats:
    """Drop round pieces wherever none covers the ground yet, until the wanted part of it is covered.

    Returns:
        (n, 2) their middles along and across the way, each piece whole on one stretch.
    """
    if not terrain.n_pieces:
        return np.empty((0, 2))
    (length, width), radius = FIELD, terrain.texture_size / 2
    cell = max(terrain.texture_size / RASTER, math.sqrt(length * width / MAX_RASTER))
    n_x, n_y = round(length / cell), round(width / cell)
    along, across = FIELD_START + (np.arange(n_x) + 0.5) * cell, -width / 2 + (np.arange(n_y) + 0.5) * cell
    is_ground, is_room = np.zeros(n_x, dtype=bool), np.zeros(n_x, dtype=bool)
    for start, end in levels(terrain):
        margin = min(radius, 0.49 * (end - start))
        is_ground |= (start <= along) & (along < end)
        is_room |= (start + margin <= along) & (along <= end - margin)
    reach = math.ceil(radius / cell)
    offsets = (np.arange(-reach, reach + 1) * cell) ** 2
    disc = offsets[:, np.newaxis] + offsets <= radius**2
    exact = disc.sum() * cell**2 / (math.pi * radius**2)  # a disc of whole cells is a little too large, or too small
    wanted = terrain.texture_density * is_ground.sum() * n_y * exact
    bare = np.pad(np.repeat(is_ground[:, np.newaxis], n_y, axis=1), reach)
    places = np.flatnonzero(is_room[:, np.newaxis] & (np.abs(across) <= width / 2 - radius))
    covered, spots = 0, list[tuple[float, float]]()
    for place in rng.permutation(places):
        i, j = divmod(int(place), n_y)
        if covered >= wanted or len(spots) == MAX_PIECES:
            break
        around = bare[i : i + 2 * reach + 1, j : j + 2 * reach + 1]
        if around[reach, reach]:
            covered += int((around & disc).sum())
            around &= ~disc
            spots.append((along[i], across[j]))
    return np.array(spots).reshape(-1, 2)


def _strew_obstacles(terrain: Terrain, rng: Generator) -> tuple[Floats, Floats, Floats]:
    """Drop obstacles beyond the landing, none within the reach of another, the largest first.

    What leans on a hillside takes more room.

    Returns:
        (n, 2) their middles along and across the way; (n,) their turns, rad; (n,) their sizes, m.
    """
    if terrain.obstacle == Obstacle.none:
        return np.empty((0, 2)), np.empty(0), np.empty(0)
    stretches = np.maximum(levels(terrain), LANDING)
    room = stretches[:, 1] - stretches[:, 0]
    count = round(terrain.obstacle_density * room.sum() * FIELD[1])
    if terrain.structure == Structure.stairs and terrain.n_pieces:  # whose balls show in the faces of stairs
        bulge = dome(terrain)[0] - min(terrain.texture_size / 2, 0.49 * terrain.step_depth)
        stretches[:, 1] -= min(
            bulge, terrain.step_depth - 2 * (1 + SPREAD) * REACH[terrain.obstacle] * terrain.obstacle_size
        )
        room = stretches[:, 1] - stretches[:, 0]
    sizes = np.sort(terrain.obstacle_size * rng.uniform(1 - SPREAD, 1 + SPREAD, count))[::-1]
    spots, widths, laid = np.empty((count, 2)), np.empty(count), np.zeros(count, dtype=bool)
    for n, size in enumerate(sizes):
        reach = REACH[terrain.obstacle] * size
        fits = np.where(room >= 2 * reach, room, 0.0)
        start, end = stretches[rng.choice(len(room), THROWS, p=fits / fits.sum())].T
        along, across = rng.uniform(start + reach, end - reach), rng.uniform(-1, 1, THROWS) * (FIELD[1] / 2 - reach)
        throws = np.stack([along, across], axis=1)
        slant = np.sqrt(1 - _onto(terrain, throws, reach)[1][:, 2] ** 2) * (terrain.structure == Structure.rough)
        width = reach * np.sqrt(1 - slant**2) + 1.2 * size * slant
        apart = np.linalg.norm(throws[:, np.newaxis] - spots[laid], axis=2)
        free = (apart >= width[:, np.newaxis] + widths[laid]).all(axis=1) & (along - width > LANDING - 1e-9)
        if free.any():
            first = int(np.argmax(free))
            spots[n], widths[n], laid[n] = throws[first], width[first], True
    return spots[laid], rng.uniform(-math.pi, math.pi, laid.sum()), sizes[laid]
