"""The pose in which a robot stands when its walk begins."""

from functools import lru_cache

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.simulation.starts import settled_pose
from walkerlab.world.scene import ORIENTATION, POSITION, Scene, scene_of

MAX_CACHED_POSES = 2048  # of some 200 bytes each
MIN_UPRIGHT = 0.3  # vertical component of the upward axis of the first segment of a robot that stands
MAX_SHIFT = 1.0  # m plus the body length; a robot that moves farther while settling is drawn in its start pose


def standing_scene(genome: Genome, settings: Settings) -> tuple[Scene, Floats]:
    """Compile a robot in its world without obstacles, and return it with its ``standing_pose``.

    Args:
        genome: Genome within the robot limits.
        settings: Settings of the world; its loose obstacles and the pieces on its ground are omitted.
    """
    bare = settings.with_(obstacle="none", texture_density=0.0)
    return scene_of(genome, bare), standing_pose(genome, bare)


def standing_pose(genome: Genome, settings: Settings) -> Floats:
    """Return the pose in which the walk of a robot begins, shape (nq,).

    The pose is simulated as for a walk, because in the start pose, which has the offsets of the gait, only the lowest
    foot of most robots touches the ground. On level ground, this takes about 8 ms; the latest poses are cached.

    Args:
        genome: Genome within the robot limits.
        settings: Settings of the world.
    """
    return np.array(_pose(genome, settings))


def lies_at_start(genome: Genome, settings: Settings) -> bool:
    """Return whether a robot has fallen onto its back or its side before its walk begins.

    Args:
        genome: Genome within the robot limits.
        settings: Settings of the world, as for ``standing_scene``.
    """
    _, pose = standing_scene(genome, settings)
    _, x, y, _ = pose[ORIENTATION]
    return bool(1 - 2 * (x**2 + y**2) < MIN_UPRIGHT)


@lru_cache(maxsize=MAX_CACHED_POSES)
def _pose(genome: Genome, settings: Settings) -> tuple[float, ...]:
    scene = scene_of(genome, settings)
    start = scene.start
    pose = settled_pose(scene)
    is_far = np.linalg.norm(pose[POSITION] - start[POSITION]) > MAX_SHIFT + scene.phenotype.body_length
    return tuple((start if is_far else pose).tolist())
