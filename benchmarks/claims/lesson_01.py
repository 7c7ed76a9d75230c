"""Claims of lesson 01, bodies and genes."""

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here

SETTINGS = wl.Settings().with_(population_size=16, duration=5)
N_GENERATIONS = 8


def _random_walkers(seed: int) -> float:
    """Return 8 minus the number of 16 random robots that walk further than their own body length."""
    records = evolve_here(SETTINGS.with_(generations=1, seed=seed)).records
    walks = records[records.verdict == "ok"]
    return 8.0 - float((walks.distance > walks.body_length).sum())


def _strong_legs(seed: int) -> float:
    """Return how much further the champion with strong legs walks than the one with weak legs, m."""
    settings = SETTINGS.with_(generations=N_GENERATIONS, seed=seed)
    weak, strong = (evolve_here(settings.with_(leg_force=force)) for force in ((2, 4), (15, 30)))
    return strong.champion.fitness - weak.champion.fitness


CLAIMS: tuple[Claim, ...] = (
    Claim("01.a", "Fewer than half of 16 random robots walk further than their own body length.", _random_walkers),
    Claim(
        "01.b",
        "After 8 generations, robots with strong legs walk further than robots with weak legs.",
        _strong_legs,
        "m",
    ),
)
