"""A function that does not return is stopped after its time limit; any other behaves as if called directly."""

import contextvars
import signal
import sys
import threading
import traceback

import numpy as np
import pytest

from walkerlab.system.time_limit import THREAD_NAME, TimeLimitExceeded, call_with_limit, effective_limit


def loop_forever():
    n = 0
    while True:
        n += 1


def running_threads():
    """Return the threads of user functions that still run, after a moment in which they can end."""
    threads = [thread for thread in threading.enumerate() if thread.name == THREAD_NAME]
    for thread in threads:
        thread.join(0.5)
    return [thread for thread in threads if thread.is_alive()]


def test_results_and_exceptions_are_passed_on_with_their_traceback():
    assert call_with_limit(lambda: 7, 60) == 7

    def fail():
        raise TimeoutError("raised by the function")

    with pytest.raises(TimeoutError, match="raised by the function") as caught:
        call_with_limit(fail, 60)
    assert caught.traceback[-1].name == "fail"
    for exit_exception in (KeyboardInterrupt, SystemExit):
        with pytest.raises(exit_exception):
            call_with_limit(lambda error=exit_exception: (_ for _ in ()).throw(error), 60)
    assert not running_threads()


def test_a_function_over_the_limit_is_stopped_and_the_traceback_shows_where():
    with pytest.raises(TimeLimitExceeded, match=r"after 0\.05 s") as caught:
        call_with_limit(loop_forever, 0.05)
    frame, line = list(traceback.walk_tb(caught.value.__traceback__))[-1]
    assert frame.f_code is loop_forever.__code__
    assert 2 <= line - loop_forever.__code__.co_firstlineno <= 3
    assert caught.value.is_stopped
    assert not running_threads()


def test_a_function_blocked_in_c_code_is_reported_as_not_stopped():
    event = threading.Event()
    with pytest.raises(TimeLimitExceeded) as caught:
        call_with_limit(event.wait, 0.05)
    assert not caught.value.is_stopped
    [thread] = running_threads()
    event.set()
    thread.join()


def test_ctrl_c_stops_the_function():
    def press_ctrl_c():
        signal.raise_signal(signal.SIGINT)
        loop_forever()

    with pytest.raises(KeyboardInterrupt):
        call_with_limit(press_ctrl_c, 60)
    assert not running_threads()


def test_the_limit_holds_outside_the_main_thread_too():
    caught = []

    def call():
        try:
            call_with_limit(loop_forever, 0.05)
        except TimeLimitExceeded as error:
            caught.append(error)

    thread = threading.Thread(target=call)
    thread.start()
    thread.join()
    assert [error.is_stopped for error in caught] == [True]


def test_the_function_sees_the_context_of_its_caller():
    colour = contextvars.ContextVar("colour")
    colour.set("red")
    assert call_with_limit(colour.get, 60) == "red"
    with np.errstate(divide="raise"), pytest.raises(FloatingPointError):
        call_with_limit(lambda: np.ones(1) / 0, 60)


def test_there_is_no_limit_in_a_debugger():
    event = threading.Event()

    def wait_at_a_breakpoint():
        sys._getframe().f_trace = lambda *_: None
        return event.wait(0.5) or "returned"

    assert call_with_limit(wait_at_a_breakpoint, 0.05) == "returned"
    before = sys.gettrace()
    sys.settrace(lambda *_: None)
    try:
        assert call_with_limit(threading.current_thread, 60) is threading.current_thread()
    finally:
        sys.settrace(before)


@pytest.mark.parametrize(("value", "seconds"), [(None, 60), ("", 60), ("600", 600), ("0.2", 0.2)])
def test_the_environment_variable_overrides_the_limit(value, seconds, monkeypatch):
    monkeypatch.delenv("WALKERLAB_PATIENCE", raising=False)
    if value is not None:
        monkeypatch.setenv("WALKERLAB_PATIENCE", value)
    assert effective_limit(60) == seconds


@pytest.mark.parametrize("value", ["ten", "0", "-1", "nan"])
def test_an_environment_variable_that_is_not_a_positive_number_is_rejected(value, monkeypatch):
    monkeypatch.setenv("WALKERLAB_PATIENCE", value)
    with pytest.raises(ValueError, match=f"WALKERLAB_PATIENCE is '{value}'; it must be a number of seconds above 0"):
        effective_limit(60)
