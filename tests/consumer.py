"""Code of a user, which pyright checks in its strict mode: the types of all results are known. It is not executed."""

# pyright: strict, reportUnknownMemberType=true, reportUnknownVariableType=true, reportUnknownArgumentType=true

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import walkerlab as wl


def sideways(walk: wl.Rollout) -> float:
    """Rate a walk by its distance to the side, in m."""
    return abs(float(walk.com[-1, 1]))


settings = wl.Settings().with_(structure="stairs", population_size=8, fitness=sideways)
run = wl.evolve(settings, "stairs.walk", stop=wl.Stop(after="10min"))
assert_type(run, wl.Run)
assert_type(run.champion.fitness, float)
assert_type(run.settings, wl.Settings)

genome = wl.Genome.random(settings.robot, rng=np.random.default_rng(1))
assert_type(genome, wl.Genome)
assert_type(wl.simulate(genome, settings).distance, float)
assert_type(wl.express(genome).n_legs, int)
with ThreadPoolExecutor(1) as executor:
    rated = wl.evaluate([genome], settings, executor, descriptors=["height"])
assert_type(rated, list[wl.Evaluation])
assert_type(wl.export_mjcf(genome, settings, "exported"), Path)

problem = wl.Problem(settings, descriptors=("height", "n_legs"), uncounted=-10)
points = problem.sample(4, rng=np.random.default_rng(1))
assert_type(points, NDArray[np.float64])
assert_type(problem(points), NDArray[np.float64])
assert_type(problem.evaluate(points).counts, NDArray[np.bool_])

algorithm = wl.GeneticAlgorithm(settings)
algorithm.tell(wl.evaluate(algorithm.ask(), settings))
assert_type(algorithm.run, wl.Run)

environment = wl.environment(genome, settings, reward=lambda physics: 0.0)
policy = wl.gait_policy(environment)
assert_type(policy(None), NDArray[np.float64])
