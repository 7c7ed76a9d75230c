"""One robot at a time is looked at, and what somebody watches or edits is not taken away."""

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.view.replay.page import Frame
from walkerlab.widgets.robot import RobotRoom


@pytest.fixture
def room(done):
    return RobotRoom(done.settings, lambda _: "It will be in generation 7.")


@pytest.fixture
def early(done):
    """The same run when it had one robot, and not its best."""
    worst = done.records.sort_values("fitness").individual.iloc[0]
    return wl.Run(done.settings, done.records[done.records.individual == worst])


def test_the_champion_makes_way_for_a_better_one(room, early, done):
    for run in (early, done):
        room.show(run, -1)
        assert f"Robot {run.champion.individual}, the champion so far" in room.card.value
        assert room.editor.genome == run.champion.genome


def test_a_champion_that_is_watched_stays(room, early, done):
    room.show(early, -1)
    before = room.card.value
    room.frame.is_open = True
    room.show(done, -1)
    assert room.card.value == before


def test_a_gene_that_is_edited_stays_until_a_robot_is_selected(room, early, done):
    room.show(early, -1)
    room.editor.text = edited = str(wl.Genome.random(done.settings.robot, rng=np.random.default_rng(3)))
    room.show(done, -1)
    assert room.editor.text == edited
    room.show(done, done.champion.individual)
    assert room.editor.genome == done.champion.genome


def test_picked_the_champion_whose_gene_was_edited_is_as_it_was(room, done):
    room.show(done, -1)
    room.editor.text = "a slip of the hand"
    room.show(done, done.champion.individual)
    assert room.editor.genome == done.champion.genome


def test_a_robot_that_stays_selected_keeps_what_is_edited(room, early, done):
    elite = early.champion.individual
    room.show(early, elite)
    room.editor.text = edited = str(done.champion.genome)
    room.show(done, elite)
    assert room.editor.text == edited


def test_a_run_in_another_world_is_shown_though_one_is_watched_and_genes_walk_in_it(room, done):
    room.show(done, -1)
    room.frame.is_open = True
    moon = wl.Run(done.settings.with_(gravity="moon"), done.records)
    room.show(moon, -1)
    assert room.editor.settings == room.frame._make().settings == moon.settings


def test_an_edited_gene_is_played(room, monkeypatch):
    sent = []
    monkeypatch.setattr(Frame, "send", lambda _, message: sent.append(message))
    room.editor._handle_custom_msg({"press": "walk"}, [])
    assert sent == [{"play": True}]
    assert "gene in the editor" in room.frame.alt


def test_what_became_of_a_gene_that_was_put_in_stands_below_it(room):
    room.editor._handle_custom_msg({"press": "insert"}, [])
    assert room.editor.notes == ["It will be in generation 7."]


def test_before_anybody_has_walked_a_robot_of_chance_can_be_watched(room):
    assert "drawn by chance" in room.card.value
    assert room.frame._make().walks[0].scene.genome == room.editor.genome
