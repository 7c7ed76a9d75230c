"""The same seed gives the same table, byte for byte, on any executor and in any order and environment."""

import hashlib
import locale
import multiprocessing
import os
import subprocess
import sys
import threading
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache

import numpy as np
import pytest
from loky import ProcessPoolExecutor as LokyPool
from loky import get_reusable_executor

import walkerlab as wl
from tests.faults import number
from tests.simulation.test_cluster import started_cluster
from walkerlab.simulation.pausable import PausableExecutor
from walkerlab.simulation.workers import n_workers

WORLDS = {
    "flat": {},
    "stairs": {"structure": "stairs", "texture": "gravel", "texture_density": 0.05},
    "loads": {"obstacle": "box", "obstacle_density": 0.5, "carry_weight": 1.0, "drag_weight": 1.0, "n_starts": 2},
}
RUNS = [(world, seed) for world in number(("loads",), tuple(WORLDS)) for seed in range(number(1, 2))]
SIZE = {"population_size": number(6, 12), "generations": number(3, 4), "duration": number(1, 2)}
NUMBERS = number((2,), (1, 2, 4))


class ShufflingExecutor(Executor):
    """Executor that computes waiting tasks in a random order and returns their results in another random order."""

    def __init__(self, seed):
        self._rng = np.random.default_rng(seed)
        self._waiting = []
        self._has_tasks = threading.Event()
        self._lock = threading.Lock()
        self._is_over = False
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        with self._lock:
            self._waiting.append((future, fn, args, kwargs))
        self._has_tasks.set()
        return future

    def shutdown(self, wait=True, *, cancel_futures=False):
        self._is_over = True
        self._has_tasks.set()
        self._thread.join()

    def _serve(self):
        while not self._is_over:
            self._has_tasks.wait()
            self._has_tasks.clear()
            while batch := self._take():
                results = []
                for index in self._rng.permutation(len(batch)):
                    future, fn, args, kwargs = batch[index]
                    if future.set_running_or_notify_cancel():
                        results.append((future, fn(*args, **kwargs)))
                for index in self._rng.permutation(len(results)):
                    future, result = results[index]
                    future.set_result(result)

    def _take(self):
        """Return up to five random waiting tasks, the newest first."""
        with self._lock:
            chosen = sorted(self._rng.permutation(len(self._waiting))[:5].tolist(), reverse=True)
            return [self._waiting.pop(index) for index in chosen]


@contextmanager
def reusable(n):
    with get_reusable_executor(n) as pool:
        yield pool


@contextmanager
def spawned(n):
    with ProcessPoolExecutor(n, multiprocessing.get_context("spawn")) as pool:
        yield pool


@contextmanager
def pausable(n):
    with ThreadPoolExecutor(n) as pool, PausableExecutor(lambda: pool, n_workers) as executor:
        yield executor


@contextmanager
def pausable_and_shuffling(n):
    with ShufflingExecutor(n) as pool, PausableExecutor(lambda: pool, lambda _: 8 * n) as executor:
        yield executor


@contextmanager
def on_a_cluster(n):
    with started_cluster(n) as client:
        client.wait_for_workers(n, 60)
        yield client.get_executor()


EXECUTORS = {
    "threads": ThreadPoolExecutor,
    "loky": LokyPool,
    "spawned processes": spawned,
    "a shuffling executor": ShufflingExecutor,
    "a pausable shuffling executor": pausable_and_shuffling,
    "pausable threads": pausable,
    "loky's reusable executor": reusable,
    "a cluster": on_a_cluster,
}


def table(world, seed, executor):
    """Evolve, and write the table as bytes."""
    settings = wl.Settings().with_(**SIZE, **WORLDS[world], seed=seed)
    return wl.evolve(settings, executor=executor, progress=False).records.to_csv().encode()


@cache
def single_threaded_table(world, seed):
    """Return the table of a run on one thread."""
    with ThreadPoolExecutor(1) as pool:
        return table(world, seed, pool)


@pytest.mark.parametrize("kind", list(EXECUTORS)[: number(5, None)])
@pytest.mark.parametrize("n", NUMBERS)
def test_the_table_is_the_same_on_every_executor(kind, n):
    with EXECUTORS[kind](n) as executor:
        for world, seed in RUNS:
            assert table(world, seed, executor) == single_threaded_table(world, seed), (world, seed)


def test_another_seed_gives_another_table():
    world, seed = RUNS[0]
    assert single_threaded_table(world, seed) != single_threaded_table(world, seed + 1)


def test_the_shuffling_executor_shuffles():
    done = []
    with ShufflingExecutor(0) as executor:
        futures = [executor.submit(done.append, i) for i in range(20)]
        [future.result(60) for future in futures]
    assert sorted(done) == list(range(20)) != done


# ------------------------------------------------------------------------------------- other processes and environments

PRINT = """
import hashlib, sys
from concurrent.futures import ThreadPoolExecutor
from tests.faults.test_any_executor import table
if __name__ == "__main__":
    world, seed, kind = sys.argv[1:]
    with ThreadPoolExecutor(2) as pool:
        print(hashlib.sha256(table(world, int(seed), pool if kind == "threads" else None)).hexdigest())
"""


def find_locale_with_decimal_comma():
    for name in ("de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8"):
        try:
            locale.setlocale(locale.LC_NUMERIC, name)
        except locale.Error:
            continue
        locale.setlocale(locale.LC_NUMERIC, "C")
        return name
    return None


ENVIRONMENTS = [
    ({"PYTHONHASHSEED": "1", "OMP_NUM_THREADS": "4", "OPENBLAS_NUM_THREADS": "4"}, "threads"),
    ({"PYTHONHASHSEED": "2", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "TZ": "Asia/Tokyo"}, "processes"),
    ({"PYTHONHASHSEED": "3", "LC_ALL": find_locale_with_decimal_comma() or "C"}, "threads"),
    ({"PYTHONHASHSEED": "4", "PYTHONOPTIMIZE": "2", "PYTHONUTF8": "0", "LC_ALL": "POSIX"}, "processes"),
]


@pytest.mark.parametrize(("environment", "kind"), ENVIRONMENTS[number(1, 0) : number(2, None)])
def test_the_environment_does_not_change_the_table(environment, kind):
    for world, seed in RUNS[:: number(1, 2)]:
        command = [sys.executable, "-c", PRINT, world, str(seed), kind]
        done = subprocess.run(
            command, env={**os.environ, **environment}, capture_output=True, text=True, check=False, timeout=600
        )
        assert not done.returncode, done.stderr
        assert done.stdout.split()[-1] == hashlib.sha256(single_threaded_table(world, seed)).hexdigest(), (world, seed)
