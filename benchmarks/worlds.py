"""What a world costs: the same walkers in each, against bare flat ground, taking turns within one run.

    python benchmarks/worlds.py [--walks 40] [--runs 5] [--csv FILE]

Prints, for each world, the median of the runs' ratios: 2 is twice the time for compiling and walking. One thread.
"""

import argparse
from statistics import median
from time import perf_counter

import pandas as pd

import walkerlab as wl
from walkerlab.algorithm import generate_robot_population
from walkerlab.layout import lay_out
from walkerlab.rollout import walk

BARE = {}
WORLDS = {
    "20 boxes": {"obstacle": "box", "obstacle_density": 20 / 90},
    "20 balls": {"obstacle": "ball", "obstacle_density": 20 / 90},
    "20 cylinders": {"obstacle": "cylinder", "obstacle_density": 20 / 90},
    "20 rocks": {"obstacle": "rock", "obstacle_density": 20 / 90},
    "20 logs": {"obstacle": "log", "obstacle_density": 20 / 90},
    "60 rocks": {"obstacle": "rock", "obstacle_density": 60 / 90},
    "2,000 pieces": {"texture": "gravel", "texture_density": 0.0525},
    "2,000 pieces, 20 rocks": {
        "texture": "gravel", "texture_density": 0.0525, "obstacle": "rock", "obstacle_density": 20 / 90,
    },
    "stairs": {"structure": "stairs"},
    "hills": {"structure": "rough"},
    "gaps": {"structure": "gaps"},
    "a pack": {"carry_weight": 2.0},
    "a sledge": {"drag_weight": 2.0},
    "wind": {"wind": (-3.0, 0.0, 0.0)},
}  # fmt: skip


def timed(genomes, settings):
    start = perf_counter()
    for genome in genomes:
        walk(wl.compile_scene(genome, settings), poses=False)
    return perf_counter() - start


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--walks", type=int, default=40)
    options.add_argument("--runs", type=int, default=5)
    options.add_argument("--csv")
    given = options.parse_args()

    bare = wl.Settings()
    genomes = [wl.Genome(values) for values in generate_robot_population(bare.robot, given.walks, seed=0)]
    timed(genomes, bare)  # has every body plan built
    rows = []
    for name, changes in WORLDS.items():
        world = bare.with_(**changes)
        timed(genomes, world)
        ratios = []
        for _ in range(given.runs):
            against = timed(genomes, bare)
            ratios.append(timed(genomes, world) / against)
        layout = lay_out(world.terrain)
        rows.append((name, len(layout.pieces), len(layout.obstacles), median(ratios), min(ratios), max(ratios)))
        print("{:24} {:5} pieces {:3} obstacles   {:.2f} × bare flat ground ({:.2f} to {:.2f})".format(*rows[-1]))
    if given.csv:
        columns = ["world", "pieces", "obstacles", "ratio", "least", "most"]
        pd.DataFrame(rows, columns=columns).to_csv(given.csv, index=False)


if __name__ == "__main__":
    main()
