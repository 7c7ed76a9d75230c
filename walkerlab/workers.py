"""The workers: loky's processes on all cores of this computer, replaced when one of them is lost."""

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

from walkerlab.faults import Fault
from walkerlab.interrupts import interrupts_held

IDLE_TIMEOUT = 300  # s without work after which loky's workers go home
KILL = getattr(signal, "SIGKILL", signal.SIGTERM)  # on Windows the latter is no weaker
TRIES = 3  # how many pools may be lost in a row before anything is done


FEWER_WORKERS = (
    "close other programs, make the world smaller, or let fewer robots walk at once: executor=ThreadPoolExecutor(1) "
    "or, on the command line, LOKY_MAX_CPU_COUNT=1 before the command"
)
"""The mend where memory is short."""


class WorkersLostError(Fault, RuntimeError):
    """Those who should do some work did not: they ended time and again, gave no answer, or had no memory left."""


class WorkerLostWarning(UserWarning):
    """Worker processes were lost; others do their work, and nothing else is."""

    def __init__(self, loss: str) -> None:
        """Say it of a loss, as the workers tell it."""
        super().__init__(
            f"The worker processes had to be replaced: {loss}. Their robots walk again in new ones, and nothing is "
            f"lost. If it happens often: {FEWER_WORKERS}"
        )


def n_cores() -> int:
    """How many cores this process may use: on a shared machine, or in a container, fewer than there are."""
    from loky import cpu_count

    return cpu_count()


def n_workers(executor: Executor) -> int:
    """How many pieces of work an executor does at once, now; if it does not tell, as many as there are cores here.

    The pools of the standard library and of loky tell it, a gate asks whoever is inside, and Dask's executor its
    cluster, where workers join and leave.

    Raises:
        RuntimeError: if it is Dask's, and its client is closed.
    """
    if count := getattr(executor, "n_workers", None):
        return count()
    if client := getattr(executor, "_client", None):
        check_open(executor)
        return sum(client.nthreads().values()) or n_cores()  # nobody is there yet
    return getattr(executor, "_max_workers", n_cores())


def check(executor: object) -> None:
    """Make sure that work can be handed to it, or that it is None.

    Raises:
        TypeError: if not; it names the mend.
    """
    if executor is not None and (isinstance(executor, type) or not hasattr(executor, "submit")):
        raise TypeError(
            "executor must be a concurrent.futures.Executor, as ThreadPoolExecutor(4) or, of a Dask cluster, "
            f"Client(cluster).get_executor(); or None, for all cores of this computer; got {executor!r:.80}"
        )


def check_open(executor: object) -> None:
    """Check that an executor still accepts work, as far as it can be known.

    Raises:
        RuntimeError: if it is closed.
    """
    if getattr(getattr(executor, "_client", None), "status", "") == "closed":
        raise RuntimeError("this executor's Dask client is closed; make another: Client(cluster).get_executor()")
    flags = getattr(executor, "_flags", executor)  # loky keeps it there
    if any(getattr(flags, name, False) is True for name in ("_shutdown", "_shutdown_thread", "shutdown")):
        raise RuntimeError(
            "this executor is closed. Create another, such as ThreadPoolExecutor(4), and use it before it is shut "
            "down; or give none, for all cores of this computer."
        )


def innermost(executor: Executor) -> Executor:
    """Return who does the work behind a gate; an executor that is none, itself."""
    inside = getattr(executor, "inside", None)
    return inside() if inside else executor


def renewed(executor: Executor, patience: float) -> bool:
    """Have processes that do not answer replaced; tell whether the executor sees to that.

    Args:
        executor: that was silent.
        patience: for so long, s.
    """
    executor = innermost(executor)
    if isinstance(executor, _Workers):
        executor.renew(patience)
        return True
    return hasattr(executor, "_client")  # Dask waits for workers that are to join, and replaces those that it lost


@cache
def default_executor() -> "_Workers":
    """Return the workers of this process: they start with the first work, and are kept for the next."""
    return _Workers()


if hasattr(os, "register_at_fork"):  # a process that is split off has none of the threads, and hires workers of its own
    os.register_at_fork(after_in_child=default_executor.cache_clear)


