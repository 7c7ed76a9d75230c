"""Claims of lesson 11, class tournament."""

from concurrent.futures import ThreadPoolExecutor
from functools import cache

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here
from walkerlab.lessons.saved_runs import RUN_CHANGES

SETTINGS = wl.Settings().with_(population_size=24, duration=6, generations=8)
MINE = "my robot"


@cache
def hold_league(seed: int, *, is_mystery: bool) -> dict[str, int]:
    """Return the rank of each robot of the lesson by name; the student's robot is evolved with a seed."""
    robots = {ground: wl.lessons.saved_champion(ground).genome for ground in RUN_CHANGES}
    robots[MINE] = evolve_here(SETTINGS.with_(seed=seed)).champion.genome
    ground = wl.lessons.mystery_terrain() if is_mystery else SETTINGS
    with ThreadPoolExecutor(1) as executor:
        table = wl.league(robots, ground, executor=executor, progress=False).table
    return dict(zip(table["name"], table["rank"], strict=True))


def _ranks_behind(seed: int) -> float:
    return hold_league(seed, is_mystery=False)[MINE] - 1.0


def _n_changed_ranks(seed: int) -> float:
    known, mystery = (hold_league(seed, is_mystery=is_mystery) for is_mystery in (False, True))
    return float(sum(known[name] != mystery[name] for name in known))


def _has_another_winner(seed: int) -> float:
    known, mystery = (hold_league(seed, is_mystery=is_mystery) for is_mystery in (False, True))
    winners = [{name for name, rank in ranks.items() if rank == 1} for ranks in (known, mystery)]
    return 1.0 if winners[0].isdisjoint(winners[1]) else -1.0


CLAIMS: tuple[Claim, ...] = (
    Claim("11.a", "On flat ground, a robot from less than half of the trials does not win.", _ranks_behind, "ranks"),
    Claim("11.b", "The order on the mystery terrain differs from that on flat ground.", _n_changed_ranks, "robots"),
    Claim("11.c", "The winner on flat ground does not win on the mystery terrain.", _has_another_winner),
)
