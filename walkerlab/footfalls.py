"""When each foot is on the ground: what a gait diagram is drawn from."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from walkerlab.entities.walker import SIDES
from walkerlab.genes import Floats
from walkerlab.scene import Scene


def feet(scene: Scene) -> tuple[str, ...]:
    """Name each foot as in its body's shank, (n_legs,): segments from the front, left before right: ``"left 1"``."""
    return tuple(f"{side} {number}" for number, side in _legs(scene))


def footfalls(scene: Scene, poses: Floats) -> NDArray[np.bool_]:
    """Find out in which poses each foot touches the ground, or whatever lies on it.

    A foot is the whole of a shank: a robot may walk on its toes or kneel. What it touches of its own body does not
    count; a sledge does not belong to the body.

    Args:
        scene: the compiled world.
        poses: (n, nq) as in ``Rollout.poses``.

    Returns:
        (n, n_legs) in the order of ``feet``; where a pose is not finite, nothing touches.

    Raises:
        ValueError: if the poses are not of this scene.
    """
    model = scene.model
    if poses.ndim != 2 or poses.shape[1] != model.nq:
        raise ValueError(
            f"footfalls takes the poses of a walk in this scene, (n, {model.nq}); got {poses.shape}. They must come "
            "from the same genome and settings, and be recorded: simulate(genome, settings).poses"
        )
    data, n_legs = mujoco.MjData(model), scene.phenotype.n_legs
    foot = np.full(model.ngeom, -1)  # the foot that a geom is; -1 for all others
    foot[[model.geom(f"walker/{side}_shank{number}").id for number, side in _legs(scene)]] = np.arange(n_legs)
    down = np.zeros((len(poses), n_legs), dtype=np.bool_)
    for pose, on_ground in zip(poses, down, strict=True):
        if not np.isfinite(pose).all():
            continue
        data.qpos[:] = pose
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        pairs: NDArray[np.intc] = data.contact.geom
        touching = foot[pairs[scene.own[pairs].sum(axis=1) == 1]]
        on_ground[touching[touching >= 0]] = True
    return down


def _legs(scene: Scene) -> list[tuple[int, str]]:
    """List segment, counted from 1, and side of each leg, in the order in which they were grown."""
    return [(number, side) for number, legged in enumerate(scene.phenotype.plan, start=1) if legged for side in SIDES]
