"""The stage: what is to be seen of recorded walks, as K3D meshes, and the numbers that move them."""

import io
import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import k3d
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from walkerlab.cameras import FIELD_OF_VIEW, aim
from walkerlab.choices import Camera
from walkerlab.genes import Floats
from walkerlab.ground import height, slope
from walkerlab.rollout import Rollout
from walkerlab.scene import Scene
from walkerlab.shapes import Surface, paint, rotate, surfaces
from walkerlab.viewer.tracks import FINEST, Tracks, before_it_broke, follow

RGB = tuple[float, float, float]

PATCHES = (1.0, 0.62)  # brightness of the patches of a ball, so that it is seen to roll
ROPE_RADIUS = 0.006  # m
SHADE, SHADOW = 0.28, (0.62, 0.22)  # how dark a shadow is; its length and width in those of the segment
LIFT = 0.004  # m of a shadow, or a line, over the ground
LINE = 0.02  # m, half the width of the starting line
SEEN = 1e-3  # m, to which cameras are rounded


@dataclass(frozen=True, eq=False)
class Walk:
    """One recorded walk on the stage.

    Attributes:
        label: by which it is told from the others.
        scene: its compiled world, with scenery.
        rollout: with its poses.
        colour: that it is painted in, or None for the natural ones.
        lane: how far to the left of the others' way it is shown [m].
        loose: whether what lies about is shown as it moved it.
    """

    label: str
    scene: Scene
    rollout: Rollout
    colour: RGB | None = None
    lane: float = 0.0
    loose: bool = True


@dataclass(frozen=True, eq=False)
class Stage:
    """What the player needs.

    Attributes:
        plot: the K3D plot with all meshes in it.
        things: the ids of the meshes that move.
        channels: (c, n) eight for each thing as in ``Tracks.places``, six for each camera (eye and target), three for
            the centre of mass of each walk.
        finest: (c,) to what each is rounded.
        ups: which way is up for each camera.
        seconds: how long the walk is.
    """

    plot: Any
    things: list[int]
    channels: Floats
    finest: Floats
    ups: dict[Camera, tuple[float, float, float]]
    seconds: float


def set_up(walks: list[Walk], name: str) -> Stage:
    """Build the stage for one walk, or for several at once on the ground of the first."""
    first = walks[0]
    recorded = [before_it_broke(walk.rollout.poses) for walk in walks]
    moments = max(map(len, recorded))
    time = np.arange(max(moments, 2)) * (first.rollout.time[1] - first.rollout.time[0])
    plot = k3d.plot(
        background_color=_packed(np.array([first.scene.model.vis.rgba.haze[:3]]))[0],
        camera_fov=FIELD_OF_VIEW, camera_auto_fit=False, grid_visible=False, menu_visibility=False, lighting=1.6,
        axes_helper=0.0, name=name,
    )  # fmt: skip
    things, channels = list[int](), list[Floats]()

    def enter(mesh: Any, track: Floats) -> None:
        plot.__iadd__(mesh)
        things.append(mesh.id)
        channels.append(_lasting(track, len(time)).T)

    for walk, poses in zip(walks, recorded, strict=True):
        tracks = follow(walk.scene, poses)
        seen = list(surfaces(walk.scene.model))
        if walk is first:
            for mesh in _scenery(walk.scene, seen):
                plot += mesh
        roots = walk.scene.model.body_rootid
        shown = [body for body in range(1, len(roots)) if walk.loose or roots[body] in walk.scene.roots]
        for body in shown:
            parts = [one for one in seen if one.body == body]
            if walk.colour and _is_grown(walk.scene, body):
                parts = [_tinted(one, walk.colour) for one in parts]
            if not parts:
                continue
            mesh = _mesh(parts)
            if body in tracks.moving:
                enter(mesh, _shifted(tracks.places[tracks.moving.index(body)], walk.lane))
            else:
                mesh.model_matrix = _matrix(tracks.still[body])
                plot += mesh
        for segment, track in _shadows(walk, tracks):
            enter(segment, track)
        if len(tracks.rope):
            enter(_rope(walk.scene), _shifted(tracks.rope, walk.lane))
    plot += _starting_line(walks)
    paths = np.array([_path(walk, len(time)) for walk in walks])
    size = max(walk.scene.phenotype.body_length + walk.scene.rope for walk in walks)
    shots = {camera: aim(camera, time, paths, size) for camera in Camera}
    for shot in shots.values():
        channels += [shot.eye.T, shot.target.T]
    channels += [path.T for path in paths]
    units = len(things) * FINEST + (SEEN,) * (6 * len(Camera) + 3 * len(walks))
    ups = {camera: shot.up for camera, shot in shots.items()}
    return Stage(plot, things, np.concatenate(channels), np.array(units), ups, float(time[-1]))


