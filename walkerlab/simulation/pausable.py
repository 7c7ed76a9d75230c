"""An executor that can be paused and stopped; it passes work on to another executor in small portions."""

import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, Future, InvalidStateError, ThreadPoolExecutor
from contextlib import suppress
from functools import cache, partial
from typing import Any

TASKS_PER_WORKER = 2  # submitted at once: one that is being computed and the next one


class Stopped(Exception):
    """The executor was stopped before the task was done."""


class PausableExecutor(Executor):
    """Executor that passes tasks on to another one, only as many at a time as keep its workers busy.

    Tasks that have not been passed on can be held back, so that a pause takes effect at once. Also, two of these
    executors can share one executor without one of them filling its queue.

    Attributes:
        wrapped: Function that returns the wrapped executor, which is created with the first task.
        is_paused: Whether tasks are held back.
    """

    def __init__(self, create: Callable[[], Executor], n_workers: Callable[[Executor], int]) -> None:
        """Create a running executor.

        Args:
            create: Function that returns the wrapped executor; called once, with the first task.
            n_workers: Function that returns the number of tasks that the wrapped executor computes at once.
        """
        self.wrapped = cache(create)
        self.is_paused = False
        self._is_stopped = False
        self._count_workers = n_workers
        self._n_workers = 1
        self._waiting: deque[tuple[Future[Any], Callable[[], Any]]] = deque()
        self._submitted: set[Future[Any]] = set()
        self._lock = threading.RLock()

    def n_workers(self) -> int:
        """Count the workers of the wrapped executor, and keep that many busy from now on."""
        self._n_workers = self._count_workers(self.wrapped())
        return self._n_workers

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Add a task to the queue.

        Raises:
            Stopped: If this executor is stopped.
        """
        outer = Future[Any]()
        self.wrapped()
        with self._lock:
            if self._is_stopped:
                raise Stopped
            self._waiting.append((outer, partial(fn, *args, **kwargs)))
        self._submit_waiting()
        return outer

    def resume(self) -> None:
        """Pass tasks on again."""
        with self._lock:
            self.is_paused = False
        self._submit_waiting()

    def pause(self) -> None:
        """Hold back all tasks that have not been passed on; the others continue."""
        with self._lock:
            self.is_paused = True

    def stop(self) -> None:
        """Stop permanently: every task that is not done raises ``Stopped`` at once."""
        with self._lock:
            self._is_stopped = True
            self.is_paused = True
            pending = [*self._submitted, *(outer for outer, _ in self._waiting)]
            self._waiting.clear()
        for outer in pending:
            with suppress(Exception):  # the task has just finished or been cancelled
                outer.set_exception(Stopped())

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        """Stop this executor; the wrapped executor belongs to the caller and continues."""
        self.stop()

    def _submit_waiting(self) -> None:
        """Pass on as many tasks as allowed, without holding the lock, since the wrapped executor may use its own."""
        while task := self._next_task():
            outer, work = task
            try:
                inner = self.wrapped().submit(work)
            except Exception as error:
                with self._lock:
                    self._submitted.discard(outer)
                with suppress(InvalidStateError):  # it has just been stopped
                    outer.set_exception(error)
            else:
                inner.add_done_callback(partial(self._forward_result, outer))

    def _next_task(self) -> tuple[Future[Any], Callable[[], Any]] | None:
        with self._lock:
            limit = TASKS_PER_WORKER * self._n_workers
            while not self.is_paused and self._waiting and len(self._submitted) < limit:
                outer, work = self._waiting.popleft()
                if outer.set_running_or_notify_cancel():
                    self._submitted.add(outer)
                    return outer, work
        return None

    def _forward_result(self, outer: Future[Any], inner: Future[Any]) -> None:
        """Pass a result on; called in a thread of the wrapped executor. The next task is submitted in another one."""
        with self._lock:
            self._submitted.discard(outer)
        with suppress(InvalidStateError):  # it has just been stopped
            if inner.cancelled():
                outer.set_exception(CancelledError())  # not by stop(), which sets its own exception
            elif error := inner.exception():
                outer.set_exception(error)
            else:
                outer.set_result(inner.result())
        with suppress(RuntimeError):  # Python is shutting down
            _submitting_thread().submit(self._submit_waiting)


@cache
def _submitting_thread() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, "walkerlab gate")
