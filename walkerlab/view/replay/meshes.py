"""K3D meshes of a replay: the ground with everything fixed to it, robots, loads, obstacles, ropes and shadows."""

import io
import math
from collections.abc import Iterable
from dataclasses import replace
from itertools import groupby
from typing import Any, NamedTuple

import k3d
import numpy as np
from k3d.factory.plot import plot
from numpy.typing import NDArray
from PIL import Image

from walkerlab.ga.genes import Floats
from walkerlab.settings.terrain import Terrain
from walkerlab.world.cameras import FIELD_OF_VIEW
from walkerlab.world.geometry import Surface, material_image, rotate
from walkerlab.world.heights import ground_height
from walkerlab.world.scene import ORIENTATION, POSITION, Scene

RGB = tuple[float, float, float]

BALL_BRIGHTNESS = (1.0, 0.62)  # brightness of the two kinds of patches on a ball, which make its rolling visible
MAX_TEXTURE_COLOURS = 32  # small, to keep the file small
LIMB_LIGHTENING = 0.45  # share of white that is mixed into the colour of a racer's right legs
LIMB_DARKENING = 0.4  # share of black that is mixed into the colour of a racer's left legs
MIN_RIGHT_RED = 0.2  # minimum red component of the natural colour of right legs; left legs have less
ROPE_RADIUS = 0.006  # m
ROPE_SIDES = 8
SHADOW_OPACITY = 0.28
SHADOW_CORNERS = 24
SHADOW_NAME = "shadow"
DISC_CORNERS = 12  # corners, and triangles, of a footprint
DISC_OPACITY = 0.75
GROUND_CLEARANCE = 0.004  # m between the ground and a shadow or a line on it
LINE_OVERHANG = 0.15  # m by which a line on the ground extends beyond the lanes, at each end
LINE_POINTS = 24  # number of points along each line, which follow the ground


class LineStyle(NamedTuple):
    """Appearance of lines on the ground.

    Attributes:
        half_width: Half of the width [m].
        opacity: Opacity, from 0 to 1.
    """

    half_width: float
    opacity: float


START_LINE = LineStyle(0.02, 0.85)
METRE_LINE = LineStyle(0.01, 0.6)


def create_plot(scene: Scene, name: str) -> Any:
    """Create an empty plot with the sky's colour at the horizon as background."""
    return plot(
        background_color=_pack_colours(scene.model.vis.rgba.haze[np.newaxis, :3])[0], camera_fov=FIELD_OF_VIEW,
        camera_auto_fit=False, grid_visible=False, menu_visibility=False, axes_helper=0.0, lighting=1.6, name=name,
    )  # fmt: skip


def ground_meshes(scene: Scene, ground: Iterable[Surface]) -> list[Any]:
    """Create the meshes of everything that never moves.

    There is one mesh for each textured material, one for the texture pieces, one for all other opaque surfaces, and
    one for each transparent surface.
    """
    by_material = sorted(ground, key=lambda surface: surface.material)
    meshes: list[Any] = []
    for material, group in groupby(by_material, key=lambda surface: surface.material):
        members = list(group)
        if material >= 0:
            meshes.append(_textured_mesh(scene, members, material))
            continue
        opaque = [surface for surface in members if surface.colour[3] == 1]
        if pieces := [surface for surface in opaque if surface.is_ball]:
            meshes.append(_piece_points(pieces))
        if others := [surface for surface in opaque if not surface.is_ball]:
            meshes.append(surface_mesh(others))
        meshes += [
            surface_mesh([surface], opacity=float(surface.colour[3])) for surface in members if surface.colour[3] < 1
        ]
    return meshes


def surface_mesh(members: list[Surface], name: str = "", opacity: float = 1.0) -> Any:
    """Create one mesh of several surfaces, each in its colour."""
    points, triangles = _join_surfaces(members)
    colours = np.concatenate([np.tile(surface.colour[:3], (len(surface.points), 1)) for surface in members])
    if any(surface.is_ball for surface in members):
        patch = (np.sign(points[triangles].mean(axis=1)).prod(axis=1) > 0).astype(int)
        points = points[triangles].reshape(-1, 3)
        colours = colours[triangles].reshape(-1, 3) * np.repeat(np.take(BALL_BRIGHTNESS, patch), 3)[:, np.newaxis]
        triangles = np.arange(len(points)).reshape(-1, 3)
    return _create_mesh(
        points, triangles, colors=_pack_colours(colours), opacity=opacity, flat_shading=False, roughness=0.6,
        side="front" if opacity == 1 else "double", name=name,
    )  # fmt: skip


