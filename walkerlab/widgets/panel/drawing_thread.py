"""A thread that draws a panel's pictures: the newest of each, with a limited load on the computer."""

import threading
import time
from collections.abc import Callable

MAX_LOAD = 1 / 20  # share of a core's time for drawing during a run, which uses the same cores
MIN_INTERVAL = 0.2  # s from the end of one drawing to the start of the next


class DrawingThread:
    """A thread that draws.

    Of several requests for one picture, only the newest is drawn. All requested pictures are drawn together, so that
    they show the same state of a run. While the load is limited, the thread then pauses so that drawing takes a small
    share of the time, however slow the computer is.
    """

    def __init__(self, is_limited: Callable[[], bool], on_error: Callable[[Exception], None]) -> None:
        """Create the object; its thread starts with the first request.

        Args:
            is_limited: Function that returns whether to limit the load now.
            on_error: Called with the exception of a drawing that failed.
        """
        self._is_limited = is_limited
        self._on_error = on_error
        self._requests: dict[str, Callable[[], None]] = {}
        self._urgent: set[str] = set()
        self._changed = threading.Condition()
        self._is_open = True
        self._thread: threading.Thread | None = None

    def request(self, name: str, draw: Callable[[], None], *, is_urgent: bool = False) -> None:
        """Request a drawing; it replaces a request of the same name that has not started.

        Args:
            name: Name of the picture.
            draw: Function that draws it.
            is_urgent: Whether the picture is drawn before all others and without a pause, for an action of the user.
        """
        with self._changed:
            self._requests[name] = draw
            if is_urgent:
                self._urgent.add(name)
            if self._is_open and not self._thread:
                self._thread = threading.Thread(target=self._run, name="walkerlab drawing", daemon=True)
                self._thread.start()
            self._changed.notify_all()

    def end_pause(self) -> None:
        """Check whether the load is still to be limited, and end the current pause if not."""
        with self._changed:
            self._changed.notify_all()

    def close(self) -> None:
        """Discard all requests and end the thread."""
        with self._changed:
            self._is_open = False
            self._requests.clear()
            self._urgent.clear()
            self._changed.notify_all()

    def _run(self) -> None:
        pause_end = 0.0
        while (names := self._wait(pause_end)) is not None:
            before = time.thread_time()  # excludes waiting for a core
            is_batch = bool(names)
            while draw := self._next(names):
                try:
                    draw()
                except Exception as error:
                    self._on_error(error)
            if is_batch:
                work = time.thread_time() - before
                pause_end = time.monotonic() + max(MIN_INTERVAL, work * (1 / MAX_LOAD - 1))

    def _wait(self, pause_end: float) -> set[str] | None:
        """Wait for an urgent request, or for the end of a pause and any request.

        Returns:
            Names of all requested pictures; empty if only the urgent ones are due, and None after closing.
        """
        with self._changed:
            while self._is_open:
                left = pause_end - time.monotonic() if self._is_limited() else 0.0
                if self._requests and left <= 0:
                    return set(self._requests)
                if self._urgent:
                    return set()
                self._changed.wait(left if self._requests else None)
            return None

    def _next(self, names: set[str]) -> Callable[[], None] | None:
        """Return the function of an urgent request, or of one of some pictures, and remove it from both."""
        with self._changed:
            urgent = [name for name in self._requests if name in self._urgent]
            due = urgent or [name for name in self._requests if name in names]
            if not due:
                return None
            names.discard(due[0])
            self._urgent.discard(due[0])
            return self._requests.pop(due[0])
