"""The notebooks in notebooks/beyond have short cells with questions, and do what they say, with small numbers."""

import itertools
import json
from concurrent.futures import ThreadPoolExecutor
from statistics import median

import numpy as np
import pytest

from benchmarks.beyond import FIGURES, FOLDER, run_notebook

NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
PACKAGES = {"cma_gait": "cma", "deap_operators": "deap", "map_elites": "ribs", "speed_and_energy": "pymoo"}
SMALL = {
    "cma_gait": {"generations": 2, "size": 6, "batches": 1},
    "deap_operators": {"generations": 2, "size": 8},
    "map_elites": {"evaluations": 40, "batch_size": 8},
    "speed_and_energy": {"generations": 2, "size": 12},
}


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_cells_are_short_and_follow_a_question(path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)
    lengths = [sum(1 for line in cell["source"] if line.strip()) for cell in code]
    assert median(lengths) <= 6
    assert max(lengths) <= 15
    for previous, cell in itertools.pairwise(cells):
        if cell["cell_type"] == "code":
            assert "?" in "".join(previous["source"])


@pytest.mark.parametrize("name", FIGURES)
def test_a_notebook_runs_with_small_numbers(name, monkeypatch):
    pytest.importorskip(PACKAGES[name], reason=f"{PACKAGES[name]}, of the extra ecosystem, is not installed")
    monkeypatch.setattr("walkerlab.simulation.evaluation.default_executor", lambda: executor)
    with ThreadPoolExecutor(1) as executor:
        found = run_notebook(name, **SMALL[name])
    assert np.isfinite([*FIGURES[name](found).values()]).all()
    assert SMALL[name].items() <= found.items()
    saved = found["problem"].save(optimiser=name, generation=4)  # a run, on which plots and replays work
    assert saved.champion.fitness == found["problem"].records.fitness.max()
