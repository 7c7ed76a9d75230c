"""Geometry for drawing: the surface of every geom and site, and the placement of bodies in a pose."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats, Indices
from walkerlab.world.scene import ORIENTATION, POSITION, ROPE_ENDS, Scene

N_AROUND = 24  # vertices of round surfaces about their axis
N_RINGS = 12  # rings of vertices of a sphere from pole to pole
MAX_JUMP = 3.0  # m; a body that moves farther between two recorded poses (150 m/s) shows that the physics broke down
PLANE_EXTENT = 60.0  # m to each side to which an infinite plane is drawn
CAPSULE = int(mujoco.mjtGeom.mjGEOM_CAPSULE)
ROPE_POINTS = 2  # points of a part that is drawn as a line
MAX_OUTLINE_CORNERS = 48


@dataclass(frozen=True, eq=False)
class Surface:
    """Visible surface of a geom or a site.

    Attributes:
        points: Vertices in the frame of the body [m], shape (k, 3); faces share them on round surfaces only.
        triangles: Vertex indices, counter-clockwise seen from outside, shape (m, 3).
        colour: RGBA, shape (4,).
        body: Index of the body; 0 is the ground.
        material: Index of the material, or -1.
        is_ball: Whether it is a sphere, which needs a pattern for its rolling to be visible.
    """

    points: Floats
    triangles: Indices
    colour: Floats
    body: int
    material: int
    is_ball: bool


def visible_surfaces(model: mujoco.MjModel, *, bodies: bool, far: float = PLANE_EXTENT) -> Iterator[Surface]:
    """Yield the surfaces of all visible geoms and sites; the rope is neither.

    Args:
        model: Compiled model.
        bodies: True for the surfaces of moving bodies, False for the surfaces of the ground, including texture pieces.
        far: Distance [m] to each side to which a plane is drawn.
    """
    for kind in ("geom", "site"):
        types, sizes, body, colours, positions, orientations, materials = (
            getattr(model, f"{kind}_{field}") for field in ("type", "size", "bodyid", "rgba", "pos", "quat", "matid")
        )
        for i in np.flatnonzero((colours[:, 3] > 0) & ((body > 0) == bodies)).tolist():
            points, triangles = _geom_surface(
                model, types[i], sizes[i], int(model.geom_dataid[i]) if kind == "geom" else -1
            )
            if types[i] == mujoco.mjtGeom.mjGEOM_PLANE:
                points = points * far
            rotation = np.empty(9)
            mujoco.mju_quat2Mat(rotation, orientations[i])
            yield Surface(
                points=positions[i] + points @ rotation.reshape(3, 3).T,
                triangles=triangles,
                colour=colours[i].astype(np.float64),
                body=int(body[i]),
                material=int(materials[i]),
                is_ball=types[i] == mujoco.mjtGeom.mjGEOM_SPHERE,
            )


def material_image(model: mujoco.MjModel, material: int) -> tuple[NDArray[np.uint8], Floats]:
    """Return the image of a material, (height, width, 3), and its repetitions per metre, (2,)."""
    texture = int(model.mat_texid[material, int(mujoco.mjtTextureRole.mjTEXROLE_RGB)])
    height, width, start = (int(array[texture]) for array in (model.tex_height, model.tex_width, model.tex_adr))
    image = model.tex_data[start : start + 3 * height * width].reshape(height, width, 3)
    return image, model.mat_texrepeat[material].astype(np.float64)


def body_placements(scene: Scene, poses: Floats) -> Floats:
    """Return the position and orientation of each body in each pose.

    Args:
        scene: Compiled scene.
        poses: Poses as in ``Rollout.poses``, shape (n, nq).

    Returns:
        Position [m] and unit quaternion (w, x, y, z) of each body's frame, shape (n, nbody, 7).
    """
    data = mujoco.MjData(scene.model)
    placed = np.empty((len(poses), scene.model.nbody, 7))
    for i, pose in enumerate(poses):
        data.qpos[:] = pose
        mujoco.mj_kinematics(scene.model, data)
        placed[i, :, POSITION] = data.xpos
        placed[i, :, ORIENTATION] = data.xquat
    return placed


def n_valid_poses(scene: Scene, poses: Floats) -> int:
    """Count the poses before the physics of the robot or its sledge broke down; all of them if it did not.

    Args:
        scene: Compiled scene.
        poses: Poses as in ``Rollout.poses``, shape (n, nq).
    """
    is_invalid = ~np.isfinite(poses).all(axis=1)
    n_finite = int(np.argmax(is_invalid)) if is_invalid.any() else len(poses)
    is_followed = np.isin(scene.model.body_rootid, scene.roots)
    positions = body_placements(scene, poses[:n_finite])[:, is_followed, POSITION]
    jumps = np.abs(np.diff(positions, axis=0)).max(axis=(1, 2), initial=0)
    return int(np.argmax(jumps > MAX_JUMP)) + 1 if (jumps > MAX_JUMP).any() else n_finite


def valid_poses(scene: Scene, poses: Floats) -> Floats:
    """Return the poses before the physics broke down, shape (n, nq); the start pose if no pose is valid."""
    n = n_valid_poses(scene, poses)
    return poses[:n] if n else scene.start[np.newaxis]


def rope_ends(scene: Scene, placed: Floats) -> Floats:
    """Return the ends of the rope [m] for the given ``body_placements``, shape (n, 2, 3); (n, 0, 3) without a rope."""
    sites = [scene.model.site(name) for name in ROPE_ENDS] if scene.rope_length else []
    ends = [
        placed[:, site.bodyid[0], POSITION] + rotate(placed[:, site.bodyid[0], ORIENTATION], site.pos) for site in sites
    ]
    return np.stack(ends, axis=1) if ends else np.empty((len(placed), 0, 3))


def rotate(quaternions: Floats, vectors: Floats) -> Floats:
    """Rotate vectors, (n, 3) or (3,), by unit quaternions (w, x, y, z), (n, 4)."""
    w, axis = quaternions[:, :1], quaternions[:, 1:]
    cross = 2 * np.cross(axis, vectors)
    return vectors + w * cross + np.cross(axis, cross)


def surface_points(scene: Scene, pose: Floats, *, loose: bool = False) -> list[tuple[Floats, Floats]]:
    """Return the surface points of the robot and its loads, or of the obstacles, for drawings without OpenGL.

    Args:
        scene: Compiled scene.
        pose: Pose as in ``Rollout.poses``, shape (nq,).
        loose: Whether to return the loose obstacles instead of the robot and its loads.

    Returns:
        For each geom the points [m] whose convex hull it is, shape (k, 3), and its RGBA colour, shape (4,).
        A rope is represented by its two ends.
    """
    model = scene.model
    data = mujoco.MjData(model)
    data.qpos[:] = pose
    mujoco.mj_kinematics(model, data)
    root = model.body_rootid[model.geom_bodyid]
    selected = np.flatnonzero((root > 0) & (np.isin(root, scene.roots) != loose)).tolist()
    parts = [
        (data.geom_xpos[i] + _points(model, i) @ data.geom_xmat[i].reshape(3, 3).T, model.geom_rgba[i])
        for i in selected
    ]
    if scene.rope_length and not loose:
        ends = np.array([data.site(name).xpos for name in ROPE_ENDS])
        parts.append((ends, model.tendon_rgba[0]))
    return parts


def convex_outline(points: Floats) -> Floats:
    """Return the corners of the convex hull of (k, 2) points, in order; return the two points of a rope unchanged.

    The hull is approximated by the farthest point in each of ``MAX_OUTLINE_CORNERS`` directions.
    """
    if len(points) == ROPE_POINTS:
        return points
    farthest = np.argmax(points @ _DIRECTIONS.T, axis=0)
    return points[farthest[np.flatnonzero(np.diff(farthest, prepend=-1))]]


def _points(model: mujoco.MjModel, geom: int) -> Floats:
    return _geom_surface(model, model.geom_type[geom], model.geom_size[geom], int(model.geom_dataid[geom]))[0]


# ----------------------------------------------------------------------------------------------------- primitives


def _geom_surface(model: mujoco.MjModel, kind: int, size: Floats, data: int) -> tuple[Floats, Indices]:
    """Return the vertices of a geom in its own frame [m], shape (k, 3), and its triangles, shape (m, 3).

    Args:
        model: Compiled model.
        kind: Type of the geom, an ``mjtGeom``.
        size: Size parameters of the geom, shape (3,).
        data: Index of its mesh or height field, or -1.
    """
    match mujoco.mjtGeom(kind):
        case mujoco.mjtGeom.mjGEOM_PLANE:
            return _grid_surface(np.array([-1.0, 1.0]), np.array([-1.0, 1.0]), np.zeros((2, 2)))
        case mujoco.mjtGeom.mjGEOM_HFIELD:
            return _height_field(model, data)
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            z = size[1] * np.repeat([1, -1], N_RINGS // 2 * N_AROUND)
            return UNIT_BALL * size[0] + np.stack([0 * z, 0 * z, z], axis=1), _BALL_TRIANGLES
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            rings = np.concatenate([UNIT_RING + np.array([0, 0, z]) for z in (1, -1)]) * [size[0], size[0], size[1]]
            return rings[_CYLINDER_VERTICES], _CYLINDER_TRIANGLES
        case mujoco.mjtGeom.mjGEOM_BOX:
            return UNIT_CUBE * size, _BOX_TRIANGLES
        case mujoco.mjtGeom.mjGEOM_MESH:
            vertices, faces = (
                values[start[data] : start[data] + count[data]]
                for values, start, count in (
                    (model.mesh_vert, model.mesh_vertadr, model.mesh_vertnum),
                    (model.mesh_face, model.mesh_faceadr, model.mesh_facenum),
                )
            )
            split = vertices[faces.ravel()].astype(np.float64)
            return split, np.arange(len(split), dtype=np.intp).reshape(-1, 3)
        case _:
            return UNIT_BALL * size[0], _BALL_TRIANGLES


def _grid_surface(x: Floats, y: Floats, z: Floats) -> tuple[Floats, Indices]:
    """Return the surface of heights z, (len(y), len(x)), over a grid."""
    grid_x, grid_y = np.meshgrid(x, y)
    index = np.arange(z.size, dtype=np.intp).reshape(z.shape)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return np.stack([grid_x, grid_y, z], axis=-1).reshape(-1, 3), triangles


def _height_field(model: mujoco.MjModel, field: int) -> tuple[Floats, Indices]:
    rows, columns, start = (int(array[field]) for array in (model.hfield_nrow, model.hfield_ncol, model.hfield_adr))
    half_length, half_width, highest, _ = model.hfield_size[field]
    heights = model.hfield_data[start : start + rows * columns].reshape(rows, columns) * highest
    x = np.linspace(-half_length, half_length, columns)
    y = np.linspace(-half_width, half_width, rows)
    return _grid_surface(x, y, heights.astype(np.float64))


def _ring_triangles(n_rings: int) -> Indices:
    """Return triangles that join each ring of ``N_AROUND`` vertices to the next one below and close both ends."""
    around = np.arange(N_AROUND)
    upper = (np.arange(n_rings - 1)[:, np.newaxis] * N_AROUND + around).ravel()
    upper_next = (np.arange(n_rings - 1)[:, np.newaxis] * N_AROUND + (around + 1) % N_AROUND).ravel()
    lower, lower_next = upper + N_AROUND, upper_next + N_AROUND
    sides = np.stack([upper, lower, lower_next, upper, lower_next, upper_next], axis=1)
    top = np.stack([0 * around[2:], around[1:-1], around[2:]], axis=1)
    bottom = top[:, ::-1] + (n_rings - 1) * N_AROUND
    return np.concatenate([sides.reshape(-1, 3), top, bottom]).astype(np.intp)


_OUTLINE_ANGLES = np.arange(MAX_OUTLINE_CORNERS) * math.tau / MAX_OUTLINE_CORNERS
_DIRECTIONS = np.array([(math.cos(angle), math.sin(angle)) for angle in _OUTLINE_ANGLES])

_AZIMUTHS = np.linspace(0, math.tau, N_AROUND, endpoint=False)
_POLAR_ANGLES = (np.arange(N_RINGS) + 0.5) * math.pi / N_RINGS
UNIT_RING = np.stack([np.cos(_AZIMUTHS), np.sin(_AZIMUTHS), np.zeros(N_AROUND)], axis=1)
"""Vertices of a circle of radius 1, (N_AROUND, 3)."""
UNIT_BALL = np.concatenate([UNIT_RING * math.sin(angle) + [0, 0, math.cos(angle)] for angle in _POLAR_ANGLES])
"""Vertices of a sphere of radius 1, (N_RINGS * N_AROUND, 3)."""
_BALL_TRIANGLES = _ring_triangles(N_RINGS)

# The vertices of both end rings twice, for the side and for the flat ends, which have different normals.
_CYLINDER_VERTICES = np.concatenate([np.arange(2 * N_AROUND), np.arange(2 * N_AROUND)])
_CYLINDER_TRIANGLES = _ring_triangles(2)
_N_SIDE_TRIANGLES = 2 * N_AROUND
_CYLINDER_TRIANGLES[_N_SIDE_TRIANGLES:] += 2 * N_AROUND

_CUBE_SIDE = np.array([(1, -1, -1), (1, 1, -1), (1, 1, 1), (1, -1, 1)], dtype=np.float64)
UNIT_CUBE = np.concatenate([np.roll(sign * _CUBE_SIDE[::sign], axis, axis=1) for axis in range(3) for sign in (1, -1)])
"""Vertices of a cube from -1 to 1, four for each side, (24, 3)."""
_BOX_TRIANGLES = np.concatenate([np.array([(0, 1, 2), (0, 2, 3)]) + 4 * side for side in range(6)]).astype(np.intp)
