"""The panel does what its buttons say; how it looks and feels is tested in a browser."""

import sqlite3
import threading
import time

import ipywidgets
import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.evolution.live import LiveRun, State
from walkerlab.text.numbers import with_unit
from walkerlab.view.report.code import as_python
from walkerlab.widgets.card import card

SMALL = wl.Settings().with_(population_size=6, generations=4, duration=1)
LONG = SMALL.with_(population_size=100, generations=1000)
PATIENCE = 60  # s


def until(holds):
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.fixture
def lab(pool, tmp_path):
    panel = wl.Lab(SMALL, tmp_path / "lab", executor=pool)
    yield panel
    panel.close()


def press(lab, button):
    lab.transport._hear(lab.transport, {"press": button}, [])


def step(lab):
    """Let one generation walk, and wait for it."""
    before = lab.transport.words
    press(lab, "step")
    until(lambda: lab.transport.state == "paused" and lab.transport.words != before)


def load(lab, path):
    lab.runs.drawer._hear(lab.runs.drawer, {"load": str(path)}, [])


def put_in(lab):
    """Put the gene in the editor into the next generation; return what is said of that."""
    lab.robot.editor._hear(lab.robot.editor, {"press": "insert"}, [])
    [words] = lab.robot.editor.notes
    return words


def drawn(lab):
    """Wait until everything that was ordered is drawn."""
    done = []
    lab._desk.order("test", lambda: done.append(True))
    until(lambda: done)


def test_a_run_goes_from_start_to_end_and_is_kept(lab, pool):
    press(lab, "start")
    until(lambda: lab.transport.state == "finished")
    drawn(lab)
    alone = wl.evolve(SMALL, executor=pool, progress=False)
    pd.testing.assert_frame_equal(lab.run.records, alone.records)
    pd.testing.assert_frame_equal(wl.load(lab.run.path).records, alone.records)
    [entry] = lab.runs.shelf.runs
    assert (entry["key"], entry["state"]) == ("run 1", "finished")
    assert with_unit(alone.champion.fitness, "m") == entry["best"]
    assert f"Robot {alone.champion.individual}" in lab.robot.card.value
    assert "<svg" in lab.runs.curve.value
    assert lab.transport.share == 1


def test_workers_that_were_lost_are_told_of(lab, monkeypatch):
    monkeypatch.setattr(LiveRun, "note", "One was killed.")
    step(lab)
    assert lab.runs.drawer.words == "One was killed."


def test_nothing_happens_before_a_button_is_pressed(lab, tmp_path):
    drawn(lab)
    assert lab.run is None
    assert not (tmp_path / "lab").exists()
    assert "on this computer" in lab.transport.forecast


def test_steps_pauses_and_stops(lab):
    press(lab, "step")
    until(lambda: lab.transport.state == "paused")
    assert lab.run.n_generations == 1
    press(lab, "step")
    until(lambda: lab.transport.state == "paused" and lab.run.n_generations == 2)
    press(lab, "stop")
    until(lambda: lab.transport.state == "stopped")
    assert lab.run.n_generations == 2
    press(lab, "go_on")
    press(lab, "pause")
    assert lab.transport.state == "stopped"


def test_what_cannot_be_is_explained_and_does_not_start(lab):
    lab.form.values = {**lab.form.values, "algorithm": {**lab.form.values["algorithm"], "n_elites": 6}}
    assert lab.settings is None
    assert "Elites is 6" in lab.transport.fault
    press(lab, "start")
    assert lab.run is None
    lab.settings = SMALL
    assert not lab.transport.fault


@pytest.mark.parametrize("nonsense", [None, "start", {}, {"press": "fly"}, {"press": None}, [1]])
def test_nonsense_from_a_browser_does_nothing(lab, nonsense):
    for piece in (lab.transport, lab.runs.drawer):
        piece._hear(piece, nonsense, [])
    assert lab.run is None


def test_runs_are_told_apart_and_one_that_is_dropped_is_gone(lab):
    for mutation in ("micro", "macro"):
        lab.settings = SMALL.with_(mutation=mutation, generations=1)
        press(lab, "start")
        until(lambda: lab.transport.state == "finished")
    drawn(lab)
    assert [entry["differs"] for entry in lab.runs.shelf.runs] == ["mutation micro", "mutation macro"]
    assert lab.runs.shelf.selected == "run 2"
    assert "Run 1: distance" in lab.runs.curve.value
    lab.runs.shelf.drop("run 2")
    drawn(lab)
    assert lab.runs.shelf.selected == "run 1"
    assert lab.run.settings.algorithm.mutation == wl.Mutation.micro


