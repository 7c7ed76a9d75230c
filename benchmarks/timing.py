"""Timing of two things in turn within one run, so that the load of the computer affects both equally."""

import os
import sys
from collections.abc import Callable
from time import perf_counter
from typing import Any

N_WALKS = int(os.environ.get("BENCHMARK_WALKS", "120"))
"""Number of robots in each measurement, two generations by default; a smaller number is enough for a trial."""


def time_call(function: Callable[..., Any], *arguments: Any) -> float:
    """Call a function and return the time that it took [s]."""
    start = perf_counter()
    function(*arguments)
    return perf_counter() - start


def measure_ratios(n_pairs: int, numerator: Callable[[], float], denominator: Callable[[], float]) -> list[float]:
    """Measure two quantities in turn and return the ratio of each pair.

    Args:
        n_pairs: Number of pairs.
        numerator: Measures the numerator.
        denominator: Measures the denominator.
    """
    return [numerator() / denominator() for _ in range(n_pairs)]


def print_note(text: str) -> None:
    """Print a note, such as an absolute figure, to stderr, so that it is not part of the table."""
    print(f"    {text}", file=sys.stderr, flush=True)
