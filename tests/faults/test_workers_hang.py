"""Workers that hang, run out of memory or are killed: the run continues or ends with a helpful error."""

import os
import signal
import sys
import threading
import time
import warnings
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from tests.faults import number
from tests.simulation.test_workers import SETTINGS, UNIX, expected, lost, processes, workers  # noqa: F401
from walkerlab.__main__ import main
from walkerlab.evolution.live import LiveRun, State
from walkerlab.simulation import evaluation, timeouts
from walkerlab.simulation.timeouts import wait_for
from walkerlab.simulation.workers import WorkerLostWarning, WorkersLostError, replace_hung_workers

ALL = None


@UNIX
@pytest.mark.parametrize("n_stopped", number([ALL], [ALL, 1, ALL, 1]))
def test_workers_that_hang_are_replaced_and_the_records_do_not_change(n_stopped, workers, expected, monkeypatch):  # noqa: F811
    def on_walks(_):
        if len(walks) == 9:
            stopped.extend(sorted(processes(workers))[:n_stopped])
            for pid in stopped:
                os.kill(pid, signal.SIGSTOP)
        walks.append(None)

    def wait_briefly(future, seconds):
        is_hanging = stopped and {*stopped} & processes(workers)
        return wait_for(future, seconds / 1000 if is_hanging else seconds)

    walks = []
    stopped = []
    evolution = wl.Evolution(SETTINGS, on_walks=on_walks)
    monkeypatch.setattr(timeouts, "wait_for", wait_briefly)
    monkeypatch.setattr(
        timeouts, "replace_hung_workers", lambda executor, silence: replace_hung_workers(executor, silence / 200)
    )
    with pytest.warns(WorkerLostWarning, match="they stopped responding"):
        for _ in evolution:
            pass
    pd.testing.assert_frame_equal(evolution.run.records, expected, check_exact=True)
    assert stopped
    assert not {*stopped} & processes(workers)


@pytest.fixture
def waits(monkeypatch):
    """Duration of each wait for a result; the waits take a thousandth of it."""
    durations = []

    def wait_briefly(future, seconds):
        durations.append(seconds)
        return wait_for(future, seconds / 1000)

    monkeypatch.setattr(timeouts, "wait_for", wait_briefly)
    return durations


def test_a_thread_that_hangs_ends_the_run_and_keeps_its_generations(monkeypatch, tmp_path):
    def walk(*args, walk=evaluation._simulate_task):
        if path.exists() and wl.load(path).n_generations:
            assert released.wait(60)
        return walk(*args)

    released = threading.Event()
    path = tmp_path / "run.walk"
    monkeypatch.setattr(evaluation, "_simulate_task", walk)
    monkeypatch.setattr(timeouts, "MIN_TIME_LIMIT", 3)
    monkeypatch.setenv("WALKERLAB_PATIENCE", "3")
    with ThreadPoolExecutor(2) as threads:
        with pytest.raises(
            WorkersLostError, match=r"no answer for \d+ s: .* To fix it, use another executor"
        ) as raised:
            wl.evolve(SETTINGS, path, threads, progress=False)
        released.set()
    assert str(path) in "".join(raised.value.__notes__)
    assert wl.load(path).n_generations == 1


def test_a_live_run_continues_after_a_pause_longer_than_the_time_limit(waits, monkeypatch):
    monkeypatch.setenv("WALKERLAB_PATIENCE", "1000")
    over = threading.Event()
    settings = SETTINGS.with_(population_size=200, generations=1, duration=1)
    with ThreadPoolExecutor(1) as threads:
        live = LiveRun(settings, executor=threads, on_change=lambda live: live.is_over and over.set())
        live.resume()
        until(lambda: live.n_done)
        live.pause()
        enough = len(waits) + 1200
        until(lambda: len(waits) > enough)
        live.resume()
        assert over.wait(60)
        assert live.state == State.finished


def until(holds):
    deadline = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.001)


class Queueing(Executor):
    """Has not started any task."""

    def submit(self, fn, /, *args, **kwargs):
        return Future()


class Cluster(Queueing):
    """Reports every task as running, as Dask's executor does even if no worker has joined."""

    _client = SimpleNamespace(status="running", nthreads=dict)

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        future.set_running_or_notify_cancel()
        return future


@pytest.mark.parametrize("executor", [Queueing(), Cluster()])
def test_an_executor_that_waits_for_workers_does_not_count_as_hanging(executor, waits):
    future = executor.submit(abs, -1)
    results = timeouts.results_in_order([future], executor, limit=20)
    thread = threading.Thread(target=lambda: (until(lambda: len(waits) > 100), future.set_result(1)), daemon=True)
    thread.start()
    assert list(results) == [1]
    thread.join()


