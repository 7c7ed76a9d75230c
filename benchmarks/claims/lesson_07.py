"""Statements of lesson 07, is it better? Those about the saved results have the same figure for each seed."""

import numpy as np
from numpy.typing import NDArray

import walkerlab as wl
from benchmarks.claims.claim import Claim

N_EXPERIMENTS = 200
MAX_SEEDS = 40


def _best() -> dict[str, NDArray[np.float64]]:
    """Return the best fitness of each run of each condition, in the order of the seeds."""
    results = wl.lessons.saved_results().sort_values("seed")
    return {str(name): rows.fitness.to_numpy() for name, rows in results.groupby("condition")}


def seeds_that_disagree(_: int) -> float:
    """Return the number of seeds with which macro is better, although evolution is better with most."""
    return float((_best()["macro"] > _best()["evolution"]).sum())


def clear_against_random(_: int) -> float:
    """Return how far the p-value of evolution and random search is below 0.05."""
    return 0.05 - wl.stats.paired_test(_best()["evolution"], _best()["random search"])


def unclear_against_macro(_: int) -> float:
    """Return how far the p-value of evolution and macro is above 0.05."""
    return wl.stats.paired_test(_best()["evolution"], _best()["macro"]) - 0.05


def first_seeds_agree(_: int) -> float:
    """Return 1 if evolution is better than random search with each of the first seven seeds."""
    best = _best()
    return float((best["evolution"] > best["random search"])[:7].all())


def false_alarms(seed: int) -> float:
    """Return by how much more than 10 % of the experiments with peeking find a difference between equal methods."""
    rng = np.random.default_rng(seed)
    n_clear = 0
    for _ in range(N_EXPERIMENTS):
        differences = rng.normal(size=MAX_SEEDS)
        tests = (wl.stats.paired_test(differences[:n], np.zeros(n)) for n in range(6, MAX_SEEDS + 1))
        n_clear += any(p < 0.05 for p in tests)
    return n_clear / N_EXPERIMENTS - 0.1


def champions_lose(seed: int) -> float:
    """Return how many more than half of the 12 champions of evolution walk less far from other starts."""
    results = wl.lessons.saved_results()
    champions = results[results.condition == "evolution"]
    n_starts = 3 + 2 * seed  # an odd number, so that the median is one of the walks
    confirmed = [wl.confirm(genome, results.attrs["settings"], n_starts) for genome in champions.genome]
    return sum(one.kept_nudged < 1 for one in confirmed) - len(confirmed) / 2


CLAIMS: tuple[Claim, ...] = (
    Claim("07.a", "A single seed can name the wrong method.", seeds_that_disagree, "of 12 seeds"),
    Claim("07.b", "Evolution is clearly better than random search.", clear_against_random, "below 0.05", needed=5),
    Claim("07.c", "Between evolution and macro, nothing is shown.", unclear_against_macro, "above 0.05", needed=5),
    Claim("07.d", "Evolution is better with each of the first seven seeds.", first_seeds_agree, needed=5),
    Claim(
        "07.e", "Adding seeds until a difference is clear finds one in far more than 5 %.", false_alarms, "above 10 %"
    ),
    Claim("07.f", "Most of the saved champions walk less far from other starts.", champions_lose, "of 12, above half"),
)
