"""Contacts of the robot with the ground: those of each foot over time, and the share of all contacts made by feet."""

import math
from collections.abc import Iterator

import mujoco
import numpy as np
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats
from walkerlab.world.entities.walker import list_legs
from walkerlab.world.scene import Scene

FOOT_LENGTH = 0.25  # share of a shank's length, at its end, that counts as its foot


def foot_names(scene: Scene) -> tuple[str, ...]:
    """Return the name of each foot, such as ``"left 1"``: its side, and its segment counted from the front."""
    return tuple(f"{side} {number}" for number, side in list_legs(scene.phenotype.plan))


def find_footfalls(scene: Scene, poses: Floats) -> NDArray[np.bool_]:
    """Find the poses in which each foot touches the ground or anything else outside the robot's body.

    A foot is the whole shank, because a robot may walk on its toes or kneel. A sledge is not part of the body.

    Args:
        scene: Compiled scene.
        poses: Poses as in ``Rollout.poses``, shape (n, nq).

    Returns:
        Whether each foot touches something, in the order of ``foot_names``, shape (n, n_legs); False in poses that
        are not finite.

    Raises:
        ValueError: If the poses do not fit the scene.
    """
    shanks = shank_geoms(scene)
    footfalls = np.zeros((len(poses), len(shanks)), dtype=np.bool_)
    for (geoms, _), on_ground in zip(_find_contacts(scene, poses), footfalls, strict=True):
        on_ground[:] = np.isin(shanks, geoms)
    return footfalls


def foot_share(scene: Scene, poses: Floats) -> float:
    """Return the share of a robot's ground contacts that is made by its feet, from 0 to 1.

    In each pose, each part of the body (trunk, thigh or shank) that touches anything outside the robot counts once. A
    shank counts as a foot if only its end touches, and not if the robot kneels on it or it lies flat.

    Args:
        scene: Compiled scene.
        poses: Poses as in ``Rollout.poses``, shape (n, nq).

    Returns:
        The share; NaN if the robot touches nothing.

    Raises:
        ValueError: If the poses do not fit the scene.
    """
    n_parts = 0
    n_feet = 0
    shanks = shank_geoms(scene)
    for geoms, along in _find_contacts(scene, poses):
        parts = set(geoms)
        beside_foot = set(geoms[along < 1 - FOOT_LENGTH])
        n_parts += len(parts)
        n_feet += len(parts.intersection(shanks) - beside_foot)
    return n_feet / n_parts if n_parts else math.nan


def shank_geoms(scene: Scene) -> list[int]:
    """Return the geom of each shank, in the order of ``foot_names``."""
    return [scene.model.geom(f"walker/{side}_shank{number}").id for number, side in list_legs(scene.phenotype.plan)]


def _find_contacts(scene: Scene, poses: Floats) -> Iterator[tuple[NDArray[np.intc], Floats]]:
    """Find the contacts of the robot with anything else in each pose.

    Yields:
        For each contact, the geom of the robot, shape (n,), and the place of the contact along the geom's bone, shape
        (n,): 0 at its joint and 1 at its end; both empty for poses that are not finite.

    Raises:
        ValueError: If the poses do not fit the scene.
    """
    model = scene.model
    if poses.ndim != 2 or poses.shape[1] != model.nq:
        raise ValueError(
            f"poses must come from a walk in this scene, shape (n, {model.nq}); got {poses.shape}. Record them with "
            "the genome and settings of the scene: simulate(genome, settings).poses"
        )
    data = mujoco.MjData(model)
    is_robot = scene.is_robot_geom
    length = 2 * np.maximum(model.geom_size[:, 1], mujoco.mjMINVAL)
    for pose in poses:
        if not np.isfinite(pose).all():
            yield np.empty(0, dtype=np.intc), np.empty(0)
            continue
        data.qpos[:] = pose
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        pairs: NDArray[np.intc] = data.contact.geom
        is_outer = is_robot[pairs].sum(axis=1) == 1
        geoms = pairs[is_outer][is_robot[pairs[is_outer]]]
        bodies = model.geom_bodyid[geoms]
        bone = -data.xmat[bodies].reshape(-1, 3, 3)[:, :, 2]  # legs point down in the frames of their bodies
        along = ((data.contact.pos[is_outer] - data.xpos[bodies]) * bone).sum(axis=1) / length[geoms]
        yield geoms, along
