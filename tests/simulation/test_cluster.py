"""On a Dask cluster a run is the run that it is at home, also when workers die, come and go."""

import importlib.util
import os
import signal
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import pandas as pd
import pytest

import walkerlab as wl
from tests.conftest import lacking
from walkerlab.breeding import generate_robot_population
from walkerlab.evolution.forecast import n_walks
from walkerlab.evolution.live import LiveRun, State
from walkerlab.simulation.workers import n_cores, n_workers
from walkerlab.system.interrupts import interrupts_held

SMALL = wl.Settings().with_(population_size=24, generations=3, duration=2)
PATIENCE = 60  # s

not_on_windows = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")


@contextmanager
def started(how_many, threads_per_worker=1):
    """Yield the client of a cluster on this computer; at the end, no process of it is left, and no thread at work."""
    if not importlib.util.find_spec("distributed"):
        lacking("distributed")
    from distributed import Client, LocalCluster

    before = at_work()
    here = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0"}
    with interrupts_held():
        cluster = LocalCluster(n_workers=how_many, threads_per_worker=threads_per_worker, **here)
    with cluster, Client(cluster) as client:
        yield client
        workers = pids(client)
    until(lambda: not any(map(exists, workers)))
    until(lambda: at_work() <= before)


@pytest.fixture(scope="module")
def shared():
    with started(2) as client:
        yield client


@pytest.fixture
def client(shared):
    """The client of two workers that have nothing to do."""
    shared.wait_for_workers(2, PATIENCE)
    yield shared
    until(lambda: is_idle(shared))


@pytest.fixture(scope="module")
def at_home():
    with ThreadPoolExecutor(2) as pool:
        return wl.evolve(SMALL, executor=pool, progress=False).records


def until(holds, within=PATIENCE):
    deadline = time.monotonic() + within
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def at_work():
    """Dask's threads, and those of live runs; but for the one that Dask keeps for good."""
    return {thread for thread in threading.enumerate() if thread.name.startswith(("IO loop", "Async", "walkerlab run"))}


def pids(client):
    """The process of each worker."""
    return list(client.run(os.getpid).values())