class _Workers(Executor):
    """Passes work on to loky's pool, and once more to a new one if a process of the pool was lost.

    That happens: a system that is short of memory kills whoever has most. loky then gives up all that its pool had
    to do; none of it is lost here, and as a walk is worth the same whoever steps it, nothing is changed.

    Attributes:
        losses: what befell each pool that was lost so far, in words for people.
    """

    def __init__(self) -> None:
        """Hire nobody yet."""
        # loky keeps a pool for each thread that asks for one, so a single thread asks, whoever wants work done.
        self._keeper = ThreadPoolExecutor(1, "walkerlab pool")
        self._pool: Executor | None = None
        self._lost, self._n_lost = self._pool, 0  # the pool that was lost last, and how many were in a row
        self._hung: Executor | None = None
        self._answered = time.monotonic()
        self.losses: list[str] = []
        # Were Ctrl-C to break off loky's own farewell, Python would wait for its processes for ever.
        Finalize(None, self._kill, exitpriority=1000)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have some work done by one of the processes.

        The future raises ``WorkersLostError`` if ``TRIES`` pools in a row were lost before anything was done.
        """
        outer = Future[Any]()
        self._keeper.submit(self._send, outer, partial(fn, *args, **kwargs))
        return outer

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        """Send the processes home; others come with the next work."""
        gone = self._keeper.submit(self._dismiss)
        if wait:
            gone.result()

    def renew(self, patience: float) -> None:
        """End the processes if none has answered for so long [s]; their work is done again by others."""
        if self._pool and time.monotonic() - self._answered >= patience:
            self._hung, self._answered = self._pool, time.monotonic()
            self._kill()

    def end(self) -> None:
        """End the processes at once and for good, as Python is about to end; nobody waits for what they do."""
        self._kill()
        self._keeper.shutdown(cancel_futures=True)
        self._kill()  # those that were being started

    def _kill(self) -> None:
        for pid in list(getattr(self._pool, "_processes", ())):
            with suppress(OSError):  # it has ended already
                os.kill(pid, KILL)

    def _dismiss(self) -> None:
        if self._pool:
            self._pool.shutdown(wait=False)

    def _send(self, outer: Future[Any], work: Callable[[], Any]) -> None:
        """Hand work to the pool, on the keeper's thread."""
        if outer.done():
            return
        from loky import get_reusable_executor

        try:
            with interrupts_held():  # processes that are started now inherit it
                self._pool = get_reusable_executor(
                    n_cores(), timeout=IDLE_TIMEOUT, initializer=_prepare_worker, initargs=(os.getpid(),)
                )
                inner: Future[Any] = self._pool.submit(work)
        except BrokenExecutor as error:
            self._again(outer, work, str(error), self._pool)
        except Exception as error:
            outer.set_exception(error)
        else:
            outer.add_done_callback(lambda _: inner.cancel())
            inner.add_done_callback(partial(self._answer, outer, work, self._pool))

    def _answer(self, outer: Future[Any], work: Callable[[], Any], pool: Executor, inner: Future[Any]) -> None:
        """Pass an answer on, on a thread of loky's."""
        with suppress(InvalidStateError):  # given up just now
            if inner.cancelled():
                outer.cancel()
            elif isinstance(error := inner.exception(), BrokenExecutor):
                with suppress(RuntimeError):  # Python ends
                    self._keeper.submit(self._again, outer, work, str(error), pool)
            else:
                self._answered = time.monotonic()
                if error:
                    outer.set_exception(error)
                else:
                    self._n_lost = 0
                    outer.set_result(inner.result())

    def _again(self, outer: Future[Any], work: Callable[[], Any], why: str, lost: Executor | None) -> None:
        """Send work that was in a pool that was lost to the next one, or say why not, on the keeper's thread."""
        if outer.done():
            return
        if lost is not self._lost:
            self._lost, self._n_lost = lost, self._n_lost % TRIES + 1
            self.losses.append(_in_words(why, hung=lost is self._hung))
        if self._n_lost < TRIES:
            self._send(outer, work)
            return
        with suppress(InvalidStateError):  # given up just now
            outer.set_exception(
                WorkersLostError(
                    f"{TRIES} times in a row the worker processes ended before anything was done; the last time, "
                    f"{self.losses[-1]}. Mend: {FEWER_WORKERS}"
                )
            )


def _in_words(why: str, *, hung: bool) -> str:
    """Say how a pool was lost, from what loky says of it."""
    if hung:
        return "they gave no answer any more"
    if "SIGKILL" in why:
        return "one was killed (SIGKILL), as a system does that is short of memory"
    code = re.search(r"[A-Z]+\(-?\d+\)", why)
    return f"one ended with {code[0]}" if code else "one ended"


def _prepare_worker(caller: int) -> None:
    """Make a worker leave Ctrl-C to its caller, and follow it when it is gone.

    Ctrl-C reaches every process of a terminal; one of them is enough to stop a run in good order. And a caller that
    is killed, as a notebook's kernel is when it is restarted, can't send its workers home.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_leave_with, args=(caller,), daemon=True).start()


def _leave_with(caller: int) -> None:
    while os.getppid() == caller:  # on Windows this stays as it is, and the idle timeout has to do
        time.sleep(1)
    os._exit(0)
