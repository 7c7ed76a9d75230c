"""Patience with a function of the user's own: it is called on a thread, waited for so long, and then stopped."""

import contextvars
import ctypes
import os
import sys
import threading
import time
import traceback
from collections.abc import Callable
from itertools import takewhile
from types import FrameType, TracebackType
from typing import Any, TypeVar

VARIABLE = "WALKERLAB_PATIENCE"
STEP = 0.1  # s of waiting at a time: on Windows no Ctrl-C comes through while one waits
TRIES = 5  # to stop a thread, a step each

Answer = TypeVar("Answer")


class Overdue(Exception):
    """A function has not returned in time; the traceback ends where it was.

    Attributes:
        seconds: for how long it was waited.
        is_stopped: whether it could be stopped.
    """

    def __init__(self, seconds: float, is_stopped: bool) -> None:
        super().__init__(f"it had not returned after {seconds:g} s")
        self.seconds, self.is_stopped = seconds, is_stopped


def patience(seconds: float) -> float:
    """Return how many s to wait for a call: so many, unless the environment variable WALKERLAB_PATIENCE says otherwise.

    Raises:
        ValueError: if that is no number above 0.
    """
    asked = os.environ.get(VARIABLE, "")
    try:
        seconds = float(asked or seconds)
    except ValueError:
        seconds = 0.0
    if not seconds > 0:
        raise ValueError(
            f"the environment variable {VARIABLE} is {asked!r}; it must be a number of seconds above 0, such as '600'. "
            "It is how long walkerlab waits for an answer."
        )
    return seconds


def in_time(call: Callable[[], Answer], seconds: float) -> Answer:
    """Call a function on a thread of its own, and wait for so long and no longer; Ctrl-C stops it at any time.

    What it raises comes back as it is, with its traceback. The thread costs 0.1 to 0.2 ms a call. Under a debugger,
    which has no hurry, there is no limit. One thing cannot be stopped: C code that keeps Python's lock to itself, as
    a regular expression that runs away; then all of Python stands still, this clock with it, and only the end of the
    process helps. What a run has in its file is whole then all the same.

    Args:
        call: takes nothing.
        seconds: to wait, to the tenth.

    Raises:
        Overdue: if it has not returned by then; it was stopped, if Python can.
    """
    if sys.gettrace():  # a debugger, whose breakpoints hold on this thread only
        return call()
    guest = _Guest(contextvars.copy_context(), call)
    deadline, where = time.monotonic() + seconds, None
    try:
        guest.start()
        while not guest.done.wait(STEP):
            if time.monotonic() > deadline and not any(frame.f_trace for frame, _ in guest.steps()):
                break
        is_done = guest.done.is_set()
        for frame, line in guest.steps():
            where = TracebackType(where, frame, frame.f_lasti, line)
    finally:
        is_stopped = guest.stop()
    if not is_done:
        raise Overdue(seconds, is_stopped).with_traceback(where)
    if guest.errors:
        raise guest.errors.pop()
    return guest.answers.pop()


def raised_in_call(error: BaseException) -> bool:
    """Say whether an error was raised by a function called by ``in_time``, on its thread, where no Ctrl-C arrives."""
    return any(frame.f_code is _Guest.run.__code__ for frame, _ in traceback.walk_tb(error.__traceback__))


class _Guest(threading.Thread):
    """Makes one call, and keeps what comes of it.

    Nobody joins it: a join that Ctrl-C ends leaves a thread of Python 3.11 that is taken for dead.
    """

    def __init__(self, context: contextvars.Context, call: Callable[[], Any]) -> None:
        super().__init__(name="walkerlab guest", daemon=True)
        self._context, self._call = context, call
        self.answers, self.errors, self.done = list[Any](), list[BaseException](), threading.Event()

    def run(self) -> None:
        """Make the call."""
        try:
            self.answers.append(self._context.run(self._call))
        except BaseException as error:
            self.errors.append(error)
        finally:
            self.done.set()

    def steps(self) -> list[tuple[FrameType, int]]:
        """Say where it is, the innermost first."""
        innermost = sys._current_frames().get(self.ident or 0)
        walk = traceback.walk_stack(innermost) if innermost else ()
        return list(takewhile(lambda step: step[0].f_code is not _Guest.run.__code__, walk))

    def stop(self) -> bool:
        """Raise SystemExit, of which threads die in silence, where it is, and say whether it has died of it."""
        ident, error = ctypes.c_ulong(self.ident or 0), ctypes.py_object(SystemExit)
        for _ in range(TRIES):
            if self.done.is_set():
                break
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ident, error)
            self.done.wait(STEP)
        return self.done.is_set()
