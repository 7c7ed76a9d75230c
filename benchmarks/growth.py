"""What a run costs as it grows, beside its walks: these are stood in for by a sum, and all else is as ever.

    python -m benchmarks.growth [--population 1000] [--generations 200]

That tells seconds, bytes and megabytes, of one run. The limits are absolute, for 200,000 robots: a file of at most 1.2
kB a robot; 3 s to load it with its table, in a process that has not seen it; 1 s to draw and save its curve; no more
than 50 MB between the tenth generation and the last; 50 µs for a child to learn that nobody walked with its genome.
The ratios divide each of these by something that is known: the same rows fetched by sqlite3 alone, the text of the
genomes, the curve of a tenth of the run, the tenth generation, the writing of a genome's text.
"""

import argparse
import resource
import sqlite3
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
import pandas as pd

import walkerlab as wl
from benchmarks.timing import WALKS, note, seconds
from walkerlab.evolution import evolution
from walkerlab.runfile.archive import Archive
from walkerlab.simulation.evaluation import Evaluation
from walkerlab.view.plots.appearance import paper

FIRST = 10  # the generation against which growth is measured: by then all that is built once is built
FULL = 120  # WALKS of a whole benchmark, with which a run has 1000 robots in each generation

Figures = dict[str, float]


def rows(pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield what a run of 200 generations costs when it is long, as multiples of what it is compared with."""
    found = [measure(max(20, 1000 * WALKS // FULL), 200) for _ in range(pairs)]
    for line in in_words(found[-1]):
        note(line)
    for case, compared, above, below in (
        ("load a run", "wl.load / sqlite3 fetching it", "load", "fetch"),
        ("file of a run", "bytes / genomes' text", "file", "text"),
        ("its fitness curve", "all / a tenth of it", "curve", "short curve"),
        ("memory, with a file", f"last / generation {FIRST}", "memory", "early memory"),
        ("memory, without a file", f"last / generation {FIRST}", "memory without", "early memory without"),
        ("between two generations", f"last / generation {FIRST}", "own", "early own"),
        ("who has walked before", "asking / writing the genome", "find", "write"),
    ):
        yield case, compared, [each[above] / each[below] for each in found]


def measure(population: int, generations: int) -> Figures:
    """Grow two runs, with a file and without, and look at the one with; each in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.walk"
        found = alone(grow, path, population, generations)
        without = alone(grow, None, population, generations)
        found |= {f"{name} without": without[name] for name in ("memory", "early memory")}
        return found | alone(look, path) | {"n": population * generations}


def alone(work: Callable[..., Figures], *given: Any) -> Figures:
    """Do it in a fresh process."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        return process.submit(work, *given).result()


# ------------------------------------------------------------------------------------------- in a process of its own


def rated(values) -> Evaluation:
    """Stand in for a walk, as fast as can be, with the kinds of values that walks have."""
    way, counts = float(values[1] - values[2:].std()), values[3] % 1 > 0.02
    fitness, verdict, why = (way, "ok", "") if counts else (-np.inf, "airborne", "no foot on the ground for 1.23 s")
    measures = (int(values[0]), 4, float(values[3]), float(values[2]))
    return Evaluation(wl.Genome(values), fitness, verdict, why, way * 8.123, way * 1.0173, *measures)


def grow(path: Path | None, population: int, generations: int) -> Figures:
    """Evolve, and look at memory [MB] and at the process's own time [s] with every generation."""
    walking, memory, own = [0.0], [], []

    def evaluate(genomes, *, on_done, **_):
        start = perf_counter()
        found = [rated(values) for values in genomes]
        on_done(len(found))
        walking[0] += perf_counter() - start
        return found

    evolution.evaluate = evaluate
    settings = wl.Settings().with_(population_size=population, generations=generations)
    start = perf_counter()
    for generation in wl.Evolution(settings, path):
        assert generation.champion  # as a progress bar wants to know
        own.append(perf_counter() - start - walking[0])
        memory.append(_megabytes())
        start, walking[0] = perf_counter(), 0.0
    early = min(FIRST, generations - 1)
    return {
        "memory": memory[-1],
        "early memory": memory[early],
        "own": median(own[-9:]),
        "early own": median(own[max(1, early - 4) : early + 5]),
    }


def _megabytes() -> float:
    statm = Path("/proc/self/statm")
    if statm.exists():
        return int(statm.read_text().split()[1]) * resource.getpagesize() / 1e6
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # elsewhere, the most that it ever was
    return peak / (1e6 if sys.platform == "darwin" else 1e3)


def look(path: Path) -> Figures:
    """Load a run, as one that nobody has looked at in this process, and draw it."""
    draw = wl.plots.fitness_curve  # whose import is not what is timed
    start = perf_counter()
    run = wl.load(path)
    records = run.records
    found = {"load": perf_counter() - start, "fetch": seconds(_fetch, path)}
    tenth = records[records.generation < max(1, run.n_generations // 10)]
    for name, table in (("curve", records), ("short curve", tenth)):
        found[name] = min(seconds(_save, draw, table, path.with_suffix(".svg")) for _ in range(2))
    found |= {"file": float(path.stat().st_size), "text": float(records.genome.str.len().sum())}
    known, children = Archive.of(path, records), wl.generate_robot_population(run.settings.robot, 1000, seed=99)
    texts = [str(genome) for genome in map(wl.Genome, children)]
    found["find"] = min(seconds(known.find, texts) for _ in range(3)) / len(texts)
    found["write"] = seconds(lambda: [str(genome) for genome in map(wl.Genome, children)]) / len(texts)
    return found | {name: seconds(work, run) for name, work in OTHERS.items()}


def _fetch(path: Path) -> None:
    db = sqlite3.connect(path)
    db.execute("SELECT * FROM records ORDER BY generation, rowid").fetchall()
    db.close()


def _save(draw, table: pd.DataFrame, path: Path) -> None:
    wl.plots.save(draw(table, paper(7, 4)), path)


OTHERS: dict[str, Callable[[wl.Run], object]] = {
    "champion": lambda run: run.champion,
    "repr": repr,
    "lineage": lambda run: run.lineage(run.champion.individual),
    "in a notebook": lambda run: run._repr_html_(),
    "trait": lambda run: wl.plots.trait(run.records, "weight", paper(7, 4)),
    "verdicts": lambda run: wl.plots.verdicts(run.records, paper(7, 4)),
    "diversity": lambda run: wl.plots.diversity(run.records, paper(7, 4)),
    "genes": lambda run: wl.plots.genes(run.records, paper(9, 5)),
    "family_tree": lambda run: wl.plots.family_tree(run.records, paper(7, 9)),
}
"""What else is asked of a long run, and should be there at once."""


def in_words(found: Figures) -> Iterator[str]:
    """Tell the absolute figures of one run."""
    yield f"{found['n']:,.0f} robots: {found['file'] / found['n']:.0f} bytes each in the file"
    yield f"loaded with its table in {found['load']:.2f} s; its curve drawn and saved in {found['curve']:.2f} s"
    grown = {kind: found[f"memory{kind}"] - found[f"early memory{kind}"] for kind in ("", " without")}
    yield f"memory since generation {FIRST}: {grown['']:+.0f} MB with a file, {grown[' without']:+.0f} MB without"
    yield (
        f"between two generations {1e3 * found['own']:.0f} ms ({1e3 * found['early own']:.0f} ms after generation "
        f"{FIRST}); {1e6 * found['find']:.1f} µs for a child to learn that nobody walked with its genome"
    )
    yield "; ".join(f"{name} {found[name]:.2f} s" for name in OTHERS)


def main() -> None:
    """Tell the figures of one run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--population", type=int, default=1000)
    parser.add_argument("--generations", type=int, default=200)
    given = parser.parse_args()
    for line in in_words(measure(given.population, given.generations)):
        print(line)


if __name__ == "__main__":
    main()
