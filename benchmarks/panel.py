"""Cost of the panel: the throughput of a run that is shown in it, divided by that of the same run without a panel.

The panel draws everything that it would send to a browser. The browser itself is not part of the measurement.
"""

import tempfile
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import walkerlab as wl
from benchmarks.timing import N_WALKS, measure_ratios, time_call
from walkerlab.widgets import Lab

N_VISIBLE = 24  # robots of the population that a browser shows at the same time


def rows(n_pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield the relative speed of a run in the panel."""
    settings = wl.Settings().with_(generations=max(2, N_WALKS // 15))
    run_without_panel = partial(time_call, partial(wl.evolve, settings, progress=False))
    run_without_panel()  # starts the workers, which then build every body plan
    ratios = measure_ratios(n_pairs, run_without_panel, partial(time_run_in_panel, settings))
    yield "a run", "without / in the panel", ratios


def time_run_in_panel(settings: wl.Settings) -> float:
    """Evolve in a panel and return the time from the press of the button to the last walk [s]."""
    with tempfile.TemporaryDirectory() as folder:
        lab = Lab(settings, Path(folder))
        lab.population.visible = [0, N_VISIBLE]
        time.sleep(2)  # until it has drawn the world and estimated the duration of the run
        start = time.perf_counter()
        lab.transport._on_press("start")
        while lab.transport.state in ("ready", "running"):
            time.sleep(0.005)
        duration = time.perf_counter() - start
        lab.form.close()  # closing the panel would stop the workers, which the next run needs
        return duration
