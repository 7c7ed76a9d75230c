"""Claims of lesson 09, broken operators; tests/lessons/test_broken.py holds what the tools show of each operator."""

from functools import partial
from typing import Any

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here
from walkerlab.lessons import broken
from walkerlab.view.plots.genomes import diversity_by_generation

SETTINGS = wl.Settings().with_(population_size=24, duration=4, generations=8)
BROKEN: dict[str, dict[str, Any]] = {
    "operator_a": {"selection": broken.operator_a},
    "operator_b": {"mutation": broken.operator_b},
    "operator_c": {"crossover": broken.operator_c},
    "operator_e": {"mutation": broken.operator_e},
    "operator_f": {"selection": broken.operator_f},
}


def _rise(seed: int, name: str) -> float:
    run = evolve_here(SETTINGS.with_(seed=seed, **BROKEN[name]))
    return float(run.champion.fitness - run.records.query("generation == 0").fitness.max())


def _final_diversity(settings: wl.Settings) -> float:
    return float(diversity_by_generation(evolve_here(settings).records).iloc[-1])


def _diversity_lost(seed: int) -> float:
    settings = SETTINGS.with_(seed=seed)
    return _final_diversity(settings) - _final_diversity(settings.with_(**BROKEN["operator_c"]))


def _best_always_lost(seed: int) -> float:
    table = wl.analysis.measure_selection(
        {"f": broken.operator_f, "d": broken.operator_d}, population_size=40, n_populations=40, seed=seed
    )
    lost = table[table.measure == "best_lost"].set_index("selection").measured
    return 1.0 if lost["f"] == 1 and lost["d"] < 1 else -1.0


CLAIMS: tuple[Claim, ...] = (
    *(
        Claim(
            f"09.{letter}",
            f"The best robot of a run with {name} improves despite the bug.",
            partial(_rise, name=name),
            "m",
        )
        for letter, name in zip("abcde", BROKEN, strict=True)
    ),
    Claim("09.f", "uniform keeps more diversity than operator_c.", _diversity_lost, "of the range of a gene"),
    Claim("09.g", "operator_f loses the best robot every time, and operator_d does not.", _best_always_lost),
)
