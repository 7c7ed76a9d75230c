"""Compare the models, walks and verdicts of a playground page with those of walkerlab.

    python -m benchmarks.playground [--robots 200] [--csv FILE]

Random robots walk on several grounds, once in ``wl.simulate`` and once with the scripts of a playground page, run by
Node instead of a browser. Each page contains the model of one robot only; its scripts set the sizes of all others.
The table shows, for each ground, the largest relative difference between the two compiled models, how many verdicts
are equal, and how far the centres of mass of the robots are apart after 1, 2 and 4 s.
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

import walkerlab as wl
from walkerlab.view.playground.payload import page_data, physics_script
from walkerlab.view.playground.vendor import FILES, decompressed_file

GROUNDS = {
    "flat": {},
    "stairs": {"structure": "stairs", "step_height": 0.05},
    "pack, sledge": {"carry_weight": 1, "drag_weight": 1},
}
TIMES = (1, 2, 4)  # s
WALK_SCRIPT = Path(__file__).with_name("playground_walks.mjs")
MIN_SCALE = 1e-3  # differences are relative to the largest value of an array, or to this if it is larger


def draw_genomes(n_robots, settings):
    rng = np.random.default_rng(settings.algorithm.seed)
    return [wl.Genome.random(settings.robot, rng=rng) for _ in range(n_robots)]


def walk_on_pages(tasks):
    """Return what ``playground_walks.mjs`` prints for each genome of each page."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / name for name in ("physics.js", *FILES, "tasks.json")]
        contents = [physics_script().encode(), *map(decompressed_file, FILES), json.dumps(tasks).encode()]
        for path, content in zip(paths, contents, strict=True):
            path.write_bytes(content)
        lines = subprocess.run(["node", WALK_SCRIPT, *paths], capture_output=True, text=True, check=True).stdout
    return list(map(json.loads, lines.splitlines()))


def compare_walk(genome, settings, page_walk):
    """Return a row with the differences between a walk in Python and on the page."""
    walk = wl.simulate(genome, settings, poses=False)
    model = wl.compile_scene(genome, settings).model
    errors = [
        np.abs(np.array(values) - getattr(model, name).ravel()).max(initial=0)
        / max(MIN_SCALE, np.abs(getattr(model, name)).max(initial=0))
        for name, values in page_walk["model"].items()
    ]
    com = np.array(page_walk["com"], dtype=float)
    row = {
        "model": max(errors),
        "verdict": page_walk["verdict"] == walk.verdict,
        "reason": page_walk["reason"] == walk.reason,
    }
    row |= {"python": walk.verdict, "page": page_walk["verdict"], "seconds": page_walk["seconds"]}
    for time in TIMES:
        at = int(np.searchsorted(walk.time, time))
        row[f"{time} s [mm]"] = 1000 * np.linalg.norm(com[at] - walk.com[at]) if at < len(com) else np.nan
    row["distance"] = abs(page_walk["distance"] - walk.distance) / max(1, abs(walk.distance))
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=200)
    parser.add_argument("--csv")
    arguments = parser.parse_args()
    rows: list[dict[str, object]] = []
    for ground, changes in GROUNDS.items():
        settings = wl.Settings().with_(**changes)
        genomes = draw_genomes(arguments.robots, settings)
        page = page_data(genomes[:1], settings)
        walks = walk_on_pages([{"page": page, "genomes": list(map(str, genomes))}])
        rows += [
            {"ground": ground} | compare_walk(*pair)
            for pair in zip(genomes, [settings] * len(genomes), walks, strict=True)
        ]
    table = pd.DataFrame(rows)
    figures = table.groupby("ground", sort=False).agg(
        robots=("model", "size"),
        **{"largest difference of models": ("model", "max"), "equal verdicts": ("verdict", "mean")},
        **{"equal reasons": ("reason", "mean"), "ms per walk": ("seconds", lambda seconds: 1000 * seconds.mean())},
        **{f"{time} s: 90 % below [mm]": (f"{time} s [mm]", lambda gap: gap.quantile(0.9)) for time in TIMES},
        **{f"{time} s: below 1 mm": (f"{time} s [mm]", lambda gap: (gap < 1).mean()) for time in TIMES},
    )
    print(figures.T.to_string(float_format="{:.3g}".format))
    print(table[~table.verdict].groupby(["python", "page"]).size().to_string())
    if arguments.csv:
        table.to_csv(arguments.csv, index=False)


if __name__ == "__main__":
    main()
