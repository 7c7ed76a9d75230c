"""Forecast how long a run will take: its number of walks, and the time of a walk on this computer."""

import time
from functools import lru_cache

import numpy as np

from walkerlab.genome.breeding import generate_robot_population
from walkerlab.genome.genome import Genome
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.simulation import Simulation
from walkerlab.settings.terrain import Terrain
from walkerlab.simulation.rollout import simulate
from walkerlab.simulation.workers import n_cores

N_SAMPLES = 4  # number of robots that are timed
SHORT_WALK = 1.0  # s of simulated time
LONG_WALK = 3.0  # s of simulated time


def n_walks(settings: Settings, done: int = 0) -> int:
    """Count the walks that a run still requires; elites are not simulated again.

    Args:
        settings: Complete settings of the run.
        done: Number of completed generations.
    """
    algorithm = settings.algorithm
    children = algorithm.population_size - algorithm.n_elites
    first = 0 if done else algorithm.n_elites
    return first + max(0, algorithm.generations - done) * children


def estimate_seconds(settings: Settings) -> float:
    """Estimate how long a run will take, by timing short walks of a few random robots.

    Args:
        settings: Complete settings of the run.

    Returns:
        Time in seconds, not including the start of the workers.
    """
    return n_walks(settings) * _seconds_per_walk(settings.terrain, settings.robot, settings.simulation) / n_cores()


@lru_cache(maxsize=64)
def _seconds_per_walk(terrain: Terrain, robot: Robot, simulation: Simulation) -> float:
    settings = Settings(terrain=terrain, robot=robot, simulation=simulation)
    genomes = [Genome(values) for values in generate_robot_population(robot, N_SAMPLES, seed=0)]
    for genome in genomes:
        simulate(genome, settings.with_(duration=SHORT_WALK), poses=False)  # fills the caches of compiled models
    short, long = (
        np.median([_timed(genome, settings.with_(duration=duration)) for genome in genomes])
        for duration in (SHORT_WALK, LONG_WALK)
    )
    # Both walks include the same time for building and settling, which the difference cancels.
    per_simulated_second = max(0.0, float(long - short)) / (LONG_WALK - SHORT_WALK)
    return simulation.n_starts * (float(short) + per_simulated_second * (simulation.duration - SHORT_WALK))


def _timed(genome: Genome, settings: Settings) -> float:
    """Return the time that a walk takes, in seconds."""
    started = time.perf_counter()
    simulate(genome, settings, poses=False)
    return time.perf_counter() - started


def describe_duration(seconds: float) -> str:
    """Write a duration as text: ``about 40 s``, ``about 3 minutes``, ``about 2 hours``."""
    if seconds < 2:
        return "a moment"
    if seconds < 90:
        step = 1 if seconds < 10 else 5
        return f"about {step * round(seconds / step)} s"
    minutes = seconds / 60
    return f"about {minutes:.0f} minutes" if minutes < 90 else f"about {minutes / 60:.0f} hours"
