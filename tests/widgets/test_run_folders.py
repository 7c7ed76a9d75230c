"""Runs are kept in files of their own, found again, and told apart in words."""

import os

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.widgets.run_folders import best_of, new_file, run_files, told_apart


def test_a_file_of_a_new_run_is_nobodys(tmp_path):
    first = new_file(tmp_path)
    first.parent.mkdir()
    assert new_file(tmp_path).parent != first.parent


def test_where_no_run_is_kept_there_is_no_file(tmp_path):
    new_file(tmp_path).parent.mkdir()
    assert run_files(tmp_path) == run_files(tmp_path / "not there") == []


def test_run_files_come_newest_first(tmp_path):
    for age, name in enumerate(["b.walk", "a/run.walk", "c.walk"]):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
        os.utime(path, (1000 - age, 1000 - age))
    assert run_files(tmp_path) == [str(tmp_path / name) for name in ("b.walk", "a/run.walk", "c.walk")]


def test_a_link_to_nowhere_is_no_run_file(tmp_path):
    (tmp_path / "gone.walk").symlink_to(tmp_path / "nowhere")
    assert run_files(tmp_path) == []


@pytest.mark.parametrize(
    ("verdict", "fitness", "words"), [("ok", 2.5, "2.50 m"), ("too_fast", -np.inf, "no walk counted")]
)
def test_the_best_of_a_run_is_what_its_champion_has_reached_if_its_walk_counts(done, verdict, fitness, words):
    assert best_of(wl.Run(done.settings, done.records.assign(verdict=verdict, fitness=fitness))) == words


def test_the_best_of_a_run_that_has_just_begun_is_not_told(done):
    assert best_of(wl.Run(done.settings, done.records.iloc[:0])) == ""


def test_a_single_run_is_told_by_what_is_not_the_default():
    assert told_apart([wl.Settings().with_(generations=4, duration=1)]) == ["generations 4, duration 1 s"]


def test_many_differences_are_counted():
    many = wl.Settings().with_(population_size=6, generations=4, seed=1, n_elites=1, texture="ice", duration=1)
    [words] = told_apart([many])
    assert words.count(",") == 3
    assert words.endswith(" and 2 more")
