"""The ground, and what lies about on it: built from the settings and the lay of the land.

The pieces of its texture are not here: there can be thousands, which are written into the compiled world as numbers.
"""

import math
from typing import Any

from dm_control import composer

from walkerlab.choices import Structure
from walkerlab.entities.obstacle import add_obstacles
from walkerlab.entities.scenery import dress, mix_paints
from walkerlab.ground import ARENA_LENGTH, ARENA_WIDTH, LANDING, PLATEAU, TRENCH, slope
from walkerlab.layout import Layout, lay_out
from walkerlab.settings import Terrain
from walkerlab.textures import MATERIALS, RGB, Material

BEHIND = 20.0  # m of level ground behind the start, where the plane is not it
BASE = 0.5  # m from the level ground down to the plane, where the plane is not it
DROWSY = 0.002  # m/s (and rad/s, of bodies of 1 m) under which what lies about falls asleep
AIR = (1.2, 1.8e-5)  # density [kg/m³] and viscosity [Pa·s] of what moves as wind


class Ground(composer.Arena):
    r"""The ground that all robots of a run walk on, forward being +x; it decides the friction of what touches it.

    Seen from the side, robots walking to the right:

        flat   ______________    incline ___---‾‾‾         stairs ____┌──┌──┌──
        rough  ___/‾\_/‾‾\__    gaps    _____  ___  ___
    """

    def _build(self, terrain: Terrain, layout: Layout, *, scenery: bool = False, name: str = "ground") -> None:
        super()._build(name=name)
        root, material = self._mjcf_root, MATERIALS[terrain.texture]
        root.option.gravity = terrain.gravity
        root.option.cone = "pyramidal"
        root.option.noslip_iterations = 0
        root.option.flag.sleep = "enable"
        root.option.sleep_tolerance = DROWSY
        if any(terrain.wind):
            root.option.wind = terrain.wind
            root.option.density, root.option.viscosity = AIR
        default = root.default.geom
        default.friction, default.priority, default.condim = material.friction(), 1, 4  # turning feet meet friction too
        self._paints = mix_paints(root, terrain) if scenery else {}
        raised = terrain.structure in (Structure.rough, Structure.gaps)
        self._lay("plane", (0, 0, -BASE * raised), (0, 0, 1), material.light, "chequer", type="plane")
        root.find("geom", "plane").euler = (0, -slope(terrain), 0)
        match terrain.structure:
            case Structure.stairs:
                self._lay_stairs(terrain, material)
            case Structure.gaps:
                self._lay_gaps(terrain, material)
            case Structure.rough:
                self._lay_hills(layout, material)
            case _:
                pass

    def _lay(self, name: str, pos: Any, size: Any, colour: RGB, paint: str, **more: Any) -> None:
        """Lay one geom of the ground: painted where it is for looking at, of one colour elsewhere."""
        geom = self._mjcf_root.worldbody.add("geom", name=name, pos=pos, size=size, **more)
        if self._paints:
            geom.material = self._paints[paint]
        else:
            geom.rgba = (*colour, 1)

    def _lay_slab(self, name: str, ends: tuple[float, float], top: float, thick: float, material: Material) -> None:
        """Lay a box across the arena, from one end to the other along the way; neighbours differ in shade."""
        is_dark = name[-1] in "13579"
        self._lay(
            name,
            (sum(ends) / 2, 0, top - thick / 2),
            ((ends[1] - ends[0]) / 2, ARENA_WIDTH / 2, thick / 2),
            material.dark if is_dark else material.light,
            "dark" if is_dark else "light",
            type="box",
        )

    def _lay_stairs(self, terrain: Terrain, material: Material) -> None:
        """Lay slabs, each a tread deep and thick enough to reach into the one below."""
        rise, tread = terrain.step_height, terrain.step_depth
        count = math.ceil(ARENA_LENGTH / tread)
        for i in range(1, count + 1):
            start = LANDING + (i - 1) * tread
            end = start + (tread if i < count else PLATEAU)
            self._lay_slab(f"stair{i}", (start, end), i * rise, rise + 0.02, material)

    def _lay_gaps(self, terrain: Terrain, material: Material) -> None:
        """Lay slabs with a trench between each and the next."""
        period = terrain.gap_width + terrain.gap_distance
        count = int(ARENA_LENGTH / period)
        for i in range(count + 1):
            start = LANDING + i * period - terrain.gap_distance if i else -BEHIND
            end = LANDING + i * period if i < count else LANDING + ARENA_LENGTH + PLATEAU
            self._lay_slab(f"slab{i}", (start, end), 0.0, TRENCH, material)

    def _lay_hills(self, layout: Layout, material: Material) -> None:
        """Lay a height field from the landing on, and level slabs before and after it."""
        self._lay_slab("slab0", (-BEHIND, LANDING), 0.0, BASE, material)
        self._lay_slab("slab2", (LANDING + ARENA_LENGTH, LANDING + ARENA_LENGTH + PLATEAU), 0.0, BASE, material)
        highest = max(layout.hills.max(), 1e-6)  # MuJoCo knows no height field without a height
        hills, size = layout.hills, (ARENA_LENGTH / 2, ARENA_WIDTH / 2, highest, BASE)
        field = self._mjcf_root.asset.add(
            "hfield", name="hills", nrow=len(hills), ncol=hills.shape[1], size=size, elevation=hills[::-1].ravel()
        )
        middle = (LANDING + ARENA_LENGTH / 2, 0, 0)
        geom = self._mjcf_root.worldbody.add("geom", name="hills", type="hfield", hfield=field, pos=middle)
        if self._paints:
            geom.material = self._paints["chequer"]
        else:
            geom.rgba = (*material.light, 1)


def generate_terrain(terrain: Terrain, *standing: composer.Entity, scenery: bool = False) -> Ground:
    """Build the ground that these settings describe, and all that lies on it.

    Args:
        terrain: the settings.
        *standing: what stands on it, free to move, such as a robot; these bodies come before those of obstacles.
        scenery: whether to add what only eyes need.
    """
    layout = lay_out(terrain)
    ground = Ground(terrain, layout, scenery=scenery)
    for entity in standing:
        ground.attach(entity).add("freejoint", name="free")
    add_obstacles(ground.mjcf_model, terrain, layout)
    if scenery:
        dress(ground.mjcf_model, terrain)
    return ground
