"""The default executor: loky's worker processes on all cores, replaced when one of them is lost."""

import os
import re
import signal
import threading
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, InvalidStateError, ThreadPoolExecutor
from contextlib import suppress
from functools import cache, partial
from multiprocessing.util import Finalize
from typing import Any

from walkerlab.simulation.stepping import disable_step_timers
from walkerlab.system.errors import WalkerlabError
from walkerlab.system.interrupts import interrupts_held

IDLE_TIMEOUT = 300  # s without work after which worker processes end
KILL_SIGNAL = getattr(signal, "SIGKILL", signal.SIGTERM)  # Windows has no SIGKILL, and SIGTERM has the same effect
MAX_LOST_POOLS = 3  # lost pools in a row without any result after which tasks fail
PARENT_CHECK_INTERVAL = 1.0  # s between a worker's checks that its parent process still exists


LOAD_ADVICE = (
    "close other programs, choose a world with less in it, or use fewer workers: executor=ThreadPoolExecutor(1), or on "
    "the command line LOKY_MAX_CPU_COUNT=1 before the command"
)
"""How to reduce the load on a computer that is short of memory."""


class WorkersLostError(WalkerlabError, RuntimeError):
    """The workers did not complete their tasks: they ended repeatedly, gave no answer, or ran out of memory."""


class WorkerLostWarning(UserWarning):
    """Worker processes were lost and replaced; their tasks are repeated and the results do not change."""

    def __init__(self, loss: str) -> None:
        """Create the warning.

        Args:
            loss: How the processes were lost, as in ``losses`` of the default executor.
        """
        super().__init__(
            f"The worker processes had to be replaced: {loss}. Their robots walk again in new ones, and no result is "
            f"lost. If it happens often, {LOAD_ADVICE}."
        )


def n_cores() -> int:
    """Return the number of cores that this process may use, which containers and shared computers can limit."""
    from loky import cpu_count

    return cpu_count()


def n_workers(executor: Executor) -> int:
    """Return the number of tasks that an executor computes at once now; the number of cores if it is unknown.

    It is known for the executors of the standard library, loky and Dask, and for ``PausableExecutor``.

    Raises:
        RuntimeError: If the executor belongs to a Dask client that is closed.
    """
    if count := getattr(executor, "n_workers", None):
        return count()
    if client := getattr(executor, "_client", None):
        check_open(executor)
        return sum(client.nthreads().values()) or n_cores()  # no worker has joined yet
    return getattr(executor, "_max_workers", n_cores())


def check_executor(executor: object) -> None:
    """Check that a value is an executor or None.

    Raises:
        TypeError: If it is neither.
    """
    if executor is not None and (isinstance(executor, type) or not hasattr(executor, "submit")):
        raise TypeError(
            "executor must be a concurrent.futures.Executor such as ThreadPoolExecutor(4) or, for a Dask cluster, "
            f"Client(cluster).get_executor(); or None for all cores of this computer; got {executor!r:.80}"
        )


def check_open(executor: object) -> None:
    """Check that an executor still accepts tasks, as far as this can be determined.

    Raises:
        RuntimeError: If it is closed.
    """
    check_client_open(executor)
    flags = getattr(executor, "_flags", executor)  # loky keeps it there
    if any(getattr(flags, name, False) is True for name in ("_shutdown", "_shutdown_thread", "shutdown")):
        raise RuntimeError(
            "this executor is closed. Create another, such as ThreadPoolExecutor(4), and use it before it is shut "
            "down; or omit it to use all cores of this computer."
        )


def check_client_open(executor: object) -> None:
    """Check that the Dask client of an executor, if it has one, is open; tasks of a closed client may never end.

    Raises:
        RuntimeError: If it is closed.
    """
    if getattr(getattr(executor, "_client", None), "status", "") == "closed":
        raise RuntimeError("this executor's Dask client is closed; make another: Client(cluster).get_executor()")


def unwrap_executor(executor: Executor) -> Executor:
    """Return the executor inside a ``PausableExecutor``; any other executor unchanged."""
    wrapped = getattr(executor, "wrapped", None)
    return wrapped() if wrapped else executor


def replace_hung_workers(executor: Executor, silence: float) -> bool:
    """Replace worker processes that do not answer.

    Args:
        executor: Executor that computes the tasks.
        silence: Time without any result, in seconds.

    Returns:
        Whether the executor replaces lost workers; if not, its tasks will never finish.
    """
    executor = unwrap_executor(executor)
    if isinstance(executor, _WorkerProcesses):
        executor.replace_hung(silence)
        return True
    return hasattr(executor, "_client")  # Dask waits for workers to join, and replaces lost ones


@cache
def default_executor() -> "_WorkerProcesses":
    """Return the default executor of this process; its workers start with the first task and are reused."""
    return _WorkerProcesses()


if hasattr(os, "register_at_fork"):  # a forked process has none of the executor's threads and needs its own executor
    os.register_at_fork(after_in_child=default_executor.cache_clear)


