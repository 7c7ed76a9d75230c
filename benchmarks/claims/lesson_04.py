"""Statements of lesson 04, crossover."""

from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here
from walkerlab.lessons.saved_runs import RUN_CHANGES

SETTINGS = wl.Settings().with_(population_size=24, duration=4, generations=12)
CHILDREN = 20
RATE = 0.04
LAST = SETTINGS.algorithm.generations - 1


def _settings(seed: int, crossover: str, rate: float) -> wl.Settings:
    return SETTINGS.with_(seed=seed, crossover=crossover, mutation_rate=rate)


@cache
def walk_with_children(parents: tuple[str, str], settings: wl.Settings) -> tuple[list[float], list[float]]:
    """Return the distances of two parents and of their children by uniform crossover; 0 if a walk does not count."""
    settings = settings.with_(crossover="uniform", duration=5)
    children, _ = wl.crossover_population(parents, [0, 0], CHILDREN, settings.robot, settings.algorithm, generation=1)
    with ThreadPoolExecutor(1) as executor:
        pairs = [wl.evaluate(robots, settings, executor) for robots in (parents, children)]
    of_parents, of_children = [[walk.distance if walk.verdict == "ok" else 0.0 for walk in walks] for walks in pairs]
    return of_parents, of_children


def _strangers(seed: int) -> tuple[str, str]:
    """Return the champions of two runs with different seeds."""
    champions = wl.lessons.saved_results().query("condition == 'evolution'").genome.to_list()
    return champions[seed % len(champions)], champions[(seed + 1) % len(champions)]


def relatives_lead(seed: int) -> float:
    """Return the median of the children of relatives minus that of strangers, each as a share of the better parent."""
    run = wl.lessons.saved_run(list(RUN_CHANGES)[seed % len(RUN_CHANGES)])
    last = run.records.query("generation == generation.max()")
    ranked = last.sort_values("fitness", ascending=False).genome.drop_duplicates().to_list()
    shares: list[float] = []
    for parents, settings in (((ranked[0], ranked[9]), run.settings), (_strangers(seed), SETTINGS)):
        of_parents, of_children = walk_with_children(parents, settings)
        shares.append(float(np.median(of_children)) / max(of_parents))
    return shares[0] - shares[1]


def strangers_worse(seed: int) -> float:
    """Return the share of the children of strangers that walk less far than both parents, minus one half."""
    of_parents, of_children = walk_with_children(_strangers(seed), SETTINGS)
    return float((np.array(of_children) < min(of_parents)).mean() - 0.5)


def gain(seed: int, crossover: str) -> float:
    """Return by how much the best robot of a run without mutation improves, in m."""
    records = evolve_here(_settings(seed, crossover, 0.0)).records
    return float(records.fitness.max() - records.fitness[records.generation == 0].max())


def _count_values(seed: int, rate: float, generation: int) -> int:
    """Return the number of different values in a generation of a run with uniform crossover, over all genes."""
    records = evolve_here(_settings(seed, "uniform", rate)).records
    texts: list[str] = records.genome[records.generation == generation].to_list()
    values = np.array([wl.Genome.parse(text).values for text in texts])
    return sum(len(np.unique(of_gene)) for of_gene in values.T)


def values_lost(seed: int) -> float:
    """Return by how much more than four fifths of the gene values a run without mutation loses."""
    return 0.2 - _count_values(seed, 0.0, LAST) / _count_values(seed, 0.0, 0)


def values_added(seed: int) -> float:
    """Return how many more gene values a run with mutation has at the end, as a share of one without mutation."""
    return _count_values(seed, RATE, LAST) / _count_values(seed, 0.0, LAST) - 1


def new_values(seed: int) -> float:
    """Return the number of new gene values of weighted crossover; -1 if another operator makes any."""
    parents = wl.generate_robot_population(SETTINGS.robot, 24, seed=seed)
    counts: dict[str, int] = {}
    for crossover in wl.Crossover:
        algorithm = SETTINGS.with_(crossover=crossover).algorithm
        children, _ = wl.crossover_population(parents, np.arange(24.0), 24, SETTINGS.robot, algorithm, generation=1)
        counts[crossover.name] = int((~np.isin(children, parents)).sum())
    blended = counts.pop("weighted")
    return -1.0 if any(counts.values()) else float(blended)


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "04.a",
        "The children of two champions of different runs walk less far, compared with their better parent, than the "
        "children of relatives.",
        relatives_lead,
        "of the better parent's distance",
    ),
    Claim("04.f", "Most children of strangers are worse than both parents.", strangers_worse, "above one half"),
    Claim(
        "04.b",
        "Without crossover and mutation, the best robot never improves.",
        lambda seed: float(gain(seed, "none") == 0),
        needed=5,
    ),
    Claim(
        "04.c",
        "Without mutation, the best robot improves by uniform crossover.",
        lambda seed: gain(seed, "uniform"),
        "m",
    ),
    Claim(
        "04.d",
        "Without mutation, fewer than one in five of the gene values of generation 0 are left at the end.",
        values_lost,
        "of the values, below one fifth",
    ),
    Claim("04.g", "With mutation, there are more different gene values at the end.", values_added, "of those without"),
    Claim("04.e", "Of all crossover operators, only weighted creates new gene values.", new_values, "values", needed=5),
)