def test_a_robot_is_selected_edited_and_put_into_the_next_generation(lab):
    press(lab, "step")
    until(lambda: lab.transport.state == "paused")
    drawn(lab)
    number = int(lab.run.records.individual.iloc[2])
    lab.population.selected = number
    drawn(lab)
    assert f"Robot {number}" in lab.robot.card.value
    assert str(lab.robot.editor.genome) == lab.run.records.genome.iloc[2]
    assert lab.robot.frame.poster.startswith("data:image/svg+xml")
    assert not lab.robot.frame.page
    lab.robot.frame._hear(None, {"want": "page"}, [])
    assert f"robot {number} of generation 0".encode() in lab.robot.frame.page

    edited = wl.Genome.random(SMALL.robot, rng=np.random.default_rng(1))
    lab.robot.editor.text = str(edited)
    lab.robot.editor._hear(None, {"press": "insert"}, [])
    assert "generation 1" in lab.robot.editor.notes[0]
    press(lab, "step")
    until(lambda: lab.run.n_generations == 2)
    guest = lab.run.records.iloc[-1]
    assert (guest.genome, guest.operators) == (str(edited), "by hand")
    assert "made by hand" in card(lab.run.records, guest.individual)
    drawn(lab)
    assert "evolution.insert" in lab.runs.drawer.code


def test_code_of_a_stopped_run_makes_its_table_again(lab):
    press(lab, "step")
    until(lambda: lab.transport.state == "paused")
    press(lab, "stop")
    place = {}
    exec(as_python(lab.run.settings, lab.run.records), place)
    pd.testing.assert_frame_equal(place["run"].records, lab.run.records)


def test_exported_all_is_in_the_folder_of_the_run_and_can_be_loaded(lab):
    press(lab, "start")
    until(lambda: lab.transport.state == "finished")
    lab.runs.drawer._hear(None, {"export": True}, [])
    until(lambda: lab.runs.drawer.words.startswith("Exported"))
    folder = lab.run.path.parent
    assert {"report.html", "replay.html", "run.walk", "records.csv", "champion.txt"} <= {
        path.name for path in folder.iterdir()
    }
    assert lab.runs.drawer.files == [str(lab.run.path)]
    lab.runs.drawer._hear(None, {"load": str(folder)}, [])
    assert lab.runs.shelf.selected == str(lab.run.path)
    drawn(lab)
    assert lab.runs.shelf.runs[1]["state"] == "loaded"
    assert lab.runs.shelf.runs[1]["name"] == folder.name
    lab.runs.drawer._hear(None, {"load": "no/such.walk"}, [])
    assert "no run file" in lab.runs.drawer.words


def test_without_the_right_to_write_a_run_is_in_memory(pool, tmp_path):
    (tmp_path / "lab").write_text("in the way")
    lab = wl.Lab(SMALL.with_(generations=1), tmp_path / "lab", executor=pool)
    press(lab, "start")
    until(lambda: lab.transport.state == "finished")
    assert "will not be kept" in lab.runs.drawer.words
    assert lab.run.n_generations == 1
    lab.close()


def test_an_operator_that_will_not_do_is_named_and_nothing_starts(lab):
    def halve(genomes, genes, *, rng):
        return genomes[::2]

    lab.settings = SMALL.with_(mutation=halve)
    press(lab, "start")
    assert "halve" in lab.transport.words
    assert lab.run is None


def test_two_panels_do_not_know_of_each_other(lab, pool, tmp_path):
    other = wl.Lab(SMALL.with_(seed=5), tmp_path / "lab", executor=pool)
    for panel in (lab, other):
        press(panel, "start")
    for panel in (lab, other):
        until(lambda panel=panel: panel.transport.state == "finished")
    for panel, settings in ((lab, SMALL), (other, SMALL.with_(seed=5))):
        alone = wl.evolve(settings, executor=pool, progress=False)
        pd.testing.assert_frame_equal(panel.run.records, alone.records)
    other.close()


