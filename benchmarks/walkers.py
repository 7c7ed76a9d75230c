"""Does it evolve walkers, or find them by luck? Champions of several seeds, on several grounds.

    python benchmarks/walkers.py [--seeds 5] [--generations 84] [--starts 1] [--ground NAME] [--csv FILE]

For each ground and seed: how far the champion of one evolution walks, how much of its fitness is left at a quarter of
the timestep and from other starts, how many walks did not count, and, on the flat, how far the best of equally many
random robots walks.
"""

import argparse
import math

import pandas as pd

import walkerlab as wl
from walkerlab.breeding import generate_robot_population
from walkerlab.world.heights import LANDING

GROUNDS = {
    "flat": wl.Terrain(),
    "incline": wl.Terrain(structure="incline", incline=10),
    "stairs": wl.Terrain(structure="stairs", step_height=0.08),
    "gravel, rocks": wl.Terrain(texture="gravel", texture_density=0.05, obstacle="rock"),
}


def try_out(ground, seed, given):
    """Evolve once, and measure the champion."""
    settings = wl.Settings(terrain=GROUNDS[ground]).with_(
        population_size=given.population_size, generations=given.generations, n_starts=given.starts, seed=seed
    )
    run = wl.evolve(settings, progress=False)
    n_evaluations = run.records.drop_duplicates("individual").shape[0]
    champion = wl.simulate(run.champion.genome, settings, poses=False)
    kept = run.confirm()
    distance, terrain = wl.fitness.distance(champion), settings.terrain
    row = {
        "ground": ground,
        "seed": seed,
        "evaluations": n_evaluations,
        "not counted": int((run.records.verdict != "ok").sum()),
        "verdicts": " ".join(f"{n} {verdict}" for verdict, n in run.records.verdict.value_counts().items()),
        "distance [m]": distance,
        "body lengths/s": wl.fitness.velocity(champion) / champion.phenotype.body_length,
        "kept at dt/4": kept.kept_finer,
        "kept from other starts": kept.kept_nudged,
        "poorest start": max(0.0, kept.nudged[0] / kept.fitness),
        "void again": ", ".join(verdict for verdict in kept.verdicts if verdict != "ok"),
        "along slope [m]": distance / math.cos(math.radians(terrain.incline)) if "incline" in ground else None,
        "stairs climbed": max(0, math.floor((champion.com[-1, 0] - LANDING) / terrain.step_depth) + 1)
        if "stairs" in ground
        else None,
    }
    if ground == "flat":
        strangers = generate_robot_population(settings.robot, n_evaluations, seed=1000 + seed)
        row["best random [m]"] = max(evaluation.fitness for evaluation in wl.evaluate(strangers, settings))
    return row


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--seeds", type=int, default=5)
    options.add_argument("--population-size", type=int, default=60)
    options.add_argument("--generations", type=int, default=84)
    options.add_argument("--starts", type=int, default=1, help="from how many starts every robot walks")
    options.add_argument("--ground", action="append", choices=list(GROUNDS), help="only this one; may be repeated")
    options.add_argument("--csv")
    given = options.parse_args()

    rows = []
    for ground in given.ground or GROUNDS:
        for seed in range(given.seeds):
            rows.append(try_out(ground, seed, given))
            print({name: round(v, 2) if isinstance(v, float) else v for name, v in rows[-1].items()}, flush=True)
    table = pd.DataFrame(rows)
    print("\nmedians\n", table.groupby("ground", sort=False).median(numeric_only=True).round(2).to_string())
    if given.csv:
        table.to_csv(given.csv, index=False)


if __name__ == "__main__":
    main()
