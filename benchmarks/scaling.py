"""What all cores gain over one, against what plain processes gain that do nothing but step the same worlds.

A gain is how much more is done at once, all cores over one worker; that of plain processes is what the machine can
give, whose cores share memory, heat and power. 1 is all of it. The plain processes have their worlds ready, and each
steps the same ones, so that their gain has no tail; evaluation's has. `dask` is the throughput of a local cluster of as
many processes over that of the default workers.
"""

import logging
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial
from importlib.util import find_spec
from statistics import median

from loky import ProcessPoolExecutor

import walkerlab as wl
from benchmarks import floor
from benchmarks.timing import WALKS, in_turn, note, seconds
from walkerlab.simulation.workers import n_cores

HERE = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0"}  # a cluster for this computer only


def rows(pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield what is left of the machine's gain with each kind of worker, and of its throughput with Dask."""
    settings = wl.Settings()
    genomes = wl.generate_robot_population(settings.robot, WALKS, seed=0)
    evaluate = partial(wl.evaluate, genomes, settings)
    yield from gains(pairs, genomes, settings, evaluate)
    if find_spec("distributed"):
        yield "dask", "loky / dask", dask(pairs, evaluate)
    else:
        note("dask: no row, for distributed is not installed")


def gains(pairs, genomes, settings, evaluate) -> Iterator[tuple[str, str, list[float]]]:
    """Take the gain of each kind of worker and of plain processes in turn."""
    with ExitStack() as stack:
        start = stack.enter_context
        alike = {"initializer": prepare, "initargs": (genomes, settings)}
        plain = [start(ProcessPoolExecutor(1, **alike)) for _ in range(n_cores())]
        kinds = {
            "loky": (start(ProcessPoolExecutor(1)), None),
            "threads": (start(ThreadPoolExecutor(1)), start(ThreadPoolExecutor(n_cores()))),
        }
        step_in(plain)
        for executor in 2 * [executor for kind in kinds.values() for executor in kind]:
            evaluate(executor)  # twice, so that each worker has met every body plan
        found = {"plain": []} | {kind: [] for kind in kinds}
        for _ in range(pairs):
            found["plain"].append(len(plain) * seconds(step_in, plain[:1]) / seconds(step_in, plain))
            for kind, (one, all_cores) in kinds.items():
                found[kind].append(seconds(evaluate, one) / seconds(evaluate, all_cores))
    note(f"gain on {n_cores()} cores: " + ", ".join(f"{kind} {median(gain):.2f}" for kind, gain in found.items()))
    for kind in kinds:
        yield kind, "gain / plain processes' gain", [a / b for a, b in zip(found[kind], found["plain"], strict=True)]


def dask(pairs, evaluate) -> list[float]:
    """Divide the default workers' time by that of a local cluster."""
    from distributed import Client, LocalCluster

    logging.getLogger("distributed").setLevel(logging.ERROR)
    one_a_core = LocalCluster(n_workers=n_cores(), threads_per_worker=1, **HERE)
    with one_a_core as cluster, Client(cluster) as client:
        cluster_wide = client.get_executor()
        for _ in range(2):
            evaluate(cluster_wide)
            evaluate(None)
        return in_turn(pairs, lambda: seconds(evaluate, None), lambda: seconds(evaluate, cluster_wide))


# ------------------------------------------------------------------------------------------- in a plain process

_walks: list[floor.Walk] = []


def prepare(genomes, settings) -> None:
    """Get the worlds ready."""
    _walks.extend(floor.prepare(genome, settings) for genome in genomes)


def step() -> None:
    """Step every world through its walk."""
    for walk in _walks:
        walk()


def step_in(processes: list[Executor]) -> None:
    """Have each of these processes step all its worlds, at once."""
    for done in [process.submit(step) for process in processes]:
        done.result()
