"""Measure the cost of walkerlab and print it as a table; --csv also writes it to a file.

    python -m benchmarks [--pairs 5] [--only floor,scaling] [--csv FILE]

Each figure is a ratio of two things that are timed in turn within one run. Run it from the root of the repository.
The docstring of each module (benchmarks/floor.py and so on) explains its figures. The aims apply to the median of
5 pairs on an otherwise idle computer. For a quick trial, set BENCHMARK_WALKS=16: fewer robots walk, and the aims do
not apply.
"""

import argparse
import csv
import io
from collections.abc import Iterator
from importlib import import_module
from itertools import chain
from statistics import median

from benchmarks.floor import PIECES_AND_ROCKS
from walkerlab.system.files import PathError, file_path, write_text

BENCHMARKS = ("floor", "scaling", "worlds", "recording", "panel", "first", "growth")
"""Names of the benchmarks, each a module of that name."""

AIMS = {
    ("floor", "flat"): "at least 0.90",
    ("floor", PIECES_AND_ROCKS): "at least 0.93",
    ("scaling", "loky"): "at least 0.95",
    ("scaling", "dask"): "at least 0.90",
    ("panel", "a run"): "at least 0.95",
}
"""Aims for the median, by benchmark and case."""

COLUMNS = ("benchmark", "case", "compared", "median", "least", "most", "pairs", "aim")
LINE_FORMAT = "{:10} {:27} {:29} {:>7} {:>7} {:>7} {:>5}  {}"


def measure(benchmarks: list[str], n_pairs: int) -> Iterator[tuple[object, ...]]:
    """Yield a row of the table for each case of each benchmark, as soon as it is measured."""
    for name in benchmarks:
        for case, compared, ratios in import_module(f"benchmarks.{name}").rows(n_pairs):
            figures = (f"{statistic(ratios):.3f}" for statistic in (median, min, max))
            yield name, case, compared, *figures, len(ratios), AIMS.get((name, case), "")


def main() -> None:
    """Run the requested benchmarks."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--pairs", type=int, default=5, help="number of pairs of measurements")
    parser.add_argument(
        "--only", default=",".join(BENCHMARKS), help="names of benchmarks, separated by commas [%(default)s]"
    )
    parser.add_argument("--csv", metavar="FILE", help="CSV file to which the table is also written")
    arguments = parser.parse_args()
    names = arguments.only.split(",")
    if unknown := sorted(set(names) - set(BENCHMARKS)):
        parser.error(f"there is no benchmark {', '.join(unknown)}; the benchmarks are {', '.join(BENCHMARKS)}")
    if arguments.pairs < 1:
        parser.error(f"--pairs is {arguments.pairs}; it must be 1 or more")

    try:
        path = file_path(arguments.csv, "--csv") if arguments.csv else None
    except PathError as error:
        parser.error(str(error))
    table = io.StringIO()
    for row in chain([COLUMNS], measure(names, arguments.pairs)):
        print(LINE_FORMAT.format(*row).rstrip(), flush=True)
        csv.writer(table, lineterminator="\n").writerow(row)
        if path:
            write_text(path, table.getvalue())  # after each row, because the next one can take minutes


if __name__ == "__main__":
    main()
