"""Compare the walks of exported robots in several versions of MuJoCo with those in walkerlab.

    python benchmarks/mujoco_versions.py FOLDER [--champions 20] [--version 3.9.0 --version 3.14.0 ...] [--csv FILE]

This evolves small champions on flat ground and exports each of them on every ground. Each version of MuJoCo is
installed, without walkerlab, in a separate environment below FOLDER, and repeats the walk of each file for 4 s. The
table shows, for each version and ground, how many files load and how far their distances are from those of
``wl.simulate``.
"""

import argparse
import json
import subprocess
import sys
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
VERSIONS = [f"3.{minor}.0" for minor in range(9, 18)]
DURATION = 4.0  # s
WALK_SCRIPT = Path(__file__).with_name("plain_walk.py")


def export_champions(n_champions, folder):
    """Evolve and export champions; return a row for each file, with the distance of ``wl.simulate``."""
    rows: list[list[str]] = []
    for seed in range(n_champions):
        settings = wl.Settings().with_(
            population_size=12, generations=3, duration=2, seed=seed, fitness=list(wl.Fitness)[seed % len(wl.Fitness)]
        )
        champion = wl.evolve(settings, progress=False).champion.genome
        for ground, changes in GROUNDS.items():
            settings_on_ground = settings.with_(**changes, duration=DURATION)
            path = wl.export_mjcf(champion, settings_on_ground, folder, name=f"{seed} {ground}")
            distance = wl.simulate(champion, settings_on_ground, poses=False).distance
            rows.append({"file": str(path), "ground": ground, "seed": seed, "simulate": distance})
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
    parser.add_argument("--champions", type=int, default=20)
    parser.add_argument("--version", action="append", help="use this version only; may be repeated")
    parser.add_argument("--csv")
    arguments = parser.parse_args()

    files = export_champions(arguments.champions, arguments.folder / "files")
    tables: list[str] = []
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
