"""A run on a Dask cluster equals a local run, also when workers are killed, join or leave."""

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
from tests.conftest import skip_without
from walkerlab.evolution.forecast import n_walks
from walkerlab.evolution.live import LiveRun, State
from walkerlab.genome.breeding import generate_robot_population
from walkerlab.simulation.workers import n_cores, n_workers
from walkerlab.system.interrupts import interrupts_held

SMALL = wl.Settings().with_(population_size=24, generations=3, duration=2)
TIMEOUT = 60  # s

not_on_windows = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")


@contextmanager
def started_cluster(n_processes, threads_per_worker=1):
    """Yield the client of a local cluster; at the end, check that all its processes and threads have ended."""
    if not importlib.util.find_spec("distributed"):
        skip_without("distributed")
    from distributed import Client, LocalCluster

    before = busy_threads()
    here = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0"}
    with interrupts_held():
        cluster = LocalCluster(n_workers=n_processes, threads_per_worker=threads_per_worker, **here)
    with cluster, Client(cluster) as client:
        yield client
        workers = pids(client)
    wait_until(lambda: not any(map(is_running, workers)))
    wait_until(lambda: busy_threads() <= before)


@pytest.fixture(scope="module")
def shared():
    with started_cluster(2) as client:
        yield client


@pytest.fixture
def client(shared):
    """Yield the client of two idle workers."""
    shared.wait_for_workers(2, TIMEOUT)
    yield shared
    wait_until(lambda: is_idle(shared))


@pytest.fixture(scope="module")
def local_records():
    with ThreadPoolExecutor(2) as pool:
        return wl.evolve(SMALL, executor=pool, progress=False).records


def wait_until(holds, within=TIMEOUT):
    deadline = time.monotonic() + within
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def busy_threads():
    """Return the threads of Dask and of live runs, except the one that Dask never ends."""
    return {thread for thread in threading.enumerate() if thread.name.startswith(("IO loop", "Async", "walkerlab run"))}


def pids(client):
    """Return the process id of each worker."""
    return list(client.run(os.getpid).values())


