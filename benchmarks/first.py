"""Time until the first walk, each measured in a new interpreter with a warm disk cache.

The denominators show how fast the computer is: the import of numpy and pandas, or the same generation once more on
warm workers. The limits are absolute, so the seconds are printed too: an import takes less than 1 s, and the first
generation on a new pool of workers is done within 3 s.
"""

import subprocess
import sys
from collections.abc import Iterator
from statistics import median

from benchmarks.timing import print_note

IMPORT_AND_DRAW = (
    "import walkerlab as wl; settings = wl.Settings(); evaluate = wl.evaluate; "
    "genomes = wl.generate_robot_population(settings.robot, 60, seed=0)"
)


def rows(n_pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield the ratio of each first time to its reference."""
    measure_once()  # fills the disk cache
    measurements = [measure_once() for _ in range(n_pairs)]
    for case, compared in measurements[0]:
        pairs = [measurement[case, compared] for measurement in measurements]
        times = [time for time, _ in pairs]
        print_note(f"{case}: {median(times):.2f} s ({min(times):.2f} to {max(times):.2f})")
        yield case, compared, [time / reference for time, reference in pairs]


def measure_once() -> dict[tuple[str, str], tuple[float, float]]:
    """Return each first time and its reference [s], by case and comparison."""
    (reference_import,) = time_in_new_interpreter("import numpy, pandas")
    (walkerlab_import,) = time_in_new_interpreter("import walkerlab")
    (evolve_import,) = time_in_new_interpreter("from walkerlab import evolve")
    first_walk = time_in_new_interpreter(IMPORT_AND_DRAW, "evaluate(genomes[:1], settings)")
    imports, first, second = time_in_new_interpreter(
        IMPORT_AND_DRAW, "evaluate(genomes, settings)", "evaluate(genomes, settings)"
    )
    return {
        ("import walkerlab", "first / numpy and pandas"): (walkerlab_import, reference_import),
        ("import all of evolve", "first / numpy and pandas"): (evolve_import, reference_import),
        ("import to first walker", "first / numpy and pandas"): (sum(first_walk), reference_import),
        ("import to first generation", "first / warm second"): (imports + first, second),
        ("first generation", "first / warm second"): (first, second),
    }


def time_in_new_interpreter(*lines: str) -> list[float]:
    """Run lines of Python in a new interpreter and return the time of each [s]."""
    timed = "\n".join(f"start = now(); {line}; print(now() - start)" for line in lines)
    code = f"from time import perf_counter as now\n{timed}"
    process = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    return [float(time) for time in process.stdout.split()]
