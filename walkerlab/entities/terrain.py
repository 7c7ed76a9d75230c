"""The ground: a level plane, an incline, or stairs."""

import math
from typing import Any

import numpy as np
from dm_control import composer

from walkerlab.genes import Floats
from walkerlab.settings import Structure, Terrain

ARENA_LENGTH = 30.0  # m of stairs ahead of the landing
PLATEAU = 300.0  # m of level ground after the last stair, more than anyone walks
ARENA_WIDTH = 10.0  # m
LANDING = 1.0  # m of level ground ahead of the robot's nose before the first stair
FRICTION = (0.9, 0.01, 0.001)  # sliding, torsional [m], rolling [m]: rubber feet on a sports floor

LIGHT, DARK = (0.87, 0.88, 0.84, 1), (0.79, 0.81, 0.77, 1)


class Ground(composer.Arena):
    """The ground that all robots of a run walk on, forward being +x; it decides the friction of what touches it.

    Seen from the side, robots walking to the right:

        flat ______________   incline ___---‾‾‾   stairs ____┌──┌──┌──
    """

    def _build(self, terrain: Terrain, *, scenery: bool = False, name: str = "ground") -> None:
        super()._build(name=name)
        root = self._mjcf_root
        root.option.gravity = terrain.gravity
        root.option.cone = "pyramidal"
        root.option.noslip_iterations = 0
        root.default.geom.friction = FRICTION
        root.default.geom.priority = 1
        root.worldbody.add(
            "geom", name="plane", type="plane", size=(0, 0, 1), euler=(0, -slope(terrain), 0), rgba=LIGHT
        )
        if terrain.structure == Structure.stairs:
            self._lay_stairs(terrain.step_height, terrain.step_depth)
        if scenery:
            self._add_scenery()

    def _lay_stairs(self, rise: float, tread: float) -> None:
        """Lay slabs, each a tread deep and thick enough to reach into the one below."""
        thick = rise + 0.02
        count = math.ceil(ARENA_LENGTH / tread)
        for i in range(1, count + 1):
            depth = tread if i < count else PLATEAU
            self._mjcf_root.worldbody.add(
                "geom",
                name=f"stair{i}",
                type="box",
                size=(depth / 2, ARENA_WIDTH / 2, thick / 2),
                pos=(LANDING + (i - 1) * tread + depth / 2, 0, i * rise - thick / 2),
                rgba=DARK if i % 2 else LIGHT,
            )

    def _add_scenery(self) -> None:
        """Add what only eyes need: a sky, squares of 1 m on the plane, and a sun that casts shadows."""
        root: Any = self._mjcf_root
        root.statistic.extent, root.statistic.center = 3, (6, 0, 0)
        root.visual.map.znear, root.visual.map.zfar, root.visual.map.shadowclip = 0.01, 50, 4
        root.visual.quality.shadowsize = 4096
        root.visual.rgba.haze = (0.95, 0.96, 0.98, 1)
        root.asset.add(
            "texture", name="sky", type="skybox", builtin="gradient",
            rgb1=(0.95, 0.96, 0.98), rgb2=(0.55, 0.72, 0.88), width=256, height=256,
        )  # fmt: skip
        squares = root.asset.add(
            "texture",
            name="squares",
            type="2d",
            builtin="checker",
            rgb1=LIGHT[:3],
            rgb2=DARK[:3],
            width=256,
            height=256,
        )
        paint = root.asset.add("material", name="squares", texture=squares, texrepeat=(0.5, 0.5), texuniform="true")
        plane = root.find("geom", "plane")
        plane.material, plane.rgba = paint, None
        root.worldbody.add(
            "light", name="sun", directional="true", castshadow="true",
            pos=(6, 0, 10), dir=(0.2, 0.4, -1), diffuse=(0.5, 0.5, 0.5), specular=(0.1, 0.1, 0.1),
        )  # fmt: skip


def slope(terrain: Terrain) -> float:
    """Return the pitch of the ground at the start, in rad; positive is uphill."""
    return math.radians(terrain.incline) if terrain.structure == Structure.incline else 0.0


def height(terrain: Terrain, x: Floats) -> Floats:
    """Return the height of the ground [m] along the middle of the way, at each x [m]."""
    if terrain.structure == Structure.stairs:
        return terrain.step_height * np.maximum(0, np.floor((x - LANDING) / terrain.step_depth) + 1)
    return x * math.tan(slope(terrain))


def bounds(terrain: Terrain) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the least and the greatest (x, y) in m of the ground that is built; a plane has no end."""
    if terrain.structure != Structure.stairs:
        return (-math.inf, -math.inf), (math.inf, math.inf)
    return (-math.inf, -ARENA_WIDTH / 2), (LANDING + ARENA_LENGTH + PLATEAU / 2, ARENA_WIDTH / 2)


def generate_terrain(terrain: Terrain, *, scenery: bool = False) -> Ground:
    """Build the ground that these settings describe.

    Args:
        terrain: the settings.
        scenery: whether to add what only eyes need.
    """
    return Ground(terrain, scenery=scenery)
