"""Compare the walks of exported robots in several versions of MuJoCo with those in walkerlab.

    python benchmarks/mujoco_versions.py FOLDER [--runs FOLDER] [--champions 20] [--version 3.9.0 ...] [--csv FILE]

This takes the champions of the run files below the folder ``--runs``, or evolves small ones on flat ground, and
exports each of them on every ground. Each version of MuJoCo is installed, without walkerlab, in a separate
environment below FOLDER, and repeats the walk of each file for 4 s. The table shows, for each version and ground, how
many files load and how far their distances are from those of ``wl.simulate``.
"""

import argparse
import json
import subprocess
import sys
from itertools import islice
from pathlib import Path

import pandas as pd

import walkerlab as wl

GROUNDS = {
    "flat": {},
    "incline": {"structure": "incline", "incline": 8},
    "stairs": {"structure": "stairs", "step_height": 0.05},
    "gravel, rocks": {"texture": "gravel", "obstacle": "rock"},
    "pack, sledge": {"carry_weight": 1, "drag_weight": 1},
}
# MuJoCo 3.11 replaced the midpoint integration of free bodies, such as a sledge, and added a criterion that ends
# Newton's method earlier; walks in 3.9 and 3.10 can therefore differ.
VERSIONS = [f"3.{minor}.0" for minor in range(9, 18)]
DURATION = 4.0  # s
WALK_SCRIPT = Path(__file__).with_name("plain_walk.py")


def evolve_champions(n_champions):
    """Yield the champions of small runs."""
    for seed in range(n_champions):
        fitness = list(wl.Fitness)[seed % len(wl.Fitness)]
        settings = wl.Settings().with_(population_size=12, generations=3, duration=2, seed=seed, fitness=fitness)
        yield wl.evolve(settings, progress=False).champion.genome


def read_champions(folder):
    """Yield the champions of all run files below a folder whose walks count, each genome once."""
    found = set()
    for path in sorted(folder.rglob("*.walk")):
        champion = wl.load(path).champion
        if champion.verdict == "ok" and str(champion.genome) not in found:
            found.add(str(champion.genome))
            yield champion.genome


def export_champions(champions, folder):
    """Export champions on every ground; return a row for each file, with the distance of ``wl.simulate``."""
    rows: list[dict[str, object]] = []
    for number, champion in enumerate(champions):
        for ground, changes in GROUNDS.items():
            settings = wl.Settings().with_(**changes, duration=DURATION)
            path = wl.export_mjcf(champion, settings, folder, name=f"{number} {ground}")
            walk = wl.simulate(champion, settings, poses=False)
            row = {"file": str(path), "ground": ground, "champion": number}
            rows.append(row | {"simulate": walk.distance, "verdict": walk.verdict})
    return pd.DataFrame(rows)


def install(version, folder):
    """Create an environment with a version of MuJoCo, unless it exists; return the path of its Python."""
    python = folder / version / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", folder / version], check=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", f"mujoco=={version}"], check=True)
    return python


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder for the files and the environments")
    parser.add_argument("--runs", type=Path, help="folder of run files whose champions are used")
    parser.add_argument("--champions", type=int, default=20)
    parser.add_argument("--version", action="append", help="use this version only; may be repeated")
    parser.add_argument("--csv")
    arguments = parser.parse_args()

    champions = read_champions(arguments.runs) if arguments.runs else evolve_champions(arguments.champions)
    files = export_champions(islice(champions, arguments.champions), arguments.folder / "files")
    tables: list[pd.DataFrame] = []
    for version in arguments.version or VERSIONS:
        command = [install(version, arguments.folder), WALK_SCRIPT, str(DURATION), *files.file]
        lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
        walked = files.merge(pd.DataFrame(map(json.loads, lines)).reindex(columns=["file", "distance", "error"]))
        tables.append(walked.assign(version=version, difference=(walked.distance - walked.simulate).abs()))
        for _, row in walked[walked.error.notna()].iterrows():
            print(f"{version}: {row.file}: {row.error}", flush=True)
    table = pd.concat(tables)
    figures = table.groupby(["version", "ground"], sort=False).difference.agg(
        **{"files": "size", "loaded": "count", "median [m]": "median", "largest [m]": "max"}
    )
    print(figures.to_string(float_format="{:.1e}".format))
    if arguments.csv:
        table.to_csv(arguments.csv, index=False)


if __name__ == "__main__":
    main()
