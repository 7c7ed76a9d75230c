"""Measure how well champions walk, on several grounds and with several seeds, and whether their fitness is luck.

    python benchmarks/walkers.py [--seeds 5] [--generations 84] [--starts 1] [--ground NAME] [--csv FILE]

For each ground and seed, this reports how far the champion of one evolution walks, how much of its fitness remains at a
quarter of the timestep and from other starts, how many walks did not count, and, on flat ground, how far the best of
equally many random robots walks.
"""

import argparse
import math

import pandas as pd

import walkerlab as wl
from walkerlab.breeding import generate_robot_population
from walkerlab.world.heights import LANDING_LENGTH

GROUNDS = {
    "flat": wl.Terrain(),
    "incline": wl.Terrain(structure="incline", incline=10),
    "stairs": wl.Terrain(structure="stairs", step_height=0.08),
    "gravel, rocks": wl.Terrain(texture="gravel", texture_density=0.05, obstacle="rock"),
}


def measure_champion(ground, seed, arguments):
    """Evolve once and return a row of the table with the figures of the champion."""
    settings = wl.Settings(terrain=GROUNDS[ground]).with_(
        population_size=arguments.population_size,
        generations=arguments.generations,
        n_starts=arguments.starts,
        seed=seed,
    )
    run = wl.evolve(settings, progress=False)
    n_evaluations = run.records.drop_duplicates("individual").shape[0]
    champion = wl.simulate(run.champion.genome, settings, poses=False)
    confirmation = run.confirm()
    distance = wl.fitness.distance(champion)
    terrain = settings.terrain
    row = {
        "ground": ground,
        "seed": seed,
        "evaluations": n_evaluations,
        "not counted": int((run.records.verdict != "ok").sum()),
        "verdicts": " ".join(f"{n} {verdict}" for verdict, n in run.records.verdict.value_counts().items()),
        "distance [m]": distance,
        "body lengths/s": wl.fitness.velocity(champion) / champion.phenotype.body_length,
        "kept at dt/4": confirmation.kept_finer,
        "kept from other starts": confirmation.kept_nudged,
        "poorest start": max(0.0, confirmation.nudged[0] / confirmation.fitness),
        "not counted again": ", ".join(verdict for verdict in confirmation.verdicts if verdict != "ok"),
        "along slope [m]": distance / math.cos(math.radians(terrain.incline)) if "incline" in ground else None,
        "stairs climbed": max(0, math.floor((champion.com[-1, 0] - LANDING_LENGTH) / terrain.step_depth) + 1)
        if "stairs" in ground
        else None,
    }
    if ground == "flat":
        genomes = generate_robot_population(settings.robot, n_evaluations, seed=1000 + seed)
        row["best random [m]"] = max(evaluation.fitness for evaluation in wl.evaluate(genomes, settings))
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--population-size", type=int, default=60)
    parser.add_argument("--generations", type=int, default=84)
    parser.add_argument("--starts", type=int, default=1, help="number of starts of every robot")
    parser.add_argument(
        "--ground", action="append", choices=list(GROUNDS), help="use this ground only; may be repeated"
    )
    parser.add_argument("--csv")
    arguments = parser.parse_args()

    rows = []
    for ground in arguments.ground or GROUNDS:
        for seed in range(arguments.seeds):
            row = measure_champion(ground, seed, arguments)
            rows.append(row)
            rounded = {name: round(value, 2) if isinstance(value, float) else value for name, value in row.items()}
            print(rounded, flush=True)
    table = pd.DataFrame(rows)
    print("\nmedians\n", table.groupby("ground", sort=False).median(numeric_only=True).round(2).to_string())
    if arguments.csv:
        table.to_csv(arguments.csv, index=False)


if __name__ == "__main__":
    main()
