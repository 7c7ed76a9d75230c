"""Statements of lesson 04, crossover."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here

SETTINGS = wl.Settings().with_(population_size=24, duration=4, generations=12)
CHILDREN = 20


def _settings(seed: int, crossover: str, rate: float) -> wl.Settings:
    return SETTINGS.with_(seed=seed, crossover=crossover, mutation_rate=rate)


def median_of_children(parents: list[str]) -> float:
    """Return the median distance of children by uniform crossover, as a share of that of the better parent."""
    settings = SETTINGS.with_(crossover="uniform", duration=5)
    children, _ = wl.crossover_population(parents, [0, 0], CHILDREN, settings.robot, settings.algorithm, generation=1)
    with ThreadPoolExecutor(1) as executor:
        best = max(walk.distance for walk in wl.evaluate(parents, settings, executor))
        walks = wl.evaluate(children, settings, executor)
    return float(np.median([walk.distance / best * (walk.verdict == "ok") for walk in walks]))


def relatives_lead(seed: int) -> float:
    """Return the median of the children of relatives minus that of the children of strangers."""
    champions = wl.lessons.saved_results().query("condition == 'evolution'").genome.to_list()
    strangers = [champions[seed % len(champions)], champions[(seed + 1) % len(champions)]]
    last = evolve_here(_settings(seed, "uniform", 0.04)).records.query("generation == generation.max()")
    relatives = last.sort_values("fitness").genome.drop_duplicates().to_list()[-2:]
    return median_of_children(relatives) - median_of_children(strangers)


def gain(seed: int, crossover: str) -> float:
    """Return by how much the best robot of a run without mutation improves, in m."""
    records = evolve_here(_settings(seed, crossover, 0.0)).records
    return float(records.fitness.max() - records.fitness[records.generation == 0].max())


def diversity_lost(seed: int) -> float:
    """Return how much lower the final diversity is without mutation than with it."""
    final = [wl.stats.curves(evolve_here(_settings(seed, "uniform", rate))).diversity.iloc[-1] for rate in (0.04, 0.0)]
    return float(final[0] - final[1])


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
    Claim("04.d", "Diversity ends lower without mutation than with it.", diversity_lost),
    Claim("04.e", "Of all crossover operators, only weighted creates new gene values.", new_values, "values", needed=5),
)