def exists(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def n_tasks(dask_scheduler):
    return len(dask_scheduler.tasks)


def is_idle(client):
    """Whether nothing walks, and nothing waits to."""
    return not client.run_on_scheduler(n_tasks) and not any(client.processing().values())


def test_it_gives_the_table_of_threads_and_of_loky(client, at_home):
    told = []
    evolution = wl.Evolution(SMALL, executor=client.get_executor(), on_walks=told.append)
    for _ in evolution:
        pass
    pd.testing.assert_frame_equal(evolution.run.records, at_home, check_exact=True)
    pd.testing.assert_frame_equal(wl.evolve(SMALL, progress=False).records, at_home, check_exact=True)
    assert sum(told) == n_walks(SMALL)


@not_on_windows
def test_a_worker_killed_in_the_middle_of_a_generation_loses_and_changes_nothing(client, at_home):
    told, killed = [], {}

    def walked(n):
        told.append(n)
        if evolution.n_generations == 1 and not killed:
            address, pid = next(iter(client.run(os.getpid).items()))
            os.kill(pid, signal.SIGSTOP)  # so that it cannot finish before it is killed
            killed.update(pid=pid, walking=client.processing()[address])
            os.kill(pid, signal.SIGKILL)

    evolution = wl.Evolution(SMALL, executor=client.get_executor(), on_walks=walked)
    for generation in evolution:
        if generation.number == 1:
            client.wait_for_workers(2, PATIENCE)
    assert killed["walking"]
    pd.testing.assert_frame_equal(evolution.run.records, at_home, check_exact=True)
    assert sum(told) == n_walks(SMALL)
    assert killed["pid"] not in pids(client)


@not_on_windows
def test_ctrl_c_keeps_what_is_done_clears_the_cluster_and_the_run_goes_on_there(client, at_home, tmp_path):
    workers = pids(client)

    def interrupting(rollout):
        if "interrupted" not in done and os.path.exists(path) and wl.load(path).n_generations == 2:
            done.append("interrupted")
            for pid in workers:  # a terminal and a notebook send it to every process
                os.kill(pid, signal.SIGINT)
            signal.raise_signal(signal.SIGINT)
        return wl.fitness.distance(rollout)

    done, path = [], tmp_path / "run.walk"
    settings = SMALL.with_(fitness=interrupting)
    stopped = wl.evolve(settings, path, client.get_executor(), progress=False).records
    until(lambda: is_idle(client))
    assert done
    assert stopped.generation.max() == 1
    assert pids(client) == workers
    run = wl.resume(path, executor=client.get_executor(), progress=False, fitness=interrupting)
    pd.testing.assert_frame_equal(run.records, at_home, check_exact=True)


def test_an_interruption_takes_back_what_waits(client):
    def interrupt(n):
        raise KeyboardInterrupt

    settings = wl.Settings().with_(duration=20)
    robots = generate_robot_population(settings.robot, 1000, seed=0)  # who would walk for a minute
    with pytest.raises(KeyboardInterrupt):
        wl.evaluate(robots, settings, client.get_executor(), on_done=interrupt)
    until(lambda: is_idle(client), within=10)


@pytest.fixture
def live(client):
    """A run on the cluster that goes on by itself, and has more to do than a test has time for."""
    long = SMALL.with_(population_size=400, n_elites=0, generations=50)
    live = LiveRun(long, executor=client.get_executor())
    yield live
    live.close()
    assert not live._thread.is_alive()
    until(lambda: is_idle(client))
    assert client.get_executor().submit(abs, -1).result() == 1


def test_a_live_run_pauses_and_goes_on(live, client):
    live.resume()
    until(lambda: live.n_done > 0)
    live.pause()
    until(lambda: is_idle(client))
    assert live.n_generations == 0
    before = live.n_done
    live.resume()
    until(lambda: live.n_done > before)
    assert live.state == State.running


def test_a_live_run_stops_at_once(live):
    live.resume()
    until(lambda: live.n_done > 0)
    live.stop()
    live._thread.join(1)
    assert not live._thread.is_alive()


def test_functions_of_a_notebook_cell_stay_at_home(client):
    cell = {"lock": threading.Lock()}  # which can't be sent anywhere
    exec(
        "def slow(rollout):\n"
        "    with lock:\n"
        "        return -float(rollout.com[-1, 0])\n"
        "def nudge(genomes, genes, *, rng):\n"
        "    with lock:\n"
        "        return genomes + 0.01 * (genes.high - genes.low) * rng.uniform(-1, 1, genomes.shape)\n",
        cell,
    )
    settings = SMALL.with_(fitness=cell["slow"], mutation=cell["nudge"])
    with ThreadPoolExecutor(2) as pool:
        tables = [wl.evolve(settings, executor=it, progress=False).records for it in (pool, client.get_executor())]
    pd.testing.assert_frame_equal(*tables, check_exact=True)


def test_two_runs_of_the_same_settings_share_a_cluster_and_one_is_stopped(client, at_home):
    def impatient(n):
        raise InterruptedError

    executor = client.get_executor()
    with ThreadPoolExecutor(1) as beside:
        other = beside.submit(wl.evolve, SMALL, executor=executor, progress=False)
        while not other.done():
            with pytest.raises(InterruptedError):
                next(iter(wl.Evolution(SMALL, executor=executor, on_walks=impatient)))
    pd.testing.assert_frame_equal(other.result().records, at_home, check_exact=True)


def test_workers_with_threads_come_and_go_while_robots_walk(at_home):
    with started(1, threads_per_worker=3) as client:
        evolution = wl.Evolution(SMALL, executor=client.get_executor(), on_walks=lambda _: walked())
        numbers = {1: 2, 2: 1}

        def walked():
            if n := numbers.pop(evolution.n_generations, 0):
                client.cluster.scale(n)

        for _ in evolution:
            pass
        assert not numbers
        pd.testing.assert_frame_equal(evolution.run.records, at_home, check_exact=True)


def test_workers_that_come_later_are_given_work():
    with started(0) as client:
        executor = client.get_executor()
        assert n_workers(executor) == n_cores(), "a job that waits for its turn"
        live = LiveRun(SMALL, executor=executor)
        client.cluster.scale(1)
        client.wait_for_workers(1)
        live.resume()
        until(lambda: live.is_over)
        assert live.state == State.finished
        assert live._pausable._n_workers == n_workers(executor) == 1


def test_a_client_that_is_closed_is_told_in_words(client):
    own = type(client)(client.cluster)
    executor = own.get_executor()
    live = LiveRun(SMALL.with_(generations=100), executor=executor)
    live.resume()
    until(lambda: live.n_done > 0)
    own.close()
    until(lambda: live.is_over)
    assert live.state == State.failed
    assert "closed" in str(live.error)
    with pytest.raises(RuntimeError, match="client is closed; make another"):
        wl.evolve(SMALL, executor=executor, progress=False)
