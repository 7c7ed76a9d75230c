"""At the desk the newest of each picture is drawn, and pictures take up a small share of the time."""

import threading
import time

import pytest

from walkerlab.widgets.drawing_thread import SHARE, SHORTEST, Desk


@pytest.fixture
def desk():
    faults = []
    made = Desk(lambda: made.sparing, faults.append)
    made.sparing, made.faults = False, faults
    yield made
    made.close()


def test_of_several_orders_for_one_picture_the_newest_is_drawn(desk):
    begun, go_on, drawn, done = threading.Event(), threading.Event(), [], threading.Event()
    desk.order("first", lambda: (begun.set(), go_on.wait(5)))
    assert begun.wait(5)
    for n in range(5):
        desk.order("curve", lambda n=n: drawn.append(n))
    desk.order("last", done.set)
    go_on.set()
    assert done.wait(5)
    assert drawn == [4]


def test_while_it_spares_the_computer_it_rests_longer_than_it_draws(desk):
    desk.sparing, times, work, done = True, [], [], threading.Event()

    def draw():
        work[:] = [time.thread_time()]
        times.append(time.monotonic())
        while time.monotonic() < times[-1] + 0.03 or time.thread_time() < work[0] + 0.03:
            pass
        if len(times) == 2:
            done.set()

    desk.order("a", draw)
    desk.order("b", draw)
    assert done.wait(10)
    assert times[1] - times[0] > 0.03 / SHARE * 0.95


@pytest.mark.parametrize("waits", [0.0, 0.2])
def test_it_rests_after_work_of_its_own_and_not_after_waiting(desk, waits):
    desk.sparing, begun, ended, done = True, [], [], threading.Event()

    def draw():
        begun.append(time.monotonic())
        threading.Event().wait(waits)
        ended.append(time.monotonic())
        if len(ended) == 2:
            done.set()

    desk.order("a", draw)
    desk.order("b", draw)
    assert done.wait(10)
    assert SHORTEST * 0.95 < begun[1] - ended[0] < 2


def test_in_a_hurry_it_ends_its_rest(desk):
    desk.sparing, drawn, done = True, threading.Event(), threading.Event()
    desk.order("long", lambda: (sum(range(10**7)), drawn.set()))
    assert drawn.wait(5)
    desk.order("next", done.set)
    desk.sparing = False
    desk.hurry()
    assert done.wait(2)


def test_a_drawing_that_fails_is_told_and_the_next_one_is_drawn(desk):
    done = threading.Event()
    desk.order("bad", lambda: 1 / 0)
    desk.order("good", done.set)
    assert done.wait(5)
    assert [type(fault) for fault in desk.faults] == [ZeroDivisionError]


def test_closed_its_thread_ends(desk):
    done = threading.Event()
    desk.order("one", done.set)
    assert done.wait(5)
    desk.close()
    desk._thread.join(5)
    assert not desk._thread.is_alive()
