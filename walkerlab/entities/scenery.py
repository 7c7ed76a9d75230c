"""What only eyes need: sky and sun, the grain of the ground, crates and tins, and a windsock where there is wind.

Nothing here can be touched: grounds are painted, and all that is added is sites, of which the physics knows nothing.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkerlab.choices import Obstacle, Structure, Texture
from walkerlab.ground import ARENA_LENGTH, ARENA_WIDTH, LANDING, TRENCH, height
from walkerlab.settings import FIELD, Terrain
from walkerlab.textures import MATERIALS, RGB


@dataclass(frozen=True)
class Grain:
    """How a ground is painted.

    Attributes:
        cells: of the grain, along and across the way, in four squares of the chequer; few are coarse.
        square: length of a square along and across the way, m.
        shine: how much it glints.
        mirror: how much is mirrored in it.
    """

    cells: tuple[int, int] = (512, 512)
    square: tuple[float, float] = (1.0, 1.0)
    shine: float = 0.05
    mirror: float = 0.0


GRAINS: dict[Texture, Grain] = {
    Texture.rubber: Grain(),
    Texture.marble: Grain((256, 128), shine=0.5, mirror=0.13),
    Texture.ice: Grain((384, 24), shine=0.8, mirror=0.2),  # scratches
    Texture.wood: Grain((48, 128), square=(1.0, 0.125), shine=0.2),  # planks
    Texture.concrete: Grain((384, 384)),
    Texture.grass: Grain((512, 160)),
    Texture.sand: Grain((320, 80)),  # ripples
    Texture.gravel: Grain((128, 128)),
    Texture.mud: Grain((64, 48), shine=0.6),  # wet
    Texture.snow: Grain((256, 256), shine=0.3),
}


@dataclass(frozen=True)
class Sky:
    """The light over a ground: colours overhead, at the horizon and of the sun, how bright shadows are, and stars."""

    zenith: RGB
    horizon: RGB
    sun: RGB
    shade: float
    stars: float = 0.0


SKIES = {
    2.5: Sky((0.00, 0.00, 0.02), (0.04, 0.05, 0.09), (0.85, 0.84, 0.80), 0.16, stars=0.004),
    6.0: Sky((0.66, 0.45, 0.32), (0.90, 0.74, 0.58), (0.82, 0.64, 0.50), 0.34),
    15.0: Sky((0.30, 0.56, 0.86), (0.92, 0.96, 0.99), (0.74, 0.71, 0.65), 0.33),
    math.inf: Sky((0.62, 0.50, 0.38), (0.93, 0.86, 0.72), (0.68, 0.62, 0.50), 0.38),
}
"""Up to which pull of gravity [m/s²] there is which sky: that of the moon, of Mars, of the earth, of Jupiter."""

SUN = (-0.36, 0.64, -0.68)  # which way it shines: on the side that is seen, and not on the risers of stairs
SOCKS = (3.0, 7.0, 11.0)  # m along the way, where there are windsocks
MAST, SOCK, FULL = 1.3, 0.9, 12.0  # m of mast and of sock; m/s of wind in which it stands out level
STRIPES = ((0.84, 0.25, 0.12, 1), (0.97, 0.96, 0.93, 1))
STEEL, LABEL, LID = (0.75, 0.77, 0.79, 1), (0.95, 0.92, 0.83, 1), (0.86, 0.88, 0.90, 1)
HEARTWOOD, RING, STRAP = (0.80, 0.63, 0.42, 1), (0.66, 0.47, 0.29, 1), (0.20, 0.16, 0.14, 1)


def mix_paints(root: Any, terrain: Terrain) -> dict[str, Any]:
    """Make what the ground is painted with: a chequer, and each of its shades alone, all with grain."""
    material, grain = MATERIALS[terrain.texture], GRAINS[terrain.texture]

    def mix(name: str, builtin: str, first: RGB, second: RGB) -> Any:
        texture = root.asset.add(
            "texture", name=name, type="2d", builtin=builtin, rgb1=first, rgb2=second,
            width=grain.cells[0], height=grain.cells[1], mark="random", markrgb=material.speckle, random=material.grain,
        )  # fmt: skip
        return root.asset.add(
            "material", name=name, texture=texture, texrepeat=[1 / (2 * side) for side in grain.square],
            texuniform="true", specular=grain.shine, shininess=0.6, reflectance=grain.mirror,
        )  # fmt: skip

    return {
        "chequer": mix("chequer", "checker", material.light, material.dark),
        "light": mix("light", "flat", material.light, material.light),
        "dark": mix("dark", "flat", material.dark, material.dark),
    }


def dress(root: Any, terrain: Terrain) -> None:
    """Add sky, sun and wind, and make what lies about and what is carried look like what it is."""
    pull = math.hypot(*terrain.gravity)
    _light(root, next(sky for most, sky in SKIES.items() if pull <= most))
    if terrain.structure == Structure.gaps:
        _darken_trenches(root)
    if any(terrain.wind):
        for along in SOCKS:
            _raise_windsock(root, terrain, along)
    if terrain.obstacle:
        _dress_obstacles(root, terrain.obstacle)
    for name in ("walker/pack/box", "sledge/cargo"):
        if box := root.find("geom", name):
            _strap(box)


def _light(root: Any, sky: Sky) -> None:
    root.statistic.extent, root.statistic.center = 3, (6, 0, 0)
    root.visual.map.znear, root.visual.map.zfar, root.visual.map.shadowclip = 0.01, 50, 3.5
    root.visual.map.haze = 0.6
    root.visual.quality.shadowsize = 4096
    root.visual.rgba.haze = (*(0.4 * np.array(sky.zenith) + 0.6 * np.array(sky.horizon)), 1)
    glow = root.visual.headlight
    glow.ambient, glow.diffuse, glow.specular = [sky.shade] * 3, [0.12] * 3, [0.0] * 3
    marks: dict[str, Any] = {"mark": "random", "markrgb": (1, 1, 1), "random": sky.stars} if sky.stars else {}
    root.asset.add(
        "texture", name="sky", type="skybox", builtin="gradient", rgb1=sky.zenith, rgb2=sky.horizon,
        width=512, height=512, **marks,
    )  # fmt: skip
    trunk = root.find("geom", "walker/trunk1")
    (trunk.parent if trunk else root.worldbody).add(  # above the robot, wherever it goes: so its shadow is crisp
        "light", name="sun", mode="trackcom", directional="true", castshadow="true",
        pos=np.array([2, 0, 0]) - np.multiply(40, SUN), dir=SUN, diffuse=sky.sun, specular=(0.3, 0.3, 0.3),
    )  # fmt: skip


def _darken_trenches(root: Any) -> None:
    """Let less light into a trench the deeper it is: dark glass between the slabs, which hide the rest of it."""
    size = (ARENA_LENGTH / 2, ARENA_WIDTH / 2 - 0.01, 0.001)
    for share in (0.2, 0.4, 0.6, 0.8, 0.99):
        root.worldbody.add(
            "site", name=f"dusk{share:g}", type="box", size=size, pos=(LANDING + ARENA_LENGTH / 2, 0, -share * TRENCH),
            rgba=(0.05, 0.04, 0.05, 0.35),
        )  # fmt: skip


def _raise_windsock(root: Any, terrain: Terrain, along: float) -> None:
    """Put up a striped windsock beside the way: the stronger the wind, the less it droops."""
    across = FIELD[1] / 2 + 0.2
    foot = np.array([along, across, float(height(terrain, np.array([along]), np.array([across]))[0])])
    top = foot + np.array([0, 0, MAST])
    _rod(root.worldbody, foot, top, 0.018, STEEL)
    ahead, aside, _ = terrain.wind
    lift, bearing = math.pi / 2 * min(math.hypot(ahead, aside) / FULL, 1), math.atan2(aside, ahead)
    way = np.array([math.sin(lift) * math.cos(bearing), math.sin(lift) * math.sin(bearing), -math.cos(lift)])
    for i in range(5):
        start, end = (top + way * SOCK * j / 5 for j in (i, i + 1))
        _rod(root.worldbody, start, end, 0.14 - 0.016 * i, STRIPES[i % 2])


def _rod(body: Any, start: Any, end: Any, radius: float, colour: Any) -> None:
    body.add("site", type="cylinder", size=[radius], fromto=(*start, *end), rgba=colour)


def _dress_obstacles(root: Any, kind: Obstacle) -> None:
    """Give crates their frames, balls their patches, tins and logs their ends, and stones their grain."""
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
    shine = {Obstacle.ball: 0.4, Obstacle.cylinder: 0.5}.get(kind, 0.05)
    material = root.asset.add("material", name="look", texture=texture, specular=shine)
    for geom in root.find_all("geom"):
        if not geom.full_identifier.startswith("obstacle"):
            continue
        body, geom.material = geom.parent, material
        if kind == Obstacle.cylinder:
            radius, half = geom.size
            for reach, thick, colour in ((0.5, 1.01, LABEL), (1.01, 0.9, LID)):
                body.add("site", type="cylinder", size=(thick * radius, reach * half), rgba=colour)
        if kind == Obstacle.log:
            radius, half = geom.size
            for reach, thick, colour in ((1.006, 0.9, HEARTWOOD), (1.010, 0.55, RING), (1.014, 0.45, HEARTWOOD)):
                body.add("site", type="cylinder", size=(thick * radius, reach * half), euler=geom.euler, rgba=colour)


def _strap(box: Any) -> None:
    """Put two straps round a box."""
    x, y, z = box.size
    for side in (-0.5, 0.5):
        middle = np.add(box.pos, (side * x, 0, 0))
        box.parent.add("site", type="box", size=(0.07 * x, y + 0.002, z + 0.002), pos=middle, rgba=STRAP)
