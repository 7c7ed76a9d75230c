"""Recorded walks as numbers for the player: where each moving part is at each moment, small enough to be mailed."""

import zlib
from dataclasses import dataclass

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.simulation.rollout import Rollout
from walkerlab.world.geometry import placements, rope_ends, valid_poses
from walkerlab.world.scene import Scene

TICK = 0.02  # s from one moment of a replay to the next: that of the gait's clock
FINEST = (1e-4,) * 3 + (1 / 30000,) * 4 + (1e-4,)  # m, parts of a unit quaternion, m: to what tracks are rounded
STILL = 5e-4  # m, and parts of a quaternion, within which a part stays all the time


@dataclass(frozen=True, eq=False)
class Tracks:
    """Where the parts of one recorded walk are, until its numbers ran away, if they did.

    Attributes:
        moving: (k,) the bodies that move, of the scene's model.
        places: (k, n, 8) where each of them is: position [m], unit quaternion (w, x, y, z), and 1.
        rope: (n, 8) the rope as a rod: its middle, the turn of its axis from z, its length [m]; (0, 8) without one.
        still: (nbody, 7) where each body is at the start.
        com: (n, 3) centre of mass of the robot [m].
        load: (n, 3) where a sledge is [m]; (0, 3) without one.
    """

    moving: list[int]
    places: Floats
    rope: Floats
    still: Floats
    com: Floats
    load: Floats


def moments(duration: float) -> Floats:
    """Divide a walk [s] evenly, in steps of a ``TICK`` or nearly so."""
    return np.linspace(0, duration, round(duration / TICK) + 1)


def follow(scene: Scene, rollout: Rollout) -> Tracks:
    """Follow every body of a walk, its rope and its centre of mass, at even moments."""
    poses = valid_poses(scene, rollout.poses)
    sound, time = len(poses), rollout.time[: len(poses)]
    grid = moments(float(rollout.time[-1]))
    grid = grid[: max(1, int(np.searchsorted(grid, time[-1] + 1e-9)))]
    placed = placements(scene, poses)
    for i in range(1, len(placed)):  # a quaternion and its negative are the same turn: take the one nearer to the last
        placed[i, :, 3:] *= np.where((placed[i, :, 3:] * placed[i - 1, :, 3:]).sum(axis=1) < 0, -1, 1)[:, np.newaxis]
    ends, placed = (resample(grid, time, track) for track in (rope_ends(scene, placed), placed))
    placed[:, :, 3:] /= np.linalg.norm(placed[:, :, 3:], axis=2, keepdims=True)
    moves = np.abs(placed - placed[0]).max(axis=(0, 2)) > STILL
    moving = np.flatnonzero(moves | (scene.model.body_rootid == 1)).tolist()
    whole = np.ones((len(moving), len(placed), 1))
    return Tracks(
        moving=moving,
        places=np.concatenate([placed[:, moving].transpose(1, 0, 2), whole], axis=2),
        rope=_rod(ends),
        still=placed[0],
        com=resample(grid, time, np.nan_to_num(rollout.com[:sound])),
        load=resample(grid, time, np.nan_to_num(rollout.load[:sound])) if scene.rope_length else np.empty((0, 3)),
    )


def resample(grid: Floats, time: Floats, track: Floats) -> Floats:
    """Return a track, (n, …) at (n,) times, at the (m,) times of a grid: between two of its rows, what lies between."""
    if len(time) == 1:
        return np.repeat(track, len(grid), axis=0)
    after = np.clip(np.searchsorted(time, grid - 1e-9), 1, len(time) - 1)
    before = after - 1
    part = np.clip((grid - time[before]) / (time[after] - time[before]), 0, 1)
    part = part.reshape(-1, *[1] * (track.ndim - 1))
    return track[before] * (1 - part) + track[after] * part


def pack(channels: Floats, finest: Floats) -> bytes:
    """Write channels as the player reads them: each as its first number, and its steps in units of its own.

    Args:
        channels: (c, n).
        finest: (c,) the unit to which each is rounded.

    Returns:
        zlib of c float64 firsts and c × (n - 1) int32 steps, little-endian.
    """
    units = np.rint(channels / finest[:, np.newaxis])
    steps = np.diff(units, axis=1)
    firsts = (units[:, 0] * finest).astype("<f8").tobytes()
    return zlib.compress(firsts + steps.astype("<i4").tobytes(), 9)


def _rod(ends: Floats) -> Floats:
    """Turn (n, 2, 3) ends into the track of a rod of length 1 along z, stretched between them."""
    if not ends.shape[1]:
        return np.empty((0, 8))
    along = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(along, axis=1, keepdims=True)
    way = along / np.maximum(length, 1e-9)
    turn = np.stack([1 + way[:, 2], -way[:, 1], way[:, 0], 0 * way[:, 0]], axis=1)
    turn /= np.maximum(np.linalg.norm(turn, axis=1, keepdims=True), 1e-9)
    return np.concatenate([ends.mean(axis=1), turn, length], axis=1)