def _path(walk: Walk, moments: int) -> Floats:
    com = np.where(np.isfinite(walk.rollout.com), walk.rollout.com, 0.0)
    return _lasting(com, moments) + [0, walk.lane, 0]


def _lasting(track: Floats, moments: int) -> Floats:
    """Hold the last row of a track that ends too soon, and cut one that goes on too long."""
    return track[np.minimum(np.arange(moments), len(track) - 1)]


def _shifted(track: Floats, lane: float) -> Floats:
    moved = track.copy()
    moved[:, 1] += lane
    return moved


# ------------------------------------------------------------------------------------------------- the ground


def _scenery(scene: Scene, seen: list[Surface]) -> Iterable[Any]:
    """Yield the meshes of all that never moves: one for each paint, and one for each transparency of the rest."""
    still = [one for one in seen if one.body == 0]
    for material in sorted({one.material for one in still}):
        for opacity in sorted({float(one.colour[3]) for one in still if one.material == material}, reverse=True):
            parts = [one for one in still if one.material == material and one.colour[3] == opacity]
            if material >= 0:
                yield _painted(scene, parts, material)
                continue
            if balls := [one for one in parts if one.is_ball]:
                yield _strewn(balls)
            if others := [one for one in parts if not one.is_ball]:
                for layer in [others] if opacity == 1 else [[one] for one in others]:
                    yield _mesh(layer, opacity=opacity)


def _strewn(pieces: list[Surface]) -> Any:
    """Make the pieces of a texture, each the tip of a ball, from one point each: there can be thousands."""
    middles = np.array([one.points.mean(axis=0) for one in pieces])
    radii = np.array([np.ptp(one.points[:, 2]) / 2 for one in pieces])
    return k3d.points(
        middles.astype(np.float32), point_sizes=(2 * radii).astype(np.float32), shader="3d",
        colors=_packed(np.array([one.colour[:3] for one in pieces])),
    )  # fmt: skip


def _painted(scene: Scene, parts: list[Surface], material: int) -> Any:
    """Make a mesh with the picture of its material repeated over it, in metres of the world."""
    points, triangles = _joined(parts)
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    upright = np.argmax(np.abs(normal), axis=1)
    corners = corners.reshape(-1, 3)  # a corner between two sides has two places in the picture
    axes = np.array([(1, 2), (0, 2), (0, 1)])[np.repeat(upright, 3)]
    picture, repeat = paint(scene.model, material)
    image = Image.fromarray(picture).quantize(32)
    file = io.BytesIO()
    image.save(file, "png", optimize=True)
    return k3d.mesh(
        corners.astype(np.float32), np.arange(len(corners), dtype=np.uint32), texture=file.getvalue(),
        texture_file_format="png", texture_wrap="repeat", color=0xFFFFFF, roughness=0.9, side="double",
        uvs=(np.take_along_axis(corners, axes, axis=1) * repeat).astype(np.float32), flat_shading=False,
    )  # fmt: skip


def _starting_line(walks: list[Walk]) -> Any:
    terrain = walks[0].scene.settings.terrain
    lanes = [walk.lane for walk in walks]
    y = np.linspace(min(lanes) - 0.6, max(lanes) + 0.6, 24)
    edges = [np.stack([0 * y + x, y, height(terrain, 0 * y + x, y) + LIFT], axis=1) for x in (-LINE, LINE)]
    points = np.stack(edges, axis=1).reshape(-1, 3)
    i = 2 * np.arange(len(y) - 1)
    triangles = np.stack([i, i + 1, i + 3, i, i + 3, i + 2], axis=1).reshape(-1, 3)
    return k3d.mesh(
        points.astype(np.float32), triangles.astype(np.uint32), color=0xFFFFFF, side="double", opacity=0.85,
        name="start",
    )  # fmt: skip


# ------------------------------------------------------------------------------------------------ what moves


def _mesh(parts: list[Surface], opacity: float = 1.0) -> Any:
    """Make one mesh of several parts, each in its colour."""
    points, triangles = _joined(parts)
    colours = np.concatenate([np.tile(one.colour[:3], (len(one.points), 1)) for one in parts])
    if any(one.is_ball for one in parts):
        patch = (np.sign(points[triangles].mean(axis=1)).prod(axis=1) > 0).astype(int)
        points, colours = points[triangles].reshape(-1, 3), colours[triangles].reshape(-1, 3)
        colours = colours * np.repeat(np.take(PATCHES, patch), 3)[:, np.newaxis]
        triangles = np.arange(len(points)).reshape(-1, 3)
    return k3d.mesh(
        points.astype(np.float32), triangles.astype(np.uint32), colors=_packed(colours), opacity=opacity,
        flat_shading=False, side="front" if opacity == 1 else "double", roughness=0.6,
    )  # fmt: skip