def place_mesh(mesh: Any, transform: Floats) -> Any:
    """Move a mesh to a fixed position [m] and orientation (unit quaternion), shape (7,), and return it."""
    matrix = np.eye(4, dtype=np.float32)
    matrix[:3, :3] = rotate(np.tile(transform[ORIENTATION], (3, 1)), np.eye(3)).T
    matrix[:3, 3] = transform[POSITION]
    mesh.model_matrix = matrix
    return mesh


def tint_surface(surface: Surface, colour: RGB) -> Surface:
    """Return a surface of the robot in the colour of its racer."""
    return replace(surface, colour=race_colour(surface.colour, colour))


def race_colour(natural: Floats, colour: RGB) -> Floats:
    """Return the colour of a surface in a race, from its natural RGBA colour, shape (4,).

    As in the natural colours, the legs of the right side become lighter and those of the left side darker.
    """
    red, _, blue, alpha = natural
    is_limb = blue > red
    if is_limb and red < MIN_RIGHT_RED:
        return np.array([*(np.array(colour) * (1 - LIMB_DARKENING)), alpha])
    white = LIMB_LIGHTENING if is_limb else 0.0
    return np.array([*(np.array(colour) * (1 - white) + white), alpha])


def rope_mesh(scene: Scene) -> Any:
    """Create a rod of length 1 along z in the colour of the rope."""
    angle = np.linspace(0, math.tau, ROPE_SIDES, endpoint=False)
    ring = ROPE_RADIUS * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([ring + np.array([0, 0, end]) for end in (-0.5, 0.5)])
    i = np.arange(ROPE_SIDES)
    j = (i + 1) % ROPE_SIDES
    triangles = np.stack([i, j, j + ROPE_SIDES, i, j + ROPE_SIDES, i + ROPE_SIDES], axis=1).reshape(-1, 3)
    return _create_mesh(points, triangles, color=_pack_colours(scene.model.tendon_rgba[:1, :3])[0], flat_shading=False)


def shadow_mesh(length: float) -> Any:
    """Create the shadow of a segment of this length [m], which shows how high above the ground the segment is."""
    angle = np.linspace(0, math.tau, SHADOW_CORNERS, endpoint=False)
    half_length = 0.62 * length
    half_width = 0.22 * length + 0.04
    rim = np.stack([half_length * np.cos(angle), half_width * np.sin(angle), 0 * angle], axis=1)
    corner = np.arange(1, SHADOW_CORNERS - 1)
    triangles = np.stack([0 * corner, corner, corner + 1], axis=1)
    return _create_mesh(rim, triangles, color=0x000000, opacity=SHADOW_OPACITY, side="double")


def bone_shadow_mesh(radius: float) -> Any:
    """Create the shadow of a bone with this radius [m]: along z, with length 1, to be scaled to the bone's length."""
    angle = np.linspace(0, math.tau, SHADOW_CORNERS, endpoint=False)
    across, along = (np.sign(wave) * np.sqrt(np.abs(wave)) for wave in (np.sin(angle), np.cos(angle)))
    rim = np.stack([0 * angle, radius * across, along / 2], axis=1)
    corner = np.arange(1, SHADOW_CORNERS - 1)
    triangles = np.stack([0 * corner, corner, corner + 1], axis=1)
    return _create_mesh(rim, triangles, color=0x000000, opacity=SHADOW_OPACITY, side="double", name=SHADOW_NAME)


