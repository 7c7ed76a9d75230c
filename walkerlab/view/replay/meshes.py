"""What is on the stage, as K3D meshes: the ground and all that is on it, robots, ropes and shadows."""

import io
import math
from collections.abc import Iterable
from dataclasses import replace
from itertools import groupby
from typing import Any

import k3d
import numpy as np
from k3d.factory.plot import plot
from numpy.typing import NDArray
from PIL import Image

from walkerlab.ga.genes import Floats
from walkerlab.settings.terrain import Terrain
from walkerlab.world.cameras import FIELD_OF_VIEW
from walkerlab.world.geometry import Surface, material_image, rotate
from walkerlab.world.heights import height
from walkerlab.world.scene import Scene

RGB = tuple[float, float, float]

PATCHES = (1.0, 0.62)  # brightness of the patches of a ball, so that it is seen to roll
PAINTS = 32  # colours of a painted ground: few, for a small file
ROPE_RADIUS = 0.006  # m
SHADE = 0.28  # how dark a shadow is
LIFT = 0.004  # m of a shadow, or a line, over the ground
START, METRE = (0.02, 0.85), (0.006, 0.4)  # m of half a line's width, and how opaque it is
BESIDE = 0.15  # m by which it is longer than the lanes


def empty_plot(scene: Scene, name: str) -> Any:
    """Make a plot with nothing in it but the sky at the horizon."""
    return plot(
        background_color=_packed(scene.model.vis.rgba.haze[np.newaxis, :3])[0], camera_fov=FIELD_OF_VIEW,
        camera_auto_fit=False, grid_visible=False, menu_visibility=False, axes_helper=0.0, lighting=1.6, name=name,
    )  # fmt: skip


def scenery(scene: Scene, ground: Iterable[Surface]) -> list[Any]:
    """Make the meshes of all that never moves: one for each paint, one of the rest, and each layer of glass alone."""
    still = sorted(ground, key=lambda one: one.material)
    meshes = list[Any]()
    for material, group in groupby(still, key=lambda one: one.material):
        parts = list(group)
        if material >= 0:
            meshes.append(_painted(scene, parts, material))
            continue
        solid = [one for one in parts if one.colour[3] == 1]
        if pieces := [one for one in solid if one.is_ball]:
            meshes.append(_strewn(pieces))
        if others := [one for one in solid if not one.is_ball]:
            meshes.append(mesh(others))
        meshes += [mesh([one], opacity=float(one.colour[3])) for one in parts if one.colour[3] < 1]
    return meshes


def mesh(parts: list[Surface], name: str = "", opacity: float = 1.0) -> Any:
    """Make one mesh of several parts, each in its colour."""
    points, triangles = _joined(parts)
    colours = np.concatenate([np.tile(one.colour[:3], (len(one.points), 1)) for one in parts])
    if any(one.is_ball for one in parts):
        patch = (np.sign(points[triangles].mean(axis=1)).prod(axis=1) > 0).astype(int)
        points, colours = points[triangles].reshape(-1, 3), colours[triangles].reshape(-1, 3)
        colours = colours * np.repeat(np.take(PATCHES, patch), 3)[:, np.newaxis]
        triangles = np.arange(len(points)).reshape(-1, 3)
    return _mesh(
        points, triangles, colors=_packed(colours), opacity=opacity, flat_shading=False, roughness=0.6,
        side="front" if opacity == 1 else "double", name=name,
    )  # fmt: skip


def placed(still: Any, place: Floats) -> Any:
    """Put a mesh to where its body is for good: (7,) position and unit quaternion."""
    matrix = np.eye(4, dtype=np.float32)
    matrix[:3, :3] = rotate(np.tile(place[3:], (3, 1)), np.eye(3)).T
    matrix[:3, 3] = place[:3]
    still.model_matrix = matrix
    return still


def tinted(one: Surface, colour: RGB) -> Surface:
    """Paint a part in its racer's colour."""
    return replace(one, colour=tint(one.colour, colour))


def tint(natural: Floats, colour: RGB) -> Floats:
    """Turn a natural colour, (4,), into a racer's: limbs, which are blue by nature, get a lighter one."""
    lift = 0.45 * bool(natural[2] > natural[0])
    return np.array([*(np.array(colour) * (1 - lift) + lift), natural[3]])


