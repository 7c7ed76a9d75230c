"""Recorded walks as numbers for the player: where each moving part is at each moment, small enough to be mailed."""

import zlib
from dataclasses import dataclass

import numpy as np

from walkerlab.genes import Floats
from walkerlab.scene import Scene
from walkerlab.shapes import placements, rope_ends

FINEST = (1e-4,) * 3 + (1 / 30000,) * 4 + (1e-4,)  # m, parts of a unit quaternion, m: to what tracks are rounded
STILL = 5e-4  # m, and parts of a quaternion, within which a part stays all the time
LEAP = 3.0  # m from one moment to the next, beyond which a world has blown up


@dataclass(frozen=True, eq=False)
class Tracks:
    """Where the parts of one recorded walk are.

    Attributes:
        moving: (k,) the bodies that move, of the scene's model.
        places: (k, n, 8) where each of them is: position [m], unit quaternion (w, x, y, z), and 1.
        rope: (n, 8) the rope as a rod: its middle, the turn of its axis from z, its length [m]; (0, 8) without one.
        still: (nbody, 7) where each body is at the start.
    """

    moving: list[int]
    places: Floats
    rope: Floats
    still: Floats


def follow(scene: Scene, poses: Floats) -> Tracks:
    """Follow every body of a walk, and the rope."""
    placed = placements(scene, poses)
    for i in range(1, len(placed)):  # a quaternion and its negative are the same turn: take the one nearer to the last
        placed[i, :, 3:] *= np.where((placed[i, :, 3:] * placed[i - 1, :, 3:]).sum(axis=1) < 0, -1, 1)[:, np.newaxis]
    moves = np.abs(placed - placed[0]).max(axis=(0, 2)) > STILL
    moving = np.flatnonzero(moves | (scene.model.body_rootid == 1)).tolist()
    whole = np.ones((len(moving), len(placed), 1))
    return Tracks(
        moving=moving,
        places=np.concatenate([placed[:, moving].transpose(1, 0, 2), whole], axis=2),
        rope=_rod(rope_ends(scene, placed)),
        still=placed[0],
    )


def before_it_broke(poses: Floats) -> Floats:
    """Return the poses up to the moment at which the numbers ran away, if they did; the first one in any case."""
    wild = ~np.isfinite(poses).all(axis=1)
    whole = poses[: int(np.argmax(wild))] if wild.any() else poses
    leaps = np.abs(np.diff(whole[:, :3], axis=0)).max(axis=1, initial=0) > LEAP
    return poses[: max(1, int(np.argmax(leaps)) + 1 if leaps.any() else len(whole))]


def pack(channels: Floats, finest: Floats) -> bytes:
    """Write channels as the player reads them: each as its first number, and its steps in units of its own.

    Args:
        channels: (c, n).
        finest: (c,) the unit to which each is rounded.

    Returns:
        zlib of c float64 firsts and c × (n - 1) int16 steps, little-endian.
    """
    units = np.rint(channels / finest[:, np.newaxis])
    steps = np.diff(units, axis=1)
    assert np.abs(steps).max(initial=0) < 2**15
    firsts = (units[:, 0] * finest).astype("<f8").tobytes()
    return zlib.compress(firsts + steps.astype("<i2").tobytes(), 9)


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
