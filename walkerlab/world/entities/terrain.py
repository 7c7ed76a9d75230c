"""The ground and the loose obstacles on it, built from the terrain settings and the layout.

Texture pieces are not built here: there can be thousands, and ``assembly`` adds them to the model.
"""

import math
from typing import Any

from dm_control import composer

from walkerlab.settings.choices import Structure
from walkerlab.settings.terrain import Terrain
from walkerlab.world.entities.obstacle import add_obstacles
from walkerlab.world.entities.scenery import add_ground_materials, add_scenery
from walkerlab.world.heights import (
    ARENA_LENGTH,
    ARENA_WIDTH,
    LANDING_LENGTH,
    PLATEAU_LENGTH,
    TRENCH_DEPTH,
    gap_ranges,
    hill_heights,
    slope,
)
from walkerlab.world.materials import MATERIALS, RGB, Material
from walkerlab.world.placement import compute_layout

LENGTH_BEHIND = 20.0  # m of level slab behind the start, on rough ground and on ground with gaps
BASE_DEPTH = 0.5  # m from the level ground down to the plane, on rough ground and on ground with gaps
SLEEP_TOLERANCE = 0.002  # m/s (and rad/s, for bodies of 1 m) below which obstacles fall asleep
AIR_DENSITY = 1.2  # kg/m³; wind has no effect in a medium without density
AIR_VISCOSITY = 1.8e-5  # Pa·s
MIN_HFIELD_HEIGHT = 1e-6  # m; MuJoCo rejects a height field of height 0


class Ground(composer.Arena):
    r"""The ground that all robots of a run walk on; forward is +x. Its friction applies to every contact with it.

    Seen from the side, robots walking to the right:

        flat   ______________    incline ___---‾‾‾         stairs ____┌──┌──┌──
        rough  ___/‾\_/‾‾\__    gaps    _____  ___  ___
    """

    def _build(self, terrain: Terrain, *, scenery: bool = False, name: str = "ground") -> None:
        super()._build(name=name)
        root = self._mjcf_root
        material = MATERIALS[terrain.texture]
        root.option.gravity = terrain.gravity
        root.option.cone = "pyramidal"
        root.option.noslip_iterations = 0
        root.option.flag.sleep = "enable"
        root.option.sleep_tolerance = SLEEP_TOLERANCE
        if any(terrain.wind):
            root.option.wind = terrain.wind
            root.option.density = AIR_DENSITY
            root.option.viscosity = AIR_VISCOSITY
        default = root.default.geom
        default.friction = material.friction()
        default.priority = 1
        default.condim = 3  # sliding friction only; obstacles also have torsional and rolling friction
        self._ground_materials = add_ground_materials(root, terrain) if scenery else {}
        is_below = terrain.structure in (Structure.rough, Structure.gaps)
        self._add_ground_geom(
            "plane", material.light, "chequer", type="plane", pos=(0, 0, -BASE_DEPTH if is_below else 0.0),
            size=(0, 0, 1), euler=(0, -slope(terrain), 0),
        )  # fmt: skip
        match terrain.structure:
            case Structure.stairs:
                self._add_stairs(terrain, material)
            case Structure.gaps:
                self._add_gaps(terrain, material)
            case Structure.rough:
                self._add_hills(terrain, material)
            case _:
                pass

    def _add_ground_geom(self, name: str, colour: RGB, pattern: str, **geom: Any) -> None:
        """Add a geom of the ground, with the named pattern if the world has scenery and in plain colour otherwise."""
        element = self._mjcf_root.worldbody.add("geom", name=name, **geom)
        if self._ground_materials:
            element.material = self._ground_materials[pattern]
        else:
            element.rgba = (*colour, 1)

    def _add_slab(
        self, number: int, start: float, end: float, top: float, thickness: float, material: Material
    ) -> None:
        """Add a box across the arena, from x = start to x = end [m]; neighbouring slabs differ in shade."""
        shade = "dark" if number % 2 else "light"
        pos = ((start + end) / 2, 0, top - thickness / 2)
        size = ((end - start) / 2, ARENA_WIDTH / 2, thickness / 2)
        self._add_ground_geom(f"slab{number}", getattr(material, shade), shade, type="box", pos=pos, size=size)

    def _add_stairs(self, terrain: Terrain, material: Material) -> None:
        """Add a slab for each step, thick enough to reach into the one below."""
        rise, depth = terrain.step_height, terrain.step_depth
        count = math.ceil(ARENA_LENGTH / depth)
        for i in range(1, count + 1):
            start = LANDING_LENGTH + (i - 1) * depth
            self._add_slab(i, start, start + (depth if i < count else PLATEAU_LENGTH), i * rise, rise + 0.02, material)

    def _add_gaps(self, terrain: Terrain, material: Material) -> None:
        """Add the slabs before, between and after the gaps."""
        edges = [-LENGTH_BEHIND, *gap_ranges(terrain).ravel().tolist(), LANDING_LENGTH + ARENA_LENGTH + PLATEAU_LENGTH]
        for i, (start, end) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
            self._add_slab(i, start, end, 0.0, TRENCH_DEPTH, material)

    def _add_hills(self, terrain: Terrain, material: Material) -> None:
        """Add the height field, from the landing on, and level slabs before and after it."""
        heights = hill_heights(terrain)
        end = LANDING_LENGTH + ARENA_LENGTH
        self._add_slab(0, -LENGTH_BEHIND, LANDING_LENGTH, 0.0, BASE_DEPTH, material)
        self._add_slab(2, end, end + PLATEAU_LENGTH, 0.0, BASE_DEPTH, material)
        field = self._mjcf_root.asset.add(
            "hfield", name="hills", nrow=len(heights), ncol=heights.shape[1], elevation=heights[::-1].ravel(),
            size=(ARENA_LENGTH / 2, ARENA_WIDTH / 2, max(heights.max(), MIN_HFIELD_HEIGHT), BASE_DEPTH),
        )  # fmt: skip
        centre = (LANDING_LENGTH + ARENA_LENGTH / 2, 0, 0)
        self._add_ground_geom("hills", material.light, "chequer", type="hfield", hfield=field, pos=centre)


def generate_terrain(terrain: Terrain, *entities: composer.Entity, scenery: bool = False) -> Ground:
    """Build the ground that the settings describe, with its obstacles.

    Args:
        terrain: Terrain settings.
        *entities: Entities that stand on the ground and move freely, such as a robot; their bodies precede those of
            the obstacles.
        scenery: Whether to add visual-only geometry: sky, sun, patterns, windsocks.
    """
    if not isinstance(terrain, Terrain):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"terrain must be a Terrain, such as settings.terrain; got a {type(terrain).__name__}")
    ground = Ground(terrain, scenery=scenery)
    for entity in entities:
        ground.attach(entity).add("freejoint", name="free")
    add_obstacles(ground.mjcf_model, terrain, compute_layout(terrain))
    if scenery:
        add_scenery(ground.mjcf_model, terrain)
    return ground
