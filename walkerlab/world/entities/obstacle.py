"""Loose obstacles: bodies that robots can push; they sleep until something touches them."""

import math
from typing import Any

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.settings.choices import Obstacle
from walkerlab.settings.terrain import Terrain
from walkerlab.world.materials import MATERIALS, RGB
from walkerlab.world.placement import Layout

OBSTACLE_DENSITIES = {
    Obstacle.box: 300,
    Obstacle.ball: 80,
    Obstacle.cylinder: 500,
    Obstacle.rock: 2000,
    Obstacle.log: 500,
}
"""Density [kg/m³] of a crate, a beach ball, a tin, a stone, dry wood."""

OBSTACLE_COLOURS: dict[Obstacle, RGB] = {
    Obstacle.box: (0.72, 0.53, 0.30),
    Obstacle.ball: (0.80, 0.47, 0.65),
    Obstacle.cylinder: (0.00, 0.62, 0.45),
    Obstacle.rock: (0.36, 0.36, 0.39),
    Obstacle.log: (0.42, 0.27, 0.16),
}
LOG_ASPECT = 2.4  # length of a log over its diameter
ROCK_CORNERS = 16
N_ROCK_SHAPES = 5


def add_obstacles(root: Any, terrain: Terrain, layout: Layout) -> None:
    """Add the obstacles to the world, each with a free joint, upright on the ground below it."""
    kind = terrain.obstacle
    material = MATERIALS[terrain.texture]
    placements = zip(
        layout.obstacles, layout.obstacle_normals, layout.obstacle_angles, layout.obstacle_sizes, strict=True
    )
    for i, (spot, normal, angle, size) in enumerate(placements, start=1):
        shape = _obstacle_geom(root, kind, i, size)
        body = root.worldbody.add("body", name=f"obstacle{i}", pos=spot + shape.pop("centre_height") * normal)
        body.xyaxes = body_axes(normal, angle)
        body.sleep = "allowed" if any(terrain.wind) else "init"
        body.add("freejoint", name=f"obstacle{i}")
        colour = np.clip(np.array(OBSTACLE_COLOURS[kind]) * (1 + 0.12 * math.sin(2.4 * i)), 0, 1)
        body.add(
            "geom", name=f"obstacle{i}", density=OBSTACLE_DENSITIES[kind],
            friction=material.friction(size / 2), condim=6, rgba=(*colour, 1), **shape,
        )  # fmt: skip


def body_axes(normal: Floats, angle: float) -> Floats:
    """Return the x and y axes, shape (6,), of a body that stands along a normal and is rotated by an angle [rad]."""
    x = np.array([math.cos(angle), math.sin(angle), 0.0])
    x -= (x @ normal) * normal
    x /= np.linalg.norm(x)
    return np.concatenate([x, np.cross(normal, x)])


def _obstacle_geom(root: Any, kind: Obstacle, number: int, size: float) -> dict[str, Any]:
    """Return the geom attributes of an obstacle of this size [m], and the height of its centre over the ground [m]."""
    half = size / 2
    match kind:
        case Obstacle.ball:
            return {"type": "sphere", "size": [half], "centre_height": half}
        case Obstacle.cylinder:
            return {"type": "cylinder", "size": [0.8 * half, half], "centre_height": half}
        case Obstacle.log:
            size_of_log = [half, LOG_ASPECT * half]
            return {"type": "cylinder", "size": size_of_log, "euler": (0, math.pi / 2, 0), "centre_height": half}
        case Obstacle.rock:
            corners = half * ROCK_SHAPES[number % len(ROCK_SHAPES)]
            mesh = root.asset.add("mesh", name=f"rock{number}", vertex=corners.ravel())
            return {"type": "mesh", "mesh": mesh, "centre_height": -corners[:, 2].min()}
        case _:
            return {"type": "box", "size": [half, half, half], "centre_height": half}


def _rock_corners(number: int) -> Floats:
    """Return the corners of a rock about 2 wide, (16, 3): points on a sphere, some moved inward, and flattened."""
    i = np.arange(ROCK_CORNERS)
    z = 1 - (2 * i + 1) / ROCK_CORNERS
    angle = i * math.pi * (3 - math.sqrt(5))
    radius = 0.85 + 0.25 * np.sin(5 * i + 2 * number)
    ring = np.sqrt(1 - z**2)
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), 0.8 * z], axis=1) * radius[:, np.newaxis]


ROCK_SHAPES = [_rock_corners(number) for number in range(N_ROCK_SHAPES)]
"""Corners of each rock shape, (16, 3), for a rock of width 2."""
