"""A picture shows the numbers of the table, and says what they are."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import walkerlab as wl
from walkerlab.records import COLUMNS, join, tidy


def made_up(n=8, seed=0):
    rng = np.random.default_rng(seed)
    rows = pd.DataFrame(
        [(g, i, g, "", "random", rng.normal(g), "ok" if i else "airborne") for g in range(5) for i in range(n)],
        columns=list(COLUMNS)[:7],
    )
    rows.loc[rows.verdict != "ok", "fitness"] = -np.inf
    table = rows.assign(distance=0.0, velocity=0.0, n_segments=1, n_legs=2, weight=1.0, body_length=1.0, genome="")
    return tidy(table)


@pytest.fixture
def ax():
    return Figure().add_subplot()


def test_the_curve_is_best_median_and_quartiles_of_the_walks_that_count(ax):
    records = made_up()
    wl.plots.fitness_curve(records, ax)
    lines = {line.get_label(): line.get_ydata() for line in ax.lines}
    for generation in range(5):
        counted = records[(records.generation == generation) & (records.verdict == "ok")].fitness
        assert lines["best"][generation] == pytest.approx(max(counted))
        assert lines["median"][generation] == pytest.approx(np.median(counted))
    assert ax.get_xlabel() == "generation"


def test_axes_bear_the_name_and_unit_of_the_fitness(ax):
    run = wl.Run(wl.Settings(), made_up())
    wl.plots.fitness_curve(run.records, ax)
    assert ax.get_ylabel() == "distance [m]"


def test_several_runs_on_one_axes_can_be_told_apart(ax):
    for i, label in enumerate(("gentle", "harsh")):
        wl.plots.fitness_curve(made_up(seed=i), ax, label=label)
    best = [line for line in ax.lines if line.get_label().endswith("best")]
    assert [line.get_label() for line in best] == ["gentle: best", "harsh: best"]
    assert best[0].get_color() != best[1].get_color()


def test_text_stays_text_in_svg(ax, tmp_path):
    wl.plots.fitness_curve(made_up(), ax)
    wl.plots.save(ax, tmp_path / "a.svg", tmp_path / "a.png")
    assert "generation</text>" in (tmp_path / "a.svg").read_text()
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_a_table_without_rows_is_drawn_as_an_empty_picture(ax):
    wl.plots.fitness_curve(join([]), ax)