def disc_mesh(centres: Floats, radii: Floats, colours: Floats) -> Any:
    """Create one mesh of level discs, in the given order.

    Args:
        centres: Centres [m], shape (n, 3).
        radii: Radii [m], shape (n,).
        colours: Colours, shape (n, 3) or (n, 4).
    """
    angle = np.linspace(0, math.tau, DISC_CORNERS, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    corners = np.concatenate([np.zeros((1, 3)), ring])
    points = centres[:, np.newaxis] + radii[:, np.newaxis, np.newaxis] * corners
    i = np.arange(DISC_CORNERS)
    triangles = np.stack([0 * i, i + 1, (i + 1) % DISC_CORNERS + 1], axis=1)
    starts = len(corners) * np.arange(len(centres))
    return _create_mesh(
        points.reshape(-1, 3),
        (starts[:, np.newaxis, np.newaxis] + triangles).reshape(-1, 3),
        colors=_pack_colours(np.repeat(colours[:, :3], len(corners), axis=0)),
        opacity=DISC_OPACITY,
        side="double",
    )


def line_mesh(terrain: Terrain, extent: tuple[float, float], distances: NDArray[Any], style: LineStyle) -> Any:
    """Create white lines on the ground, across all lanes.

    Args:
        terrain: Terrain whose ground the lines follow.
        extent: Right and left edge of the lanes [m].
        distances: Positions of the lines along x [m].
        style: Width and opacity of the lines.
    """
    y = np.linspace(extent[0] - LINE_OVERHANG, extent[1] + LINE_OVERHANG, LINE_POINTS)
    edges = (-style.half_width, style.half_width)
    x = np.add.outer(distances, edges)[:, np.newaxis, :] + 0 * y[:, np.newaxis]  # (n_lines, LINE_POINTS, 2)
    across = np.broadcast_to(y[:, np.newaxis], x.shape)
    points = np.stack([x, across, ground_height(terrain, x, across) + GROUND_CLEARANCE], axis=-1).reshape(-1, 3)
    i = (2 * np.arange(len(y) - 1) + 2 * len(y) * np.arange(len(distances))[:, np.newaxis]).ravel()
    triangles = np.stack([i, i + 1, i + 3, i, i + 3, i + 2], axis=1).reshape(-1, 3)
    return _create_mesh(points, triangles, color=0xFFFFFF, opacity=style.opacity, side="double")


def _piece_points(pieces: list[Surface]) -> Any:
    """Create the texture pieces as points drawn as balls; there may be thousands of them."""
    centres = np.array([piece.points.mean(axis=0) for piece in pieces])
    widths = np.array([np.ptp(piece.points[:, 0]) for piece in pieces])
    colours = _pack_colours(np.array([piece.colour[:3] for piece in pieces]))
    return k3d.points(
        centres.astype(np.float32), point_sizes=widths.astype(np.float32), colors=colours, shader="3d"
    )  # fmt: skip


def _textured_mesh(scene: Scene, members: list[Surface], material: int) -> Any:
    """Create a mesh with the image of its material repeated over it, at a fixed scale in world coordinates."""
    points, triangles = _join_surfaces(members)
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    axes = np.array([(1, 2), (0, 2), (0, 1)])[np.repeat(np.argmax(np.abs(normal), axis=1), 3)]
    corners = corners.reshape(-1, 3)  # not shared by faces: each face has its own texture coordinates
    image, repeat = material_image(scene.model, material)
    file = io.BytesIO()
    Image.fromarray(image).quantize(MAX_TEXTURE_COLOURS).save(file, "png", optimize=True)
    return _create_mesh(
        corners, np.arange(len(corners)), color=0xFFFFFF, side="double", roughness=0.9, flat_shading=False,
        texture=file.getvalue(), texture_file_format="png", texture_wrap="repeat",
        uvs=(np.take_along_axis(corners, axes, axis=1) * repeat).astype(np.float32),
    )  # fmt: skip


def _create_mesh(points: Floats, triangles: NDArray[Any], **appearance: Any) -> Any:
    return k3d.mesh(points.astype(np.float32), triangles.astype(np.uint32), **appearance)


def _join_surfaces(members: list[Surface]) -> tuple[Floats, NDArray[np.intp]]:
    """Return the points, (n, 3), and the triangles, (m, 3), of several surfaces."""
    starts = np.cumsum([0, *(len(surface.points) for surface in members[:-1])])
    triangles = [surface.triangles + start for surface, start in zip(members, starts, strict=True)]
    return np.concatenate([surface.points for surface in members]), np.concatenate(triangles)


def _pack_colours(colours: NDArray[Any]) -> list[int]:
    """Return colours, (n, 3) from 0 to 1, as integers 0xRRGGBB."""
    return (np.rint(255 * np.clip(colours, 0, 1)).astype(int) @ np.array([0x10000, 0x100, 1])).tolist()
