"""Measure how far selection, takeover, OneMax and the Price equation are from theory, over several seeds.

``python -m benchmarks.theory`` prints a row for each quantity, and fails if an error exceeds its limit. The Price
equation is tested on real runs, with elites and walks that do not count.
"""

import math
import sys
from functools import partial

import numpy as np
import pandas as pd

import walkerlab as wl
from walkerlab.ga.selection import tournament

SEEDS = range(5)
SELECTIONS = {"tournament of 2": partial(tournament, size=2), "tournament of 5": partial(tournament, size=5)}
SELECTIONS |= {"top_half": "top_half"}
KNOWN = {
    "tournament of 2": {"intensity": 0.5642, "loss_of_diversity": 0.25, "unselected": 0.4323},
    "tournament of 5": {"intensity": 1.1630, "loss_of_diversity": 0.5350, "unselected": 0.6058},
    "top_half": {"intensity": 0.7979, "loss_of_diversity": 0.5, "unselected": 0.5},
}
"""Values in the literature: order statistics of normal numbers, and Blickle & Thiele 1996."""


def main() -> int:
    """Print the table; return 1 if an error exceeds its limit."""
    table = pd.DataFrame([*selection_rows(), *onemax_rows(), *takeover_rows(), *price_rows()])
    table["ok"] = table.worst_error <= table.limit
    print(table.to_string(index=False, float_format=lambda number: f"{number:.4g}"))
    return int(not table.ok.all())


def row(what, measured, theory, errors, limit):
    """Return one row: the mean over the seeds, theory, and the largest error of a seed."""
    return {"what": what, "measured": np.mean(measured), "theory": theory, "worst_error": max(errors), "limit": limit}


def selection_rows():
    tables = [wl.analysis.measure_selection(SELECTIONS, n_populations=100, seed=seed) for seed in SEEDS]
    for name, values in KNOWN.items():
        for measure, theory in values.items():
            measured = [
                table[(table.selection == name) & (table.measure == measure)].measured.item() for table in tables
            ]
            yield row(f"{name}: {measure}", measured, theory, [abs(each / theory - 1) for each in measured], 0.03)


def onemax_rows():
    table = wl.analysis.evolve_onemax(SELECTIONS, seeds=SEEDS)
    last = table.groupby(["selection", "seed"]).generation.max()
    for name in SELECTIONS:
        theory = math.pi / 2 * math.sqrt(100) / KNOWN[name]["intensity"]
        yield row(f"OneMax, {name}: generations", last[name], theory, [abs(last[name].mean() / theory - 1)], 0.1)


def takeover_rows():
    lengths = [wl.analysis.follow_takeover("top_half", n_trials=3, seed=seed).generation.max() for seed in SEEDS]
    yield row("top_half: takeover of 100", lengths, 7, [abs(length - 7) for length in lengths], 0)


def price_rows():
    errors, counted = [], []
    for seed in SEEDS:
        settings = wl.Settings().with_(seed=seed, population_size=30, generations=15, duration=2, mutation="macro")
        run = wl.evolve(settings, progress=False)
        split = wl.analysis.price_equation(run)
        terms = split[["selection", "failed_walks", "variation", "insertion"]].sum(axis=1)
        table = run.records
        means = table[table.verdict == "ok"].groupby("generation").fitness.mean()
        errors += [*abs(terms - np.diff(means))]
        counted.append((table.verdict == "ok").mean())
    assert min(counted) < 1, "every walk counts, so walks that do not count are not tested"
    yield row(f"Price equation: {len(errors)} generations", errors, 0, errors, 1e-9)


if __name__ == "__main__":
    sys.exit(main())
