"""The robot area shows one robot; a robot that is watched or edited stays."""

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.view.replay.page import Frame
from walkerlab.widgets.robot import RobotArea


@pytest.fixture
def area(done):
    return RobotArea(done.settings, lambda _: "Inserted.")


@pytest.fixture
def early(done):
    """The same run with its worst robot only."""
    worst = done.records.sort_values("fitness").individual.iloc[0]
    return wl.Run(done.settings, done.records[done.records.individual == worst])


def test_the_champion_is_replaced_by_a_better_one(area, early, done):
    for run in (early, done):
        area.show(run, -1)
        assert f"Robot {run.champion.individual}, the champion so far" in area.card.value
        assert area.editor.genome == run.champion.genome


def test_a_champion_that_is_watched_stays(area, early, done):
    area.show(early, -1)
    before = area.card.value
    area.frame.is_open = True
    area.show(done, -1)
    assert area.card.value == before


def test_a_gene_that_is_edited_stays_until_a_robot_is_selected(area, early, done):
    area.show(early, -1)
    area.editor.text = edited = str(wl.Genome.random(done.settings.robot, rng=np.random.default_rng(3)))
    area.show(done, -1)
    assert area.editor.text == edited
    area.show(done, done.champion.individual)
    assert area.editor.genome == done.champion.genome


def test_selecting_the_champion_restores_its_edited_gene(area, done):
    area.show(done, -1)
    area.editor.text = "invalid text"
    area.show(done, done.champion.individual)
    assert area.editor.genome == done.champion.genome


def test_the_edited_gene_of_a_selected_robot_stays(area, early, done):
    elite = early.champion.individual
    area.show(early, elite)
    area.editor.text = edited = str(done.champion.genome)
    area.show(done, elite)
    assert area.editor.text == edited


def test_a_run_in_another_world_is_shown_even_if_a_robot_is_watched(area, done):
    area.show(done, -1)
    area.frame.is_open = True
    moon = wl.Run(done.settings.with_(gravity="moon"), done.records)
    area.show(moon, -1)
    assert area.editor.settings == area.frame._make().settings == moon.settings


def test_an_edited_gene_is_played(area, monkeypatch):
    sent = []
    monkeypatch.setattr(Frame, "send", lambda _, message: sent.append(message))
    area.editor._handle_custom_msg({"press": "walk"}, [])
    assert sent == [{"play": True}]
    assert "genome in the editor" in area.frame.alt


def test_the_result_of_an_insertion_is_shown_below_the_gene(area):
    area.editor._handle_custom_msg({"press": "insert"}, [])
    assert area.editor.notes == ["Inserted."]


def test_before_a_run_a_random_robot_can_be_watched(area):
    assert "random" in area.card.value
    assert area.frame._make().walks[0].scene.genome == area.editor.genome
