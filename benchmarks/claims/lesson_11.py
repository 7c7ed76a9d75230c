"""Claims of lesson 11, class tournament."""

from concurrent.futures import ThreadPoolExecutor
from functools import cache

import pandas as pd

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here
from walkerlab.lessons.saved_runs import RUN_CHANGES

SETTINGS = wl.Settings().with_(population_size=24, duration=6, generations=8)
MINE = "my robot"


@cache
def hold_league(seed: int, *, is_mystery: bool) -> pd.DataFrame:
    """Return the ranks and scores of the robots of the lesson by name; the student's robot is evolved with a seed."""
    robots = {ground: wl.lessons.saved_champion(ground).genome for ground in RUN_CHANGES}
    robots[MINE] = evolve_here(SETTINGS.with_(seed=seed)).champion.genome
    ground = wl.lessons.mystery_terrain() if is_mystery else SETTINGS
    with ThreadPoolExecutor(1) as executor:
        return wl.league(robots, ground, executor=executor, progress=False).table.set_index("name")


def _ranks_behind(seed: int) -> float:
    return hold_league(seed, is_mystery=False)["rank"][MINE] - 1.0


def _n_changed_ranks(seed: int) -> float:
    known, mystery = (hold_league(seed, is_mystery=is_mystery)["rank"] for is_mystery in (False, True))
    return float((known != mystery.reindex(known.index)).sum())


def _has_another_winner(seed: int) -> float:
    known, mystery = (hold_league(seed, is_mystery=is_mystery)["rank"] for is_mystery in (False, True))
    return 1.0 if {*known.index[known == 1]}.isdisjoint(mystery.index[mystery == 1]) else -1.0


def _smallest_difference(seed: int) -> float:
    """Return the smallest difference between the scores of two successive robots on the mystery terrain [m]."""
    scores = hold_league(seed, is_mystery=True)["score"].sort_values()
    return float(scores.diff().min()) if scores.min() > 0 else 0.0


CLAIMS: tuple[Claim, ...] = (
    Claim("11.a", "On flat ground, a robot from less than half of the trials does not win.", _ranks_behind, "ranks"),
    Claim("11.b", "The order on the mystery terrain differs from that on flat ground.", _n_changed_ranks, "robots"),
    Claim("11.c", "The winner on flat ground does not win on the mystery terrain.", _has_another_winner),
    Claim("11.d", "On the mystery terrain, every robot gets forward and has its own rank.", _smallest_difference, "m"),
)
