"""The benchmarks run, and measure what they say; how fast anything is, no test asks."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from mujoco.rollout import rollout

import walkerlab as wl
from benchmarks import floor

ROOT = Path(floor.__file__).parents[1]


def test_one_command_prints_a_table_and_writes_it_as_csv(tmp_path):
    command = [sys.executable, "-m", "benchmarks", "--only", "floor", "--pairs", "1", "--csv", tmp_path / "table.csv"]
    few = os.environ | {"BENCHMARK_WALKS": "2"}
    done = subprocess.run(command, cwd=ROOT, env=few, capture_output=True, text=True, check=True)
    table = pd.read_csv(tmp_path / "table.csv")
    assert list(table) == ["benchmark", "case", "compared", "median", "least", "most", "pairs", "aim"]
    assert len(table) == len(floor.GROUNDS) + 1
    assert (table.least <= table["median"]).all()
    assert (table["median"] <= table.most).all()
    assert (table.least > 0).all()
    head, *lines = done.stdout.splitlines()
    assert head.split() == list(table)
    assert [line.split("  ")[0] for line in lines] == list(table.benchmark)


@pytest.mark.parametrize("ground", floor.GROUNDS)
def test_the_floor_steps_the_very_walk_that_is_evaluated(ground):
    settings = wl.Settings().with_(**floor.GROUNDS[ground])
    genome = wl.generate_robot_population(settings.robot, 1, seed=3)[0]
    walk = floor.prepare(genome, settings)
    walk()  # leaves nothing behind that would change the next
    models, (data,), state, controls = walk.args
    rollout(models, data, state, controls[:, :-1])  # what is recorded last is how the last step finds it
    np.testing.assert_array_equal(data.qpos, wl.simulate(genome, settings).poses[-1])
