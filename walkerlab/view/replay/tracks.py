"""Positions of the moving bodies of recorded walks over time, in a compact binary format for the player."""

import zlib
from dataclasses import dataclass

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.simulation.rollout import Rollout
from walkerlab.world.assembly import ROBOT_BODY
from walkerlab.world.geometry import body_placements, rope_ends, valid_poses
from walkerlab.world.scene import ORIENTATION, Scene

TIME_STEP = 0.02  # s between two frames of a replay, as between two servo targets
TRANSFORM_RESOLUTION = (1e-4,) * 3 + (1 / 30000,) * 4 + (1e-4,)  # position [m], unit quaternion, length [m]
MOTION_TOLERANCE = 5e-4  # m, or quaternion units; a body that moves less throughout the walk is at rest
TIME_TOLERANCE = 1e-9  # s


@dataclass(frozen=True, eq=False)
class Tracks:
    """Motion of the bodies of one recorded walk at n times, up to the time at which the physics breaks down, if any.

    A transform is a position [m], a unit quaternion (w, x, y, z) and a scale along z.

    Attributes:
        moving_bodies: Indices of the k bodies that move.
        transforms: Transforms of these bodies, with scale 1, shape (k, n, 8).
        rope: Transforms of a rod of length 1 along z that becomes the rope, shape (n, 8); (0, 8) without a rope.
        start: Position and orientation of each body at the start, shape (nbody, 7).
        com: Centre of mass of the robot [m], shape (n, 3).
        load: Position of the sledge [m], shape (n, 3); (0, 3) without a sledge.
    """

    moving_bodies: list[int]
    transforms: Floats
    rope: Floats
    start: Floats
    com: Floats
    load: Floats


def frame_times(duration: float) -> Floats:
    """Return evenly spaced times from 0 to the duration of a walk [s], about ``TIME_STEP`` apart."""
    return np.linspace(0, duration, round(duration / TIME_STEP) + 1)


def track_bodies(scene: Scene, rollout: Rollout) -> Tracks:
    """Compute the tracks of all bodies of a walk, of its rope and of its centre of mass.

    Args:
        scene: Compiled scene of the walk, with or without scenery.
        rollout: Rollout with its poses.
    """
    poses = valid_poses(scene, rollout.poses)
    n_valid = len(poses)
    time = rollout.time[:n_valid]
    grid = frame_times(float(rollout.time[-1]))
    grid = grid[: max(1, int(np.searchsorted(grid, time[-1] + TIME_TOLERANCE)))]
    placed = body_placements(scene, poses)
    _align_quaternions(placed)
    ends = resample(grid, time, rope_ends(scene, placed))
    placed = resample(grid, time, placed)
    placed[:, :, ORIENTATION] /= np.linalg.norm(placed[:, :, ORIENTATION], axis=2, keepdims=True)
    moves = np.abs(placed - placed[0]).max(axis=(0, 2)) > MOTION_TOLERANCE
    moving = np.flatnonzero(moves | (scene.model.body_rootid == ROBOT_BODY)).tolist()
    unit_scale = np.ones((len(moving), len(placed), 1))
    return Tracks(
        moving_bodies=moving,
        transforms=np.concatenate([placed[:, moving].transpose(1, 0, 2), unit_scale], axis=2),
        rope=_rod_transforms(ends),
        start=placed[0],
        com=resample(grid, time, np.nan_to_num(rollout.com[:n_valid])),
        load=resample(grid, time, np.nan_to_num(rollout.load[:n_valid])) if scene.rope_length else np.empty((0, 3)),
    )


def _align_quaternions(placed: Floats) -> None:
    """Choose the sign of each quaternion that is closer to its predecessor; both signs mean the same rotation.

    Args:
        placed: Position and orientation of each body in each pose, shape (n, nbody, 7); modified in place.
    """
    orientations = placed[:, :, ORIENTATION]
    for i in range(1, len(placed)):
        is_opposite = (orientations[i] * orientations[i - 1]).sum(axis=1) < 0
        orientations[i] *= np.where(is_opposite, -1, 1)[:, np.newaxis]


def resample(grid: Floats, time: Floats, track: Floats) -> Floats:
    """Interpolate a track linearly at the times of a grid.

    Args:
        grid: Times at which to interpolate [s], shape (m,).
        time: Times of the rows of the track [s], shape (n,).
        track: Values at these times, shape (n, …).

    Returns:
        Values at the times of the grid, shape (m, …).
    """
    if len(time) == 1:
        return np.repeat(track, len(grid), axis=0)
    after = np.clip(np.searchsorted(time, grid - TIME_TOLERANCE), 1, len(time) - 1)
    before = after - 1
    fraction = np.clip((grid - time[before]) / (time[after] - time[before]), 0, 1)
    fraction = fraction.reshape(-1, *[1] * (track.ndim - 1))
    return track[before] * (1 - fraction) + track[after] * fraction


def pack_channels(channels: Floats, resolution: Floats) -> bytes:
    """Encode channels for the player, as first values and differences.

    Args:
        channels: Values of each channel over time, shape (c, n).
        resolution: Unit to which each channel is rounded, shape (c,).

    Returns:
        zlib of c first values (float64) and c × (n - 1) differences in units of the resolution (int32), little-endian.
    """
    in_units = np.rint(channels / resolution[:, np.newaxis])
    differences = np.diff(in_units, axis=1)
    first_values = (in_units[:, 0] * resolution).astype("<f8").tobytes()
    return zlib.compress(first_values + differences.astype("<i4").tobytes(), 9)


def _rod_transforms(ends: Floats) -> Floats:
    """Return the transforms, (n, 8), of a rod of length 1 along z that is stretched between ends, (n, 2, 3).

    Without ends, (n, 0, 3), the shape is (0, 8).
    """
    if not ends.shape[1]:
        return np.empty((0, 8))
    along = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(along, axis=1, keepdims=True)
    x, y, z = (along / np.maximum(length, 1e-9)).T
    rotation = np.stack([1 + z, -y, x, 0 * x], axis=1)
    rotation /= np.maximum(np.linalg.norm(rotation, axis=1, keepdims=True), 1e-9)
    return np.concatenate([ends.mean(axis=1), rotation, length], axis=1)
