"""Measures of a champion: speed, distance, robustness, and the share of its ground contact that is by feet."""

import math
from typing import Any

import mujoco
import numpy as np

import walkerlab as wl
from walkerlab.ga.genes import Floats
from walkerlab.settings.choices import Structure
from walkerlab.simulation.fitness import find_poorest, rate_walk
from walkerlab.simulation.rollout import walk_from_every_start
from walkerlab.world.entities.walker import SIDES
from walkerlab.world.heights import LANDING_LENGTH
from walkerlab.world.scene import Scene

FOOT_REACH = 2.0
"""Distance from the centre of the end of a shank within which a contact is by the foot, in radii of the shank."""


def measure_champion(genome: wl.Genome, settings: wl.Settings) -> dict[str, Any]:
    """Simulate a champion again, also at a quarter of the timestep and from other starts, and return its measures.

    Args:
        genome: Genome of the champion.
        settings: Complete settings of the search.

    Returns:
        Measures by name, as JSON data; those of the poorest walk if the settings have several starts.
    """
    scene = wl.compile_scene(genome, settings)
    rollouts = walk_from_every_start(scene, poses=True)
    fitness, rollout = find_poorest([rate_walk(rollout, settings.algorithm.fitness) for rollout in rollouts])
    confirmation = wl.confirm(genome, settings)
    phenotype = rollout.phenotype
    feet, total = measure_ground_contact(scene, rollout.poses)
    measures = {
        "fitness": fitness,
        "verdict": rollout.verdict,
        "distance": rollout.distance,
        "body lengths/s": rollout.velocity / phenotype.body_length,
        "kept at dt/4": confirmation.kept_finer,
        "kept from other starts": confirmation.kept_nudged,
        "contact by feet": feet / total if total else 0.0,
        "stairs climbed": _count_stairs(rollout, settings.terrain),
        "segments": len(phenotype.segments),
        "legs": phenotype.n_legs,
        "weight": phenotype.weight,
        "body length": phenotype.body_length,
        "genome": str(genome),
    }
    is_number = {name: isinstance(value, float) for name, value in measures.items()}
    return {name: None if is_number[name] and not math.isfinite(value) else value for name, value in measures.items()}


def _count_stairs(rollout: wl.Rollout, terrain: wl.Terrain) -> int | None:
    """Count the stairs up to the centre of mass at the end of a walk; None on other ground."""
    if terrain.structure != Structure.stairs:
        return None
    return max(0, math.floor((rollout.com[-1, 0] - LANDING_LENGTH) / terrain.step_depth) + 1)


def measure_ground_contact(scene: Scene, poses: Floats) -> tuple[int, int]:
    """Count the contacts of a walk with the ground and with anything else outside the robot, weighted by time.

    In each pose, each geom of the robot that touches something counts once. A shank touches with its foot if the
    contact is within ``FOOT_REACH`` radii of the centre of its end. Other contacts of a shank count apart from those of
    its foot.

    Args:
        scene: Compiled scene.
        poses: Poses at regular intervals, as in ``Rollout.poses``, shape (n, nq).

    Returns:
        Number of contacts by feet and of all contacts, in poses.
    """
    model = scene.model
    data = mujoco.MjData(model)
    is_robot = scene.is_robot_geom
    shanks = {
        model.body(f"walker/{side}_shank{number}").id: model.geom(f"walker/{side}_shank{number}").id
        for number, has_legs in enumerate(scene.phenotype.plan, start=1)
        if has_legs
        for side in SIDES
    }
    n_feet = 0
    n_contacts = 0
    for pose in poses[np.isfinite(poses).all(axis=1)]:
        data.qpos[:] = pose
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        touching: set[tuple[int, bool]] = set()
        for pair, position in zip(data.contact.geom, data.contact.pos, strict=True):
            if is_robot[pair].sum() != 1:
                continue
            geom = int(pair[np.argmax(is_robot[pair])])
            body = int(model.geom_bodyid[geom])
            shank = shanks.get(body)
            touching.add((geom, shank is not None and _is_at_end(model, data, body, shank, position)))
        n_feet += sum(is_foot for _, is_foot in touching)
        n_contacts += len(touching)
    return n_feet, n_contacts


def _is_at_end(model: mujoco.MjModel, data: mujoco.MjData, body: int, shank: int, position: Floats) -> bool:
    """Return whether a position is near the end of a shank, which is the end farther from the knee."""
    axis = data.geom_xmat[shank].reshape(3, 3)[:, 2] * model.geom_size[shank, 1]
    ends = data.geom_xpos[shank] + np.array([axis, -axis])
    end = ends[np.argmax(np.linalg.norm(ends - data.xpos[body], axis=1))]
    return bool(np.linalg.norm(position - end) <= FOOT_REACH * model.geom_size[shank, 0])
