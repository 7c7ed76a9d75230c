"""Speed-up by all cores, compared with that of plain processes that only step the same worlds.

A speed-up is the throughput of all cores over that of one worker. The speed-up of plain processes is the most that the
computer allows, because cores share memory, heat and power; 1 means that all of it is used. Every plain process has its
worlds prepared and steps the same ones, so that no process has to wait for another at the end, as evaluation has to.
``dask`` is the throughput of a local cluster with one process per core, divided by that of the default workers.
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
from benchmarks.timing import N_WALKS, measure_ratios, print_note, time_call
from walkerlab.simulation.workers import n_cores

LOCAL_ONLY = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0"}  # not reachable from other computers


def rows(n_pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield the relative speed-up of each kind of worker, and the relative throughput of Dask."""
    settings = wl.Settings()
    genomes = wl.generate_robot_population(settings.robot, N_WALKS, seed=0)
    evaluate = partial(wl.evaluate, genomes, settings)
    yield from compare_speedups(n_pairs, genomes, settings, evaluate)
    if find_spec("distributed"):
        yield "dask", "loky / dask", compare_with_dask(n_pairs, evaluate)
    else:
        print_note("dask: no row, because distributed is not installed")


def compare_speedups(n_pairs, genomes, settings, evaluate) -> Iterator[tuple[str, str, list[float]]]:
    """Measure the speed-ups of each kind of worker and of plain processes in turn; yield a row for each kind."""
    with ExitStack() as stack:
        start = stack.enter_context
        options = {"initializer": prepare_walks, "initargs": (genomes, settings)}
        plain_processes = [start(ProcessPoolExecutor(1, **options)) for _ in range(n_cores())]
        kinds = {
            "loky": (start(ProcessPoolExecutor(1)), None),
            "threads": (start(ThreadPoolExecutor(1)), start(ThreadPoolExecutor(n_cores()))),
        }
        step_in_processes(plain_processes)
        for _ in range(2):  # so that each worker has built every body plan
            for executors in kinds.values():
                for executor in executors:
                    evaluate(executor)
        plain_speedups: list[float] = []
        speedups: dict[str, list[float]] = {kind: [] for kind in kinds}
        for _ in range(n_pairs):
            one_process = time_call(step_in_processes, plain_processes[:1])
            all_processes = time_call(step_in_processes, plain_processes)
            plain_speedups.append(len(plain_processes) * one_process / all_processes)
            for kind, (one_worker, all_workers) in kinds.items():
                speedups[kind].append(time_call(evaluate, one_worker) / time_call(evaluate, all_workers))
    medians = {"plain": median(plain_speedups)} | {kind: median(speedups[kind]) for kind in kinds}
    print_note(f"speed-up on {n_cores()} cores: " + ", ".join(f"{kind} {value:.2f}" for kind, value in medians.items()))
    for kind in kinds:
        ratios = [speedup / plain for speedup, plain in zip(speedups[kind], plain_speedups, strict=True)]
        yield kind, "speed-up / plain speed-up", ratios


def compare_with_dask(n_pairs, evaluate) -> list[float]:
    """Return the time of the default workers divided by that of a local Dask cluster."""
    from distributed import Client, LocalCluster

    logging.getLogger("distributed").setLevel(logging.ERROR)
    local_cluster = LocalCluster(n_workers=n_cores(), threads_per_worker=1, **LOCAL_ONLY)
    with local_cluster as cluster, Client(cluster) as client:
        executor = client.get_executor()
        for _ in range(2):
            evaluate(executor)
            evaluate(None)
        return measure_ratios(n_pairs, lambda: time_call(evaluate, None), lambda: time_call(evaluate, executor))


# ------------------------------------------------------------------------------------------- in a plain process

_walks: list[floor.Walk] = []


def prepare_walks(genomes, settings) -> None:
    """Prepare the walk of each genome."""
    _walks.extend(floor.prepare_walk(genome, settings) for genome in genomes)


def step_walks() -> None:
    """Step every prepared world through its walk."""
    for walk in _walks:
        walk()


def step_in_processes(processes: list[Executor]) -> None:
    """Step all worlds in each of the processes, in parallel, and wait for them."""
    futures = [process.submit(step_walks) for process in processes]
    for future in futures:
        future.result()
