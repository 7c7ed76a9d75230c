"""Cost of recording more during walks: the same robots evaluated with and without it.

A figure of 1.1 means 10 % more time. With worker processes, the recordings are also sent to this process.
"""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import walkerlab as wl
from benchmarks.timing import N_WALKS, measure_ratios, time_call
from walkerlab.settings.choices import Recording

RECORDINGS = {
    "joints": ["joint_angles", "joint_velocities"],
    "orientation": ["orientation"],
    "contact forces": ["contact_forces"],
    "all": [one.name for one in Recording if one],
}


def rows(n_pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield the relative cost of each recording, on one thread and with worker processes."""
    plain = wl.Settings()
    genomes = wl.generate_robot_population(plain.robot, N_WALKS // 2 or 1, seed=0)
    with ThreadPoolExecutor(1) as thread:
        for name, record in RECORDINGS.items():
            for place, executor in (("one thread", thread), ("all cores", None)):
                with_it, without = (
                    partial(time_call, wl.evaluate, genomes, settings, executor)
                    for settings in (plain.with_(record=record), plain)
                )
                with_it()  # builds every body plan
                without()
                yield f"{name}, {place}", "recorded / not", measure_ratios(n_pairs, with_it, without)
