"""The parts of a robot and its loads as moving rods, for drawings."""

from dataclasses import dataclass

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.world.geometry import CAPSULE, body_placements, rope_ends, rotate
from walkerlab.world.scene import ORIENTATION, POSITION, Scene

ROPE_RADIUS = 0.004  # m, of the drawn rope


@dataclass(frozen=True, eq=False)
class Limb:
    """A part of the robot or its loads in n poses, as a rod around an axis.

    Attributes:
        ends: Ends of the axis [m], shape (n, 2, 3).
        radius: Radius [m].
        colour: RGBA, shape (4,).
        has_round_ends: Whether the rod has a hemisphere at each end.
    """

    ends: Floats
    radius: float
    colour: Floats
    has_round_ends: bool


def limb_tracks(scene: Scene, poses: Floats) -> list[Limb]:
    """Return each part of the robot and its loads as a rod in each pose.

    Args:
        scene: Compiled scene.
        poses: Poses as in ``Rollout.poses``, shape (n, nq).
    """
    model = scene.model
    placed = body_placements(scene, poses)
    limbs: list[Limb] = []
    for geom in np.flatnonzero(np.isin(model.body_rootid[model.geom_bodyid], scene.roots)).tolist():
        body = placed[:, model.geom_bodyid[geom]]
        size = model.geom_size[geom]
        is_capsule = model.geom_type[geom] == CAPSULE
        axis = np.array([0.0, 0.0, size[1]]) if is_capsule else np.array([size[0], 0.0, 0.0])
        ends = [
            model.geom_pos[geom] + rotate(model.geom_quat[geom][np.newaxis], sign * axis)[0] for sign in (-1.0, 1.0)
        ]
        track = np.stack([body[:, POSITION] + rotate(body[:, ORIENTATION], end) for end in ends], axis=1)
        limbs.append(Limb(track, float(size[0] if is_capsule else size[2]), model.geom_rgba[geom], is_capsule))
    if scene.rope_length:
        limbs.append(Limb(rope_ends(scene, placed), ROPE_RADIUS, model.tendon_rgba[0], True))
    return limbs
