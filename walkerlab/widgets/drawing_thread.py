"""The desk at which a panel's pictures are drawn: on one thread, the newest of each kind, and sparingly."""

import threading
import time
from collections.abc import Callable

SHARE = 1 / 20  # of a core's time that may go into pictures while robots walk, for they walk on the same cores
SHORTEST = 0.2  # s from one picture to the next


class Desk:
    """A thread that draws.

    Of several orders for one picture, only the newest is drawn. While the desk is *sparing*, it rests after each
    picture for so long that drawing takes up a small share of the time, however slow the computer is.
    """

    def __init__(self, is_sparing: Callable[[], bool], on_error: Callable[[Exception], None]) -> None:
        """Set it up; its thread starts with the first order.

        Args:
            is_sparing: whether to spare the computer now.
            on_error: told what went wrong in a drawing, which is left as it was.
        """
        self._is_sparing, self._on_error = is_sparing, on_error
        self._orders = dict[str, Callable[[], None]]()
        self._news = threading.Condition()
        self._is_open = True
        self._thread: threading.Thread | None = None

    def order(self, name: str, draw: Callable[[], None]) -> None:
        """Have a picture drawn, in the place of one of the same name that is not drawn yet."""
        with self._news:
            self._orders[name] = draw
            if self._is_open and not self._thread:
                self._thread = threading.Thread(target=self._work, name="walkerlab desk", daemon=True)
                self._thread.start()
            self._news.notify_all()

    def hurry(self) -> None:
        """End a rest, for there is no more need to spare the computer."""
        with self._news:
            self._news.notify_all()

    def close(self) -> None:
        """Draw nothing more."""
        with self._news:
            self._is_open = False
            self._orders.clear()
            self._news.notify_all()

    def _work(self) -> None:
        while draw := self._next():
            before = time.thread_time()  # of work, not of waiting for a core
            try:
                draw()
            except Exception as error:
                self._on_error(error)
            work = time.thread_time() - before
            self._rest_until(time.monotonic() + max(SHORTEST, work * (1 / SHARE - 1)))

    def _next(self) -> Callable[[], None] | None:
        with self._news:
            self._news.wait_for(lambda: self._orders or not self._is_open)
            return self._orders.pop(next(iter(self._orders))) if self._is_open else None

    def _rest_until(self, end: float) -> None:
        with self._news:
            while self._is_open and self._is_sparing() and (left := end - time.monotonic()) > 0:
                self._news.wait(left)