def is_running(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def n_tasks(dask_scheduler):
    return len(dask_scheduler.tasks)


def is_idle(client):
    """Return whether no task is running or waiting."""
    return not client.run_on_scheduler(n_tasks) and not any(client.processing().values())


def test_the_table_equals_that_of_threads_and_of_loky(client, local_records):
    n_walked = []
    evolution = wl.Evolution(SMALL, executor=client.get_executor(), on_walks=n_walked.append)
    for _ in evolution:
        pass
    pd.testing.assert_frame_equal(evolution.run.records, local_records, check_exact=True)
    pd.testing.assert_frame_equal(wl.evolve(SMALL, progress=False).records, local_records, check_exact=True)
    assert sum(n_walked) == n_walks(SMALL)


@not_on_windows
def test_killing_a_worker_during_a_generation_does_not_change_the_table(client, local_records):
    n_walked = []
    killed = {}

    def walked(n):
        n_walked.append(n)
        if evolution.n_generations == 1 and not killed:
            address, pid = next(iter(client.run(os.getpid).items()))
            os.kill(pid, signal.SIGSTOP)  # so that it cannot finish before it is killed
            killed.update(pid=pid, walking=client.processing()[address])
            os.kill(pid, signal.SIGKILL)

    evolution = wl.Evolution(SMALL, executor=client.get_executor(), on_walks=walked)
    for generation in evolution:
        if generation.number == 1:
            client.wait_for_workers(2, TIMEOUT)
    assert killed["walking"]
    pd.testing.assert_frame_equal(evolution.run.records, local_records, check_exact=True)
    assert sum(n_walked) == n_walks(SMALL)
    assert killed["pid"] not in pids(client)


@not_on_windows
def test_ctrl_c_saves_generations_cancels_tasks_and_the_run_can_be_resumed(client, local_records, tmp_path):
    workers = pids(client)

    def interrupting(rollout):
        if "interrupted" not in done and os.path.exists(path) and wl.load(path).n_generations == 2:
            done.append("interrupted")
            for pid in workers:  # a terminal and a notebook send it to every process
                os.kill(pid, signal.SIGINT)
            signal.raise_signal(signal.SIGINT)
        return wl.fitness.distance(rollout)

    done = []
    path = tmp_path / "run.walk"
    settings = SMALL.with_(fitness=interrupting)
    stopped = wl.evolve(settings, path, client.get_executor(), progress=False).records
    wait_until(lambda: is_idle(client))
    assert done
    assert stopped.generation.max() == 1
    assert pids(client) == workers
    run = wl.resume(path, executor=client.get_executor(), progress=False, fitness=interrupting)
    pd.testing.assert_frame_equal(run.records, local_records, check_exact=True)


def test_an_interruption_cancels_waiting_tasks(client):
    def interrupt(n):
        raise KeyboardInterrupt

    settings = wl.Settings().with_(duration=20)
    robots = generate_robot_population(settings.robot, 1000, seed=0)  # a minute of walks
    with pytest.raises(KeyboardInterrupt):
        wl.evaluate(robots, settings, client.get_executor(), on_done=interrupt)
    wait_until(lambda: is_idle(client), within=10)


@pytest.fixture
def live(client):
    """Yield a live run on the cluster that is longer than any test."""
    long = SMALL.with_(population_size=400, n_elites=0, generations=50)
    live = LiveRun(long, executor=client.get_executor())
    yield live
    live.close()
    assert not live._thread.is_alive()
    wait_until(lambda: is_idle(client))
    assert client.get_executor().submit(abs, -1).result() == 1


def test_a_live_run_pauses_and_resumes(live, client):
    live.resume()
    wait_until(lambda: live.n_done > 0)
    live.pause()
    wait_until(lambda: is_idle(client))
    assert live.n_generations == 0
    before = live.n_done
    live.resume()
    wait_until(lambda: live.n_done > before)
    assert live.state == State.running


def test_a_live_run_stops_at_once(live):
    live.resume()
    wait_until(lambda: live.n_done > 0)
    live.stop()
    live._thread.join(1)
    assert not live._thread.is_alive()


def test_functions_of_a_notebook_cell_are_not_sent_to_workers(client):
    cell = {"lock": threading.Lock()}  # cannot be pickled
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
        tables = [
            wl.evolve(settings, executor=executor, progress=False).records for executor in (pool, client.get_executor())
        ]
    pd.testing.assert_frame_equal(*tables, check_exact=True)


def test_stopping_one_of_two_equal_runs_on_a_cluster_does_not_affect_the_other(client, local_records):
    def interrupt(n):
        raise InterruptedError

    executor = client.get_executor()
    with ThreadPoolExecutor(1) as thread:
        other = thread.submit(wl.evolve, SMALL, executor=executor, progress=False)
        while not other.done():
            with pytest.raises(InterruptedError):
                next(iter(wl.Evolution(SMALL, executor=executor, on_walks=interrupt)))
    pd.testing.assert_frame_equal(other.result().records, local_records, check_exact=True)


def test_workers_may_join_and_leave_during_a_run(local_records):
    with started_cluster(1, threads_per_worker=3) as client:
        evolution = wl.Evolution(SMALL, executor=client.get_executor(), on_walks=lambda _: walked())
        numbers = {1: 2, 2: 1}

        def walked():
            if n := numbers.pop(evolution.n_generations, 0):
                client.cluster.scale(n)

        for _ in evolution:
            pass
        assert not numbers
        pd.testing.assert_frame_equal(evolution.run.records, local_records, check_exact=True)


def test_workers_that_join_later_get_tasks():
    with started_cluster(0) as client:
        executor = client.get_executor()
        assert n_workers(executor) == n_cores(), "no worker has joined yet"
        live = LiveRun(SMALL, executor=executor)
        client.cluster.scale(1)
        client.wait_for_workers(1)
        live.resume()
        wait_until(lambda: live.is_over)
        assert live.state == State.finished
        assert live._pausable._n_workers == n_workers(executor) == 1


def test_a_closed_client_is_reported(client):
    closed = type(client)(client.cluster)
    executor = closed.get_executor()
    live = LiveRun(SMALL.with_(generations=100), executor=executor)
    live.resume()
    wait_until(lambda: live.n_done > 0)
    closed.close()
    wait_until(lambda: live.is_over)
    assert live.state == State.failed
    assert "closed" in str(live.error)
    with pytest.raises(RuntimeError, match="client is closed; make another"):
        wl.evolve(SMALL, executor=executor, progress=False)
