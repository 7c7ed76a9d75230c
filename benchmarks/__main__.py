"""Measure what walkerlab costs, and print it as a table; --csv writes it too.

    python -m benchmarks [--pairs 5] [--only floor,scaling] [--csv FILE]

Every figure is a ratio of two things that are timed in turn within one run. Run it from the root of the repository.
What each means stands at the head of its file, benchmarks/floor.py and so on; the aims are for the median of 5 pairs on
a machine that does nothing else. With BENCHMARK_WALKS=16 before it fewer robots walk, for a try: no aim is for that.
"""

import argparse
import csv
import io
from collections.abc import Iterator
from importlib import import_module
from itertools import chain
from statistics import median

from benchmarks.floor import ROUGH
from walkerlab.system.files import PathError, file_path, write_text

BENCHMARKS = ("floor", "scaling", "worlds", "panel", "first", "growth")
"""What is measured, each by the module of that name."""

AIMS = {
    ("floor", "flat"): "at least 0.90",
    ("floor", ROUGH): "at least 0.93",
    ("scaling", "loky"): "at least 0.95",
    ("scaling", "dask"): "at least 0.90",
    ("panel", "a run"): "at least 0.95",
}
"""What the median should come to, where that is settled."""

COLUMNS = ("benchmark", "case", "compared", "median", "least", "most", "pairs", "aim")
LINE = "{:10} {:27} {:29} {:>7} {:>7} {:>7} {:>5}  {}"


def measure(names: list[str], pairs: int) -> Iterator[tuple[object, ...]]:
    """Yield a row for each case of each benchmark, as soon as it is measured."""
    for name in names:
        for case, compared, ratios in import_module(f"benchmarks.{name}").rows(pairs):
            figures = (f"{of(ratios):.3f}" for of in (median, min, max))
            yield name, case, compared, *figures, len(ratios), AIMS.get((name, case), "")


def main() -> None:
    """Run the benchmarks that are asked for."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--pairs", type=int, default=5, help="how often each two are timed in turn")
    parser.add_argument("--only", default=",".join(BENCHMARKS), help="some of them; all are %(default)s")
    parser.add_argument("--csv", metavar="FILE", help="where to write the table as well")
    given = parser.parse_args()
    names = given.only.split(",")
    if unknown := sorted(set(names) - set(BENCHMARKS)):
        parser.error(f"there is no benchmark {', '.join(unknown)}; there are {', '.join(BENCHMARKS)}")
    if given.pairs < 1:
        parser.error(f"--pairs is {given.pairs}; it must be 1 or more")

    try:
        path = file_path(given.csv, "--csv") if given.csv else None
    except PathError as error:
        parser.error(str(error))
    table = io.StringIO()
    for row in chain([COLUMNS], measure(names, given.pairs)):
        print(LINE.format(*row).rstrip(), flush=True)
        csv.writer(table, lineterminator="\n").writerow(row)
        if path:
            write_text(path, table.getvalue())  # whole after each row: the next may take minutes


if __name__ == "__main__":
    main()
