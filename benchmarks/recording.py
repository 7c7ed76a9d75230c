"""Cost of recording more during walks: the same robots evaluated with and without it, on one thread.

A figure of 1.1 means 10 % more computing time of this process, which other processes hardly affect. The last case
compares the time that passes with worker processes, which also send their recordings to this process.
"""

from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import partial
from time import process_time
from typing import Any

import walkerlab as wl
from benchmarks.timing import N_WALKS, measure_ratios, time_call
from walkerlab.settings.choices import Recording

ALL = [one.name for one in Recording if one]
RECORDINGS = {
    "joints": ["joint_angles", "joint_velocities"],
    "orientation": ["orientation"],
    "contact forces": ["contact_forces"],
    "all": ALL,
}


def rows(n_pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield the relative cost of each recording on one thread, and of all of them with worker processes."""
    genomes = wl.generate_robot_population(wl.Settings().robot, N_WALKS // 4 or 1, seed=0)
    with ThreadPoolExecutor(1) as thread:
        for name, record in RECORDINGS.items():
            yield f"{name}, one thread", "recorded / not", _compare(n_pairs, genomes, record, thread, _measure_cpu)
    yield "all, worker processes", "recorded / not", _compare(n_pairs, genomes, ALL, None, time_call)


def _compare(n_pairs: int, genomes: Any, record: list[str], executor: Executor | None, measure: Any) -> list[float]:
    plain = wl.Settings()
    pair = [partial(measure, wl.evaluate, genomes, s, executor) for s in (plain.with_(record=record), plain)]
    for evaluate in pair:
        evaluate()  # builds every body plan
    return measure_ratios(n_pairs, *pair)


def _measure_cpu(*call: Any) -> float:
    """Call a function and return the computing time of this process [s]."""
    function, *arguments = call
    start = process_time()
    function(*arguments)
    return process_time() - start
