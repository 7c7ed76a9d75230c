"""Waiting for workers: their answers in the order of the questions, or words when none comes any more."""

import warnings
from collections.abc import Generator, Sequence
from concurrent.futures import Executor, Future
from contextlib import suppress
from typing import TypeVar

from walkerlab.time_limit import LIMIT_VARIABLE, effective_limit
from walkerlab.workers import FEWER_WORKERS, WorkerLostWarning, WorkersLostError, renewed

START_UP = 10.0  # s that workers are given to begin, whatever patience people have
TICK = 1.0  # s at most between two looks at whether anything has come back

_T = TypeVar("_T")

_limits: list[float] = []
"""The limits [s] of all who wait now: they may wait for each other's work, so the largest holds for all of them."""


def in_turn(futures: Sequence[Future[_T]], executor: Executor, limit: float) -> Generator[_T]:
    """Yield what comes back, in the order in which it was sent, for as long as anything does.

    Time is counted in small pieces: a gate that is shut stops the clock, and so does a computer that sleeps. When the
    limit is over, processes of ours are replaced, and do their work again.

    Args:
        futures: of all the work.
        executor: to which it was sent.
        limit: for how long nothing may come back, s.

    Raises:
        WorkersLostError: if nothing comes back from another executor, or a worker has no memory left.
    """
    limit = max(START_UP, effective_limit(limit))
    n_back, silence, losses = 0, 0.0, getattr(executor, "losses", [])
    n_told = len(losses)
    _limits.append(limit)
    try:
        for future in futures:
            while not is_done(future, tick := min(TICK, limit / 10)):
                before, n_back = n_back, sum(future.done() for future in futures)
                is_due = n_back == before and getattr(executor, "is_open", True)
                silence = silence + tick if is_due else 0.0
                if silence >= max(_limits):
                    if not renewed(executor, silence) and any(future.running() for future in futures):
                        raise WorkersLostError(_no_answer(silence))
                    silence = 0.0
            for loss in losses[n_told:]:
                warnings.warn(WorkerLostWarning(loss), stacklevel=2)
            n_told = len(losses)
            yield _answer(future)
    finally:
        _limits.remove(limit)


def is_done(future: Future[_T], seconds: float) -> bool:
    """Wait for some work for so long at most, and tell whether it is done; some begin only when they are asked."""
    with suppress(Exception):
        future.result(seconds)
    return future.done()


def _no_answer(silence: float) -> str:
    return (
        f"the executor has given no answer for {silence:.0f} s: its workers hang, or are far too slow for their work. "
        "Mend: another executor, or none, for all cores of this computer; or, by the environment variable "
        f"{LIMIT_VARIABLE}, more seconds of patience."
    )


def _answer(future: Future[_T]) -> _T:
    try:
        return future.result()
    except Exception as error:
        if isinstance(error, MemoryError) or "allocate memory" in str(error):  # MuJoCo has errors of its own for it
            raise WorkersLostError(f"a worker had no memory left for a walk. Mend: {FEWER_WORKERS}") from error
        raise
