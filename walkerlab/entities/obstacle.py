"""What lies about on the ground: loose bodies, asleep until something touches them."""

import math
from typing import Any

import numpy as np

from walkerlab.choices import Obstacle
from walkerlab.genes import Floats
from walkerlab.layout import Layout
from walkerlab.settings import Terrain
from walkerlab.textures import MATERIALS, RGB

DENSITY = {Obstacle.box: 300, Obstacle.ball: 80, Obstacle.cylinder: 500, Obstacle.rock: 2000, Obstacle.log: 500}
"""kg/m³: a crate, a beach ball, a tin, a stone, dry wood."""

COLOUR: dict[Obstacle, RGB] = {
    Obstacle.box: (0.72, 0.53, 0.30),
    Obstacle.ball: (0.80, 0.47, 0.65),
    Obstacle.cylinder: (0.00, 0.62, 0.45),
    Obstacle.rock: (0.36, 0.36, 0.39),
    Obstacle.log: (0.42, 0.27, 0.16),
}
LOG = 2.4  # length of a log, in its thickness


def add_obstacles(root: Any, terrain: Terrain, layout: Layout) -> None:
    """Lay the obstacles on the ground, each with a free joint, standing as the ground does where it is."""
    kind, material = terrain.obstacle, MATERIALS[terrain.texture]
    spots = zip(layout.obstacles, layout.upright, layout.turns, layout.sizes, strict=True)
    for i, (spot, up, turn, size) in enumerate(spots, start=1):
        shape = _shape(root, kind, i, size)
        body = root.worldbody.add("body", name=f"obstacle{i}", pos=spot + shape.pop("lift") * up)
        body.xyaxes = axes_of(up, turn)
        body.sleep = "allowed" if any(terrain.wind) else "init"
        body.add("freejoint", name=f"obstacle{i}")
        body.add(
            "geom", name=f"obstacle{i}", density=DENSITY[kind], friction=material.friction(size / 2), condim=6,
            rgba=(*np.clip(np.array(COLOUR[kind]) * (1 + 0.12 * math.sin(2.4 * i)), 0, 1), 1), **shape,
        )  # fmt: skip


def axes_of(up: Floats, turn: float) -> Floats:
    """Lay the x and the y axis of what stands on a slope and is turned."""
    x = np.array([math.cos(turn), math.sin(turn), 0.0])
    x -= (x @ up) * up
    x /= np.linalg.norm(x)
    return np.concatenate([x, np.cross(up, x)])


def _shape(root: Any, kind: Obstacle, number: int, size: float) -> dict[str, Any]:
    """Say how a geom of this kind and size [m] is made, and how far its middle is above what it lies on."""
    half = size / 2
    match kind:
        case Obstacle.ball:
            return {"type": "sphere", "size": [half], "lift": half}
        case Obstacle.cylinder:
            return {"type": "cylinder", "size": [0.8 * half, half], "lift": half}
        case Obstacle.log:
            return {"type": "cylinder", "size": [half, LOG * half], "euler": (0, math.pi / 2, 0), "lift": half}
        case Obstacle.rock:
            corners = half * ROCKS[number % len(ROCKS)]
            mesh = root.asset.add("mesh", name=f"rock{number}", vertex=corners.ravel())
            return {"type": "mesh", "mesh": mesh, "lift": -corners[:, 2].min()}
        case _:
            return {"type": "box", "size": [half, half, half], "lift": half}


def _rock(number: int) -> Floats:
    """Return the 16 corners of a stone about 2 wide: a ball's, some pushed in, and flattened."""
    i = np.arange(16)
    z = 1 - (2 * i + 1) / 16
    around = i * math.pi * (3 - math.sqrt(5))
    far = 0.85 + 0.25 * np.sin(5 * i + 2 * number)
    ring = np.sqrt(1 - z**2)
    return np.stack([ring * np.cos(around), ring * np.sin(around), 0.8 * z], axis=1) * far[:, np.newaxis]


ROCKS = [_rock(number) for number in range(5)]
