"""Workers that hang, that have no memory left, or that the system kills: the run goes on, or ends in words."""

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
from tests.test_workers import SETTINGS, UNIX, lost, processes, undisturbed, workers  # noqa: F401
from walkerlab import evaluation, waiting
from walkerlab.__main__ import main
from walkerlab.live import LiveRun, State
from walkerlab.waiting import is_done
from walkerlab.workers import WorkerLostWarning, WorkersLostError, renewed

ALL = None


@UNIX
@pytest.mark.parametrize("n_stopped", number([ALL], [ALL, 1, ALL, 1]))
def test_workers_that_hang_are_replaced_and_nothing_is_changed(n_stopped, workers, undisturbed, monkeypatch):  # noqa: F811
    def walked(_):
        if len(walks) == 9:
            stopped.extend(sorted(processes(workers))[:n_stopped])
            for pid in stopped:
                os.kill(pid, signal.SIGSTOP)
        walks.append(None)

    def look(future, seconds):
        hurries = stopped and {*stopped} & processes(workers)
        return is_done(future, seconds / 1000 if hurries else seconds)

    walks, stopped = [], []
    evolution = wl.Evolution(SETTINGS, on_walks=walked)
    monkeypatch.setattr(waiting, "is_done", look)
    monkeypatch.setattr(waiting, "renewed", lambda executor, silence: renewed(executor, silence / 200))
    with pytest.warns(WorkerLostWarning, match="they gave no answer any more"):
        for _ in evolution:
            pass
    pd.testing.assert_frame_equal(evolution.run.records, undisturbed, check_exact=True)
    assert stopped
    assert not {*stopped} & processes(workers)


@pytest.fixture
def ticks(monkeypatch):
    """Each look at whether anything has come back, which take a thousandth of their time."""
    looks = []

    def look(future, seconds):
        looks.append(seconds)
        return is_done(future, seconds / 1000)

    monkeypatch.setattr(waiting, "is_done", look)
    return looks


def test_a_thread_that_never_comes_back_ends_the_run_in_words_and_what_is_done_is_kept(monkeypatch, tmp_path):
    def walk(*given, walk=evaluation._walk_all):
        if path.exists() and wl.load(path).n_generations:
            assert let_go.wait(60)
        return walk(*given)

    let_go, path = threading.Event(), tmp_path / "run.walk"
    monkeypatch.setattr(evaluation, "_walk_all", walk)
    monkeypatch.setattr(waiting, "START_UP", 3)
    monkeypatch.setenv("WALKERLAB_PATIENCE", "3")
    with ThreadPoolExecutor(2) as threads:
        with pytest.raises(WorkersLostError, match=r"no answer for \d+ s: .* Mend: another executor") as told:
            wl.evolve(SETTINGS, path, threads, progress=False)
        let_go.set()
    assert str(path) in "".join(told.value.__notes__)
    assert wl.load(path).n_generations == 1


def test_a_live_run_that_is_paused_for_longer_than_the_limit_goes_on(ticks, monkeypatch):
    monkeypatch.setenv("WALKERLAB_PATIENCE", "1000")
    over, settings = threading.Event(), SETTINGS.with_(population_size=200, generations=1, duration=1)
    with ThreadPoolExecutor(1) as threads:
        live = LiveRun(settings, executor=threads, on_news=lambda live: live.is_over and over.set())
        live.go_on()
        until(lambda: live.n_done)
        live.pause()
        enough = len(ticks) + 1200
        until(lambda: len(ticks) > enough)
        live.go_on()
        assert over.wait(60)
        assert live.state == State.finished


def until(holds):
    deadline = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.001)


class Busy(Executor):
    """Has begun nothing yet."""

    def submit(self, fn, /, *args, **kwargs):
        return Future()


class Cluster(Busy):
    """Says that everything is being done, as Dask's, whose workers may be still to come."""

    _client = SimpleNamespace(status="running", nthreads=dict)

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        future.set_running_or_notify_cancel()
        return future


@pytest.mark.parametrize("executor", [Busy(), Cluster()])
def test_who_waits_for_others_is_not_said_to_hang(executor, ticks):
    future = executor.submit(abs, -1)
    answers = waiting.in_turn([future], executor, limit=20)
    answerer = threading.Thread(target=lambda: (until(lambda: len(ticks) > 100), future.set_result(1)), daemon=True)
    answerer.start()
    assert list(answers) == [1]
    answerer.join()


