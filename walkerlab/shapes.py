"""What the robot and its world look like: the skin of every part, wherever a pose puts it."""

import math

import mujoco
import numpy as np

from walkerlab.genes import Floats
from walkerlab.scene import ROPE_ENDS, Scene


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
    moving = np.flatnonzero((root > 0) & (np.isin(root, scene.roots) != loose))
    parts = [
        (data.geom_xpos[i] + _skin(model, i) @ data.geom_xmat[i].reshape(3, 3).T, model.geom_rgba[i])
        for i in moving.tolist()
    ]
    if scene.rope and not loose:
        ends = np.array([data.site(name).xpos for name in ROPE_ENDS])
        parts.append((ends, model.tendon_rgba[0]))
    return parts


def _skin(model: mujoco.MjModel, geom: int) -> Floats:
    """Return points on the skin of a geom, (k, 3) in its own frame [m]."""
    size = model.geom_size[geom]
    match mujoco.mjtGeom(model.geom_type[geom]):
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            return np.concatenate([_BALL * size[0] + [0, 0, end] for end in (size[1], -size[1])])
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return np.concatenate([_RING * size[0] + [0, 0, end] for end in (size[1], -size[1])])
        case mujoco.mjtGeom.mjGEOM_BOX:
            return _CORNERS * size
        case mujoco.mjtGeom.mjGEOM_MESH:
            mesh = model.geom_dataid[geom]
            start = model.mesh_vertadr[mesh]
            return model.mesh_vert[start : start + model.mesh_vertnum[mesh]].astype(np.float64)
        case _:
            return _BALL * size[0]


_AROUND = np.linspace(0, math.tau, 24, endpoint=False)
_RING = np.stack([np.cos(_AROUND), np.sin(_AROUND), np.zeros(24)], axis=1)
_BALL = np.concatenate([_RING * math.sin(t) + [0, 0, math.cos(t)] for t in (np.arange(12) + 0.5) * math.pi / 12])
_CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
