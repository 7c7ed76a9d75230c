"""Time limit for user functions: each call runs in a thread, which is stopped when the limit is exceeded."""

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

LIMIT_VARIABLE = "WALKERLAB_PATIENCE"
POLL_INTERVAL = 0.1  # s; on Windows, Ctrl-C is not handled during a wait
MAX_STOP_ATTEMPTS = 5  # one per poll interval
THREAD_NAME = "walkerlab user function"

Result = TypeVar("Result")


class TimeLimitExceeded(Exception):
    """A function has not returned within its time limit; the traceback ends at the line that it was executing.

    Attributes:
        seconds: Time limit [s].
        is_stopped: Whether the function could be stopped.
    """

    def __init__(self, seconds: float, is_stopped: bool) -> None:
        super().__init__(f"the function had not returned after {seconds:g} s")
        self.seconds = seconds
        self.is_stopped = is_stopped


def effective_limit(seconds: float) -> float:
    """Return the time limit [s] from the environment variable WALKERLAB_PATIENCE, or the given one if it is not set.

    Raises:
        ValueError: If the variable is not a number above 0.
    """
    text = os.environ.get(LIMIT_VARIABLE, "")
    try:
        limit = float(text or seconds)
    except ValueError:
        limit = 0.0
    if not limit > 0:
        raise ValueError(
            f"the environment variable {LIMIT_VARIABLE} is {text!r}; it must be a number of seconds above 0, such as "
            "'600'. It is the time for which walkerlab waits for an answer."
        )
    return limit


def call_with_limit(function: Callable[[], Result], seconds: float) -> Result:
    """Call a function in a new thread and stop it when the time limit is exceeded; Ctrl-C stops it at any time.

    Exceptions of the function are raised unchanged, with their traceback. The thread costs 0.1 to 0.2 ms per call. In
    a debugger, there is no limit. C code that holds the global interpreter lock, such as a regular expression with
    catastrophic backtracking, cannot be stopped: it blocks all of Python, including this function, until the process is
    killed. The generations that a run has saved stay complete.

    Args:
        function: Function without arguments.
        seconds: Time limit [s], with a resolution of 0.1 s.

    Raises:
        TimeLimitExceeded: If the function has not returned within the limit; it was stopped if possible.
    """
    if sys.gettrace():  # a debugger, whose breakpoints work in this thread only
        return function()
    thread = _CallThread(contextvars.copy_context(), function)
    deadline = time.monotonic() + seconds
    position: TracebackType | None = None
    try:
        thread.start()
        while not thread.done.wait(POLL_INTERVAL):
            if time.monotonic() > deadline and not any(frame.f_trace for frame, _ in thread.frames()):
                break
        is_done = thread.done.is_set()
        for frame, line in thread.frames():
            position = TracebackType(position, frame, frame.f_lasti, line)
    finally:
        is_stopped = thread.stop()
    if not is_done:
        raise TimeLimitExceeded(seconds, is_stopped).with_traceback(position)
    if thread.errors:
        raise thread.errors.pop()
    return thread.results.pop()


def raised_in_call(error: BaseException) -> bool:
    """Return whether an error was raised in the thread of ``call_with_limit``, which Ctrl-C never reaches."""
    return any(frame.f_code is _CallThread.run.__code__ for frame, _ in traceback.walk_tb(error.__traceback__))


class _CallThread(threading.Thread):
    """Thread that calls a function and stores its result or its exception.

    It is never joined: in Python 3.11, a thread whose join is interrupted by Ctrl-C is considered dead.

    Attributes:
        results: Result of the function; empty until it has returned.
        errors: Exception of the function; empty if it has not raised one.
        done: Whether the function has returned or raised.
    """

    def __init__(self, context: contextvars.Context, function: Callable[[], Any]) -> None:
        super().__init__(name=THREAD_NAME, daemon=True)
        self._context = context
        self._function = function
        self.results: list[Any] = []
        self.errors: list[BaseException] = []
        self.done = threading.Event()

    def run(self) -> None:
        """Call the function."""
        try:
            self.results.append(self._context.run(self._function))
        except BaseException as error:
            self.errors.append(error)
        finally:
            self.done.set()

    def frames(self) -> list[tuple[FrameType, int]]:
        """Return the frames and line numbers that the function is executing, the innermost first."""
        innermost = sys._current_frames().get(self.ident or 0)
        stack = traceback.walk_stack(innermost) if innermost else ()
        return list(takewhile(lambda entry: entry[0].f_code is not _CallThread.run.__code__, stack))

    def stop(self) -> bool:
        """Raise SystemExit in the thread, which ends it without a message, and return whether it has ended."""
        ident = ctypes.c_ulong(self.ident or 0)
        error = ctypes.py_object(SystemExit)
        for _ in range(MAX_STOP_ATTEMPTS):
            if self.done.is_set():
                break
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ident, error)
            self.done.wait(POLL_INTERVAL)
        return self.done.is_set()
