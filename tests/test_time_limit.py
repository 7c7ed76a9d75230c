"""A function that never returns is waited for so long, and then really ends; all others are as if called directly."""

import contextvars
import signal
import sys
import threading
import traceback

import numpy as np
import pytest

from walkerlab.time_limit import Overdue, in_time, patience


def spins():
    n = 0
    while True:
        n += 1


def guests():
    """Return the threads that go on: what is done is given a moment to be gone."""
    threads = [thread for thread in threading.enumerate() if thread.name == "walkerlab guest"]
    for thread in threads:
        thread.join(0.5)
    return [thread for thread in threads if thread.is_alive()]


def test_an_answer_comes_back_and_an_exception_with_the_line_where_it_was():
    assert in_time(lambda: 7, 60) == 7

    def fails():
        raise TimeoutError("my own")

    with pytest.raises(TimeoutError, match="my own") as caught:
        in_time(fails, 60)
    assert caught.traceback[-1].name == "fails"
    for leaving in (KeyboardInterrupt, SystemExit):
        with pytest.raises(leaving):
            in_time(lambda leaving=leaving: (_ for _ in ()).throw(leaving), 60)
    assert not guests()


def test_who_never_returns_is_shown_where_it_was_and_ends():
    with pytest.raises(Overdue, match=r"after 0\.05 s") as caught:
        in_time(spins, 0.05)
    frame, line = list(traceback.walk_tb(caught.value.__traceback__))[-1]
    assert frame.f_code is spins.__code__
    assert 2 <= line - spins.__code__.co_firstlineno <= 3
    assert caught.value.is_stopped
    assert not guests()


def test_of_who_sits_in_c_it_is_said_that_it_could_not_be_stopped():
    door = threading.Event()
    with pytest.raises(Overdue) as caught:
        in_time(door.wait, 0.05)
    assert not caught.value.is_stopped
    [guest] = guests()
    door.set()
    guest.join()


def test_ctrl_c_comes_through_and_ends_it():
    def presses():
        signal.raise_signal(signal.SIGINT)
        spins()

    with pytest.raises(KeyboardInterrupt):
        in_time(presses, 60)
    assert not guests()


def test_it_works_on_a_thread_as_well():
    caught = []

    def life():
        try:
            in_time(spins, 0.05)
        except Overdue as error:
            caught.append(error)

    thread = threading.Thread(target=life)
    thread.start()
    thread.join()
    assert [error.is_stopped for error in caught] == [True]


def test_what_holds_for_the_caller_holds_for_the_function():
    colour = contextvars.ContextVar("colour")
    colour.set("red")
    assert in_time(colour.get, 60) == "red"
    with np.errstate(divide="raise"), pytest.raises(FloatingPointError):
        in_time(lambda: np.ones(1) / 0, 60)


def test_a_debugger_has_no_hurry():
    door = threading.Event()

    def stopped_at_a_breakpoint():
        sys._getframe().f_trace = lambda *_: None
        return door.wait(0.5) or "at last"

    assert in_time(stopped_at_a_breakpoint, 0.05) == "at last"
    before = sys.gettrace()
    sys.settrace(lambda *_: None)
    try:
        assert in_time(threading.current_thread, 60) is threading.current_thread()
    finally:
        sys.settrace(before)


@pytest.mark.parametrize(("asked", "seconds"), [(None, 60), ("", 60), ("600", 600), ("0.2", 0.2)])
def test_patience_is_the_variables_if_it_is_set(asked, seconds, monkeypatch):
    monkeypatch.delenv("WALKERLAB_PATIENCE", raising=False)
    if asked is not None:
        monkeypatch.setenv("WALKERLAB_PATIENCE", asked)
    assert patience(60) == seconds


@pytest.mark.parametrize("asked", ["ten", "0", "-1", "nan"])
def test_patience_that_is_none_is_refused(asked, monkeypatch):
    monkeypatch.setenv("WALKERLAB_PATIENCE", asked)
    with pytest.raises(ValueError, match=f"WALKERLAB_PATIENCE is '{asked}'; it must be a number of seconds above 0"):
        patience(60)
