"""Shadows of trunks and legs on the ground, in the light of a high sun on the near side."""

import math
from collections.abc import Iterator

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.view.replay import meshes
from walkerlab.view.replay.tracks import Tracks
from walkerlab.world.geometry import rotate
from walkerlab.world.heights import ground_height, slope
from walkerlab.world.scene import ORIENTATION, POSITION, Scene

SHADOW_SHIFT = np.array([-0.25, 0.45])
"""Shift of a shadow along x and y for each metre of height: it falls behind the robot, seen from its right."""

_TURN = math.sqrt(0.5)  # cosine of half a quarter turn, which turns the mesh of a shadow from z to x


def bone_ends(scene: Scene, tracks: Tracks) -> Iterator[tuple[int, Floats]]:
    """Yield the geom of each trunk, thigh and shank, and the ends of its axis over time [m], shape (2, n, 3).

    Args:
        scene: Compiled scene.
        tracks: Tracks of a walk in this scene.
    """
    model = scene.model
    for geom in np.flatnonzero(scene.is_robot_geom).tolist():
        name = model.geom(geom).name
        if not any(part in name for part in ("trunk", "thigh", "shank")):
            continue
        placed = tracks.transforms[tracks.moving_bodies.index(int(model.geom_bodyid[geom]))]
        axis = rotate(model.geom_quat[geom][np.newaxis], np.array([0, 0, model.geom_size[geom, 1]]))[0]
        ends = (model.geom_pos[geom] + sign * axis for sign in (1, -1))
        yield geom, np.stack([placed[:, POSITION] + rotate(placed[:, ORIENTATION], end) for end in ends])


def shadow_transforms(scene: Scene, ends: Floats, geom: int) -> Floats:
    """Compute the transforms of the shadow of a bone: on the ground, parallel to the slope, from end to end.

    Args:
        scene: Compiled scene.
        ends: Ends of the axis of the bone over time [m], shape (2, n, 3).
        geom: Geom of the bone.

    Returns:
        Transforms of the shadow, whose mesh lies along z with length 1, shape (n, 8).
    """
    terrain = scene.settings.terrain
    heights = ends[..., 2] - ground_height(terrain, ends[..., 0], ends[..., 1])
    first, second = ends[..., :2] + np.maximum(heights, 0)[..., np.newaxis] * SHADOW_SHIFT
    along = second - first
    x, y = ((first + second) / 2).T
    half_yaw = np.unwrap(np.arctan2(along[:, 1], along[:, 0])) / 2
    half_pitch = -slope(terrain) / 2
    w = math.cos(half_pitch) * np.cos(half_yaw)
    i = math.sin(half_pitch) * np.sin(half_yaw)
    j = math.sin(half_pitch) * np.cos(half_yaw)
    k = math.cos(half_pitch) * np.sin(half_yaw)
    quaternion = _TURN * np.stack([w - j, i - k, w + j, i + k])
    z = ground_height(terrain, x, y) + meshes.GROUND_CLEARANCE
    length = np.linalg.norm(along, axis=1) + 2 * scene.model.geom_size[geom, 0]
    return np.stack([x, y, z, *quaternion, length], axis=1)
