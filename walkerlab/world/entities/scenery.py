"""Visual-only geometry: sky and sun, the pattern of the ground, details of obstacles and loads, and windsocks.

None of it affects the physics: the ground gets textures, and everything that is added is a site or a light.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkerlab.settings.choices import Obstacle, Structure, Texture
from walkerlab.settings.terrain import PLACEMENT_AREA, Terrain
from walkerlab.world.heights import ARENA_LENGTH, ARENA_WIDTH, LANDING_LENGTH, TRENCH_DEPTH, ground_height
from walkerlab.world.materials import MATERIALS, RGB


@dataclass(frozen=True)
class Pattern:
    """Appearance of the ground.

    Attributes:
        pixels: Width and height of the texture image, which covers two by two squares; few pixels give coarse speckles.
        square: Length of a square along and across the walking direction, m.
        specular: Strength of highlights, 0 to 1.
        reflectance: Strength of mirror images, 0 to 1.
    """

    pixels: tuple[int, int] = (512, 512)
    square: tuple[float, float] = (1.0, 1.0)
    specular: float = 0.05
    reflectance: float = 0.0


GROUND_PATTERNS: dict[Texture, Pattern] = {
    Texture.rubber: Pattern(),
    Texture.marble: Pattern((256, 128), specular=0.5, reflectance=0.13),
    Texture.ice: Pattern((384, 24), specular=0.8, reflectance=0.2),  # scratches
    Texture.wood: Pattern((48, 128), square=(1.0, 0.125), specular=0.2),  # planks
    Texture.concrete: Pattern((384, 384)),
    Texture.grass: Pattern((512, 160)),
    Texture.sand: Pattern((320, 80)),  # ripples
    Texture.gravel: Pattern((128, 128)),
    Texture.mud: Pattern((64, 48), specular=0.6),  # wet
    Texture.snow: Pattern((256, 256), specular=0.3),
}


@dataclass(frozen=True)
class Sky:
    """Sky and light of a planet.

    Attributes:
        zenith: Colour overhead.
        horizon: Colour at the horizon.
        sun: Colour of the sunlight.
        ambient: Brightness of shadows, 0 to 1.
        stars: Share of the sky's pixels that are stars.
    """

    zenith: RGB
    horizon: RGB
    sun: RGB
    ambient: float
    stars: float = 0.0


SKIES = {
    2.5: Sky((0.00, 0.00, 0.02), (0.04, 0.05, 0.09), (0.85, 0.84, 0.80), 0.16, stars=0.004),
    6.0: Sky((0.66, 0.45, 0.32), (0.90, 0.74, 0.58), (0.82, 0.64, 0.50), 0.34),
    15.0: Sky((0.30, 0.56, 0.86), (0.92, 0.96, 0.99), (0.74, 0.71, 0.65), 0.33),
    math.inf: Sky((0.62, 0.50, 0.38), (0.93, 0.86, 0.72), (0.68, 0.62, 0.50), 0.38),
}
"""Skies of the moon, Mars, the earth and Jupiter, with the greatest gravity [m/s²] for which each is used."""

SUN_DIRECTION = (-0.36, 0.64, -0.68)  # sunlight falls onto the sides that cameras see
WINDSOCK_POSITIONS = (3.0, 7.0, 11.0)  # m from the start
MAST_HEIGHT = 1.3  # m
SOCK_LENGTH = 0.9  # m
SOCK_RINGS = 5
FULL_WIND = 12.0  # m/s; wind speed at which a windsock is horizontal
SOCK_COLOURS = ((0.84, 0.25, 0.12, 1), (0.97, 0.96, 0.93, 1))
MAST_COLOUR = (0.75, 0.77, 0.79, 1)
LABEL_COLOUR = (0.95, 0.92, 0.83, 1)
LID_COLOUR = (0.86, 0.88, 0.90, 1)
HEARTWOOD_COLOUR = (0.80, 0.63, 0.42, 1)
TREE_RING_COLOUR = (0.66, 0.47, 0.29, 1)
STRAP_COLOUR = (0.20, 0.16, 0.14, 1)


def add_ground_materials(root: Any, terrain: Terrain) -> dict[str, Any]:
    """Add the MuJoCo materials of the ground and return them, keyed by name: ``chequer``, ``light`` and ``dark``."""
    material = MATERIALS[terrain.texture]
    pattern = GROUND_PATTERNS[terrain.texture]

    def add_material(name: str, builtin: str, first: RGB, second: RGB) -> Any:
        texture = root.asset.add(
            "texture", name=name, type="2d", builtin=builtin, rgb1=first, rgb2=second, width=pattern.pixels[0],
            height=pattern.pixels[1], mark="random", markrgb=material.speckle, random=material.speckle_share,
        )  # fmt: skip
        return root.asset.add(
            "material", name=name, texture=texture, texrepeat=[1 / (2 * side) for side in pattern.square],
            texuniform="true", specular=pattern.specular, shininess=0.6, reflectance=pattern.reflectance,
        )  # fmt: skip

    return {
        "chequer": add_material("chequer", "checker", material.light, material.dark),
        "light": add_material("light", "flat", material.light, material.light),
        "dark": add_material("dark", "flat", material.dark, material.dark),
    }


def find_sky(terrain: Terrain) -> Sky:
    """Return the sky of the moon, Mars, the earth or Jupiter, depending on the strength of gravity."""
    gravity = math.hypot(*terrain.gravity)
    return next(sky for max_gravity, sky in SKIES.items() if gravity <= max_gravity)


def add_scenery(root: Any, terrain: Terrain) -> None:
    """Add sky, sun and windsocks, and the visible details of gaps, obstacles and loads."""
    _add_light(root, find_sky(terrain))
    if terrain.structure == Structure.gaps:
        _darken_gaps(root)
    if any(terrain.wind):
        for x in WINDSOCK_POSITIONS:
            _add_windsock(root, terrain, x)
    if terrain.obstacle:
        _add_obstacle_details(root, terrain.obstacle)
    for name in ("walker/pack/box", "sledge/cargo"):
        if box := root.find("geom", name):
            _add_straps(box)


def _add_light(root: Any, sky: Sky) -> None:
    root.statistic.extent = 3
    root.statistic.center = (6, 0, 0)
    root.visual.map.znear = 0.01
    root.visual.map.zfar = 50
    root.visual.map.shadowclip = 3.5
    root.visual.map.haze = 0.6
    root.visual.quality.shadowsize = 4096
    root.visual.rgba.haze = (*(0.4 * np.array(sky.zenith) + 0.6 * np.array(sky.horizon)), 1)
    headlight = root.visual.headlight
    headlight.ambient = [sky.ambient] * 3
    headlight.diffuse = [0.12] * 3
    headlight.specular = [0.0] * 3
    marks: dict[str, Any] = {"mark": "random", "markrgb": (1, 1, 1), "random": sky.stars} if sky.stars else {}
    root.asset.add(
        "texture", name="sky", type="skybox", builtin="gradient", rgb1=sky.zenith, rgb2=sky.horizon,
        width=512, height=512, **marks,
    )  # fmt: skip
    trunk = root.find("geom", "walker/trunk1")
    body = trunk.parent if trunk else root.worldbody
    body.add(  # follows the robot, so that the shadow map covers a small area and shadows are sharp
        "light", name="sun", mode="trackcom", directional="true", castshadow="true",
        pos=np.array([2, 0, 0]) - np.multiply(40, SUN_DIRECTION), dir=SUN_DIRECTION, diffuse=sky.sun,
        specular=(0.3, 0.3, 0.3),
    )  # fmt: skip


def _darken_gaps(root: Any) -> None:
    """Add layers of dark glass so that gaps look darker the deeper they are; between gaps the slabs hide them."""
    size = (ARENA_LENGTH / 2, ARENA_WIDTH / 2 - 0.01, 0.001)
    for depth in (0.2, 0.4, 0.6, 0.8, 0.99):  # share of the depth of a gap
        root.worldbody.add(
            "site", name=f"dusk{depth:g}", type="box", size=size, rgba=(0.05, 0.04, 0.05, 0.35),
            pos=(LANDING_LENGTH + ARENA_LENGTH / 2, 0, -depth * TRENCH_DEPTH),
        )  # fmt: skip


def _add_windsock(root: Any, terrain: Terrain, x: float) -> None:
    """Add a striped windsock beside the track; it droops less in stronger wind."""
    y = PLACEMENT_AREA[1] / 2 + 0.2
    foot = np.array([x, y, float(ground_height(terrain, np.array([x]), np.array([y]))[0])])
    top = foot + np.array([0, 0, MAST_HEIGHT])
    _add_rod(root.worldbody, foot, top, 0.018, MAST_COLOUR)
    wind_x, wind_y, _ = terrain.wind
    angle = math.pi / 2 * min(math.hypot(wind_x, wind_y) / FULL_WIND, 1)  # 0 hangs straight down
    bearing = math.atan2(wind_y, wind_x)
    direction = np.array([math.sin(angle) * math.cos(bearing), math.sin(angle) * math.sin(bearing), -math.cos(angle)])
    for i in range(SOCK_RINGS):
        start, end = (top + direction * SOCK_LENGTH * j / SOCK_RINGS for j in (i, i + 1))
        _add_rod(root.worldbody, start, end, 0.14 - 0.016 * i, SOCK_COLOURS[i % 2])


def _add_rod(body: Any, start: Any, end: Any, radius: float, colour: Any) -> None:
    body.add("site", type="cylinder", size=[radius], fromto=(*start, *end), rgba=colour)


def _add_obstacle_details(root: Any, kind: Obstacle) -> None:
    """Add details to obstacles: frames of crates, patches of balls, lids of tins, ends of logs, speckles of rocks."""
    look: dict[str, Any] = {
        Obstacle.box: {"builtin": "flat", "mark": "edge", "markrgb": (0.55, 0.50, 0.45), "width": 12},
        Obstacle.ball: {"builtin": "checker", "width": 64},
        Obstacle.cylinder: {"builtin": "flat", "width": 8},
        Obstacle.rock: {"builtin": "flat", "mark": "random", "markrgb": (0.7, 0.7, 0.7), "random": 0.3, "width": 24},
        Obstacle.log: {"builtin": "flat", "mark": "random", "markrgb": (0.6, 0.6, 0.6), "random": 0.4, "width": 24},
    }[kind]
    white = (1.0, 1.0, 1.0)
    texture = root.asset.add("texture", name="look", type="cube", rgb1=white, rgb2=white, **look)
    if kind == Obstacle.ball:
        texture.rgb2 = (0.62, 0.62, 0.66)
    specular = {Obstacle.ball: 0.4, Obstacle.cylinder: 0.5}.get(kind, 0.05)
    material = root.asset.add("material", name="look", texture=texture, specular=specular)
    for geom in root.find_all("geom"):
        if not geom.full_identifier.startswith("obstacle"):
            continue
        geom.material = material
        if kind == Obstacle.cylinder:
            _add_cylinders(geom, ((0.5, 1.01, LABEL_COLOUR), (1.01, 0.9, LID_COLOUR)))
        if kind == Obstacle.log:
            rings = ((1.006, 0.9, HEARTWOOD_COLOUR), (1.010, 0.55, TREE_RING_COLOUR), (1.014, 0.45, HEARTWOOD_COLOUR))
            _add_cylinders(geom, rings, euler=geom.euler)


def _add_cylinders(geom: Any, layers: tuple[tuple[float, float, Any], ...], **orientation: Any) -> None:
    """Add coloured cylinders around a cylinder; each layer is relative length, relative radius and colour."""
    radius, half_length = geom.size
    for length_share, radius_share, colour in layers:
        size = (radius_share * radius, length_share * half_length)
        geom.parent.add("site", type="cylinder", size=size, rgba=colour, **orientation)


def _add_straps(box: Any) -> None:
    """Add two straps around a box."""
    x, y, z = box.size
    for side in (-0.5, 0.5):
        centre = np.add(box.pos, (side * x, 0, 0))
        box.parent.add("site", type="box", size=(0.07 * x, y + 0.002, z + 0.002), pos=centre, rgba=STRAP_COLOUR)
