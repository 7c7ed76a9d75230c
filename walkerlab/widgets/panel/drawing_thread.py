"""A thread that draws a panel's pictures: the newest of each, with a limited load on the computer."""

import threading
import time
from collections.abc import Callable

MAX_LOAD = 1 / 20  # share of a core's time for drawing during a run, which uses the same cores
MIN_INTERVAL = 0.2  # s from the end of one drawing to the start of the next


class DrawingThread:
    """A thread that draws.

    Of several requests for one picture, only the newest is drawn. While the load is limited, the thread pauses after
    each picture so that drawing takes a small share of the time, however slow the computer is.
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
            self._changed.notify_all()

    def _run(self) -> None:
        while draw := self._next():
            before = time.thread_time()  # excludes waiting for a core
            try:
                draw()
            except Exception as error:
                self._on_error(error)
            work = time.thread_time() - before
            self._pause_until(time.monotonic() + max(MIN_INTERVAL, work * (1 / MAX_LOAD - 1)))

    def _next(self) -> Callable[[], None] | None:
        """Wait for a request and return its function; None after closing."""
        with self._changed:
            self._changed.wait_for(lambda: self._requests or not self._is_open)
            if not self._is_open:
                return None
            name = next((name for name in self._requests if name in self._urgent), next(iter(self._requests)))
            self._urgent.discard(name)
            return self._requests.pop(name)

    def _pause_until(self, end: float) -> None:
        with self._changed:
            while self._is_open and not self._urgent and self._is_limited() and (left := end - time.monotonic()) > 0:
                self._changed.wait(left)
