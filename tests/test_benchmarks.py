"""The benchmarks run and measure what they claim; no test depends on the speed of the computer."""

import sys

import numpy as np
import pandas as pd
import pytest
from mujoco.rollout import rollout

import walkerlab as wl
from benchmarks import floor, growth
from benchmarks.__main__ import main


def test_the_command_prints_a_table_and_writes_it_as_csv(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(floor, "N_WALKS", 2)
    monkeypatch.setattr(floor, "GROUNDS", {"flat": {}})
    command = ["benchmarks", "--only", "floor", "--pairs", "1", "--csv", str(tmp_path / "table.csv")]
    monkeypatch.setattr(sys, "argv", command)
    main()
    table = pd.read_csv(tmp_path / "table.csv")
    assert list(table) == ["benchmark", "case", "compared", "median", "least", "most", "pairs", "aim"]
    assert len(table) == len(floor.GROUNDS) + 1
    assert (table.least <= table["median"]).all()
    assert (table["median"] <= table.most).all()
    assert (table.least > 0).all()
    head, *lines = capsys.readouterr().out.splitlines()
    assert head.split() == list(table)
    assert [line.split("  ")[0] for line in lines] == list(table.benchmark)


@pytest.mark.parametrize("ground", floor.GROUNDS)
def test_the_floor_steps_the_same_walk_that_is_evaluated(ground):
    settings = wl.Settings().with_(**floor.GROUNDS[ground])
    genome = wl.generate_robot_population(settings.robot, 1, seed=3)[0]
    walk = floor.prepare_walk(genome, settings)
    walk()  # must not change the next call
    models, (data,), state, controls = walk.args
    rollout(models, data, state, controls[:, :-1])  # the last record precedes the last step
    np.testing.assert_array_equal(data.qpos, wl.simulate(genome, settings).poses[-1])


def test_the_figures_of_a_small_run_can_be_measured(monkeypatch, tmp_path):
    monkeypatch.setattr(growth, "OTHER_CALLS", {"repr": repr})
    monkeypatch.setattr("walkerlab.evolution.evolution.evaluate", None)  # restored after the test
    path = tmp_path / "run.walk"
    figures = growth.measure_evolution(path, 4, 2) | growth.measure_loading(path)
    assert min(figures.values()) > 0
