"""Measure how much narrower the interval of a difference is if the runs of two conditions are paired by their seeds.

    python -m benchmarks.pairing --folder FOLDER [--seeds 10] [--scale 0.15]

Two conditions differ only in the scale of the mutation: runs with the same seed have the same first generation and
draw the same random numbers for selection. Both intervals are those of the difference of the medians of the best
distance so far, after several generations of the same runs. The file is ``FOLDER/pairing.walk``; the same command
continues it.
"""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd

import walkerlab as wl

GENERATIONS = (1, 2, 4, 8, 16, 24)
"""Generations after which the two conditions are compared."""


def best_so_far(records: pd.DataFrame, condition: str, generation: int) -> np.ndarray:
    """Return the best fitness [m] of each seed up to a generation, in the order of the seeds."""
    rows = records[(records.condition == condition) & (records.generation <= generation) & (records.verdict == "ok")]
    return rows.groupby("seed").fitness.max().sort_index().to_numpy()


def main() -> None:
    """Parse the arguments, run or continue the experiment, and print its result as a Markdown table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--scale", type=float, default=0.15)
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    settings = wl.Settings().with_(population_size=24, generations=max(GENERATIONS) + 1, duration=5)
    conditions = {"default": settings, "larger": settings.with_(mutation_scale=arguments.scale)}
    result = wl.compare(conditions, range(arguments.seeds), arguments.folder / "pairing.walk")
    print("| generation | difference [m] | paired [m] | unpaired [m] | ratio of widths | correlation of the seeds |")
    print("|---:|---:|---:|---:|---:|---:|")
    for generation in GENERATIONS:
        larger, default = (best_so_far(result.records, name, generation) for name in ("larger", "default"))
        paired = wl.stats.difference_interval(larger, default)
        unpaired = wl.stats.difference_interval(larger, default, paired=False)
        ratio = np.diff(paired)[0] / np.diff(unpaired)[0]
        intervals = [f"{low:.2f} to {high:.2f}" for low, high in (paired, unpaired)]
        correlation = np.corrcoef(larger, default)[0, 1]
        difference = np.median(larger) - np.median(default)
        print(f"| {generation} | {difference:.2f} | {' | '.join(intervals)} | {ratio:.2f} | {correlation:.2f} |")


if __name__ == "__main__":
    main()
