"""The ground, and what lies about on it: built from the settings and the lay of the land.

The pieces of its texture are not here: there can be thousands, which are written into the compiled world as numbers.
"""

import math
from typing import Any

from dm_control import composer

from walkerlab.choices import Structure
from walkerlab.entities.obstacle import add_obstacles
from walkerlab.entities.scenery import dress, mix_paints
from walkerlab.ground import ARENA_LENGTH, ARENA_WIDTH, LANDING, PLATEAU, TRENCH, gaps, hills, slope
from walkerlab.layout import lay_out
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

    def _build(self, terrain: Terrain, *, scenery: bool = False, name: str = "ground") -> None:
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
        self._lay(
            "plane", material.light, "chequer", type="plane", pos=(0, 0, -BASE * raised), size=(0, 0, 1),
            euler=(0, -slope(terrain), 0),
        )  # fmt: skip
        match terrain.structure:
            case Structure.stairs:
                self._lay_stairs(terrain, material)
            case Structure.gaps:
                self._lay_gaps(terrain, material)
            case Structure.rough:
                self._lay_hills(terrain, material)
            case _:
                pass

    def _lay(self, name: str, colour: RGB, paint: str, **geom: Any) -> None:
        """Lay one geom of the ground: painted where it is for looking at, of one colour elsewhere."""
        laid = self._mjcf_root.worldbody.add("geom", name=name, **geom)
        if self._paints:
            laid.material = self._paints[paint]
        else:
            laid.rgba = (*colour, 1)

    def _lay_slab(self, number: int, start: float, end: float, top: float, thick: float, material: Material) -> None:
        """Lay a box across the arena, from one place along the way to another; neighbours differ in shade."""
        paint = "dark" if number % 2 else "light"
        pos, size = ((start + end) / 2, 0, top - thick / 2), ((end - start) / 2, ARENA_WIDTH / 2, thick / 2)
        self._lay(f"slab{number}", getattr(material, paint), paint, type="box", pos=pos, size=size)

    def _lay_stairs(self, terrain: Terrain, material: Material) -> None:
        """Lay slabs, each a tread deep and thick enough to reach into the one below."""
        rise, tread = terrain.step_height, terrain.step_depth
        count = math.ceil(ARENA_LENGTH / tread)
        for i in range(1, count + 1):
            start = LANDING + (i - 1) * tread
            self._lay_slab(i, start, start + (tread if i < count else PLATEAU), i * rise, rise + 0.02, material)

    def _lay_gaps(self, terrain: Terrain, material: Material) -> None:
        """Lay slabs from before the first trench to behind the last, and from each to the next."""
        edges = [-BEHIND, *gaps(terrain).ravel().tolist(), LANDING + ARENA_LENGTH + PLATEAU]
        for i, (start, end) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
            self._lay_slab(i, start, end, 0.0, TRENCH, material)

    def _lay_hills(self, terrain: Terrain, material: Material) -> None:
        """Lay a height field from the landing on, and level slabs before and after it."""
        heights, end = hills(terrain), LANDING + ARENA_LENGTH
        self._lay_slab(0, -BEHIND, LANDING, 0.0, BASE, material)
        self._lay_slab(2, end, end + PLATEAU, 0.0, BASE, material)
        highest = max(heights.max(), 1e-6)  # MuJoCo knows no height field without a height
        field = self._mjcf_root.asset.add(
            "hfield", name="hills", nrow=len(heights), ncol=heights.shape[1], elevation=heights[::-1].ravel(),
            size=(ARENA_LENGTH / 2, ARENA_WIDTH / 2, highest, BASE),
        )  # fmt: skip
        middle = (LANDING + ARENA_LENGTH / 2, 0, 0)
        self._lay("hills", material.light, "chequer", type="hfield", hfield=field, pos=middle)


def generate_terrain(terrain: Terrain, *standing: composer.Entity, scenery: bool = False) -> Ground:
    """Build the ground that these settings describe, and all that lies on it.

    Args:
        terrain: the settings.
        *standing: what stands on it, free to move, such as a robot; these bodies come before those of obstacles.
        scenery: whether to add what only eyes need.
    """
    if not isinstance(terrain, Terrain):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"terrain must be a Terrain, such as settings.terrain; got a {type(terrain).__name__}")
    ground = Ground(terrain, scenery=scenery)
    for entity in standing:
        ground.attach(entity).add("freejoint", name="free")
    add_obstacles(ground.mjcf_model, terrain, lay_out(terrain))
    if scenery:
        dress(ground.mjcf_model, terrain)
    return ground
