"""Claims of lesson 08, your own operator."""

from functools import partial

import numpy as np

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here
from walkerlab.ga.genes import Floats, Indices
from walkerlab.view.plots.genomes import diversity_by_generation

SETTINGS = wl.Settings().with_(population_size=16, duration=4, generations=8)


def best_three(fitness: Floats, n_parents: int, *, rng: np.random.Generator) -> Indices:
    """Select parents from the three best robots, each with the same probability."""
    return rng.choice(np.argsort(fitness)[-3:], n_parents)


def average(
    parents: Floats,
    fitness: Floats,  # noqa: ARG001  # part of the signature
    n_children: int,
    *,
    rng: np.random.Generator,  # noqa: ARG001  # part of the signature
) -> tuple[Floats, Indices]:
    """Give each child the average of two parents."""
    mothers = np.arange(n_children) % len(parents)
    fathers = (mothers + 1) % len(parents)
    return (parents[mothers] + parents[fathers]) / 2, np.stack([mothers, fathers], axis=1)


def _spread_lost_by_average(seed: int) -> float:
    parents = wl.generate_robot_population(SETTINGS.robot, 16, seed=seed)
    algorithm = SETTINGS.with_(crossover=average).algorithm
    children, _ = wl.crossover_population(parents, np.zeros(16), 16, SETTINGS.robot, algorithm, generation=0)
    return float(parents.std(axis=0).mean() - np.asarray(children).std(axis=0).mean())


def _diversity_lost(seed: int, generation: int) -> float:
    settings = SETTINGS.with_(seed=seed)
    left = [
        diversity_by_generation(evolve_here(each).records)[generation]
        for each in (settings, settings.with_(selection=best_three))
    ]
    return float(left[0] - left[1])


CLAIMS: tuple[Claim, ...] = (
    Claim("08.a", "Averaging two parents makes the spread of the genes smaller.", _spread_lost_by_average),
    Claim(
        "08.b",
        "Selecting from the three best robots ends with less diversity than tournament selection.",
        partial(_diversity_lost, generation=SETTINGS.algorithm.generations - 1),
        "of the range of a gene",
    ),
)
