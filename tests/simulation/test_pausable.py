"""A pausable executor passes tasks on in order and few at a time, holds them back when paused, and can be stopped."""

import threading
import time
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor

import pytest

from walkerlab.simulation.pausable import PausableExecutor, Stopped


@pytest.fixture
def pool():
    with ThreadPoolExecutor(4) as workers:
        yield workers


@pytest.fixture(autouse=True)
def one_task_per_worker(monkeypatch):
    monkeypatch.setattr("walkerlab.simulation.pausable.TASKS_PER_WORKER", 1)


def pausable(create, n_workers):
    executor = PausableExecutor(create, lambda _: n_workers)
    executor._n_workers = n_workers
    return executor


def test_results_and_errors_are_passed_on(pool):
    executor = pausable(lambda: pool, 2)
    assert [executor.submit(pow, 2, n).result() for n in range(20)] == [2**n for n in range(20)]
    with pytest.raises(ZeroDivisionError):
        executor.submit(divmod, 1, 0).result()
    assert list(executor.map(abs, [-1, -2])) == [1, 2]


def test_no_more_tasks_run_at_once_than_there_are_workers(pool):
    n_running = 0
    most = 0
    lock = threading.Lock()

    def work():
        nonlocal n_running, most
        with lock:
            n_running += 1
            most = max(most, n_running)
        time.sleep(0.005)
        with lock:
            n_running -= 1

    executor = pausable(lambda: pool, 2)
    for future in [executor.submit(work) for _ in range(20)]:
        future.result()
    assert most == 2


def test_tasks_are_held_back_during_a_pause_and_run_in_order_afterwards(pool):
    executor = pausable(lambda: pool, 1)
    done = []
    executor.pause()
    futures = [executor.submit(done.append, n) for n in range(5)]
    assert not futures[0].done()
    assert not futures[0].running()
    executor.resume()
    for future in futures:
        future.result(5)
    assert done == [0, 1, 2, 3, 4]


def test_stop_fails_all_pending_tasks_at_once(pool):
    executor = pausable(lambda: pool, 1)
    hold = threading.Event()
    futures = [executor.submit(hold.wait), *(executor.submit(int) for _ in range(3))]
    executor.stop()
    for future in futures:
        with pytest.raises(Stopped):
            future.result(1)
    with pytest.raises(Stopped):
        executor.submit(int)
    hold.set()
    assert pool.submit(int).result() == 0, "the wrapped executor still works"


def test_a_task_cancelled_while_waiting_does_not_run(pool):
    executor = pausable(lambda: pool, 1)
    ran = []
    executor.pause()
    cancelled, other = executor.submit(ran.append, "no"), executor.submit(ran.append, "yes")
    assert cancelled.cancel()
    executor.resume()
    other.result(5)
    assert ran == ["yes"]


def test_an_error_on_creating_the_wrapped_executor_reaches_the_caller():
    def fail():
        raise RuntimeError("no workers")

    with pytest.raises(RuntimeError, match="no workers"):
        pausable(fail, 1).submit(int)


class Closed(Executor):
    """Rejects every task."""

    def submit(self, fn, /, *args, **kwargs):
        raise RuntimeError("closed")


class Cancelling(Executor):
    """Cancels every task."""

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        future.cancel()
        return future


@pytest.mark.parametrize(("wrapped", "error"), [(Closed(), RuntimeError), (Cancelling(), CancelledError)])
def test_a_task_that_the_wrapped_executor_rejects_or_cancels_fails(wrapped, error):
    future = pausable(lambda: wrapped, 1).submit(int)
    with pytest.raises(error):
        future.result(1)


def test_a_changed_number_of_workers_is_used_from_then_on(pool):
    numbers = iter((1, 3))
    executor = PausableExecutor(lambda: pool, lambda wrapped: next(numbers) if wrapped is pool else 0)
    assert [executor.n_workers(), executor.n_workers()] == [1, 3]
    executor.pause()
    started = threading.Semaphore(0)
    finish = threading.Event()
    futures = [executor.submit(lambda: (started.release(), finish.wait(5))) for _ in range(6)]
    executor.resume()
    assert all(started.acquire(timeout=5) for _ in range(3))
    assert not started.acquire(timeout=0.1)
    finish.set()
    for future in futures:
        future.result(5)


class Locked(Executor):
    """Completes futures under a lock that ``submit`` needs too, as a broken standard process pool does."""

    def __init__(self):
        self.lock = threading.Lock()
        self.futures = []

    def submit(self, fn, /, *args, **kwargs):
        with self.lock:
            self.futures.append(Future())
            return self.futures[-1]

    def fail_first(self):
        with self.lock:
            self.futures.pop(0).set_exception(ZeroDivisionError())


def test_an_executor_that_completes_futures_under_its_lock_does_not_deadlock():
    wrapped = Locked()
    executor = pausable(lambda: wrapped, 1)
    futures = [executor.submit(int) for _ in range(3)]
    for future in futures:
        thread = threading.Thread(target=wrapped.fail_first, daemon=True)
        thread.start()
        thread.join(5)
        assert not thread.is_alive()
        with pytest.raises(ZeroDivisionError):
            future.result(5)
        time.sleep(0.1)  # in which the next task is passed on


def test_each_worker_has_one_task_in_work_and_one_queued(pool, monkeypatch):
    monkeypatch.undo()
    executor = pausable(lambda: pool, 1)
    hold = threading.Event()
    futures = [executor.submit(hold.wait, 5) for _ in range(5)]
    assert len(executor._submitted) == 2
    hold.set()
    for future in futures:
        future.result(5)
