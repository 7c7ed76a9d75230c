"""Claims of lesson 12, a bigger computer."""

from concurrent.futures import ThreadPoolExecutor

import walkerlab as wl
from benchmarks.claims.claim import Claim, evolve_here

SETTINGS = wl.Settings().with_(population_size=16, duration=4, generations=3)


def _is_same_table(seed: int) -> float:
    settings = SETTINGS.with_(seed=seed)
    with ThreadPoolExecutor(2) as executor:
        run = wl.evolve(settings, executor=executor, progress=False)
    return 1.0 if run.records.equals(evolve_here(settings).records) else -1.0


CLAIMS: tuple[Claim, ...] = (
    Claim("12.a", "The table of a run is the same on one worker and on two.", _is_same_table, needed=5),
)
