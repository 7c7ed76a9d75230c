"""loky's processes: what is lost with one of them is done again, and nothing is changed by it."""

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
from walkerlab.live import LiveRun, State
from walkerlab.workers import TRIES, WorkerLostWarning, WorkersLostError, default_executor, n_cores, n_workers

SETTINGS = wl.Settings().with_(population_size=12, generations=3, n_elites=2, duration=2)
UNIX = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")


@pytest.fixture
def workers():
    """The workers, started anew and sent home afterwards."""
    pool = default_executor()
    pool.shutdown()
    yield pool
    pool.shutdown()


@pytest.fixture(scope="module")
def undisturbed():
    with ThreadPoolExecutor(1) as thread:
        return wl.evolve(SETTINGS, executor=thread, progress=False).records


def processes(workers):
    return set(workers._pool._processes)


def kill_one(workers):
    os.kill(min(processes(workers)), signal.SIGKILL)


@pytest.fixture
def lost(workers, monkeypatch):
    """The pools that were lost, once for each work that was in them."""
    pools, again = [], type(workers)._again
    monkeypatch.setattr(type(workers), "_again", lambda self, *given: pools.append(given[-1]) or again(self, *given))
    return pools


@UNIX
def test_a_worker_killed_in_mid_generation_loses_nothing_and_changes_nothing(workers, lost, undisturbed):
    kills = []

    def walked(_):
        if len(kills) < 2 and len(walks) in (3, 9):
            kills.append(processes(workers))
            kill_one(workers)
        walks.append(None)

    walks = []
    evolution = wl.Evolution(SETTINGS, on_walks=walked)
    with pytest.warns(WorkerLostWarning, match=r"killed \(SIGKILL\).* nothing is lost"):
        for _ in evolution:
            pass
    pd.testing.assert_frame_equal(evolution.run.records, undisturbed, check_exact=True)
    assert len(kills) == 2
    assert lost, "or nobody was walking when they were killed"
    assert not kills[0] & processes(workers), "others have taken their place"


@UNIX
def test_a_run_in_the_panel_outlives_a_worker(workers, lost, undisturbed):
    started = threading.Event()
    live = LiveRun(SETTINGS, on_news=lambda live: live.n_done and started.set())
    live.go_on()
    assert started.wait(60)
    kill_one(workers)
    live._thread.join(60)
    assert live.state == State.finished
    assert lost
    assert "killed (SIGKILL)" in live.note
    pd.testing.assert_frame_equal(live.run.records, undisturbed, check_exact=True)


def test_work_that_ends_its_worker_each_time_is_given_up_in_words_and_others_are_not(workers, lost):
    with pytest.raises(
        WorkersLostError, match=r"3 times in a row the worker processes ended .* executor=ThreadPoolExecutor"
    ):
        workers.submit(os._exit, 1).result(60)
    assert len(lost) == len(set(lost)) == TRIES
    assert workers.submit(abs, -1).result(60) == 1


def test_an_error_in_the_work_is_its_own(workers, lost):
    with pytest.raises(ZeroDivisionError):
        workers.submit(divmod, 1, 0).result(60)
    assert not lost


@UNIX
def test_workers_may_die_as_often_as_they_like_as_long_as_something_is_done(workers, lost):
    futures = [workers.submit(time.sleep, 0.2) for _ in range(12 * n_cores())]
    for n in range(TRIES + 1):
        while sum(future.done() for future in futures) < 2 * (n + 1):
            time.sleep(0.01)
        kill_one(workers)
    for future in futures:
        future.result(60)
    assert len(set(lost)) > TRIES


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system splits off no processes")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_process_that_is_split_off_hires_its_own(workers):
    assert workers.submit(abs, -1).result(60) == 1
    child = get_context("fork").Process(target=_evaluate_in_child)
    child.start()
    child.join(60)
    child.kill()
    assert child.exitcode == 0


def _evaluate_in_child():
    assert default_executor().submit(abs, -2).result(30) == 2
    default_executor().shutdown()


def test_what_is_given_up_is_not_begun(workers, tmp_path):
    workers.submit(int).result(60)
    busy = [workers.submit(time.sleep, 1) for _ in range(3 * n_cores() + 2)]
    late = workers.submit((tmp_path / "begun").touch)
    time.sleep(0.3)  # now all are in the pool
    for future in (late, *busy):
        future.cancel()
    with pytest.raises(CancelledError):
        late.result(60)
    time.sleep(2)
    assert workers.submit(abs, -2).result(10) == 2, "and nobody waits for what was given up"
    assert not (tmp_path / "begun").exists()


def test_what_somebody_else_gives_up_is_given_up(workers):
    outer, inner = Future(), Future()
    inner.cancel()
    workers._answer(outer, int, workers._pool, inner)
    with pytest.raises(CancelledError):
        outer.result(1)


def test_sent_home_they_leave_and_others_come_with_the_next_work(workers):
    workers.submit(int).result(60)
    first = processes(workers)
    workers.shutdown()
    assert workers.submit(abs, -3).result(60) == 3
    assert not first & processes(workers)


def test_whichever_thread_asks_there_is_one_pool(workers):
    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(lambda n: workers.submit(abs, -n).result(60), range(20))) == list(range(20))
    assert len(processes(workers)) == n_cores()


def test_an_executor_tells_how_many_work_in_it(workers):
    assert n_workers(workers) == n_cores()
    with ThreadPoolExecutor(5) as threads:
        assert n_workers(threads) == 5


@pytest.mark.parametrize("executor", [2, "dask", ThreadPoolExecutor])
@pytest.mark.parametrize("asked", [
    lambda it: wl.evolve(SETTINGS, executor=it, progress=False), lambda it: wl.Evolution(SETTINGS, executor=it),
    lambda it: LiveRun(SETTINGS, executor=it), lambda it: wl.evaluate([], SETTINGS, it), lambda it: wl.Lab(executor=it),
], ids=["evolve", "Evolution", "LiveRun", "evaluate", "Lab"])  # fmt: skip
def test_what_is_no_executor_is_refused_at_once_with_the_mend(asked, executor):
    with pytest.raises(TypeError, match=r"Client\(cluster\)\.get_executor\(\).*got"):
        asked(executor)


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system binds no process to cores")
def test_only_the_cores_that_the_process_may_use_count():
    code = "import os; os.sched_setaffinity(0, [min(os.sched_getaffinity(0))]); import walkerlab.workers as w"
    bound = subprocess.run([sys.executable, "-c", f"{code}; print(w.n_cores())"], capture_output=True, text=True)
    assert bound.stdout.split() == ["1"], bound.stderr
