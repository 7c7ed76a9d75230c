"""The same seed gives the same table to the last byte, whoever walks, in whatever order and whatever surroundings."""

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
from tests.simulation.test_cluster import started
from walkerlab.simulation.pausable import PausableExecutor
from walkerlab.simulation.workers import n_workers

WORLDS = {
    "flat": {},
    "stairs": {"structure": "stairs", "texture": "gravel", "texture_density": 0.05},
    "laden": {"obstacle": "box", "obstacle_density": 0.5, "carry_weight": 1.0, "drag_weight": 1.0, "n_starts": 2},
}
RUNS = [(world, seed) for world in number(("laden",), tuple(WORLDS)) for seed in range(number(1, 2))]
SIZE = {"population_size": number(6, 12), "generations": number(3, 4), "duration": number(1, 2)}
NUMBERS = number((2,), (1, 2, 4))


class Shuffled(Executor):
    """Does the work that it was given in an order drawn by lot, and answers in another, once nothing more comes."""

    def __init__(self, seed):
        self._rng, self._waiting, self._came = np.random.default_rng(seed), [], threading.Event()
        self._lock, self._is_over = threading.Lock(), False
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        with self._lock:
            self._waiting.append((future, fn, args, kwargs))
        self._came.set()
        return future

    def shutdown(self, wait=True, *, cancel_futures=False):
        self._is_over = True
        self._came.set()
        self._thread.join()

    def _serve(self):
        while not self._is_over:
            self._came.wait()
            self._came.clear()
            while batch := self._take():
                answers = []
                for place in self._rng.permutation(len(batch)):
                    future, fn, args, kwargs = batch[place]
                    if future.set_running_or_notify_cancel():
                        answers.append((future, fn(*args, **kwargs)))
                for place in self._rng.permutation(len(answers)):
                    future, answer = answers[place]
                    future.set_result(answer)

    def _take(self):
        """Take a handful of what waits, never in the order in which it came."""
        with self._lock:
            chosen = sorted(self._rng.permutation(len(self._waiting))[:5].tolist(), reverse=True)
            return [self._waiting.pop(place) for place in chosen]


@contextmanager
def reusable(n):
    with get_reusable_executor(n) as pool:
        yield pool


@contextmanager
def spawned(n):
    with ProcessPoolExecutor(n, multiprocessing.get_context("spawn")) as pool:
        yield pool


@contextmanager
def gated(n):
    with ThreadPoolExecutor(n) as pool, PausableExecutor(lambda: pool, n_workers) as gate:
        yield gate


@contextmanager
def gated_and_shuffled(n):
    with Shuffled(n) as pool, PausableExecutor(lambda: pool, lambda _: 8 * n) as gate:
        yield gate


@contextmanager
def on_a_cluster(n):
    with started(n) as client:
        client.wait_for_workers(n, 60)
        yield client.get_executor()


WHO = {
    "threads": ThreadPoolExecutor,
    "loky": LokyPool,
    "spawned processes": spawned,
    "a shuffler": Shuffled,
    "a shuffler behind a gate": gated_and_shuffled,
    "threads behind a gate": gated,
    "the reusable loky": reusable,
    "a cluster": on_a_cluster,
}


def table(world, seed, executor):
    """Evolve, and write the table as bytes."""
    settings = wl.Settings().with_(**SIZE, **WORLDS[world], seed=seed)
    return wl.evolve(settings, executor=executor, progress=False).records.to_csv().encode()


@cache
def at_home(world, seed):
    """The table of a single thread."""
    with ThreadPoolExecutor(1) as pool:
        return table(world, seed, pool)


@pytest.mark.parametrize("who", list(WHO)[: number(5, None)])
@pytest.mark.parametrize("n", NUMBERS)
def test_whoever_walks_the_table_is_the_same(who, n):
    with WHO[who](n) as executor:
        for world, seed in RUNS:
            assert table(world, seed, executor) == at_home(world, seed), (world, seed)


def test_another_seed_gives_another_table():
    world, seed = RUNS[0]
    assert at_home(world, seed) != at_home(world, seed + 1)


def test_a_shuffler_shuffles():
    done = []
    with Shuffled(0) as executor:
        futures = [executor.submit(done.append, i) for i in range(20)]
        [future.result(60) for future in futures]
    assert sorted(done) == list(range(20)) != done


# ------------------------------------------------------------------------------------- another Python, elsewhere

PRINT = """
import hashlib, sys
from concurrent.futures import ThreadPoolExecutor
from tests.faults.test_any_executor import table
if __name__ == "__main__":
    world, seed, who = sys.argv[1:]
    with ThreadPoolExecutor(2) as pool:
        print(hashlib.sha256(table(world, int(seed), pool if who == "threads" else None)).hexdigest())
"""


def a_locale_with_a_decimal_comma():
    for name in ("de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8"):
        try:
            locale.setlocale(locale.LC_NUMERIC, name)
        except locale.Error:
            continue
        locale.setlocale(locale.LC_NUMERIC, "C")
        return name
    return None


SURROUNDINGS = [
    ({"PYTHONHASHSEED": "1", "OMP_NUM_THREADS": "4", "OPENBLAS_NUM_THREADS": "4"}, "threads"),
    ({"PYTHONHASHSEED": "2", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "TZ": "Asia/Tokyo"}, "processes"),
    ({"PYTHONHASHSEED": "3", "LC_ALL": a_locale_with_a_decimal_comma() or "C"}, "threads"),
    ({"PYTHONHASHSEED": "4", "PYTHONOPTIMIZE": "2", "PYTHONUTF8": "0", "LC_ALL": "POSIX"}, "processes"),
]


@pytest.mark.parametrize(("surroundings", "who"), SURROUNDINGS[number(1, 0) : number(2, None)])
def test_the_surroundings_change_nothing(surroundings, who):
    for world, seed in RUNS[:: number(1, 2)]:
        command = [sys.executable, "-c", PRINT, world, str(seed), who]
        done = subprocess.run(
            command, env={**os.environ, **surroundings}, capture_output=True, text=True, check=False, timeout=600
        )
        assert not done.returncode, done.stderr
        assert done.stdout.split()[-1] == hashlib.sha256(at_home(world, seed)).hexdigest(), (world, seed)
