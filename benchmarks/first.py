"""How long until the first walker: each time in an interpreter of its own, whose files have been read before.

The denominators say how fast the machine is: importing numpy and pandas, or the same generation once more, on workers
that are warm by then. The limits are absolute, so the seconds are told as well: an import takes less than 1 s, and the
first generation on a fresh pool comes back within 3 s.
"""

import subprocess
import sys
from collections.abc import Iterator
from statistics import median

from benchmarks.timing import note

BEGIN = (
    "import walkerlab as wl; settings = wl.Settings(); evaluate = wl.evaluate; "
    "genomes = wl.generate_robot_population(settings.robot, 60, seed=0)"
)


def rows(pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield each first time, as a multiple of one that is known."""
    once()  # so that the disk has been read
    found = [once() for _ in range(pairs)]
    for case, compared in found[0]:
        took = [each[case, compared][0] for each in found]
        note(f"{case}: {median(took):.2f} s ({min(took):.2f} to {max(took):.2f})")
        yield case, compared, [above / below for above, below in (each[case, compared] for each in found)]


def once() -> dict[tuple[str, str], tuple[float, float]]:
    """Take every first time once, and what each is divided by."""
    (others,) = fresh("import numpy, pandas")
    (door,) = fresh("import walkerlab")
    (evolve,) = fresh("from walkerlab import evolve")
    walker = fresh(BEGIN, "evaluate(genomes[:1], settings)")
    imports, first, second = fresh(BEGIN, "evaluate(genomes, settings)", "evaluate(genomes, settings)")
    return {
        ("import walkerlab", "first / numpy and pandas"): (door, others),
        ("import all of evolve", "first / numpy and pandas"): (evolve, others),
        ("import to first walker", "first / numpy and pandas"): (sum(walker), others),
        ("import to first generation", "first / warm second"): (imports + first, second),
        ("first generation", "first / warm second"): (first, second),
    }


def fresh(*lines: str) -> list[float]:
    """Time each of some lines in an interpreter of its own, s."""
    timed = "\n".join(f"start = now(); {line}; print(now() - start)" for line in lines)
    code = f"from time import perf_counter as now\n{timed}"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    return [float(took) for took in done.stdout.split()]