def rope(scene: Scene) -> Any:
    """Make a rod of length 1 along z, of the rope's colour."""
    turn = np.linspace(0, math.tau, 8, endpoint=False)
    ring = ROPE_RADIUS * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    points = np.concatenate([ring + np.array([0, 0, end]) for end in (-0.5, 0.5)])
    i, j = np.arange(8), (np.arange(8) + 1) % 8
    triangles = np.stack([i, j, j + 8, i, j + 8, i + 8], axis=1).reshape(-1, 3)
    return _mesh(points, triangles, color=_packed(scene.model.tendon_rgba[:1, :3])[0], flat_shading=False)


def shadow(length: float) -> Any:
    """Make a soft dark spot below a segment of this length [m]: it shows how high above the ground it is."""
    turn = np.linspace(0, math.tau, 24, endpoint=False)
    long, wide = 0.62 * length, 0.22 * length + 0.04
    rim = np.stack([long * np.cos(turn), wide * np.sin(turn), 0 * turn], axis=1)
    triangles = np.stack([0 * turn[2:], np.arange(1, 23), np.arange(2, 24)], axis=1)
    return _mesh(rim, triangles, color=0x000000, opacity=SHADE, side="double")


def lines(terrain: Terrain, edges: tuple[float, float], along: NDArray[Any], half: float, opacity: float) -> Any:
    """Draw white lines across all lanes, at some places along the way [m], of half a width [m]."""
    y = np.linspace(edges[0] - BESIDE, edges[1] + BESIDE, 24)
    x = np.add.outer(along, (-half, half))[:, np.newaxis, :] + 0 * y[:, np.newaxis]  # (lines, 24, 2)
    across = np.broadcast_to(y[:, np.newaxis], x.shape)
    points = np.stack([x, across, height(terrain, x, across) + LIFT], axis=-1).reshape(-1, 3)
    i = (2 * np.arange(len(y) - 1) + 2 * len(y) * np.arange(len(along))[:, np.newaxis]).ravel()
    triangles = np.stack([i, i + 1, i + 3, i, i + 3, i + 2], axis=1).reshape(-1, 3)
    return _mesh(points, triangles, color=0xFFFFFF, opacity=opacity, side="double")


def _strewn(pieces: list[Surface]) -> Any:
    """Make the pieces of a texture, each the tip of a ball, from one point each: there can be thousands."""
    middles = np.array([one.points.mean(axis=0) for one in pieces])
    widths = np.array([np.ptp(one.points[:, 0]) for one in pieces])
    colours = _packed(np.array([one.colour[:3] for one in pieces]))
    return k3d.points(
        middles.astype(np.float32), point_sizes=widths.astype(np.float32), colors=colours, shader="3d"
    )  # fmt: skip


def _painted(scene: Scene, parts: list[Surface], material: int) -> Any:
    """Make a mesh with the picture of its material repeated over it, in metres of the world."""
    points, triangles = _joined(parts)
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    axes = np.array([(1, 2), (0, 2), (0, 1)])[np.repeat(np.argmax(np.abs(normal), axis=1), 3)]
    corners = corners.reshape(-1, 3)  # not shared: one between two sides has two places in the picture
    picture, repeat = material_image(scene.model, material)
    file = io.BytesIO()
    Image.fromarray(picture).quantize(PAINTS).save(file, "png", optimize=True)
    return _mesh(
        corners, np.arange(len(corners)), color=0xFFFFFF, side="double", roughness=0.9, flat_shading=False,
        texture=file.getvalue(), texture_file_format="png", texture_wrap="repeat",
        uvs=(np.take_along_axis(corners, axes, axis=1) * repeat).astype(np.float32),
    )  # fmt: skip


def _mesh(points: Floats, triangles: NDArray[Any], **looks: Any) -> Any:
    return k3d.mesh(points.astype(np.float32), triangles.astype(np.uint32), **looks)


def _joined(parts: list[Surface]) -> tuple[Floats, NDArray[np.intp]]:
    starts = np.cumsum([0, *(len(one.points) for one in parts[:-1])])
    triangles = [one.triangles + start for one, start in zip(parts, starts, strict=True)]
    return np.concatenate([one.points for one in parts]), np.concatenate(triangles)


def _packed(colours: NDArray[Any]) -> list[int]:
    """Write (n, 3) shares of red, green and blue as one number each."""
    return (np.rint(255 * np.clip(colours, 0, 1)).astype(int) @ np.array([65536, 256, 1])).tolist()
