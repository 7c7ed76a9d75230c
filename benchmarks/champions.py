"""Measures of a champion: speed, distance, robustness, and the share of its ground contact that is by feet."""

import math
from typing import Any

import walkerlab as wl
from walkerlab.settings.choices import Structure
from walkerlab.simulation.fitness import find_poorest, rate_walk
from walkerlab.simulation.footfalls import foot_share
from walkerlab.simulation.rollout import walk_from_every_start
from walkerlab.world.heights import LANDING_LENGTH


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
    measures = {
        "fitness": fitness,
        "verdict": rollout.verdict,
        "distance": rollout.distance,
        "body lengths/s": rollout.velocity / phenotype.body_length,
        "kept at dt/4": confirmation.kept_finer,
        "kept from other starts": confirmation.kept_nudged,
        "contact by feet": foot_share(scene, rollout.poses),
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
