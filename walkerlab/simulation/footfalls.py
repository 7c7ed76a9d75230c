"""Contacts of each foot with the ground, from which a gait diagram is drawn."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats
from walkerlab.world.entities.walker import SIDES
from walkerlab.world.scene import Scene


def foot_names(scene: Scene) -> tuple[str, ...]:
    """Return the name of each foot, such as ``"left 1"``: its side, and its segment counted from the front."""
    return tuple(f"{side} {number}" for number, side in _legs_in_actuator_order(scene))


def find_footfalls(scene: Scene, poses: Floats) -> NDArray[np.bool_]:
    """Find the poses in which each foot touches the ground or anything else outside the robot's body.

    A foot is the whole of a shank, because a robot may walk on its toes or kneel. A sledge is not part of the body.

    Args:
        scene: Compiled scene.
        poses: Poses as in ``Rollout.poses``, shape (n, nq).

    Returns:
        Whether each foot touches something, in the order of ``foot_names``, shape (n, n_legs); False in poses that
        are not finite.

    Raises:
        ValueError: If the poses do not fit the scene.
    """
    model = scene.model
    if poses.ndim != 2 or poses.shape[1] != model.nq:
        raise ValueError(
            f"poses must be those of a walk in this scene, shape (n, {model.nq}); got {poses.shape}. Record them with "
            "the genome and settings of the scene: simulate(genome, settings).poses"
        )
    data = mujoco.MjData(model)
    n_legs = scene.phenotype.n_legs
    foot_of_geom = np.full(model.ngeom, -1)
    shanks = [model.geom(f"walker/{side}_shank{number}").id for number, side in _legs_in_actuator_order(scene)]
    foot_of_geom[shanks] = np.arange(n_legs)
    is_robot = scene.is_robot_geom
    footfalls = np.zeros((len(poses), n_legs), dtype=np.bool_)
    for pose, on_ground in zip(poses, footfalls, strict=True):
        if not np.isfinite(pose).all():
            continue
        data.qpos[:] = pose
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        pairs: NDArray[np.intc] = data.contact.geom
        with_others = pairs[is_robot[pairs].sum(axis=1) == 1]
        touching = foot_of_geom[with_others]
        on_ground[touching[touching >= 0]] = True
    return footfalls


def _legs_in_actuator_order(scene: Scene) -> list[tuple[int, str]]:
    """Return segment number, counted from 1, and side of each leg, in the order of the actuators."""
    plan = enumerate(scene.phenotype.plan, start=1)
    return [(number, side) for number, has_legs in plan if has_legs for side in SIDES]
