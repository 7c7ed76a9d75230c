"""Cost of a run as it grows, apart from the walks, which are replaced by a sum; all other steps are real.

    python -m benchmarks.growth [--population 1000] [--generations 200]

This prints the seconds, bytes and megabytes of one run. The limits are absolute, for 200,000 robots: a file of at
most 1.2 kB per robot; 3 s to load it with its table in a new process; 1 s to draw and save its fitness curve; at most
50 MB of growth between the tenth generation and the last; 50 µs to find out whether a child's genome has walked
before. The ratios divide each of these by a reference: the same rows fetched by sqlite3 alone, the text of the
genomes, the curve of a tenth of the run, the tenth generation, the conversion of a genome to text.
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
from benchmarks.timing import N_WALKS, print_note, time_call
from walkerlab.evolution import evolution
from walkerlab.runfile.archive import Archive
from walkerlab.simulation.evaluation import Evaluation
from walkerlab.view.plots.appearance import offscreen_axes

REFERENCE_GENERATION = 10  # by then everything that is built once has been built
FULL_N_WALKS = 120  # value of N_WALKS for which a run has 1000 robots per generation

Figures = dict[str, float]


def rows(n_pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield the cost of a run of 200 generations at its end, relative to the references."""
    runs = [measure(max(20, 1000 * N_WALKS // FULL_N_WALKS), 200) for _ in range(n_pairs)]
    for line in describe(runs[-1]):
        print_note(line)
    for case, compared, figure, reference in (
        ("load a run", "wl.load / sqlite3 fetching it", "load", "fetch"),
        ("file of a run", "bytes / genomes' text", "file", "text"),
        ("its fitness curve", "all / a tenth of it", "curve", "short curve"),
        ("memory, with a file", f"last / generation {REFERENCE_GENERATION}", "memory", "early memory"),
        (
            "memory, without a file",
            f"last / generation {REFERENCE_GENERATION}",
            "memory without",
            "early memory without",
        ),
        ("between two generations", f"last / generation {REFERENCE_GENERATION}", "overhead", "early overhead"),
        ("look up a genome", "look-up / conversion to text", "find", "write"),
    ):
        yield case, compared, [figures[figure] / figures[reference] for figures in runs]


def measure(population: int, generations: int) -> Figures:
    """Grow a run with a file and one without, and load the first; each step in a new process."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.walk"
        figures = run_in_new_process(measure_evolution, path, population, generations)
        without_file = run_in_new_process(measure_evolution, None, population, generations)
        figures |= {f"{name} without": without_file[name] for name in ("memory", "early memory")}
        return figures | run_in_new_process(measure_loading, path) | {"n": population * generations}


def run_in_new_process(function: Callable[..., Figures], *arguments: Any) -> Figures:
    """Call a function in a new process and return its result."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        return process.submit(function, *arguments).result()


# ------------------------------------------------------------------------------------------- in a new process


def fake_evaluation(values) -> Evaluation:
    """Return an evaluation without a walk, with values of the same kinds as those of real walks."""
    score = float(values[1] - values[2:].std())
    if values[3] % 1 > 0.02:
        fitness = score
        verdict = "ok"
        reason = ""
    else:
        fitness = -np.inf
        verdict = "airborne"
        reason = "no foot on the ground for 1.23 s"
    body = (int(values[0]), 4, float(values[3]), float(values[2]))
    return Evaluation(wl.Genome(values), fitness, verdict, reason, score * 8.123, score * 1.0173, *body)


def measure_evolution(path: Path | None, population: int, generations: int) -> Figures:
    """Evolve, and measure the memory [MB] and the time apart from the evaluations [s] at every generation."""
    evaluation_time = 0.0
    memory: list[float] = []
    overhead: list[float] = []

    def evaluate(genomes, *, on_done, **_):
        nonlocal evaluation_time
        start = perf_counter()
        evaluations = [fake_evaluation(values) for values in genomes]
        on_done(len(evaluations))
        evaluation_time += perf_counter() - start
        return evaluations

    evolution.evaluate = evaluate
    settings = wl.Settings().with_(population_size=population, generations=generations)
    start = perf_counter()
    for generation in wl.Evolution(settings, path):
        assert generation.champion  # read in every generation, as by a progress bar
        overhead.append(perf_counter() - start - evaluation_time)
        memory.append(_megabytes())
        start = perf_counter()
        evaluation_time = 0.0
    early = min(REFERENCE_GENERATION, generations - 1)
    return {
        "memory": memory[-1],
        "early memory": memory[early],
        "overhead": median(overhead[-9:]),
        "early overhead": median(overhead[max(1, early - 4) : early + 5]),
    }


def _megabytes() -> float:
    """Return the memory that this process uses [MB]; its peak where the current value is unknown."""
    statm = Path("/proc/self/statm")
    if statm.exists():
        return int(statm.read_text().split()[1]) * resource.getpagesize() / 1e6
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3)


def measure_loading(path: Path) -> Figures:
    """Load a run for the first time in this process, and draw it."""
    draw = wl.plots.fitness_curve  # imported here, so that the import is not timed
    start = perf_counter()
    run = wl.load(path)
    records = run.records
    figures = {"load": perf_counter() - start, "fetch": time_call(_fetch, path)}
    tenth = records[records.generation < max(1, run.n_generations // 10)]
    for name, table in (("curve", records), ("short curve", tenth)):
        figures[name] = min(time_call(_save, draw, table, path.with_suffix(".svg")) for _ in range(2))
    figures |= {"file": float(path.stat().st_size), "text": float(records.genome.str.len().sum())}
    archive = Archive.resume(path, records, run.settings.model_dump())
    children = wl.generate_robot_population(run.settings.robot, 1000, seed=99)
    texts = [str(genome) for genome in map(wl.Genome, children)]
    figures["find"] = min(time_call(archive.find, texts) for _ in range(3)) / len(texts)
    figures["write"] = time_call(lambda: [str(genome) for genome in map(wl.Genome, children)]) / len(texts)
    return figures | {name: time_call(function, run) for name, function in OTHER_CALLS.items()}


def _fetch(path: Path) -> None:
    db = sqlite3.connect(path)
    db.execute("SELECT * FROM records ORDER BY generation, rowid").fetchall()
    db.close()


def _save(draw, table: pd.DataFrame, path: Path) -> None:
    wl.plots.save(draw(table, offscreen_axes(7, 4)), path)


OTHER_CALLS: dict[str, Callable[[wl.Run], object]] = {
    "champion": lambda run: run.champion,
    "repr": repr,
    "lineage": lambda run: run.lineage(run.champion.individual),
    "in a notebook": lambda run: run._repr_html_(),
    "trait": lambda run: wl.plots.trait(run.records, "weight", offscreen_axes(7, 4)),
    "verdicts": lambda run: wl.plots.verdicts(run.records, offscreen_axes(7, 4)),
    "diversity": lambda run: wl.plots.diversity(run.records, offscreen_axes(7, 4)),
    "genes": lambda run: wl.plots.genes(run.records, offscreen_axes(9, 5)),
    "family_tree": lambda run: wl.plots.family_tree(run.records, offscreen_axes(7, 9)),
}
"""Other calls on a long run that should return quickly; their absolute times are printed."""


def describe(figures: Figures) -> Iterator[str]:
    """Yield lines of text with the absolute figures of one run."""
    yield f"{figures['n']:,.0f} robots: {figures['file'] / figures['n']:.0f} bytes each in the file"
    yield f"loaded with its table in {figures['load']:.2f} s; its curve drawn and saved in {figures['curve']:.2f} s"
    with_file = figures["memory"] - figures["early memory"]
    without_file = figures["memory without"] - figures["early memory without"]
    yield (
        f"memory since generation {REFERENCE_GENERATION}: {with_file:+.0f} MB with a file, "
        f"{without_file:+.0f} MB without"
    )
    yield (
        f"between two generations {1e3 * figures['overhead']:.0f} ms ({1e3 * figures['early overhead']:.0f} ms after "
        f"generation {REFERENCE_GENERATION}); {1e6 * figures['find']:.1f} µs to find out whether a genome has walked"
    )
    yield "; ".join(f"{name} {figures[name]:.2f} s" for name in OTHER_CALLS)


def main() -> None:
    """Print the figures of one run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--population", type=int, default=1000)
    parser.add_argument("--generations", type=int, default=200)
    arguments = parser.parse_args()
    for line in describe(measure(arguments.population, arguments.generations)):
        print(line)


if __name__ == "__main__":
    main()
