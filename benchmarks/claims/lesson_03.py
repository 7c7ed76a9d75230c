"""Claims of lesson 03, selection: runs that start from robots that already walk."""

from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from typing import Any

import numpy as np

import walkerlab as wl
from benchmarks.claims.claim import Claim
from walkerlab.ga.selection import tournament

START = 6  # generation of the saved run from which the runs start
SETTINGS = wl.Settings().with_(population_size=24, duration=5, generations=10, n_elites=0)
SELECTIONS: dict[str, Any] = {
    "gentle": partial(tournament, size=2),
    "harsh": partial(tournament, size=7),
    "uniform": "uniform",
}


@cache
def _records(name: str, seed: int) -> Any:
    """Return the table of a run with a selection operator."""
    table = wl.lessons.saved_run("flat").records
    settings = SETTINGS.with_(selection=SELECTIONS[name], seed=seed)
    with ThreadPoolExecutor(1) as executor:
        population = table[table.generation <= START]
        return wl.evolve(settings, executor=executor, progress=False, population=population).records


def _fitness(name: str, seed: int, generation: int, quantile: float) -> float:
    records = _records(name, seed)
    walks = records[(records.generation == generation) & (records.verdict == "ok")]
    return float(walks.fitness.quantile(quantile))


def _diversity(name: str, seed: int, generation: int) -> float:
    """Return the mean standard deviation of the genes, as a share of their ranges."""
    records = _records(name, seed)
    texts = records.genome[records.generation == generation]
    values = np.array([wl.Genome.parse(text).values for text in texts])
    table = wl.gene_table(SETTINGS.robot)
    spread = (table.high - table.low).to_numpy(dtype=np.float64)
    return float((values.std(axis=0)[spread > 0] / spread[spread > 0]).mean())


def _harsh_rises_sooner(seed: int) -> float:
    return _fitness("harsh", seed, 3, 0.5) - _fitness("gentle", seed, 3, 0.5)


def _uniform_falls(seed: int) -> float:
    return _fitness("uniform", seed, 0, 1) - _fitness("uniform", seed, 9, 1)


def _uniform_is_last(seed: int) -> float:
    return _fitness("gentle", seed, 9, 0.5) - _fitness("uniform", seed, 9, 0.5)


def _harsh_loses_diversity(seed: int) -> float:
    return _diversity("gentle", seed, 4) - _diversity("harsh", seed, 4)


CLAIMS: tuple[Claim, ...] = (
    Claim("03.a", "The harsh tournament rises sooner: its median is higher in generation 3.", _harsh_rises_sooner, "m"),
    Claim(
        "03.b",
        "Without elites, uniform selection ends with a poorer best robot than it began with.",
        _uniform_falls,
        "m",
    ),
    Claim("03.c", "The median of uniform selection ends below that of the gentle tournament.", _uniform_is_last, "m"),
    Claim("03.d", "The harsh tournament has lost more diversity in generation 4.", _harsh_loses_diversity),
)
