"""A gate before an executor: work goes through it a little at a time, it can be shut for a while, or for good."""

import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, Future, InvalidStateError, ThreadPoolExecutor
from contextlib import suppress
from functools import cache, partial
from typing import Any

AT_ONCE = 2  # pieces of work for each worker that are inside: one that is being done, one that is next


class Stopped(Exception):
    """The gate was shut for good, and what had not come back by then never will."""


class Gate(Executor):
    """Passes work on to another executor, no more at once than keeps it busy.

    What waits before the gate can be held back, so that a pause is a pause of the machine as well, and not of the
    words on a panel; and of two that share an executor, neither fills it up.

    Attributes:
        inside: returns the executor that does the work; made when the first work comes.
        is_open: whether it lets work through.
    """

    def __init__(self, inside: Callable[[], Executor], n_workers: Callable[[Executor], int]) -> None:
        """Make it, open.

        Args:
            inside: returns the executor that does the work; called once, when the first work comes.
            n_workers: tells how many pieces of work that does at once.
        """
        self.inside, self._count, self._n_workers = cache(inside), n_workers, 1
        self._waiting = deque[tuple[Future[Any], Callable[[], Any]]]()
        self._within = set[Future[Any]]()
        self.is_open, self._is_stopped = True, False
        self._lock = threading.RLock()

    def n_workers(self) -> int:
        """Ask how many work inside, where some may have joined or left, and from now on keep so many busy."""
        self._n_workers = self._count(self.inside())
        return self._n_workers

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Let a piece of work wait before the gate.

        Raises:
            Stopped: if the gate is shut for good.
        """
        outer = Future[Any]()
        self.inside()
        with self._lock:
            if self._is_stopped:
                raise Stopped
            self._waiting.append((outer, partial(fn, *args, **kwargs)))
        self._let_in()
        return outer

    def open(self) -> None:
        """Let work through."""
        with self._lock:
            self.is_open = True
        self._let_in()

    def close(self) -> None:
        """Hold back what waits; what is inside already goes on."""
        with self._lock:
            self.is_open = False

    def stop(self) -> None:
        """Shut it for good: whoever waits for an answer gets ``Stopped``, now."""
        with self._lock:
            self._is_stopped, self.is_open = True, False
            unanswered = [*self._within, *(outer for outer, _ in self._waiting)]
            self._waiting.clear()
        for outer in unanswered:
            with suppress(Exception):  # answered, or given up, just now
                outer.set_exception(Stopped())

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        """Stop; the executor inside is somebody else's, and stays."""
        self.stop()

    def _let_in(self) -> None:
        """Let in what there is room for; no lock is held meanwhile, for the executor inside may hold its own."""
        while next_in := self._next():
            outer, work = next_in
            try:
                inner = self.inside().submit(work)
            except Exception as error:
                with self._lock:
                    self._within.discard(outer)
                with suppress(InvalidStateError):  # stopped just now
                    outer.set_exception(error)
            else:
                inner.add_done_callback(partial(self._answer, outer))

    def _next(self) -> tuple[Future[Any], Callable[[], Any]] | None:
        with self._lock:
            while self.is_open and self._waiting and len(self._within) < AT_ONCE * self._n_workers:
                outer, work = self._waiting.popleft()
                if outer.set_running_or_notify_cancel():
                    self._within.add(outer)
                    return outer, work
        return None

    def _answer(self, outer: Future[Any], inner: Future[Any]) -> None:
        """Pass an answer on, on a thread of the executor's; the next is let in on another."""
        with self._lock:
            self._within.discard(outer)
        with suppress(InvalidStateError):  # stopped just now
            if inner.cancelled():
                outer.set_exception(CancelledError())  # by somebody else: who stopped has been answered
            elif error := inner.exception():
                outer.set_exception(error)
            else:
                outer.set_result(inner.result())
        with suppress(RuntimeError):  # Python ends
            _porter().submit(self._let_in)


@cache
def _porter() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, "walkerlab gate")
