"""Claims of lesson 10, when evolution cheats."""

from typing import Any

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here
from walkerlab.simulation.rollout import Rollout

SETTINGS = wl.Settings().with_(population_size=24, duration=4, generations=10)
GUARDS = [guard.name for guard in wl.Guard if guard]
WINDY: dict[str, Any] = {"texture": "ice", "wind": (15, 0, 0)}
USUAL_DISTANCE = (1.5, 6.5)  # m, of the best robot of a short run on flat ground
MIN_CHEATED_DISTANCE = 12.0  # m
MIN_DRIFT = 1.0  # m, before the walk
MAX_DISTANCE_STILL = 0.2  # m
MAX_DISTANCE_TALL = 1.0  # m


def save_energy(walk: Rollout) -> float:
    """Return the negative work of the legs, in J."""
    return -float(walk.work[-1])


def be_tall(walk: Rollout) -> float:
    """Return the greatest height of the centre of mass, in m."""
    return float(walk.com[:, 2].max())


def _judge_champion(seed: int, **changes: Any) -> Rollout:
    """Evolve without guards, and return the walk of the champion, judged with all guards."""
    run = evolve_here(SETTINGS.with_(seed=seed, forgive=GUARDS, **changes))
    return wl.simulate(run.champion.genome, SETTINGS.with_(**changes), poses=False)


def _usual_distance(seed: int) -> float:
    distance = evolve_here(SETTINGS.with_(seed=seed)).champion.fitness
    return min(distance - USUAL_DISTANCE[0], USUAL_DISTANCE[1] - distance)


def _cheated_distance(seed: int) -> float:
    return _judge_champion(seed, **WINDY).distance - MIN_CHEATED_DISTANCE


def _drift_before_the_walk(seed: int) -> float:
    return float(_judge_champion(seed, **WINDY).com[0, 0]) - MIN_DRIFT


def _is_voided(seed: int) -> float:
    return 1.0 if _judge_champion(seed, **WINDY).verdict == "restless" else -1.0


def _still_counts(seed: int) -> float:
    return 1.0 if _judge_champion(seed).verdict == "ok" else -1.0


def _margin(seed: int, fitness: Any, limit: float) -> float:
    """Return how far the distance of the champion is below a limit, in m."""
    run = evolve_here(SETTINGS.with_(seed=seed, fitness=fitness))
    return limit - abs(wl.simulate(run.champion.genome, SETTINGS, poses=False).distance)


def _margin_still(seed: int) -> float:
    return _margin(seed, save_energy, MAX_DISTANCE_STILL)


def _margin_tall(seed: int) -> float:
    return _margin(seed, be_tall, MAX_DISTANCE_TALL)


CLAIMS: tuple[Claim, ...] = (
    Claim("10.a", "On flat ground with all guards, the best robot comes about 2 to 6 m far.", _usual_distance, "m"),
    Claim("10.b", "On windy ice without guards, the champion comes more than 12 m far.", _cheated_distance, "m"),
    Claim("10.c", "With the guards on, the verdict on this champion is restless.", _is_voided),
    Claim("10.g", "The wind moves this champion more than 1 m before its walk begins.", _drift_before_the_walk, "m"),
    Claim("10.d", "On flat ground without guards, the champion's walk counts with the guards on.", _still_counts),
    Claim("10.e", "The champion that saves energy stays still: it moves by less than 0.2 m.", _margin_still, "m"),
    Claim("10.f", "The champion that is tall comes less than 1 m far.", _margin_tall, "m"),
)
