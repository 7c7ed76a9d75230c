"""Footprints: discs that appear on the ground where and when a foot touches down."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.simulation.footfalls import find_footfalls, foot_names
from walkerlab.simulation.rollout import Rollout
from walkerlab.view.replay import meshes
from walkerlab.world.entities.walker import LEG_COLOURS
from walkerlab.world.geometry import body_placements, rotate, valid_poses
from walkerlab.world.heights import ground_height
from walkerlab.world.scene import ORIENTATION, POSITION, Scene

MIN_STEP = 0.03  # m; minimum distance between two successive prints of one foot
PRINT_SIZE = 2.0  # radius of a print as a multiple of the radius of the shank
MAX_PRINTS = 600  # for each walk


@dataclass(frozen=True, eq=False)
class Footprints:
    """Footprints of one walk.

    Attributes:
        mesh: K3D mesh with all prints in order of time, ``meshes.DISC_CORNERS`` triangles each.
        times: Time of each print [s], shape (k,), ascending.
    """

    mesh: Any
    times: Floats


def make_footprints(scene: Scene, rollout: Rollout, lane: float, colour: meshes.RGB | None) -> Footprints | None:
    """Create the footprints of a walk; None if no foot touches down.

    Args:
        scene: Compiled scene.
        rollout: Rollout with its poses.
        lane: Distance by which the walk is shifted to the left [m].
        colour: Colour of the racer, or None for the natural colours of the legs.
    """
    poses = valid_poses(scene, rollout.poses)
    times = rollout.time[: len(poses)]
    footfalls = find_footfalls(scene, poses)
    placed = body_placements(scene, poses)
    prints: list[tuple[float, float, float, float, Floats]] = []
    for name, on_ground in zip(foot_names(scene), footfalls.T, strict=True):
        side, _, number = name.partition(" ")
        geom = scene.model.geom(f"walker/{side}_shank{number}")
        body = placed[:, int(geom.bodyid[0])]
        feet = body[:, POSITION] + rotate(body[:, ORIENTATION], 2 * geom.pos)
        natural = np.array(LEG_COLOURS[side])
        shade = natural if colour is None else meshes.race_colour(natural, colour)
        last = np.full(2, np.inf)
        for moment in np.flatnonzero(np.diff(on_ground.astype(int), prepend=0) > 0).tolist():
            x, y = feet[moment, :2].tolist()
            if np.linalg.norm(last - (x, y)) >= MIN_STEP:
                prints.append((float(times[moment]), x, y, PRINT_SIZE * float(geom.size[0]), shade))
                last = np.array([x, y])
    if not prints:
        return None
    ordered = sorted(prints, key=lambda one: one[0])[:MAX_PRINTS]
    x, y, radii = (np.array([one[i] for one in ordered]) for i in (1, 2, 3))
    z = ground_height(scene.settings.terrain, x, y) + meshes.GROUND_CLEARANCE / 2
    mesh = meshes.disc_mesh(np.stack([x, y + lane, z], axis=1), radii, np.array([one[4] for one in ordered]))
    return Footprints(mesh, np.array([one[0] for one in ordered]))