class _WorkerProcesses(Executor):
    """Executor that passes tasks on to a loky pool, and again to a new pool if a process of the old one was lost.

    An operating system that runs out of memory kills the process that uses most of it; loky then cancels all tasks of
    the pool. Here these tasks are repeated, which does not change their results.

    Attributes:
        losses: Description of each pool lost so far, such as ``one was killed``.
    """

    def __init__(self) -> None:
        """Create an executor without processes."""
        # loky keeps one pool per thread that requests one, so all requests are made in one thread.
        self._pool_thread = ThreadPoolExecutor(1, "walkerlab pool")
        self._pool: Executor | None = None
        self._last_lost: Executor | None = None
        self._n_lost_in_row = 0
        self._hung_pool: Executor | None = None
        self._last_result_time = time.monotonic()
        self.losses: list[str] = []
        # If Ctrl-C interrupted loky's own cleanup at exit, Python would wait for its processes forever.
        Finalize(None, self._kill_processes, exitpriority=1000)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Compute a task in one of the processes.

        The future raises ``WorkersLostError`` after ``MAX_LOST_POOLS`` pools in a row were lost without any result.
        """
        outer = Future[Any]()
        self._pool_thread.submit(self._submit_to_pool, outer, partial(fn, *args, **kwargs))
        return outer

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        """End the processes when they are idle; new ones start with the next task."""
        done = self._pool_thread.submit(self._shut_down_pool)
        if wait:
            done.result()

    def replace_hung(self, silence: float) -> None:
        """Kill the processes if there was no result for this time [s]; their tasks are repeated in new ones."""
        if self._pool and time.monotonic() - self._last_result_time >= silence:
            self._hung_pool = self._pool
            self._last_result_time = time.monotonic()
            self._kill_processes()

    def end(self) -> None:
        """Kill the processes and reject further tasks, before Python exits."""
        self._kill_processes()
        self._pool_thread.shutdown(cancel_futures=True)
        self._kill_processes()  # processes that were just being started

    def _kill_processes(self) -> None:
        for pid in list(getattr(self._pool, "_processes", ())):
            with suppress(OSError):  # it has already ended
                os.kill(pid, KILL_SIGNAL)

    def _shut_down_pool(self) -> None:
        if self._pool:
            self._pool.shutdown(wait=False)

    def _submit_to_pool(self, outer: Future[Any], work: Callable[[], Any]) -> None:
        """Pass a task on to the pool; runs in the pool thread."""
        if outer.done():
            return
        from loky import get_reusable_executor

        try:
            with interrupts_held():  # inherited by the processes that are started now
                self._pool = get_reusable_executor(
                    n_cores(), timeout=IDLE_TIMEOUT, initializer=prepare_worker, initargs=(os.getpid(),)
                )
                inner: Future[Any] = self._pool.submit(work)
        except BrokenExecutor as error:
            self._resubmit(outer, work, str(error), self._pool)
        except Exception as error:
            outer.set_exception(error)
        else:
            outer.add_done_callback(lambda _: inner.cancel())
            inner.add_done_callback(partial(self._forward_result, outer, work, self._pool))

    def _forward_result(self, outer: Future[Any], work: Callable[[], Any], pool: Executor, inner: Future[Any]) -> None:
        """Pass a result on; runs in a thread of loky."""
        with suppress(InvalidStateError):  # it has just been cancelled
            if inner.cancelled():
                outer.cancel()
            elif isinstance(error := inner.exception(), BrokenExecutor):
                with suppress(RuntimeError):  # Python is shutting down
                    self._pool_thread.submit(self._resubmit, outer, work, str(error), pool)
            else:
                self._last_result_time = time.monotonic()
                if error:
                    outer.set_exception(error)
                else:
                    self._n_lost_in_row = 0
                    outer.set_result(inner.result())

    def _resubmit(self, outer: Future[Any], work: Callable[[], Any], why: str, lost: Executor | None) -> None:
        """Pass a task of a lost pool on to a new pool, or fail it after too many losses; runs in the pool thread."""
        if outer.done():
            return
        if lost is not self._last_lost:
            self._last_lost = lost
            self._n_lost_in_row = self._n_lost_in_row % MAX_LOST_POOLS + 1
            self.losses.append(_describe_loss(why, hung=lost is self._hung_pool))
        if self._n_lost_in_row < MAX_LOST_POOLS:
            self._submit_to_pool(outer, work)
            return
        with suppress(InvalidStateError):  # it has just been cancelled
            outer.set_exception(
                WorkersLostError(
                    f"{MAX_LOST_POOLS} times in a row the worker processes ended before any task was done; the last "
                    f"time, {self.losses[-1]}. To fix it, {LOAD_ADVICE}."
                )
            )


def _describe_loss(why: str, *, hung: bool) -> str:
    """Describe how a pool was lost, from the message of loky's error."""
    if hung:
        return "they stopped responding"
    if "SIGKILL" in why:
        return "one was killed (SIGKILL), probably by the operating system because memory was short"
    code = re.search(r"[A-Z]+\(-?\d+\)", why)
    return f"one ended with {code[0]}" if code else "one ended"


def prepare_worker(parent: int) -> None:
    """Make a worker process ignore Ctrl-C, end with its parent process, and simulate without timers.

    A terminal sends Ctrl-C to every process, but only the parent should react. A parent that is killed, such as the
    kernel of a notebook that is restarted, cannot end its workers.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    disable_step_timers()
    threading.Thread(target=_exit_with_parent, args=(parent,), daemon=True).start()


def _exit_with_parent(parent: int) -> None:
    while os.getppid() == parent:  # never changes on Windows, where the idle timeout ends the process
        time.sleep(PARENT_CHECK_INTERVAL)
    os._exit(0)
