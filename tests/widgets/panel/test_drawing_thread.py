"""The drawing thread draws the newest request for each picture, and limits its share of the time."""

import threading
import time

import pytest

from walkerlab.widgets.panel.drawing_thread import MAX_LOAD, MIN_INTERVAL, DrawingThread


@pytest.fixture
def drawing():
    errors = []
    thread = DrawingThread(lambda: thread.is_limited, errors.append)
    thread.is_limited = False
    thread.errors = errors
    yield thread
    thread.close()


@pytest.fixture
def resume(drawing):
    """An event until which the thread is busy with a first picture."""
    begun = threading.Event()
    end = threading.Event()
    drawing.request("first", lambda: (begun.set(), end.wait(5)))
    assert begun.wait(5)
    return end


def test_of_several_requests_for_one_picture_the_newest_is_drawn(drawing, resume):
    done = threading.Event()
    drawn = []
    for n in range(5):
        drawing.request("curve", lambda n=n: drawn.append(n))
    drawing.request("last", done.set)
    resume.set()
    assert done.wait(5)
    assert drawn == [4]


def test_while_the_load_is_limited_it_pauses_longer_than_it_draws(drawing):
    drawing.is_limited = True
    done = threading.Event()
    times = []
    work = []

    def draw():
        work[:] = [time.thread_time()]
        times.append(time.monotonic())
        while time.monotonic() < times[-1] + 0.03 or time.thread_time() < work[0] + 0.03:
            pass
        if len(times) == 2:
            done.set()

    drawing.request("a", lambda: (draw(), drawing.request("a", draw)))
    assert done.wait(10)
    assert times[1] - times[0] > 0.03 / MAX_LOAD * 0.95


def test_while_the_load_is_limited_all_pictures_are_drawn_together_and_urgent_ones_first(drawing, resume):
    drawing.is_limited = True
    done = threading.Event()
    drawn = []
    for name in ("list", "population", "walker"):
        drawing.request(name, lambda name=name: drawn.append((name, time.monotonic())))
    drawing.request("world", lambda: drawn.append(("world", time.monotonic())), is_urgent=True)
    drawing.request("last", lambda: (drawn.append(("last", time.monotonic())), done.set()))
    resume.set()
    assert done.wait(5)
    names, times = zip(*drawn, strict=True)
    assert names == ("world", "list", "population", "walker", "last")
    assert times[-1] - times[1] < MIN_INTERVAL / 2


@pytest.mark.parametrize("waiting_time", [0.0, 0.2])
def test_the_pause_depends_on_work_and_not_on_waiting(drawing, waiting_time):
    drawing.is_limited = True
    done = threading.Event()
    begun = []
    ended = []

    def draw():
        begun.append(time.monotonic())
        threading.Event().wait(waiting_time)
        ended.append(time.monotonic())
        if len(ended) == 2:
            done.set()

    drawing.request("a", lambda: (draw(), drawing.request("a", draw)))
    assert done.wait(10)
    assert MIN_INTERVAL * 0.95 < begun[1] - ended[0] < 2


def test_a_pause_ends_when_the_load_is_no_longer_limited(drawing):
    drawing.is_limited = True
    drawn = threading.Event()
    done = threading.Event()
    drawing.request("long", lambda: (sum(range(10**7)), drawn.set()))
    assert drawn.wait(5)
    drawing.request("next", done.set)
    drawing.is_limited = False
    drawing.end_pause()
    assert done.wait(2)


def test_a_failed_drawing_is_reported_and_the_next_one_is_drawn(drawing):
    done = threading.Event()
    drawing.request("bad", lambda: 1 / 0)
    drawing.request("good", done.set)
    assert done.wait(5)
    assert [type(error) for error in drawing.errors] == [ZeroDivisionError]


def test_closing_ends_the_thread(drawing):
    done = threading.Event()
    drawing.request("one", done.set)
    assert done.wait(5)
    drawing.close()
    drawing._thread.join(5)
    assert not drawing._thread.is_alive()


def test_an_urgent_drawing_does_not_wait_for_the_end_of_a_pause(drawing):
    drawing.is_limited = True
    done = threading.Event()
    long = threading.Event()

    def work():
        end = time.thread_time() + 0.5  # s, followed by a pause of about 10 s
        while time.thread_time() < end:
            pass
        long.set()

    drawing.request("curve", work)
    assert long.wait(10)
    listed = threading.Event()
    drawing.request("list", listed.set)
    drawing.request("world", done.set, is_urgent=True)
    assert done.wait(3)
    assert not listed.is_set(), "other pictures wait for the end of the pause"