def _joined(parts: list[Surface]) -> tuple[Floats, NDArray[np.intp]]:
    starts = np.cumsum([0, *(len(one.points) for one in parts)])
    triangles = [one.triangles + start for one, start in zip(parts, starts, strict=False)]
    return np.concatenate([one.points for one in parts]), np.concatenate(triangles)


def _packed(colours: Floats) -> list[int]:
    shares = np.rint(255 * np.clip(colours, 0, 1)).astype(int)
    return (shares @ [65536, 256, 1]).tolist()


def _is_grown(scene: Scene, body: int) -> bool:
    """Whether a body is part of the robot itself: not of the ground, of what lies about, or of a load."""
    return scene.model.body_rootid[body] == 1 and "pack" not in scene.model.body(body).name


def _tinted(one: Surface, colour: RGB) -> Surface:
    """Paint a part in its racer's colour: limbs, which are blue by nature, in a lighter one."""
    lift = 0.45 * bool(one.colour[2] > one.colour[0])
    return replace(one, colour=np.array([*(np.array(colour) * (1 - lift) + lift), one.colour[3]]))


def _matrix(place: Floats) -> NDArray[np.float32]:
    matrix = np.eye(4, dtype=np.float32)
    matrix[:3, :3] = np.stack([rotate(place[np.newaxis, 3:], way)[0] for way in np.eye(3)], axis=1)
    matrix[:3, 3] = place[:3]
    return matrix


def _shadows(walk: Walk, tracks: Tracks) -> Iterable[tuple[Any, Floats]]:
    """Yield a soft dark spot for each segment, on the ground below it: it shows how high feet are lifted."""
    scene, terrain, model = walk.scene, walk.scene.settings.terrain, walk.scene.model
    pitch = slope(terrain)
    turn = np.linspace(0, math.tau, 24, endpoint=False)
    for number, segment in enumerate(scene.phenotype.segments, start=1):
        body = int(model.geom(f"walker/trunk{number}").bodyid[0])
        place = tracks.places[tracks.moving.index(body)]
        middle = place[:, :3] + rotate(place[:, 3:7], np.array([-segment.length / 2, 0, 0]))
        ahead = rotate(place[:, 3:7], np.array([1.0, 0, 0]))
        yaw = np.arctan2(ahead[:, 1], ahead[:, 0])
        spot = np.stack([middle[:, 0], middle[:, 1], height(terrain, middle[:, 0], middle[:, 1]) + LIFT], axis=1)
        half = np.stack([np.cos(yaw / 2), 0 * yaw, 0 * yaw, np.sin(yaw / 2)], axis=1)
        c, s = math.cos(pitch / 2), -math.sin(pitch / 2)  # lay it along the slope, then turn it: (c, 0, s, 0) * half
        laid = np.stack([c * half[:, 0], s * half[:, 3], s * half[:, 0], c * half[:, 3]], axis=1)
        long, wide = SHADOW[0] * segment.length, SHADOW[1] * segment.length + 0.04
        rim = np.stack([long * np.cos(turn), wide * np.sin(turn), 0 * turn], axis=1)
        triangles = np.stack([0 * turn[2:], np.arange(1, 23), np.arange(2, 24)], axis=1)
        mesh = k3d.mesh(
            rim.astype(np.float32), triangles.astype(np.uint32), color=0x000000, opacity=SHADE, side="double",
            name="shadow",
        )  # fmt: skip
        track = np.concatenate([spot, laid, np.ones((len(spot), 1))], axis=1)
        yield mesh, _shifted(track, walk.lane)


def _rope(scene: Scene) -> Any:
    turn = np.linspace(0, math.tau, 8, endpoint=False)
    ring = np.stack([ROPE_RADIUS * np.cos(turn), ROPE_RADIUS * np.sin(turn), 0 * turn], axis=1)
    points = np.concatenate([ring + [0, 0, end] for end in (-0.5, 0.5)])
    i, j = np.arange(8), (np.arange(8) + 1) % 8
    triangles = np.stack([i, j, j + 8, i, j + 8, i + 8], axis=1).reshape(-1, 3)
    return k3d.mesh(
        points.astype(np.float32), triangles.astype(np.uint32), color=_packed(scene.model.tendon_rgba[:1, :3])[0],
        flat_shading=False, name="rope",
    )  # fmt: skip
