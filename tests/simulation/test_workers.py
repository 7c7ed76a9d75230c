"""Worker processes: tasks of a lost process are repeated, and no result changes."""

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from multiprocessing import get_context

import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.evolution.live import LiveRun, State
from walkerlab.simulation.workers import (
    MAX_LOST_POOLS,
    WorkerLostWarning,
    WorkersLostError,
    default_executor,
    n_cores,
    n_workers,
)

SETTINGS = wl.Settings().with_(population_size=12, generations=3, n_elites=2, duration=2)
UNIX = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")


@pytest.fixture
def workers():
    """The default executor without processes; they are ended afterwards."""
    pool = default_executor()
    pool.shutdown()
    yield pool
    pool.shutdown()


@pytest.fixture(scope="module")
def expected():
    with ThreadPoolExecutor(1) as thread:
        return wl.evolve(SETTINGS, executor=thread, progress=False).records


def processes(workers):
    return set(workers._pool._processes)


def kill_one(workers):
    os.kill(min(processes(workers)), signal.SIGKILL)


@pytest.fixture
def lost(workers, monkeypatch):
    """The pools that were lost, once for each task that was in them."""
    pools = []
    resubmit = type(workers)._resubmit
    monkeypatch.setattr(type(workers), "_resubmit", lambda self, *args: pools.append(args[-1]) or resubmit(self, *args))
    return pools


@UNIX
def test_workers_killed_during_a_generation_do_not_change_the_records(workers, lost, expected):
    kills = []

    def on_walks(_):
        if len(kills) < 2 and len(walks) in (3, 9):
            kills.append(processes(workers))
            kill_one(workers)
        walks.append(None)

    walks = []
    evolution = wl.Evolution(SETTINGS, on_walks=on_walks)
    with pytest.warns(WorkerLostWarning, match=r"killed \(SIGKILL\).* no result is lost"):
        for _ in evolution:
            pass
    pd.testing.assert_frame_equal(evolution.run.records, expected, check_exact=True)
    assert len(kills) == 2
    assert lost, "no task was running when they were killed"
    assert not kills[0] & processes(workers), "the killed pool was replaced"


@UNIX
def test_a_live_run_survives_a_killed_worker(workers, lost, expected):
    started = threading.Event()
    live = LiveRun(SETTINGS, on_change=lambda live: live.n_done and started.set())
    live.resume()
    assert started.wait(60)
    kill_one(workers)
    live._thread.join(60)
    assert live.state == State.finished
    assert lost
    assert "killed (SIGKILL)" in live.loss_note
    pd.testing.assert_frame_equal(live.run.records, expected, check_exact=True)


def test_a_task_that_always_ends_its_worker_fails_and_later_tasks_succeed(workers, lost):
    with pytest.raises(
        WorkersLostError, match=r"3 times in a row the worker processes ended .* executor=ThreadPoolExecutor"
    ):
        workers.submit(os._exit, 1).result(60)
    assert len(lost) == len(set(lost)) == MAX_LOST_POOLS
    assert workers.submit(abs, -1).result(60) == 1


def test_an_error_in_a_task_is_not_a_lost_worker(workers, lost):
    with pytest.raises(ZeroDivisionError):
        workers.submit(divmod, 1, 0).result(60)
    assert not lost


@UNIX
def test_any_number_of_lost_pools_is_tolerated_if_tasks_are_done_in_between(workers, lost):
    futures = [workers.submit(time.sleep, 0.2) for _ in range(12 * n_cores())]
    for n in range(MAX_LOST_POOLS + 1):
        while sum(future.done() for future in futures) < 2 * (n + 1):
            time.sleep(0.01)
        kill_one(workers)
    for future in futures:
        future.result(60)
    assert len(set(lost)) > MAX_LOST_POOLS


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_forked_process_starts_its_own_workers(workers):
    assert workers.submit(abs, -1).result(60) == 1
    child = get_context("fork").Process(target=_evaluate_in_child)
    child.start()
    child.join(60)
    child.kill()
    assert child.exitcode == 0


def _evaluate_in_child():
    assert default_executor().submit(abs, -2).result(30) == 2
    default_executor().shutdown()


def test_a_cancelled_task_is_not_started(workers, tmp_path):
    workers.submit(int).result(60)
    busy = [workers.submit(time.sleep, 1) for _ in range(3 * n_cores() + 2)]
    late = workers.submit((tmp_path / "started").touch)
    time.sleep(0.3)  # so that all tasks are in the pool
    for future in (late, *busy):
        future.cancel()
    with pytest.raises(CancelledError):
        late.result(60)
    time.sleep(2)
    assert workers.submit(abs, -2).result(10) == 2, "workers do not finish cancelled tasks first"
    assert not (tmp_path / "started").exists()


def test_a_task_cancelled_in_the_pool_is_cancelled(workers):
    outer, inner = Future(), Future()
    inner.cancel()
    workers._forward_result(outer, int, workers._pool, inner)
    with pytest.raises(CancelledError):
        outer.result(1)


def test_new_workers_start_with_the_next_task_after_a_shutdown(workers):
    workers.submit(int).result(60)
    first = processes(workers)
    workers.shutdown()
    assert workers.submit(abs, -3).result(60) == 3
    assert not first & processes(workers)


def test_all_threads_share_one_pool(workers):
    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(lambda n: workers.submit(abs, -n).result(60), range(20))) == list(range(20))
    assert len(processes(workers)) == n_cores()


def test_the_number_of_workers_of_an_executor_is_known(workers):
    assert n_workers(workers) == n_cores()
    with ThreadPoolExecutor(5) as threads:
        assert n_workers(threads) == 5


@pytest.mark.parametrize("executor", [2, "dask", ThreadPoolExecutor])
@pytest.mark.parametrize("call", [
    lambda it: wl.evolve(SETTINGS, executor=it, progress=False), lambda it: wl.Evolution(SETTINGS, executor=it),
    lambda it: LiveRun(SETTINGS, executor=it), lambda it: wl.evaluate([], SETTINGS, it), lambda it: wl.Lab(executor=it),
], ids=["evolve", "Evolution", "LiveRun", "evaluate", "Lab"])  # fmt: skip
def test_a_value_that_is_not_an_executor_is_rejected_at_once(call, executor):
    with pytest.raises(TypeError, match=r"Client\(cluster\)\.get_executor\(\).*got"):
        call(executor)


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system cannot bind a process to cores")
def test_only_cores_that_the_process_may_use_are_counted():
    code = (
        "import os; os.sched_setaffinity(0, [min(os.sched_getaffinity(0))]); import walkerlab.simulation.workers as w"
    )
    bound = subprocess.run([sys.executable, "-c", f"{code}; print(w.n_cores())"], capture_output=True, text=True)
    assert bound.stdout.split() == ["1"], bound.stderr
