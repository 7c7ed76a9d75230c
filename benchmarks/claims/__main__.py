"""Measure the statements of the lessons with several seeds, and print which of them hold.

    python -m benchmarks.claims [--seeds 5] [--lessons 03,04] [--jobs 2] [--folder FOLDER]

Each module ``benchmarks/claims/lesson_NN.py`` has a tuple ``CLAIMS``. With ``--folder``, each figure is stored in that
folder, and the same command continues an interrupted measurement; a figure is measured again if its module has changed.
Exits with 1 if a claim does not hold.
"""

import argparse
import json
import math
import pkgutil
import sys
from collections.abc import Sequence
from concurrent.futures import Executor, Future
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Any

import pandas as pd
from loky import ProcessPoolExecutor

import benchmarks.claims
from benchmarks.claims.claim import Claim
from walkerlab.system.files import write_text

MODULE_PREFIX = "lesson_"
SEEDS_OF_NEEDED = 5  # ``Claim.needed`` is a number out of so many seeds
DIGEST_DIGITS = 16


def main() -> int:
    """Parse the arguments, measure, and print the table; return 1 if a claim does not hold."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seeds", type=int, default=SEEDS_OF_NEEDED)
    parser.add_argument("--lessons", default="", help="numbers, such as 03,04; all if omitted")
    parser.add_argument("--jobs", type=int, default=2, help="number of processes")
    parser.add_argument("--folder", type=Path, help="folder that stores the figures")
    arguments = parser.parse_args()
    claims = find_claims([number for number in arguments.lessons.split(",") if number])
    with ProcessPoolExecutor(arguments.jobs) as executor:
        figures = measure_claims(claims, range(arguments.seeds), executor, arguments.folder)
    table = to_table(claims, figures)
    print_table(table)
    return int(not table.holds.all())


def find_claims(lessons: Sequence[str] = ()) -> list[Claim]:
    """Return the claims of some lessons, or of all if empty.

    Raises:
        SystemExit: If a lesson has no module of claims.
    """
    names = sorted(module.name for module in pkgutil.iter_modules(benchmarks.claims.__path__))
    known = [name.removeprefix(MODULE_PREFIX) for name in names if name.startswith(MODULE_PREFIX)]
    if unknown := set(lessons) - set(known):
        sys.exit(f"no claims of lesson {', '.join(sorted(unknown))}; the lessons with claims are {', '.join(known)}")
    modules = [import_module(f"benchmarks.claims.{MODULE_PREFIX}{number}") for number in lessons or known]
    return [claim for module in modules for claim in module.CLAIMS]


def measure_claims(
    claims: Sequence[Claim], seeds: Sequence[int], executor: Executor, folder: Path | None = None
) -> dict[tuple[str, int], float]:
    """Return the figure of each claim and seed; NaN if a measure raises an error, which is printed.

    Args:
        claims: Claims to measure.
        seeds: Seeds of each.
        executor: Executor of the processes.
        folder: Folder that stores the figures; None to store nothing.
    """
    figures: dict[tuple[str, int], float] = {}
    waiting: list[tuple[Claim, int, Future[float]]] = []
    for seed in seeds:
        for claim in claims:
            stored = read_figure(folder, claim, seed)
            if stored is None:
                waiting.append((claim, seed, executor.submit(claim.measure, seed)))
            else:
                figures[claim.id, seed] = stored
    for claim, seed, future in waiting:
        try:
            figure = float(future.result())
        except Exception as error:
            print(f"{claim.id}, seed {seed}: {type(error).__name__}: {error}", file=sys.stderr)
            figures[claim.id, seed] = math.nan
            continue
        figures[claim.id, seed] = figure
        store_figure(folder, claim, seed, figure)
        print(f"{claim.id}, seed {seed}: {figure:.3g}", file=sys.stderr, flush=True)
    return figures


def to_table(claims: Sequence[Claim], figures: dict[tuple[str, int], float]) -> pd.DataFrame:
    """Return a row for each claim: id, figures per seed, number of seeds that agree, and whether it holds."""
    rows: list[dict[str, Any]] = []
    for claim in claims:
        values = [value for (number, _), value in figures.items() if number == claim.id]
        n_agree = sum(value > 0 for value in values)
        needed = math.ceil(claim.needed * len(values) / SEEDS_OF_NEEDED)
        texts = [f"{value:.3g}" for value in values]
        rows.append(
            {
                "claim": claim.id,
                "text": claim.text,
                "figures": " ".join(texts) + (f" {claim.unit}" if claim.unit else ""),
                "agree": f"{n_agree} of {len(values)}",
                "holds": n_agree >= needed,
            }
        )
    return pd.DataFrame(rows, columns=["claim", "text", "figures", "agree", "holds"])


def print_table(table: pd.DataFrame) -> None:
    """Print each claim with its sentence above its figures."""
    for row in table.to_dict("records"):
        print(f"{row['claim']}  {'holds' if row['holds'] else 'DOES NOT HOLD'}  {row['text']}")
        print(f"      {row['agree']} seeds: {row['figures']}")
    print(f"{int(table.holds.sum())} of {len(table)} claims hold")


def figure_path(folder: Path, claim: Claim, seed: int) -> Path:
    """Return the path of a stored figure, which contains a digest of the claim's module."""
    source = Path(__file__).with_name(f"{MODULE_PREFIX}{claim.id.partition('.')[0]}.py")
    text = source.read_bytes() if source.exists() else b""
    return folder / f"{claim.id}_{seed}_{sha256(text).hexdigest()[:DIGEST_DIGITS]}.json"


def read_figure(folder: Path | None, claim: Claim, seed: int) -> float | None:
    """Return a stored figure, or None if there is none."""
    path = figure_path(folder, claim, seed) if folder else None
    return json.loads(path.read_text(encoding="utf-8")) if path and path.exists() else None


def store_figure(folder: Path | None, claim: Claim, seed: int, figure: float) -> None:
    """Store a figure if there is a folder."""
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
        write_text(figure_path(folder, claim, seed), json.dumps(figure) + "\n")


if __name__ == "__main__":
    sys.exit(main())