def test_of_two_who_wait_the_more_patient_one_counts(ticks):
    hanging, *both = Future(), Future(), Future()
    hanging.set_running_or_notify_cancel()
    both[0].set_running_or_notify_cancel()
    both[0].set_result(1)
    patient = waiting.in_turn(both, Busy(), limit=100)
    assert next(patient) == 1, "it has begun"
    with pytest.raises(WorkersLostError, match="100 s"):
        next(waiting.in_turn([hanging], Busy(), limit=10))
    patient.close()
    with pytest.raises(WorkersLostError, match="10 s"):
        next(waiting.in_turn([hanging], Busy(), limit=10))


def test_a_task_of_a_heavy_world_is_of_one_robot_and_one_of_a_usual_world_of_many(monkeypatch):
    sent = []

    class Executed(ThreadPoolExecutor):
        def submit(self, fn, /, robots, world, asked):
            sent.append(len(robots))
            future = Future()
            future.set_exception(ZeroDivisionError())
            return future

    genomes = 200 * [wl.generate_robot_gene(wl.Robot(), rng=np.random.default_rng(0))]
    for settings, most in ((wl.Settings(), 16), (wl.Settings().with_(duration=120, timestep=0.0005, n_starts=20), 1)):
        with Executed(1) as executor, pytest.raises(ZeroDivisionError):
            wl.evaluate(genomes, settings, executor)
        assert max(sent) == most
        sent.clear()


# ------------------------------------------------------------------------------------------------- out of memory


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the memory of one process")
@pytest.mark.parametrize("spare", number([0], [0, 1, 2, 4, 8, 12, 16, 20, 24, 28, 32]))
def test_a_worker_without_memory_ends_the_run_in_words(spare, workers, monkeypatch):  # noqa: F811
    monkeypatch.setattr(evaluation, "_walk_all", Starved(spare))
    settings = SETTINGS.with_(texture_size=0.06, texture_density=0.05)
    with pytest.raises(WorkersLostError, match="Mend: close other programs") as told:
        wl.evaluate(wl.generate_robot_population(settings.robot, 4, seed=0), settings)
    assert told.value.__cause__ or "3 times in a row" in str(told.value)


class Starved:
    """Lets robots walk in a process that has only some MiB left."""

    def __init__(self, spare):
        self.spare, self.walk = spare, evaluation._walk_all

    def __call__(self, *given):
        import resource
        from pathlib import Path

        has = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        limits = resource.getrlimit(resource.RLIMIT_AS)
        resource.setrlimit(resource.RLIMIT_AS, (has + self.spare * 2**20, limits[1]))
        try:
            return self.walk(*given)
        finally:
            resource.setrlimit(resource.RLIMIT_AS, limits)


# ---------------------------------------------------------------------------------------------- the command line


@pytest.fixture
def evolving(tmp_path, monkeypatch):
    """Runs ``walkerlab evolve``, in which something happens when two generations are done."""

    threads = ThreadPoolExecutor(1)

    def evolve(happens):
        monkeypatch.setattr("walkerlab.outputs.write", lambda *_: None)
        monkeypatch.setattr("walkerlab.evolution.evaluate", lambda *given, **more: (
            happens() if (tmp_path / "run.walk").exists() and wl.load(tmp_path).n_generations == 2 else None,
            evaluation.evaluate(*given, **{**more, "executor": threads}),
        )[1])  # fmt: skip
        flags = ["--population-size", "4", "--n-elites", "0", "--generations", "4", "--duration", "1"]
        return main(["evolve", "--out", str(tmp_path), "--quiet", *flags])

    yield evolve
    threads.shutdown()


def test_the_command_line_tells_of_workers_that_were_replaced(evolving, capsys):
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        assert evolving(lambda: warnings.warn(WorkerLostWarning("one was killed (SIGKILL)"), stacklevel=1)) == 0
    said = capsys.readouterr().err
    assert said.startswith("\nNote: The worker processes had to be replaced: one was killed (SIGKILL).")
    assert ".py" not in said


def test_the_command_line_tells_of_workers_that_are_lost_and_how_to_go_on(evolving, tmp_path, capsys):
    def lose():
        raise WorkersLostError("nobody answers")

    assert evolving(lose) == 1
    said = capsys.readouterr().err
    assert "nobody answers\nStopped after 2 of 4 generations; all of these are kept." in said
    assert f"walkerlab resume {tmp_path}" in said
