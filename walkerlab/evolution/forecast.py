"""How long a run will take on this computer, from a few short walks that are timed."""

import time
from functools import lru_cache

import numpy as np

from walkerlab.breeding import generate_robot_population
from walkerlab.evolution.evolution import n_walks
from walkerlab.genome.genome import Genome
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.simulation import Simulation
from walkerlab.settings.terrain import Terrain
from walkerlab.simulation.rollout import simulate
from walkerlab.simulation.workers import n_cores

N_PROBES = 4  # robots that walk
SHORT, LONG = 1.0, 3.0  # s of their two walks each; what both have in common is building and settling


def seconds_of(settings: Settings) -> float:
    """Estimate how long a run of these settings takes, by letting a few random robots walk for a second or less.

    Returns:
        s, without the time that the workers take to start.
    """
    return n_walks(settings) * _seconds_of_a_walk(settings.terrain, settings.robot, settings.simulation) / n_cores()


@lru_cache(maxsize=64)
def _seconds_of_a_walk(terrain: Terrain, robot: Robot, simulation: Simulation) -> float:
    world = Settings(terrain=terrain, robot=robot, simulation=simulation)
    genomes = [Genome(values) for values in generate_robot_population(robot, N_PROBES, seed=0)]
    for genome in genomes:
        simulate(genome, world.with_(duration=SHORT), poses=False)  # builds what is built once for each kind of body
    short, long = (
        np.median([_timed(genome, world.with_(duration=duration)) for genome in genomes]) for duration in (SHORT, LONG)
    )
    each_second = max(0.0, float(long - short)) / (LONG - SHORT)
    return simulation.n_starts * (float(short) + each_second * (simulation.duration - SHORT))


def _timed(genome: Genome, settings: Settings) -> float:
    started = time.perf_counter()
    simulate(genome, settings, poses=False)
    return time.perf_counter() - started


def in_words(seconds: float) -> str:
    """Say how long it is, as one would: ``about 40 s``, ``about 3 minutes``, ``about 2 hours``."""
    if seconds < 2:
        return "a moment"
    if seconds < 90:
        step = 1 if seconds < 10 else 5
        return f"about {step * round(seconds / step)} s"
    minutes = seconds / 60
    return f"about {minutes:.0f} minutes" if minutes < 90 else f"about {minutes / 60:.0f} hours"
