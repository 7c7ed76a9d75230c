"""Work goes through the gate in its order and a little at a time; shut, it holds back, and stopped, it lets go."""

import threading
import time
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor

import pytest

from walkerlab.gate import Gate, Stopped


@pytest.fixture
def pool():
    with ThreadPoolExecutor(4) as workers:
        yield workers


@pytest.fixture(autouse=True)
def one_for_each_worker(monkeypatch):
    monkeypatch.setattr("walkerlab.gate.AT_ONCE", 1)


def gate_before(inside, n_workers):
    gate = Gate(inside, lambda _: n_workers)
    gate._n_workers = n_workers
    return gate


def test_answers_and_errors_come_through(pool):
    gate = gate_before(lambda: pool, 2)
    assert [gate.submit(pow, 2, n).result() for n in range(20)] == [2**n for n in range(20)]
    with pytest.raises(ZeroDivisionError):
        gate.submit(divmod, 1, 0).result()
    assert list(gate.map(abs, [-1, -2])) == [1, 2]


def test_no_more_are_inside_at_once_than_allowed(pool):
    inside, most, lock = 0, 0, threading.Lock()

    def work():
        nonlocal inside, most
        with lock:
            inside += 1
            most = max(most, inside)
        time.sleep(0.005)
        with lock:
            inside -= 1

    gate = gate_before(lambda: pool, 2)
    for future in [gate.submit(work) for _ in range(20)]:
        future.result()
    assert most == 2


def test_shut_it_holds_back_what_waits_and_opened_lets_it_in(pool):
    gate, done = gate_before(lambda: pool, 1), []
    gate.close()
    futures = [gate.submit(done.append, n) for n in range(5)]
    assert not futures[0].done()
    assert not futures[0].running()
    gate.open()
    for future in futures:
        future.result(5)
    assert done == [0, 1, 2, 3, 4]


def test_stopped_it_answers_all_that_wait_at_once(pool):
    gate, hold = gate_before(lambda: pool, 1), threading.Event()
    futures = [gate.submit(hold.wait), *(gate.submit(int) for _ in range(3))]
    gate.stop()
    for future in futures:
        with pytest.raises(Stopped):
            future.result(1)
    with pytest.raises(Stopped):
        gate.submit(int)
    hold.set()
    assert pool.submit(int).result() == 0, "the executor inside is somebody else's, and stays"


def test_what_is_given_up_before_its_turn_does_not_run(pool):
    gate, ran = gate_before(lambda: pool, 1), []
    gate.close()
    given_up, kept = gate.submit(ran.append, "no"), gate.submit(ran.append, "yes")
    assert given_up.cancel()
    gate.open()
    kept.result(5)
    assert ran == ["yes"]


def test_a_gate_to_nowhere_says_so():
    def nobody():
        raise RuntimeError("no workers")

    with pytest.raises(RuntimeError, match="no workers"):
        gate_before(nobody, 1).submit(int)


class Closed(Executor):
    """Takes no work."""

    def submit(self, fn, /, *args, **kwargs):
        raise RuntimeError("closed")


class Forgetful(Executor):
    """Gives up whatever it takes."""

    def submit(self, fn, /, *args, **kwargs):
        given_up = Future()
        given_up.cancel()
        return given_up


@pytest.mark.parametrize(("inside", "answer"), [(Closed(), RuntimeError), (Forgetful(), CancelledError)])
def test_what_the_executor_inside_does_not_do_is_answered(inside, answer):
    future = gate_before(lambda: inside, 1).submit(int)
    with pytest.raises(answer):
        future.result(1)


def test_it_asks_anew_how_many_work_inside(pool):
    numbers = iter((1, 3))
    gate = Gate(lambda: pool, lambda inside: next(numbers) if inside is pool else 0)
    assert [gate.n_workers(), gate.n_workers()] == [1, 3]
    gate.close()
    inside, open_up = threading.Semaphore(0), threading.Event()
    futures = [gate.submit(lambda: (inside.release(), open_up.wait(5))) for _ in range(6)]
    gate.open()
    assert all(inside.acquire(timeout=5) for _ in range(3))
    assert not inside.acquire(timeout=0.1)
    open_up.set()
    for future in futures:
        future.result(5)


class Locked(Executor):
    """Answers under a lock that it needs to take work too, as the standard library's process pool when it is broken."""

    def __init__(self):
        self.lock, self.taken = threading.Lock(), []

    def submit(self, fn, /, *args, **kwargs):
        with self.lock:
            self.taken.append(Future())
            return self.taken[-1]

    def answer(self):
        with self.lock:
            self.taken.pop(0).set_exception(ZeroDivisionError())


def test_an_executor_that_answers_under_its_lock_does_not_wait_for_itself():
    inside = Locked()
    gate = gate_before(lambda: inside, 1)
    futures = [gate.submit(int) for _ in range(3)]
    for future in futures:
        done = threading.Thread(target=inside.answer, daemon=True)
        done.start()
        done.join(5)
        assert not done.is_alive()
        with pytest.raises(ZeroDivisionError):
            future.result(5)
        time.sleep(0.1)  # in which the next is let in


def test_one_is_next_while_one_is_done(pool, monkeypatch):
    monkeypatch.undo()
    gate, hold = gate_before(lambda: pool, 1), threading.Event()
    futures = [gate.submit(hold.wait, 5) for _ in range(5)]
    assert len(gate._within) == 2
    hold.set()
    for future in futures:
        future.result(5)
