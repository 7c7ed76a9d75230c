"""Statements of lesson 06, evolve and watch."""

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here

SETTINGS = wl.Settings().with_(population_size=24, duration=5, generations=14)


def _run(seed: int) -> wl.Run:
    return evolve_here(SETTINGS.with_(seed=seed))


def founders_missing(seed: int) -> float:
    """Return half the number of random robots minus the number that are ancestors of the champion."""
    run = _run(seed)
    return 12.0 - float((run.lineage(run.champion.individual).born == 0).sum())


def diversity_lost(seed: int) -> float:
    """Return by how much more than 10 % the diversity falls, as a share of that of generation 0."""
    diversity = wl.stats.curves(_run(seed)).diversity
    return float(0.9 - diversity.iloc[-1] / diversity.iloc[0])


def selection_share(seed: int) -> float:
    """Return the share of generations in which selection raises the mean, minus 0.8."""
    return float((wl.analysis.price_equation(_run(seed)).selection > 0).mean() - 0.8)


def variation_share(seed: int) -> float:
    """Return the share of generations in which crossover and mutation lower the mean, minus 0.8."""
    return float((wl.analysis.price_equation(_run(seed)).variation < 0).mean() - 0.8)


def children_worse(seed: int) -> float:
    """Return how far the share of children better than both parents is below a quarter; -1 if they gain."""
    credit = wl.analysis.operator_credit(_run(seed))
    return -1.0 if credit.mean_gain.iloc[0] > 0 else float(0.25 - credit.better.iloc[0])


CLAIMS: tuple[Claim, ...] = (
    Claim("06.a", "A run soon descends from a few of its first robots: fewer than half.", founders_missing, "robots"),
    Claim("06.b", "Diversity falls.", diversity_lost, "of the first diversity"),
    Claim(
        "06.c",
        "Selection raises the mean in nearly every generation.",
        selection_share,
        "of the generations, above 0.8",
    ),
    Claim("06.d", "Crossover and mutation lower the mean in nearly every generation.", variation_share, "above 0.8"),
    Claim("06.e", "Few children are better than both parents, and their mean gain is negative.", children_worse),
)
