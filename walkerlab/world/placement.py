"""Positions of texture pieces and loose obstacles on the ground, drawn with the terrain's own seed."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.random import Generator

from walkerlab.ga.genes import Floats
from walkerlab.settings.choices import Obstacle, Structure
from walkerlab.settings.terrain import MAX_PIECES, OBSTACLE_REACH, OBSTACLE_SIZE_SPREAD, PLACEMENT_AREA, Terrain
from walkerlab.system.randomness import random_stream
from walkerlab.world.heights import FIELD_START, LANDING_LENGTH, ground_height, level_stretches, project_onto_ground

PIECE_HEIGHT = 0.25  # height of a texture piece, a flat dome, as a share of its width

CELLS_PER_PIECE = 6  # grid cells across a piece, for measuring the coverage
MAX_CELLS = 2e6  # grid cells in total; the grid is coarser if small pieces would require more
TRIES_PER_OBSTACLE = 400  # random positions; an obstacle is left out if all of them are occupied
PROBE_SPACING = 0.01  # m, greatest distance between the points at which the hills under an obstacle are sampled
MAX_MARGIN = 0.49  # share of a stretch that is kept free at each of its ends


@dataclass(frozen=True, eq=False)
class Layout:
    """Positions of everything that lies on the ground.

    Attributes:
        pieces: Centre of the base of each texture piece [m], shape (n_pieces, 3).
        piece_normals: Unit normal of the ground at each piece, shape (n_pieces, 3).
        obstacles: Point on which each obstacle stands [m], shape (n_obstacles, 3).
        obstacle_normals: Unit normal of the ground at each obstacle, shape (n_obstacles, 3).
        obstacle_angles: Rotation of each obstacle about its normal [rad], shape (n_obstacles,).
        obstacle_sizes: Width of each obstacle [m], shape (n_obstacles,).
    """

    pieces: Floats
    piece_normals: Floats
    obstacles: Floats
    obstacle_normals: Floats
    obstacle_angles: Floats
    obstacle_sizes: Floats


@lru_cache(maxsize=16)
def compute_layout(terrain: Terrain) -> Layout:
    """Scatter texture pieces and obstacles over the ground; the same seed gives the same layout."""
    spots = _scatter_pieces(terrain, random_stream(terrain.seed, "terrain", 1))
    pieces, piece_normals = project_onto_ground(terrain, spots)
    spots, angles, sizes = _scatter_obstacles(terrain, random_stream(terrain.seed, "terrain", 2))
    reaches = OBSTACLE_REACH[terrain.obstacle] * sizes
    obstacles, normals = project_onto_ground(terrain, spots, reaches)
    radius, depth = dome_sphere(terrain)
    spheres = pieces - depth * piece_normals
    for spot, normal, reach in zip(obstacles, normals, reaches, strict=True):
        spot += _clearance(terrain, spot, normal, reach, spheres, radius) * normal
    return Layout(pieces, piece_normals, obstacles, normals, angles, sizes)


def dome_sphere(terrain: Terrain) -> tuple[float, float]:
    """Return the radius of the sphere whose cap is a texture piece, and the depth of its centre, in m."""
    half = terrain.texture_size / 2
    cap_height = PIECE_HEIGHT * terrain.texture_size
    radius = (half**2 + cap_height**2) / (2 * cap_height)
    return radius, radius - cap_height


def _clearance(
    terrain: Terrain, spot: Floats, normal: Floats, reach: float, spheres: Floats, sphere_radius: float
) -> float:
    """Return how far an obstacle must be raised to stand on top of the hills and texture pieces below it.

    Args:
        terrain: Terrain settings.
        spot: Point on the ground [m], shape (3,).
        normal: Unit normal of the ground, shape (3,).
        reach: Radius [m] of the disc that represents the obstacle's base.
        spheres: Centres of the spheres of all pieces [m], shape (n, 3).
        sphere_radius: Radius of these spheres [m].

    Returns:
        Distance along the normal [m], 0 or more.
    """
    clearance = 0.0
    if terrain.structure == Structure.rough:
        grid = np.linspace(-1.2 * reach, 1.2 * reach, 2 * math.ceil(max(10, 1.2 * reach / PROBE_SPACING)) + 1)
        x, y = (values.ravel() for values in np.meshgrid(spot[0] + grid, spot[1] + grid))
        along, off = _axis_coordinates(np.stack([x, y, ground_height(terrain, x, y)], axis=1) - spot, normal)
        clearance = PROBE_SPACING / 5 + float(np.max(along, where=off <= reach, initial=clearance))
    if len(spheres):
        along, off = _axis_coordinates(spheres - spot, normal)
        beyond = np.minimum(np.maximum(0.0, off - reach), sphere_radius)
        tops = along + np.sqrt(sphere_radius**2 - beyond**2)
        clearance = float(np.max(tops, where=beyond < sphere_radius, initial=clearance))
    return clearance


def _axis_coordinates(points: Floats, axis: Floats) -> tuple[Floats, Floats]:
    """Return the coordinate of (n, 3) points along a unit axis and their distance from it, shape (n,) each."""
    along = points @ axis
    return along, np.linalg.norm(points - along[:, np.newaxis] * axis, axis=1)


def _scatter_pieces(terrain: Terrain, rng: Generator) -> Floats:
    """Add round pieces at random bare spots until the requested share of the ground is covered.

    Returns:
        Centres along and across the walking direction [m], shape (n, 2); each piece lies on one stretch of ground.
    """
    if not terrain.n_pieces:
        return np.empty((0, 2))
    length, width = PLACEMENT_AREA
    radius = terrain.texture_size / 2
    cell = max(terrain.texture_size / CELLS_PER_PIECE, math.sqrt(length * width / MAX_CELLS))
    n_x, n_y = round(length / cell), round(width / cell)
    along = FIELD_START + (np.arange(n_x) + 0.5) * cell
    across = -width / 2 + (np.arange(n_y) + 0.5) * cell
    is_ground = np.zeros(n_x, dtype=bool)
    is_allowed = np.zeros(n_x, dtype=bool)
    for start, end in level_stretches(terrain):
        margin = min(radius, MAX_MARGIN * (end - start))
        is_ground |= (start <= along) & (along < end)
        is_allowed |= (start + margin <= along) & (along <= end - margin)
    reach = math.ceil(radius / cell)
    offsets = (np.arange(-reach, reach + 1) * cell) ** 2
    disc = offsets[:, np.newaxis] + offsets <= radius**2
    disc_ratio = disc.sum() * cell**2 / (math.pi * radius**2)  # area of the disc of cells over the area of the circle
    wanted = terrain.texture_density * is_ground.sum() * n_y * disc_ratio
    bare = np.pad(np.repeat(is_ground[:, np.newaxis], n_y, axis=1), reach)
    candidates = np.flatnonzero(is_allowed[:, np.newaxis] & (np.abs(across) <= width / 2 - radius))
    covered = 0
    spots: list[tuple[float, float]] = []
    for candidate in rng.permutation(candidates):
        i, j = divmod(int(candidate), n_y)
        if covered >= wanted or len(spots) == MAX_PIECES:
            break
        around = bare[i : i + 2 * reach + 1, j : j + 2 * reach + 1]
        if around[reach, reach]:
            covered += int((around & disc).sum())
            around &= ~disc
            spots.append((along[i], across[j]))
    return np.array(spots).reshape(-1, 2)


def _scatter_obstacles(terrain: Terrain, rng: Generator) -> tuple[Floats, Floats, Floats]:
    """Place obstacles at random after the landing, the largest first, without overlap.

    An obstacle on a hillside is tilted and occupies a wider circle.

    Returns:
        Centres along and across the walking direction [m], shape (n, 2); rotations [rad], shape (n,); widths [m], shape
        (n,).
    """
    if terrain.obstacle == Obstacle.none:
        return np.empty((0, 2)), np.empty(0), np.empty(0)
    stretches = np.maximum(level_stretches(terrain), LANDING_LENGTH)
    lengths = stretches[:, 1] - stretches[:, 0]
    count = round(terrain.obstacle_density * lengths.sum() * PLACEMENT_AREA[1])
    if terrain.structure == Structure.stairs and terrain.n_pieces:
        # The spheres of the pieces on the next tread protrude from its riser.
        bulge = dome_sphere(terrain)[0] - min(terrain.texture_size / 2, MAX_MARGIN * terrain.step_depth)
        largest = 2 * (1 + OBSTACLE_SIZE_SPREAD) * OBSTACLE_REACH[terrain.obstacle] * terrain.obstacle_size
        stretches[:, 1] -= min(bulge, terrain.step_depth - largest)
        lengths = stretches[:, 1] - stretches[:, 0]
    sizes = np.sort(terrain.obstacle_size * rng.uniform(1 - OBSTACLE_SIZE_SPREAD, 1 + OBSTACLE_SIZE_SPREAD, count))[
        ::-1
    ]
    spots = np.empty((count, 2))
    radii = np.empty(count)  # radius of the circle that each obstacle occupies
    is_placed = np.zeros(count, dtype=bool)
    for n, size in enumerate(sizes):
        reach = OBSTACLE_REACH[terrain.obstacle] * size
        weights = np.where(lengths >= 2 * reach, lengths, 0.0)
        start, end = stretches[rng.choice(len(lengths), TRIES_PER_OBSTACLE, p=weights / weights.sum())].T
        along = rng.uniform(start + reach, end - reach)
        across = rng.uniform(-1, 1, TRIES_PER_OBSTACLE) * (PLACEMENT_AREA[1] / 2 - reach)
        tries = np.stack([along, across], axis=1)
        if terrain.structure == Structure.rough:
            tilt = np.sqrt(1 - project_onto_ground(terrain, tries, reach)[1][:, 2] ** 2)  # sine of the angle
        else:
            tilt = np.zeros(TRIES_PER_OBSTACLE)
        radius = reach * np.sqrt(1 - tilt**2) + 1.2 * size * tilt
        distances = np.linalg.norm(tries[:, np.newaxis] - spots[is_placed], axis=2)
        is_free = (distances >= radius[:, np.newaxis] + radii[is_placed]).all(axis=1)
        is_free &= along - radius > LANDING_LENGTH - 1e-9
        if is_free.any():
            first = int(np.argmax(is_free))
            spots[n] = tries[first]
            radii[n] = radius[first]
            is_placed[n] = True
    return spots[is_placed], rng.uniform(-math.pi, math.pi, is_placed.sum()), sizes[is_placed]