def test_an_edited_gene_stays_whatever_the_run_brings_forth(lab):
    press(lab, "step")
    until(lambda: lab.transport.state == "paused")
    drawn(lab)
    lab.robot.editor.text = edited = str(wl.Genome.random(SMALL.robot, rng=np.random.default_rng(3)))
    press(lab, "go_on")
    until(lambda: lab.transport.state == "finished")
    drawn(lab)
    assert lab.robot.editor.text == edited
    number = int(lab.run.records.individual.iloc[-1])
    lab.population.selected = number
    drawn(lab)
    assert lab.robot.editor.text != edited
    assert f"Robot {number}" in lab.robot.card.value


def test_before_a_run_an_edited_gene_walks_in_the_world_of_the_form(lab):
    lab.settings = SMALL.with_(gravity="moon")
    lab.robot.editor._hear(None, {"press": "walk"}, [])
    assert lab.robot.frame._make().settings.terrain.gravity == lab.settings.terrain.gravity
    assert "gene in the editor" in lab.robot.card.value


def test_the_form_goes_back_to_the_settings_of_a_run(lab):
    press(lab, "step")
    lab.settings = SMALL.with_(mutation="macro")
    lab.runs.drawer._hear(None, {"settings": True}, [])
    assert lab.settings == SMALL


def test_closed_it_leaves_no_widget_and_no_thread(pool, tmp_path):
    registry = ipywidgets.widgets.widget._instances
    before, threads = set(registry), set(threading.enumerate())
    lab = wl.Lab(SMALL, tmp_path / "lab", executor=pool)
    press(lab, "start")
    lab.close()
    until(lambda: {one.name for one in set(threading.enumerate()) - threads} <= {"walkerlab pool"})
    left = [registry[key] for key in set(registry) - before]
    assert all(type(widget).__name__.endswith(("Layout", "Style")) for widget in left), left


@pytest.mark.parametrize("close", [wl.Lab.close, lambda lab: lab.runs.shelf.drop("run 1")], ids=["closed", "dropped"])
def test_a_going_run_that_is_closed_or_dropped_ends_at_once_and_in_silence(lab, monkeypatch, close):
    cries = []
    monkeypatch.setattr(threading, "excepthook", cries.append)
    lab.settings = LONG
    press(lab, "start")
    live = lab._active
    until(lambda: live.n_done > 0)
    close(lab)
    assert live.state == State.stopped
    live._thread.join(PATIENCE)
    assert not live._thread.is_alive()
    assert cries == []


def test_after_the_last_run_is_dropped_none_is_looked_at(lab):
    step(lab)
    lab.runs.shelf.drop("run 1")
    assert lab.run is None
    drawn(lab)
    assert not lab.runs.drawer.code
    assert not lab.population.roster


def test_closing_does_not_wait_for_a_fitness_that_hangs(lab):
    hangs, go_on = threading.Event(), threading.Event()

    def hang(rollout):
        if lab.run and lab.run.n_generations:
            hangs.set()
            go_on.wait(15)
        return rollout.distance

    lab.settings = SMALL.with_(fitness=hang)
    press(lab, "start")
    assert hangs.wait(PATIENCE)
    before = time.monotonic()
    lab.close()
    took = time.monotonic() - before
    go_on.set()
    assert took < 3


def test_while_a_run_goes_on_no_forecast_is_walked(lab, monkeypatch):
    drawn(lab)
    lab.settings = LONG
    drawn(lab)
    press(lab, "start")
    forecasts = []
    monkeypatch.setattr("walkerlab.widgets.lab.estimate_seconds", forecasts.append)
    lab._forecast()
    assert forecasts == []


def test_a_gene_can_be_put_in_only_where_a_generation_is_to_come(lab):
    editor = lab.robot.editor
    assert not editor.can_insert
    assert put_in(lab) == "No run is going on."
    step(lab)
    assert editor.can_insert
    for _ in range(SMALL.algorithm.population_size - SMALL.algorithm.n_elites):
        assert "generation 1" in put_in(lab)
    assert "4 places for children" in put_in(lab)
    press(lab, "go_on")
    until(lambda: lab.transport.state == "finished")
    assert not editor.can_insert
    assert "is over" in put_in(lab)


def test_a_gene_that_is_put_in_while_a_generation_walks_is_in_the_one_after_that_as_it_is_told(lab):
    words = []

    def meddle(rollout):
        if lab.run and lab.run.n_generations == 1 and not words:
            words.append(put_in(lab))
        return rollout.distance

    lab.settings = SMALL.with_(fitness=meddle)
    press(lab, "start")
    until(lambda: lab.transport.state == "finished")
    born = lab.run.records[lab.run.records.operators == "by hand"].born
    assert set(born) == {2}
    assert words[0].startswith("It will be in generation 2,")


