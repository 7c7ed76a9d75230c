"""What the panel costs: the throughput of a run watched in it over that of the same run without.

Nobody looks at the panel here: it draws all that it would send to a browser, which takes its own time elsewhere.
"""

import tempfile
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import walkerlab as wl
from benchmarks.timing import WALKS, in_turn, seconds
from walkerlab.widgets import Lab

IN_SIGHT = 24  # robots of the population that a browser shows at once


def rows(pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield what is left of a run's speed in the panel."""
    settings = wl.Settings().with_(generations=max(2, WALKS // 15))
    bare = partial(seconds, partial(wl.evolve, settings, progress=False))
    bare()  # starts the workers, and builds what is built once
    yield "a run", "without / in the panel", in_turn(pairs, bare, partial(watched, settings))


def watched(settings: wl.Settings) -> float:
    """Evolve in a panel: s, from the press on the button to the last walk."""
    with tempfile.TemporaryDirectory() as folder:
        lab = Lab(settings, Path(folder))
        lab.population.visible = [0, IN_SIGHT]
        time.sleep(2)  # in which it draws the world and asks what a run will cost
        started = time.perf_counter()
        lab.transport._on_press("start")
        while lab.transport.state in ("ready", "running"):
            time.sleep(0.005)
        took = time.perf_counter() - started
        lab.form.close()  # but not the panel: its workers are those of the next run
        return took
