"""Every run has its own file; files are found again, and differences between runs are described."""

import os

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.widgets.panel.run_folders import (
    best_result,
    describe_differences,
    find_run_files,
    new_run_path,
    run_name,
)


def test_a_new_run_has_a_new_folder(tmp_path):
    first = new_run_path(tmp_path)
    first.parent.mkdir()
    assert new_run_path(tmp_path).parent != first.parent


def test_folders_without_runs_have_no_run_files(tmp_path):
    new_run_path(tmp_path).parent.mkdir()
    assert find_run_files(tmp_path) == find_run_files(tmp_path / "not there") == []


def test_run_files_are_listed_newest_first(tmp_path):
    for age, name in enumerate(["b.walk", "a/run.walk", "c.walk"]):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
        os.utime(path, (1000 - age, 1000 - age))
    assert find_run_files(tmp_path) == [str(tmp_path / name) for name in ("b.walk", "a/run.walk", "c.walk")]


def test_a_broken_link_is_not_a_run_file(tmp_path):
    (tmp_path / "gone.walk").symlink_to(tmp_path / "nowhere")
    assert find_run_files(tmp_path) == []


@pytest.mark.parametrize(
    ("verdict", "fitness", "words"), [("ok", 2.5, "2.50 m"), ("too_fast", -np.inf, "no walk counted")]
)
def test_the_best_result_is_the_fitness_of_the_champion_if_its_walk_counts(done, verdict, fitness, words):
    assert best_result(wl.Run(done.settings, done.records.assign(verdict=verdict, fitness=fitness))) == words


def test_a_run_without_generations_has_no_best_result(done):
    assert best_result(wl.Run(done.settings, done.records.iloc[:0])) == ""


def test_a_single_run_is_described_by_its_differences_from_the_defaults():
    assert describe_differences([wl.Settings().with_(generations=4, duration=1)]) == ["generations 4, duration 1 s"]


def test_the_description_of_many_differences_is_shortened():
    many = wl.Settings().with_(population_size=6, generations=4, seed=1, n_elites=1, texture="ice", duration=1)
    [words] = describe_differences([many])
    assert words.count(",") == 3
    assert words.endswith(" and 2 more")


@pytest.mark.parametrize(("folder", "name"), [
    ("2026-11-30-024936", "30 Nov, 02:49:36"),
    ("2026-11-30-024936-2", "30 Nov, 02:49:36-2"),
    ("moon", "moon"),
])  # fmt: skip
def test_a_run_is_named_after_the_time_in_the_name_of_its_folder(folder, name, tmp_path):
    assert run_name(tmp_path / folder / "run.walk") == name
