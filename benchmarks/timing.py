"""Two things timed in turn within one run, so that whatever else a machine does, it does to both."""

import os
import sys
from collections.abc import Callable
from time import perf_counter
from typing import Any

WALKS = int(os.environ.get("BENCHMARK_WALKS", "120"))
"""How many robots walk in what is timed: two generations of them; fewer for a try."""


def seconds(work: Callable[..., Any], *arguments: Any) -> float:
    """Do some work: s that it took."""
    start = perf_counter()
    work(*arguments)
    return perf_counter() - start


def in_turn(pairs: int, above: Callable[[], float], below: Callable[[], float]) -> list[float]:
    """Take two figures, one after the other and again, and divide each pair.

    Args:
        pairs: how many times.
        above: takes the numerator.
        below: takes the denominator.
    """
    return [above() / below() for _ in range(pairs)]


def note(words: str) -> None:
    """Say what is no ratio beside the table, not in it."""
    print(f"    {words}", file=sys.stderr, flush=True)