def test_the_greatest_time_limit_of_all_waiting_callers_applies(waits):
    hanging, *both = Future(), Future(), Future()
    hanging.set_running_or_notify_cancel()
    both[0].set_running_or_notify_cancel()
    both[0].set_result(1)
    patient = timeouts.results_in_order(both, Queueing(), limit=100)
    assert next(patient) == 1, "it is waiting now"
    with pytest.raises(WorkersLostError, match="100 s"):
        next(timeouts.results_in_order([hanging], Queueing(), limit=10))
    patient.close()
    with pytest.raises(WorkersLostError, match="10 s"):
        next(timeouts.results_in_order([hanging], Queueing(), limit=10))


def test_tasks_have_one_robot_in_a_slow_world_and_many_in_a_usual_one(monkeypatch):
    sent = []

    class Recording(ThreadPoolExecutor):
        def submit(self, fn, /, robots, *_):
            sent.append(len(robots))
            future = Future()
            future.set_exception(ZeroDivisionError())
            return future

    genomes = 200 * [wl.generate_robot_gene(wl.Robot(), rng=np.random.default_rng(0))]
    for settings, most in ((wl.Settings(), 16), (wl.Settings().with_(duration=120, timestep=0.0005, n_starts=20), 1)):
        with Recording(1) as executor, pytest.raises(ZeroDivisionError):
            wl.evaluate(genomes, settings, executor)
        assert max(sent) == most
        sent.clear()


# ------------------------------------------------------------------------------------------------- out of memory


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the memory of one process")
@pytest.mark.parametrize("spare", number([0], [0, 1, 2, 4, 8, 12, 16, 20, 24, 28, 32]))
def test_a_worker_without_memory_ends_the_run_with_advice(spare, workers, monkeypatch):  # noqa: F811
    monkeypatch.setattr(evaluation, "_simulate_task", Starved(spare))
    settings = SETTINGS.with_(texture_size=0.06, texture_density=0.05)
    with pytest.raises(WorkersLostError, match="To fix it, close other programs") as raised:
        wl.evaluate(wl.generate_robot_population(settings.robot, 4, seed=0), settings)
    assert raised.value.__cause__ or "3 times in a row" in str(raised.value)


class Starved:
    """Simulates walks with only a few MiB of memory left."""

    def __init__(self, spare):
        self.spare = spare
        self.walk = evaluation._simulate_task

    def __call__(self, *args):
        import resource
        from pathlib import Path

        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        limits = resource.getrlimit(resource.RLIMIT_AS)
        resource.setrlimit(resource.RLIMIT_AS, (used + self.spare * 2**20, limits[1]))
        try:
            return self.walk(*args)
        finally:
            resource.setrlimit(resource.RLIMIT_AS, limits)


# ---------------------------------------------------------------------------------------------- the command line


@pytest.fixture
def evolving(tmp_path, monkeypatch):
    """Function that runs ``walkerlab evolve`` and calls an action after two generations."""

    threads = ThreadPoolExecutor(1)

    def evolve(action):
        monkeypatch.setattr("walkerlab.evolution.outputs.write_outputs", lambda *_: None)
        monkeypatch.setattr("walkerlab.evolution.evolution.evaluate", lambda *args, **kwargs: (
            action() if (tmp_path / "run.walk").exists() and wl.load(tmp_path).n_generations == 2 else None,
            evaluation.evaluate(*args, **{**kwargs, "executor": threads}),
        )[1])  # fmt: skip
        flags = ["--population-size", "4", "--n-elites", "0", "--generations", "4", "--duration", "1"]
        return main(["evolve", "--out", str(tmp_path), "--quiet", *flags])

    yield evolve
    threads.shutdown()


def test_the_command_line_reports_replaced_workers(evolving, capsys):
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        assert evolving(lambda: warnings.warn(WorkerLostWarning("one was killed (SIGKILL)"), stacklevel=1)) == 0
    said = capsys.readouterr().err
    assert said.startswith("\nNote: The worker processes had to be replaced: one was killed (SIGKILL).")
    assert ".py" not in said


def test_the_command_line_reports_lost_workers_and_how_to_resume(evolving, tmp_path, capsys):
    def lose():
        raise WorkersLostError("no answer")

    assert evolving(lose) == 1
    said = capsys.readouterr().err
    assert "no answer\nStopped after 2 of 4 generations, which are saved." in said
    assert f"walkerlab resume {tmp_path}" in said
