"""The robot area shows one robot; a robot that is watched or edited stays."""

import base64
import threading

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.view.replay.page import Frame
from walkerlab.widgets.outcomes import compare_outcomes, recorded_outcome, simulate_outcome
from walkerlab.widgets.panel.robot import RobotArea


def decode(url):
    """Return the text of a data URL."""
    return base64.b64decode(url.partition("base64,")[2]).decode()


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


def test_a_robot_can_be_played_as_soon_as_it_is_described(area, done):
    area.card.observe(lambda _: area.frame.play(), "value")
    area.show(done, -1)
    assert area.frame.is_watched


def test_a_champion_that_is_watched_stays(area, early, done):
    area.show(early, -1)
    before = area.editor.genome
    area.frame.is_open = True
    area.show(done, -1)
    assert area.editor.genome == before


def test_a_watched_robot_is_no_longer_called_the_champion_when_a_better_one_is_found(area, early, done):
    area.show(early, -1)
    number = early.champion.individual
    assert f"Robot {number}, the champion so far" in area.card.value
    area.frame.is_open = True
    area.show(done, -1)
    assert f"Robot {number}" in area.card.value
    assert "the champion so far" not in area.card.value


def test_a_champion_that_is_watched_stays_when_it_is_selected(area, done):
    area.show(done, -1)
    area.frame.play()
    area.show(done, done.champion.individual)
    assert area.frame.is_watched


def test_a_robot_is_played_after_it_is_shown_completely(area, done):
    """The button is pressed on another thread while the drawing thread shows a robot."""
    pressed = threading.Thread(target=area.editor._handle_message, args=(None, {"press": "walk"}, []))

    def press(_):
        pressed.start()
        pressed.join(0.5)  # long enough for an action that does not wait

    area.editor.observe(press, "original")
    area.show(done, -1)
    pressed.join()
    assert area.frame.is_watched


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


def test_an_edited_robot_stays_when_its_run_is_continued(area, done):
    area.show(done, -1)
    area.editor._set_gene(1, 0.75)
    edited = area.editor.text
    area.editor.report = "The genome will be in generation 4."
    longer = wl.Run(done.settings.with_(generations=done.n_generations + 5), done.records)
    area.show(longer, -1)
    assert (area.editor.text, area.editor.report) == (edited, "The genome will be in generation 4.")
    area.show(wl.Run(longer.settings.with_(seed=7), done.records), -1)
    assert area.editor.text != edited, "another run"


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
    assert sent == [{"play": True, "reveal": True}]
    assert "the random robot" in area.frame.alt


def test_an_edited_gene_shows_its_distance_beside_the_old_one(area, done):
    number = done.records.individual[done.records.verdict != "fragile"].iloc[-1]  # a verdict of several walks
    area.show(done, number)
    area.editor._handle_custom_msg({"gene": 1, "value": 0.7}, [])
    area.editor._handle_custom_msg({"press": "try"}, [])
    row = done.records.set_index("individual").loc[number]
    assert recorded_outcome(row, done.settings) == simulate_outcome(wl.Genome.parse(row.genome), done.settings)
    after = simulate_outcome(area.editor.genome, done.settings)
    assert area.editor.result == compare_outcomes(after, recorded_outcome(row, done.settings))
    labels = [walk.label for walk in area.frame._make().walks]
    champion = done.champion.individual
    assert labels == [f"edited robot {number}", f"robot {number}"] + (
        [f"robot {champion}, the champion"] if champion != number else []
    )


def test_a_watched_replay_is_replaced_after_an_edit(area, done, monkeypatch):
    sent = []
    monkeypatch.setattr(Frame, "send", lambda _, message: sent.append(message))
    area.show(done, -1)
    for is_open, n_plays in ((False, 0), (True, 1), (False, 2)):  # in the last case, the page is still being created
        area.frame.is_open = is_open
        area.editor._handle_custom_msg({"press": "try"}, [])
        assert len(sent) == n_plays


def test_the_picture_names_the_robot_that_it_shows(area, done):
    number = done.champion.individual
    area.show(done, number)
    assert f">robot {number} of generation {done.champion.generation}<" in decode(area.frame.preview)
    area.editor._set_gene(1, 0.75)
    area.editor._handle_message(None, {"press": "try"}, [])
    assert f">edited robot {number}<" in decode(area.frame.preview)


def test_an_edited_robot_that_is_replaced_can_be_shown_again(area, done):
    first, second = done.records.individual.iloc[:2].tolist()
    area.show(done, first)
    area.editor._set_gene(1, 0.75)
    edited = area.editor.text
    area.show(done, second)
    assert area.editor.replaced == f"robot {first}"
    area.editor._handle_message(None, {"press": "restore"}, [])
    assert (area.editor.text, area.editor.replaced) == (edited, "")
    assert f"Robot {first}" in area.card.value
    assert f"Robot {first}, before your changes" in area.card.value
    area.show(done, -1)
    assert area.editor.text == edited, "the champion does not replace an edited robot"
    other = wl.Run(done.settings.with_(wind=(1, 0, 0)), done.records)
    area.show(other, -1)
    assert area.editor.replaced == f"robot {first}", "but another run does"
    area.editor._undo()
    assert not area.editor.is_edited


def test_continuing_is_offered_only_with_a_function(done):
    assert "continue" not in RobotArea(done.settings, lambda _: "").editor.buttons
    area = RobotArea(done.settings, lambda _: "", lambda genome: f"Continued with {genome.n_parts}.")
    area.editor._handle_custom_msg({"press": "continue"}, [])
    assert area.editor.report == f"Continued with {area.editor.genome.n_parts}."


def test_the_result_of_an_insertion_is_shown_until_the_genome_changes(area):
    area.editor._handle_custom_msg({"press": "insert"}, [])
    assert area.editor.report == "Inserted."
    area.editor._set_gene(1, 1.25)
    assert area.editor.report == ""


def test_before_a_run_a_random_robot_can_be_watched(area):
    assert "random" in area.card.value
    assert area.frame._make().walks[0].scene.genome == area.editor.genome


def test_a_live_robot_and_the_editor_are_synchronised_until_another_robot_is_shown(area, done):
    area.show(done, -1)
    area.editor._handle_message(None, {"press": "live"}, [])
    [live] = area.live.children
    assert live.genome == area.editor.genome
    area.editor._set_gene(1, 1.25)
    assert live.genome == area.editor.genome
    other = wl.Genome.random(done.settings.robot, rng=np.random.default_rng(4)).within(done.settings.robot)
    live.gene_text = str(other)
    assert area.editor.genome == other
    live.gene_text = "wl2 segments="  # not yet complete
    assert area.editor.genome == other
    live.is_open = True
    area.editor._undo()
    area.show(done, -1)
    assert area.live.children, "a robot that is watched stays"
    area.show(done, int(done.records.individual.iloc[0]))
    assert not area.live.children
    assert live.comm is None


def test_a_live_robot_has_the_name_of_the_edited_robot_and_is_removed_when_it_is_closed(area, done):
    area.show(done, -1)
    area.editor._set_gene(1, 1.25)
    area.editor._handle_message(None, {"press": "live"}, [])
    [live] = area.live.children
    assert "edited robot" in live.alt
    live.is_open = True
    live.is_open = False
    assert not area.live.children