def test_a_run_that_fails_says_why(lab):
    def moody(rollout):
        if lab.run:
            raise ArithmeticError("not today")
        return rollout.distance

    lab.settings = SMALL.with_(fitness=moody)
    press(lab, "start")
    until(lambda: lab.transport.state == "failed")
    assert "ArithmeticError: not today" in lab.transport.words


def test_the_curve_has_room_for_what_is_to_come_and_the_looks_of_the_list(lab, monkeypatch):
    for last in (False, False, True):
        step(lab)
        if not last:
            press(lab, "stop")
    drawn(lab)
    pictures = []
    monkeypatch.setattr(lab.runs.curve, "draw", lambda *args: pictures.append(args))
    lab.runs.shelf.tell("run 2", shown=False)
    drawn(lab)
    tables, room, looks = pictures[-1]
    assert (list(tables), room, looks) == (["run 1", "run 3"], SMALL.algorithm.generations, [0, 2])
    lab.runs.shelf.drop("run 1")
    drawn(lab)
    assert pictures[-1][2] == [2]


def test_of_another_run_that_is_chosen_the_champion_is_shown(lab):
    for seed in (1, 2):
        lab.settings = SMALL.with_(seed=seed)
        step(lab)
        press(lab, "stop")
    drawn(lab)
    lab.population.selected = 3
    lab.runs.shelf.selected = "run 1"
    assert lab.population.selected == -1
    drawn(lab)
    assert f"Robot {lab.run.champion.individual}, the champion so far" in lab.robot.card.value
    assert lab.robot.editor.genome == lab.run.champion.genome


def test_a_run_that_has_just_begun_shows_nothing_of_another(lab):
    go_on = threading.Event()

    def wait(rollout):
        if lab.runs.shelf.selected == "run 2":
            go_on.wait(PATIENCE)
        return rollout.distance

    lab.settings = SMALL.with_(fitness=wait)
    step(lab)
    press(lab, "stop")
    drawn(lab)
    assert lab.population.roster
    assert lab.runs.drawer.code
    press(lab, "start")
    drawn(lab)
    assert lab.run.n_generations == 0
    assert not lab.population.roster
    assert not lab.runs.drawer.code
    press(lab, "stop")
    go_on.set()


def test_a_file_that_has_grown_is_shown_as_it_is_now(lab, pool, tmp_path):
    path = tmp_path / "grows.walk"
    wl.evolve(SMALL.with_(generations=1), path, executor=pool, progress=False)
    load(lab, path)
    drawn(lab)
    wl.resume(path, 3, executor=pool, progress=False)
    load(lab, path)
    drawn(lab)
    assert lab.population.roster["title"].startswith("Generation 2")
    assert len(lab.runs.shelf.runs) == 1


def test_a_run_whose_genes_are_damaged_is_refused_and_the_list_goes_on(lab, pool, tmp_path):
    path = tmp_path / "bad.walk"
    wl.evolve(SMALL.with_(generations=1), path, executor=pool, progress=False)
    with sqlite3.connect(path) as db:
        db.execute("UPDATE records SET genome = 'wl1'")
    db.close()
    load(lab, path)
    assert "gen" in lab.runs.drawer.words
    step(lab)
    drawn(lab)
    [entry] = lab.runs.shelf.runs
    assert entry["key"] == "run 1"
    assert entry["best"]


def test_a_loaded_file_never_takes_the_place_of_a_run(lab, pool, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wl.evolve(SMALL.with_(generations=1), "run 1", executor=pool, progress=False)
    step(lab)
    load(lab, "run 1")
    assert len(lab.runs.kept) == len(lab.runs.shelf.runs) == 2
    assert lab.runs.kept["run 1"].live is lab._active


def test_a_loaded_run_without_generations_says_how_to_resume_it(lab, tmp_path):
    path = tmp_path / "begun.walk"
    wl.Evolution(SMALL.with_(seed=9), path)
    load(lab, path)
    drawn(lab)
    assert lab.runs.drawer.words == (
        f"Loaded {path}. No generation is done yet; resume it with wl.resume({str(path)!r})."
    )
    assert lab.run.settings == SMALL.with_(seed=9)
    [entry] = lab.runs.shelf.runs
    assert (entry["state"], entry["best"]) == ("loaded", "")
    assert not lab.runs.drawer.can_export
