"""Statements of lesson 05, mutation."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here

SETTINGS = wl.Settings().with_(population_size=24, duration=5, generations=10)
MUTANTS = 40
RATE = 0.2


def _champion(seed: int) -> str:
    results = wl.lessons.saved_results().query("condition == 'evolution'")
    return str(results.genome.iloc[seed % len(results)])


def n_changed(seed: int) -> float:
    """Return the tolerance that remains of the mean number of changed genes, which is about 2.2."""
    genome = wl.Genome.parse(_champion(seed))
    mutants = wl.mutate_population([genome] * 500, SETTINGS.robot, SETTINGS.algorithm, generation=1)
    return 0.35 - abs(float((mutants != genome.values).sum(axis=1).mean()) - 0.04 * 56)


def micro_lead(seed: int) -> float:
    """Return the median distance of mutants by micro minus the higher one of gaussian and macro, in m."""
    genome = _champion(seed)
    medians: dict[str, float] = {}
    with ThreadPoolExecutor(1) as executor:
        for name in ("micro", "gaussian", "macro"):
            algorithm = SETTINGS.with_(mutation=name, mutation_rate=RATE).algorithm
            mutants = wl.mutate_population([genome] * MUTANTS, SETTINGS.robot, algorithm, generation=1)
            walks = wl.evaluate(mutants, SETTINGS, executor)
            medians[name] = float(np.median([walk.distance if walk.verdict == "ok" else 0 for walk in walks]))
    return medians["micro"] - max(medians["gaussian"], medians["macro"])


def starts_stuck(seed: int) -> float:
    """Return from how many of 40 frequencies a climber that looks one point ahead misses the highest hill."""
    with ThreadPoolExecutor(1) as executor:
        table = wl.analysis.landscape(_champion(seed), SETTINGS, "frequency", 40, executor)
    points: Any = table[~table.is_centre]
    fitness = points.sort_values("frequency").fitness.to_numpy()
    n_reached = 0
    for start in range(len(fitness)):
        here = start
        while True:
            near = range(max(0, here - 1), min(len(fitness), here + 2))
            best = max(near, key=fitness.__getitem__)
            if fitness[best] <= fitness[here]:
                break
            here = best
        n_reached += here == int(fitness.argmax())
    return float(len(fitness) - n_reached)


def micro_median_lead(seed: int) -> float:
    """Return the median of the last generation of a run with micro minus that of a run with macro, in m."""
    medians: list[float] = []
    for name in ("micro", "macro"):
        records = evolve_here(SETTINGS.with_(seed=seed, mutation=name)).records
        medians.append(float(records.fitness[records.generation == records.generation.max()].median()))
    return medians[0] - medians[1]


CLAIMS: tuple[Claim, ...] = (
    Claim("05.a", "At a rate of 0.04, about 2.2 of 56 genes change.", n_changed, "genes left of the tolerance"),
    Claim(
        "05.b", "Of micro, gaussian and macro, the median mutant of micro keeps most of its distance.", micro_lead, "m"
    ),
    Claim("05.c", "Some starts of the climber do not lead to the highest hill.", starts_stuck, "of 40 starts"),
    Claim("05.d", "The final median is higher with micro than with macro.", micro_median_lead, "m"),
)
