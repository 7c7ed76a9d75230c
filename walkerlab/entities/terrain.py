"""The ground: a level plane, an incline, or stairs."""

import math

from dm_control import composer

from walkerlab.settings import Structure, Terrain

ARENA_LENGTH = 30.0  # m, ahead of the start
ARENA_WIDTH = 10.0  # m
LANDING = 1.0  # m of level ground ahead of the robot's nose before the first stair
FRICTION = (0.9, 0.01, 0.001)  # sliding, torsional [m], rolling [m]: rubber feet on a sports floor


class Ground(composer.Arena):
    """The ground that all robots of a run walk on, forward being +x; its geoms decide the friction of what they meet.

        flat ______________   incline ___---‾‾‾   stairs ____┌──┌──┌──
    """

    def _build(self, terrain: Terrain, name: str = "ground") -> None:
        super()._build(name=name)
        root = self._mjcf_root
        root.option.gravity = terrain.gravity
        root.default.geom.friction = FRICTION
        pitch = math.radians(terrain.incline) if terrain.structure == Structure.incline else 0.0
        plane = root.worldbody.add(
            "geom", name="plane", type="plane", size=(0, 0, 1), euler=(0, -pitch, 0), rgba=(0.78, 0.80, 0.76, 1)
        )
        self._ground = [plane]
        if terrain.structure == Structure.stairs:
            self._ground += self._stairs(terrain.step_height, terrain.step_depth)
        for geom in self._ground:
            geom.priority = 1

    def _stairs(self, rise: float, tread: float) -> list[object]:
        """Lay slabs, each a tread deep and thick enough to reach into the one below."""
        count = math.ceil(ARENA_LENGTH / tread)
        thick = rise + 0.02
        shades = ((0.70, 0.72, 0.70, 1), (0.78, 0.80, 0.76, 1))
        return [
            self._mjcf_root.worldbody.add(
                "geom",
                name=f"stair{i}",
                type="box",
                size=(tread / 2, ARENA_WIDTH / 2, thick / 2),
                pos=(LANDING + (i - 0.5) * tread, 0, i * rise - thick / 2),
                rgba=shades[i % 2],
            )
            for i in range(1, count + 1)
        ]


def generate_terrain(terrain: Terrain) -> Ground:
    """Build the ground that these settings describe."""
    return Ground(terrain)


def bounds(terrain: Terrain) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the least and the greatest (x, y) in m of the ground that is built; a plane has no end."""
    if terrain.structure != Structure.stairs:
        return (-math.inf, -math.inf), (math.inf, math.inf)
    return (-math.inf, -ARENA_WIDTH / 2), (LANDING + ARENA_LENGTH, ARENA_WIDTH / 2)
