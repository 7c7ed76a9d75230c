"""What the robot and its world look like: the surface of every part, and where a pose puts it."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from walkerlab.genes import Floats, Indices
from walkerlab.scene import ROPE_ENDS, Scene

AROUND, ALONG = 24, 12  # corners of what is round: about its axis, and from pole to pole
LEAP = 3.0  # m of any body from one tick to the next, beyond which a world has broken down: 150 m/s
ENDLESS = 60.0  # m to each side, to which a plane is drawn
ROPE = 2  # points of what is drawn as a line
OUTLINE = 48  # corners of an outline at most


@dataclass(frozen=True, eq=False)
class Surface:
    """What is to be seen of one geom or site.

    Attributes:
        points: (k, 3) corners, in the frame of its body [m]; those of round parts are shared, those of edges are not.
        triangles: (m, 3) indices of corners, counter-clockwise from outside.
        colour: (4,) RGBA.
        body: the number of its body; 0 is the ground.
        material: the number of what it is painted with, or -1.
        is_ball: whether it is a ball, which needs a pattern to be seen rolling.
    """

    points: Floats
    triangles: Indices
    colour: Floats
    body: int
    material: int
    is_ball: bool


def surfaces(model: mujoco.MjModel, *, bodies: bool, far: float = ENDLESS) -> Iterator[Surface]:
    """Yield what is to be seen of a world, geom by geom and site by site; not the rope, which is neither.

    Args:
        model: the compiled world.
        bodies: whether of its bodies, or of the ground, on which there can be thousands of pieces.
        far: to what distance [m] a plane is drawn, to each side.
    """
    for kind in ("geom", "site"):
        types, sizes, body, colours, places, turns, materials = (
            getattr(model, f"{kind}_{part}") for part in ("type", "size", "bodyid", "rgba", "pos", "quat", "matid")
        )
        for i in np.flatnonzero((colours[:, 3] > 0) & ((body > 0) == bodies)).tolist():
            points, triangles = _surface(model, types[i], sizes[i], int(model.geom_dataid[i]) if kind == "geom" else -1)
            if types[i] == mujoco.mjtGeom.mjGEOM_PLANE:
                points = points * far
            turn = np.empty(9)
            mujoco.mju_quat2Mat(turn, turns[i])
            yield Surface(
                points=places[i] + points @ turn.reshape(3, 3).T,
                triangles=triangles,
                colour=colours[i].astype(np.float64),
                body=int(body[i]),
                material=int(materials[i]),
                is_ball=types[i] == mujoco.mjtGeom.mjGEOM_SPHERE,
            )


def paint(model: mujoco.MjModel, material: int) -> tuple[NDArray[np.uint8], Floats]:
    """Return the (height, width, 3) picture that a material repeats, and how often it does in a metre, (2,)."""
    texture = int(model.mat_texid[material, int(mujoco.mjtTextureRole.mjTEXROLE_RGB)])
    height, width, start = (int(of[texture]) for of in (model.tex_height, model.tex_width, model.tex_adr))
    picture = model.tex_data[start : start + 3 * height * width].reshape(height, width, 3)
    return picture, model.mat_texrepeat[material].astype(np.float64)


def placements(scene: Scene, poses: Floats) -> Floats:
    """Return where each body is in each pose.

    Args:
        scene: the compiled world.
        poses: (n, nq) as in ``Rollout.poses``.

    Returns:
        (n, nbody, 7) position [m] and unit quaternion (w, x, y, z) of each body's frame.
    """
    data = mujoco.MjData(scene.model)
    placed = np.empty((len(poses), scene.model.nbody, 7))
    for i, pose in enumerate(poses):
        data.qpos[:] = pose
        mujoco.mj_kinematics(scene.model, data)
        placed[i, :, :3], placed[i, :, 3:] = data.xpos, data.xquat
    return placed


def n_sound(scene: Scene, poses: Floats) -> int:
    """Count the poses before the numbers of a robot, or of what it drags, ran away; all, if they did not.

    Args:
        scene: the compiled world.
        poses: (n, nq) as in ``Rollout.poses``.
    """
    wild = ~np.isfinite(poses).all(axis=1)
    n_finite = int(np.argmax(wild)) if wild.any() else len(poses)
    own = np.isin(scene.model.body_rootid, scene.roots)
    steps = np.abs(np.diff(placements(scene, poses[:n_finite])[:, own, :3], axis=0)).max(axis=(1, 2), initial=0)
    return int(np.argmax(steps > LEAP)) + 1 if (steps > LEAP).any() else n_finite


def sound_poses(scene: Scene, poses: Floats) -> Floats:
    """Return the poses before the numbers ran away, (n, nq); that of the start if there is none."""
    n = n_sound(scene, poses)
    return poses[:n] if n else scene.start[np.newaxis]


def rope_ends(scene: Scene, placed: Floats) -> Floats:
    """Return the two ends of the rope, (n, 2, 3) [m], where bodies are as in ``placements``; (n, 0, 3) without one."""
    sites = [scene.model.site(name) for name in ROPE_ENDS] if scene.rope else []
    ends = [placed[:, site.bodyid[0], :3] + rotate(placed[:, site.bodyid[0], 3:], site.pos) for site in sites]
    return np.stack(ends, axis=1) if ends else np.empty((len(placed), 0, 3))


def rotate(quaternions: Floats, vectors: Floats) -> Floats:
    """Turn vectors, (n, 3) or (3,), by unit quaternions (w, x, y, z), (n, 4)."""
    w, axis = quaternions[:, :1], quaternions[:, 1:]
    across = 2 * np.cross(axis, vectors)
    return vectors + w * across + np.cross(axis, across)


def skins(scene: Scene, pose: Floats, *, loose: bool = False) -> list[tuple[Floats, Floats]]:
    """Lay out the robot and its loads in a pose, or what lies about, for a drawing that needs no GL.

    Args:
        scene: the compiled world.
        pose: (nq,) as in ``Rollout.poses``.
        loose: whether to lay out what lies about instead.

    Returns:
        For each part, (k, 3) points on its skin [m], of which it is the hull, and its colour, (4,) RGBA. A rope is
        the two points between which it hangs.
    """
    model, data = scene.model, mujoco.MjData(scene.model)
    data.qpos[:] = pose
    mujoco.mj_kinematics(model, data)
    root = model.body_rootid[model.geom_bodyid]
    moving = np.flatnonzero((root > 0) & (np.isin(root, scene.roots) != loose)).tolist()
    parts = [
        (data.geom_xpos[i] + _points(model, i) @ data.geom_xmat[i].reshape(3, 3).T, model.geom_rgba[i]) for i in moving
    ]
    if scene.rope and not loose:
        ends = np.array([data.site(name).xpos for name in ROPE_ENDS])
        parts.append((ends, model.tendon_rgba[0]))
    return parts


def outline(points: Floats) -> Floats:
    """Return the corners of the hull of (k, 2) points, in order: the farthest in each of many ways; a rope as it is."""
    if len(points) == ROPE:
        return points
    farthest = np.argmax(points @ _WAYS.T, axis=0)
    return points[farthest[np.flatnonzero(np.diff(farthest, prepend=-1))]]


def _points(model: mujoco.MjModel, geom: int) -> Floats:
    return _surface(model, model.geom_type[geom], model.geom_size[geom], int(model.geom_dataid[geom]))[0]


# ----------------------------------------------------------------------------------------------------- primitives


def _surface(model: mujoco.MjModel, kind: int, size: Floats, data: int) -> tuple[Floats, Indices]:
    """Return the corners of a geom in its own frame, (k, 3) [m], and its (m, 3) triangles."""
    match mujoco.mjtGeom(kind):
        case mujoco.mjtGeom.mjGEOM_PLANE:
            return _grid(np.array([-1.0, 1.0]), np.array([-1.0, 1.0]), np.zeros((2, 2)))
        case mujoco.mjtGeom.mjGEOM_HFIELD:
            return _hills(model, data)
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            ends = size[1] * np.repeat([1, -1], ALONG // 2 * AROUND)
            return BALL * size[0] + np.stack([0 * ends, 0 * ends, ends], axis=1), _WRAP
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            ends = np.concatenate([RING + np.array([0, 0, end]) for end in (1, -1)]) * [size[0], size[0], size[1]]
            return ends[_CYLINDER_CORNERS], _CYLINDER
        case mujoco.mjtGeom.mjGEOM_BOX:
            return CUBE * size, _BOX
        case mujoco.mjtGeom.mjGEOM_MESH:
            corners, faces = (
                values[start[data] : start[data] + count[data]]
                for values, start, count in (
                    (model.mesh_vert, model.mesh_vertadr, model.mesh_vertnum),
                    (model.mesh_face, model.mesh_faceadr, model.mesh_facenum),
                )
            )
            split = corners[faces.ravel()].astype(np.float64)
            return split, np.arange(len(split), dtype=np.intp).reshape(-1, 3)
        case _:
            return BALL * size[0], _WRAP


def _grid(x: Floats, y: Floats, z: Floats) -> tuple[Floats, Indices]:
    """Span (len(y), len(x)) heights over a grid."""
    across, along = np.meshgrid(x, y)
    corner = np.arange(z.size, dtype=np.intp).reshape(z.shape)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]
    triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return np.stack([across, along, z], axis=-1).reshape(-1, 3), triangles


def _hills(model: mujoco.MjModel, field: int) -> tuple[Floats, Indices]:
    rows, columns, start = (int(of[field]) for of in (model.hfield_nrow, model.hfield_ncol, model.hfield_adr))
    length, width, highest, _ = model.hfield_size[field]
    heights = model.hfield_data[start : start + rows * columns].reshape(rows, columns) * highest
    return _grid(np.linspace(-length, length, columns), np.linspace(-width, width, rows), heights.astype(np.float64))


def _wrap(rings: int) -> Indices:
    """Join rings of corners, each to the next below it, and close both ends with fans."""
    turn = np.arange(AROUND)
    upper = (np.arange(rings - 1)[:, np.newaxis] * AROUND + turn).ravel()
    upper_next = (np.arange(rings - 1)[:, np.newaxis] * AROUND + (turn + 1) % AROUND).ravel()
    sides = np.stack([upper, upper + AROUND, upper_next + AROUND, upper, upper_next + AROUND, upper_next], axis=1)
    fan = np.stack([0 * turn[2:], turn[1:-1], turn[2:]], axis=1)
    bottom = fan[:, ::-1] + (rings - 1) * AROUND
    return np.concatenate([sides.reshape(-1, 3), fan, bottom]).astype(np.intp)


_WAYS = np.array([(math.cos(turn), math.sin(turn)) for turn in np.arange(OUTLINE) * math.tau / OUTLINE])
_TURN = np.linspace(0, math.tau, AROUND, endpoint=False)
RING = np.stack([np.cos(_TURN), np.sin(_TURN), np.zeros(AROUND)], axis=1)
BALL = np.concatenate([RING * math.sin(t) + [0, 0, math.cos(t)] for t in (np.arange(ALONG) + 0.5) * math.pi / ALONG])
_WRAP = _wrap(ALONG)
_CYLINDER_CORNERS = np.concatenate([np.arange(2 * AROUND), np.arange(2 * AROUND)])  # of the side, and of the ends again
_CYLINDER = np.concatenate([_wrap(2)[: 2 * AROUND], _wrap(2)[2 * AROUND :] + 2 * AROUND])
_SIDE = np.array([(1, -1, -1), (1, 1, -1), (1, 1, 1), (1, -1, 1)], dtype=np.float64)
CUBE = np.concatenate([np.roll(way * _SIDE[::way], axis, axis=1) for axis in range(3) for way in (1, -1)])
_BOX = np.concatenate([np.array([(0, 1, 2), (0, 2, 3)]) + 4 * side for side in range(6)]).astype(np.intp)
