"""Claims of lesson 02, the ground: one walker from several slightly different starts."""

from concurrent.futures import ThreadPoolExecutor
from functools import cache
from statistics import median
from typing import Any

import walkerlab as wl
from benchmarks.claims.claim import Claim

SETTINGS = wl.Settings().with_(duration=6)
N_STARTS = 5


@cache
def _distance(settings: wl.Settings, seed: int) -> float:
    """Return the median distance of five walks, m; each seed has other starts."""
    genome = wl.lessons.saved_champion("flat").genome
    starts = range(N_STARTS * seed, N_STARTS * (seed + 1))
    with ThreadPoolExecutor(1) as executor:
        walks = [wl.evaluate([genome], settings, executor, starts=[start])[0] for start in starts]
    return median(walk.distance for walk in walks)


def _loss(seed: int, share: float, **changes: Any) -> float:
    """Return by how much a walk in a changed world is shorter than a share of that on a rubber floor, m."""
    return share * _distance(SETTINGS, seed) - _distance(SETTINGS.with_(**changes), seed)


def _headwind(seed: int) -> float:
    return _loss(seed, 1, wind=(-10, 0, 0))


def _uphill(seed: int) -> float:
    return _loss(seed, 1, structure="incline", incline=10)


def _steps(seed: int) -> float:
    return _loss(seed, 0.5, structure="stairs", step_height=0.08)


def _ice(seed: int) -> float:
    return _loss(seed, 1, texture="ice")


def _sledge(seed: int) -> float:
    return _distance(SETTINGS.with_(carry_weight=3), seed) - _distance(SETTINGS.with_(drag_weight=3), seed)


def _other_planets(seed: int) -> float:
    """Return how much further the walker comes on the earth than on the moon and on Jupiter, m."""
    return min(_loss(seed, 1, gravity=planet) for planet in ("moon", "jupiter"))


CLAIMS: tuple[Claim, ...] = (
    Claim("02.a", "On ice, the walker comes less far than on the rubber floor on which it evolved.", _ice, "m"),
    Claim("02.b", "On steps of 8 cm, it loses more than half of its distance.", _steps, "m"),
    Claim("02.c", "A headwind of 10 m/s costs distance.", _headwind, "m"),
    Claim("02.d", "A sledge of 3 kg is harder than a pack of 3 kg.", _sledge, "m"),
    Claim("02.e", "It walks further on the earth than on the moon or on Jupiter.", _other_planets, "m"),
    Claim("02.f", "Uphill, it comes less far.", _uphill, "m"),
)
