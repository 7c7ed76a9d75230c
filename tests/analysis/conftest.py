"""A real run with elites, walks that do not count, and inserted robots."""

from concurrent.futures import ThreadPoolExecutor

import pytest

import walkerlab as wl


@pytest.fixture(scope="package")
def pool():
    with ThreadPoolExecutor(1) as workers:
        yield workers


@pytest.fixture(scope="package")
def run(pool):
    settings = wl.Settings().with_(population_size=8, generations=5, duration=1, n_elites=2, mutation="macro", seed=4)
    evolution = wl.Evolution(settings.with_(fitness=forward_only), executor=pool)
    for generation in evolution:
        if generation.number in (1, 2):
            evolution.insert(wl.Genome(wl.generate_robot_population(settings.robot, 1, seed=9 + generation.number)[0]))
    return evolution.run


def forward_only(rollout):
    """Rate the distance, and exclude robots that moved backward."""
    return rollout.distance if rollout.distance > 0 else None
