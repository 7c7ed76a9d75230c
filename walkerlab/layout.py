"""Where everything on a ground is: pieces of its texture, and what lies about, strewn by the terrain's own seed."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.random import Generator

from walkerlab.choices import Obstacle, Structure
from walkerlab.genes import Floats
from walkerlab.ground import FIELD_START, LANDING, height, levels, onto
from walkerlab.randomness import stream
from walkerlab.settings import FIELD, MAX_PIECES, REACH, SPREAD, Terrain

PIECE_HEIGHT = 0.25  # of a piece's width: a flat dome

RASTER = 6  # cells of the raster for each width of a piece, with which its coverage is counted
THROWS = 400  # for each obstacle; what finds no room then is left out
PROBE = 0.01  # m between the places at which hills under an obstacle are looked at, or closer
MAX_RASTER = 2e6  # cells of all; where pieces are so small that there would be more, these are coarser


@dataclass(frozen=True, eq=False)
class Layout:
    """Where everything on a ground is, in m.

    Attributes:
        pieces: (n, 3) where each piece of texture sits on the ground: the middle of its base.
        normals: (n, 3) which way the ground faces there.
        obstacles: (n, 3) where each obstacle stands on the ground.
        upright: (n, 3) which way the ground faces there.
        turns: (n,) how far each is turned about that, rad.
        sizes: (n,) how wide each is.
    """

    pieces: Floats
    normals: Floats
    obstacles: Floats
    upright: Floats
    turns: Floats
    sizes: Floats


@lru_cache(maxsize=16)
def lay_out(terrain: Terrain) -> Layout:
    """Strew pieces and obstacles over a ground, by its seed."""
    pieces, normals = onto(terrain, _strew_pieces(terrain, stream(terrain.seed, "terrain", 1)))
    spots, turns, sizes = _strew_obstacles(terrain, stream(terrain.seed, "terrain", 2))
    reaches = REACH[terrain.obstacle] * sizes
    obstacles, upright = onto(terrain, spots, reaches)
    radius, sunk = dome(terrain)
    for spot, up, reach in zip(obstacles, upright, reaches, strict=True):
        spot += _lift(terrain, spot, up, reach, pieces - sunk * normals, radius) * up
    return Layout(pieces, normals, obstacles, upright, turns, sizes)


def dome(terrain: Terrain) -> tuple[float, float]:
    """Return the radius [m] of the ball of which a piece is the tip, and how deep [m] its middle is in the ground."""
    half, rise = terrain.texture_size / 2, PIECE_HEIGHT * terrain.texture_size
    radius = (half**2 + rise**2) / (2 * rise)
    return radius, radius - rise


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
        slant = np.sqrt(1 - onto(terrain, throws, reach)[1][:, 2] ** 2) * (terrain.structure == Structure.rough)
        width = reach * np.sqrt(1 - slant**2) + 1.2 * size * slant
        apart = np.linalg.norm(throws[:, np.newaxis] - spots[laid], axis=2)
        free = (apart >= width[:, np.newaxis] + widths[laid]).all(axis=1) & (along - width > LANDING - 1e-9)
        if free.any():
            first = int(np.argmax(free))
            spots[n], widths[n], laid[n] = throws[first], width[first], True
    return spots[laid], rng.uniform(-math.pi, math.pi, laid.sum()), sizes[laid]
