"""Compare runs that continue from flat ground to stairs with runs that start on stairs, at equal evaluations.

    python -m benchmarks.curriculum [--seeds 10] [--generations 25] [--population 60] [--switch 12] [--json FILE]

The staged run has one generation fewer, because its last generation on flat ground walks again on the stairs. The table
has the best fitness on stairs for each seed, the number of evaluations of both runs, and the medians. The lines below
it give the interval of the difference of the medians and the p-value of the paired test.
"""

import argparse
import json
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import walkerlab as wl
from walkerlab.evolution.forecast import n_walks
from walkerlab.system.files import write_text


def compare_seed(settings: wl.Settings, switch: int) -> dict[str, float]:
    """Return the best fitness on stairs of a run that starts there, and of one that continues from flat ground.

    Args:
        settings: Settings of the run that starts on stairs.
        switch: Number of generations on flat ground.
    """
    direct = wl.evolve(settings, progress=False)
    total = settings.algorithm.generations - 1
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.walk"
        wl.evolve(settings.with_(structure="flat", generations=switch), path, progress=False)
        staged = wl.resume(path, total, progress=False, structure="stairs")
        assert staged.rated_since == switch
        best = staged.champion.fitness
    size = settings.algorithm.population_size
    return {
        "seed": settings.algorithm.seed,
        "stairs only": direct.champion.fitness,
        "flat, then stairs": best,
        "evaluations of stairs only": n_walks(settings),
        "evaluations of flat, then stairs": n_walks(settings.with_(generations=total)) + size,
    }


def main() -> None:
    """Parse the arguments, run both kinds from each seed and print the table as Markdown."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--generations", type=int, default=25)
    parser.add_argument("--population", type=int, default=60)
    parser.add_argument("--switch", type=int, default=12)
    parser.add_argument("--duration", type=float, default=8.0)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    settings = wl.Settings().with_(
        structure="stairs",
        generations=arguments.generations,
        population_size=arguments.population,
        duration=arguments.duration,
    )
    rows: list[dict[str, float]] = []
    for seed in range(arguments.seeds):
        rows.append(compare_seed(settings.with_(seed=seed), arguments.switch))
        if seed == 0:
            print(f"| {' | '.join(rows[0])} |\n|{'---:|' * len(rows[0])}", flush=True)
        print(f"| {' | '.join(f'{value:.4g}' for value in rows[-1].values())} |", flush=True)
    medians = [median(row[name] for row in rows) for name in list(rows[0])[1:]]
    print(f"| median | {' | '.join(f'{value:.4g}' for value in medians)} |")
    staged, direct = ([row[name] for row in rows] for name in ("flat, then stairs", "stairs only"))
    low, high = wl.stats.difference_interval(staged, direct)
    print(f"\nflat, then stairs minus stairs only: {medians[1] - medians[0]:.3g} m, {low:.3g} to {high:.3g} m")
    print(f"p = {wl.stats.paired_test(staged, direct):.3f}, A12 = {wl.stats.effect_size(staged, direct):.2f}")
    if arguments.json:
        write_text(arguments.json, json.dumps(rows))


if __name__ == "__main__":
    main()
