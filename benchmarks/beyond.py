"""Measure the notebooks in notebooks/beyond/ with several seeds: what each optimiser finds, as its notebook runs it.

    python -m benchmarks.beyond [--only cma_gait ...] [--seeds 5]

The code cells of a notebook are executed as they are, except that its parameters can be replaced.
"""

import argparse
import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt

FOLDER = Path(__file__).parents[1] / "notebooks" / "beyond"

Variables = dict[str, Any]
"""Variables of a notebook after its last cell, by name."""

FIGURES: Mapping[str, Callable[[Variables], dict[str, float]]] = {
    "cma_gait": lambda found: {
        "genes of the gait": found["problem"].n_genes,
        "evolution (m)": found["before"],
        "CMA-ES (m)": found["after"],
    },
    "deap_operators": lambda found: {
        "walks": found["problem"].n_evaluations,
        **{f"{name} (m)": champion.fitness.values[0] for name, (champion, _) in found["found"].items()},
    },
    "map_elites": lambda found: {
        "walks": found["problem"].n_evaluations,
        "filled cells (%)": 100 * len(found["archive"]) / found["archive"].cells,
        "best (m)": found["archive"].stats.obj_max,
        "mean of the cells (m)": found["archive"].stats.obj_mean,
    },
    "speed_and_energy": lambda found: {
        "walks": found["problem"].n_evaluations,
        "robots of the front": len(found["front"]),
        "slowest (m/s)": found["front"][0, 0],
        "its power (W)": found["front"][0, 1],
        "fastest (m/s)": found["front"][-1, 0],
        "its power (W) ": found["front"][-1, 1],
    },
}
"""Figures of each notebook, by its name."""


def run_notebook(name: str, **parameters: Any) -> Variables:
    """Execute the code cells of a notebook in this process.

    Args:
        name: Name of a notebook in ``notebooks/beyond``.
        **parameters: Values that replace those in the cell with the tag ``parameters``.

    Returns:
        Its variables.

    Raises:
        ValueError: If the notebook has no such parameter.
    """
    notebook = json.loads((FOLDER / f"{name}.ipynb").read_text(encoding="utf-8"))
    found: Variables = {"__name__": name}
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        exec(compile("".join(cell["source"]), f"{name}.ipynb, {cell['id']}", "exec"), found)
        if "parameters" in cell["metadata"].get("tags", []):
            if unknown := {*parameters} - {*found}:
                raise ValueError(f"{name} has no parameter {', '.join(sorted(unknown))}")
            found |= parameters
    return found


def main() -> None:
    """Run the notebooks with several seeds, and print a line for each."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.beyond", description="Measure notebooks/beyond.")
    parser.add_argument("--only", nargs="+", choices=[*FIGURES], default=[*FIGURES], help="notebooks")
    parser.add_argument("--seeds", type=int, default=5, help="number of seeds, from 1")
    options = parser.parse_args()
    mpl.use("agg")
    for name in options.only:
        for seed in range(1, options.seeds + 1):
            started = time.perf_counter()
            figures = FIGURES[name](run_notebook(name, seed=seed))
            plt.close("all")
            measured = ", ".join(f"{what.strip()} {value:.4g}" for what, value in figures.items())
            print(f"{name}, seed {seed}: {measured} ({time.perf_counter() - started:.0f} s)", flush=True)


if __name__ == "__main__":
    main()
