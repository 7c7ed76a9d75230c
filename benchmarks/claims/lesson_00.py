"""Claims of lesson 00, meet a walker."""

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here

SETTINGS = wl.Settings().with_(population_size=30, duration=6, generations=12)


def _run(seed: int) -> wl.Run:
    return evolve_here(SETTINGS.with_(seed=seed))


def _gain(seed: int) -> float:
    """Return how many times as far the champion walks as the best random robot, above 1.5."""
    run = _run(seed)
    records = run.records
    return run.champion.fitness / float(records.fitness[records.generation == 0].max()) - 1.5


def _founders(seed: int) -> float:
    """Return the share of random robots that are no ancestors of the champion, above one half."""
    run = _run(seed)
    lineage = run.lineage(run.champion.individual)
    return 0.5 - float((lineage.born == 0).sum()) / SETTINGS.algorithm.population_size


def _median_falls(seed: int) -> float:
    """Return the number of generations in which the median falls; 0 if the best robot ever gets worse."""
    records = _run(seed).records
    generations = records[records.verdict == "ok"].groupby("generation").fitness
    if (generations.max().diff() < 0).any():
        return 0.0
    return float((generations.median().diff() < 0).sum())


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "00.a", "After 12 generations, the champion walks at least 1.5 times as far as the best random robot.", _gain
    ),
    Claim("00.b", "Fewer than half of the random robots are ancestors of the champion.", _founders),
    Claim("00.c", "The best never gets worse, although the median sometimes does.", _median_falls, "generations"),
)
