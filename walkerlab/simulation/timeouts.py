"""Waiting for results of an executor, with a time limit for workers that do not answer."""

import warnings
from collections.abc import Generator, Sequence
from concurrent.futures import Executor, Future
from contextlib import suppress
from typing import TypeVar

from walkerlab.simulation.workers import (
    LOAD_ADVICE,
    WorkerLostWarning,
    WorkersLostError,
    check_client_open,
    replace_hung_workers,
    unwrap_executor,
)
from walkerlab.system.time_limit import LIMIT_VARIABLE, effective_limit

MIN_TIME_LIMIT = 10.0  # s; workers need some time to start, whatever limit the user sets
POLL_INTERVAL = 1.0  # s, greatest time between two checks for results

_T = TypeVar("_T")

_active_limits: list[float] = []
"""Time limits [s] of all callers that wait now; the largest applies to all, as they may wait for each other's tasks."""


def results_in_order(futures: Sequence[Future[_T]], executor: Executor, limit: float) -> Generator[_T]:
    """Yield the results of tasks in the order of the tasks.

    The time without a result is counted in small steps, so that neither a pause of the executor nor a computer in
    standby counts. After the time limit, worker processes of this package are replaced and repeat their tasks.

    Args:
        futures: Futures of all tasks.
        executor: Executor that computes them.
        limit: Longest time without any result, in seconds.

    Raises:
        RuntimeError: If the executor's Dask client is closed before all tasks have a result.
        WorkersLostError: If another executor exceeds the time limit, or a worker runs out of memory.
    """
    limit = max(MIN_TIME_LIMIT, effective_limit(limit))
    interval = min(POLL_INTERVAL, limit / 10)
    n_done = 0
    silence = 0.0
    losses: list[str] = getattr(executor, "losses", [])
    n_reported = len(losses)
    _active_limits.append(limit)
    try:
        for future in futures:
            while not wait_for(future, interval):
                check_client_open(unwrap_executor(executor))
                n_before = n_done
                n_done = sum(future.done() for future in futures)
                is_silent = n_done == n_before and not getattr(executor, "is_paused", False)
                silence = silence + interval if is_silent else 0.0
                if silence >= max(_active_limits):
                    if not replace_hung_workers(executor, silence) and any(future.running() for future in futures):
                        raise WorkersLostError(_no_answer(silence))
                    silence = 0.0
            for loss in losses[n_reported:]:
                warnings.warn(WorkerLostWarning(loss), stacklevel=2)
            n_reported = len(losses)
            yield _result_of(future)
    finally:
        _active_limits.remove(limit)


def wait_for(future: Future[_T], seconds: float) -> bool:
    """Wait for a future for a limited time and return whether it is done; some futures start only when waited for."""
    with suppress(Exception):
        future.result(seconds)
    return future.done()


def _no_answer(silence: float) -> str:
    return (
        f"the executor has given no answer for {silence:.0f} s: its workers hang or are far too slow for their tasks. "
        "To fix it, use another executor, or none for all cores of this computer; or set the environment variable "
        f"{LIMIT_VARIABLE} to a greater number of seconds."
    )


def _result_of(future: Future[_T]) -> _T:
    try:
        return future.result()
    except Exception as error:
        if isinstance(error, MemoryError) or "allocate memory" in str(error):  # MuJoCo raises its own error classes
            raise WorkersLostError(f"a worker ran out of memory during a walk. To fix it, {LOAD_ADVICE}.") from error
        raise
