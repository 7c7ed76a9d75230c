"""The panel carries out the actions of its buttons; its display is tested in a browser in test_panel.py."""

import shutil
import sqlite3
import threading
import time
from base64 import b64decode
from pathlib import Path

import ipywidgets
import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.evolution.live import LiveRun, State
from walkerlab.runfile.records import find_champion
from walkerlab.text.numbers import with_unit
from walkerlab.view.report.code import as_python
from walkerlab.widgets.panel.card import robot_card
from walkerlab.widgets.panel.pre_evolved import load_pre_evolved_walker
from walkerlab.widgets.panel.run_folders import run_name

SMALL = wl.Settings().with_(population_size=6, generations=4, duration=1)
LONG = SMALL.with_(population_size=100, generations=1000)
TIMEOUT = 60  # s


def wait_until(is_done):
    end = time.monotonic() + TIMEOUT
    while not is_done():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.fixture
def lab(pool, tmp_path):
    panel = wl.Lab(SMALL, tmp_path / "lab", executor=pool)
    yield panel
    panel.close()


def press(lab, button):
    lab.transport._handle_message(lab.transport, {"press": button}, [])


def step(lab):
    """Evolve one generation and wait for it."""
    before = lab.transport.words
    press(lab, "step")
    wait_until(lambda: lab.transport.state == "paused" and lab.transport.words != before)


def load(lab, path):
    lab.runs.drawer._handle_message(lab.runs.drawer, {"load": str(path)}, [])


def insert(lab):
    """Insert the genome in the editor into the next generation; return the message."""
    lab.robot.editor._handle_message(lab.robot.editor, {"press": "insert"}, [])
    return lab.robot.editor.report


def wait_for_drawings(lab):
    """Wait until all requested pictures are drawn."""
    done = []
    lab._drawing.request("test", lambda: done.append(True))
    wait_until(lambda: done)


def test_a_run_is_evolved_to_its_end_and_saved(lab, pool):
    press(lab, "start")
    wait_until(lambda: lab.transport.state == "finished")
    wait_for_drawings(lab)
    alone = wl.evolve(SMALL, executor=pool, progress=False)
    pd.testing.assert_frame_equal(lab.run.records, alone.records)
    pd.testing.assert_frame_equal(wl.load(lab.run.path).records, alone.records)
    [entry] = lab.runs.run_list.runs
    assert (entry["key"], entry["state"]) == ("run 1", "finished")
    assert with_unit(alone.champion.fitness, "m") == entry["best"]
    assert f"Robot {alone.champion.individual}" in lab.robot.card.value
    assert "<svg" in lab.runs.curve.value
    assert lab.transport.share == 1


def test_lost_workers_are_reported(lab, monkeypatch):
    monkeypatch.setattr(LiveRun, "loss_note", "One was killed.")
    step(lab)
    assert lab.runs.drawer.words == "One was killed."


def test_nothing_happens_before_a_button_is_pressed(lab, tmp_path):
    wait_for_drawings(lab)
    assert lab.run is None
    assert not (tmp_path / "lab").exists()
    assert lab.transport.forecast.startswith("A new run: 4 generations of 6 robots")


def test_a_run_is_stepped_paused_and_stopped(lab):
    press(lab, "step")
    wait_until(lambda: lab.transport.state == "paused")
    assert lab.run.n_generations == 1
    press(lab, "step")
    wait_until(lambda: lab.transport.state == "paused" and lab.run.n_generations == 2)
    press(lab, "stop")
    wait_until(lambda: lab.transport.state == "stopped")
    assert lab.run.n_generations == 2
    press(lab, "continue")
    press(lab, "pause")
    assert lab.transport.state == "stopped"


def test_invalid_settings_are_explained_and_prevent_a_start(lab):
    lab.form.values = {**lab.form.values, "algorithm": {**lab.form.values["algorithm"], "n_elites": 6}}
    assert lab.settings is None
    assert "Elites is 6" in lab.transport.fault
    press(lab, "start")
    assert lab.run is None
    lab.settings = SMALL
    assert not lab.transport.fault


@pytest.mark.parametrize("message", [None, "start", {}, {"press": "fly"}, {"press": None}, [1]])
def test_invalid_messages_of_a_browser_do_nothing(lab, message):
    for component in (lab.transport, lab.runs.drawer):
        component._handle_message(component, message, [])
    assert lab.run is None


def test_differences_of_runs_are_listed_and_a_removed_run_is_gone(lab):
    for mutation in ("micro", "macro"):
        lab.settings = SMALL.with_(mutation=mutation, generations=1)
        press(lab, "start")
        wait_until(lambda: lab.transport.state == "finished")
    wait_for_drawings(lab)
    assert [entry["differs"] for entry in lab.runs.run_list.runs] == ["mutation micro", "mutation macro"]
    assert lab.runs.run_list.selected == "run 2"
    assert "Run 1: distance" in lab.runs.curve.value
    lab.runs.run_list.remove("run 2")
    wait_for_drawings(lab)
    assert lab.runs.run_list.selected == "run 1"
    assert lab.run.settings.algorithm.mutation == wl.Mutation.micro


def test_a_robot_is_selected_edited_and_inserted_into_the_next_generation(lab):
    press(lab, "step")
    wait_until(lambda: lab.transport.state == "paused")
    wait_for_drawings(lab)
    number = int(lab.run.records.individual.iloc[2])
    lab.population.selected = number
    wait_for_drawings(lab)
    assert f"Robot {number}" in lab.robot.card.value
    assert str(lab.robot.editor.genome) == lab.run.records.genome.iloc[2]
    assert lab.robot.frame.preview.startswith("data:image/svg+xml")
    assert not lab.robot.frame.page
    lab.robot.frame._handle_message(None, {"request": "page", "number": lab.robot.frame.number}, [])
    assert f"robot {number} of generation 0".encode() in lab.robot.frame.page

    edited = wl.Genome.random(SMALL.robot, rng=np.random.default_rng(1))
    lab.robot.editor.text = str(edited)
    lab.robot.editor._handle_message(None, {"press": "insert"}, [])
    assert "generation 1" in lab.robot.editor.report
    press(lab, "step")
    wait_until(lambda: lab.run.n_generations == 2)
    inserted = lab.run.records.iloc[-1]
    assert (inserted.genome, inserted.operators) == (str(edited), "by hand")
    assert "made by hand" in robot_card(lab.run.records, inserted.individual)
    wait_for_drawings(lab)
    assert "evolution.insert" in lab.runs.drawer.code
    press(lab, "stop")
    wait_until(lambda: lab.transport.state == "stopped")
    assert lab.robot.editor.report == "", "it was about a generation of this run"


def test_the_code_of_a_stopped_run_repeats_its_table(lab):
    press(lab, "step")
    wait_until(lambda: lab.transport.state == "paused")
    press(lab, "stop")
    namespace = {}
    exec(as_python(lab.run.settings, lab.run.records), namespace)
    pd.testing.assert_frame_equal(namespace["run"].records, lab.run.records)


def test_an_exported_run_has_all_outputs_in_its_folder_and_can_be_loaded(lab):
    press(lab, "start")
    wait_until(lambda: lab.transport.state == "finished")
    lab.runs.drawer._handle_message(None, {"export": True}, [])
    wait_until(lambda: lab.runs.drawer.words.startswith("Exported"))
    path = lab.run.path
    folder = path.parent
    assert {"report.html", "replay.html", "run.walk", "records.csv", "champion.txt"} <= {
        path.name for path in folder.iterdir()
    }
    assert lab.runs.drawer.files == [], "a run that is in the list is not offered"
    assert {Path(path).name for path in lab.runs.drawer.exported} >= {"report.html", "champion.txt"}
    lab.runs.drawer._handle_message(None, {"load": str(folder)}, [])
    assert lab.runs.run_list.selected == str(path)
    assert lab.runs.drawer.exported == []
    wait_for_drawings(lab)
    assert lab.runs.run_list.runs[1]["state"] == "loaded"
    assert lab.runs.run_list.runs[1]["name"] == run_name(lab.run.path)
    lab.runs.drawer._handle_message(None, {"load": "no/such.walk"}, [])
    assert "no run file" in lab.runs.drawer.words
    for run in lab.runs.run_list.runs:
        lab.runs.run_list.remove(run["key"])
    assert [file["path"] for file in lab.runs.drawer.files] == [str(path)]


def test_in_a_folder_that_is_not_writable_a_run_is_in_memory(pool, tmp_path):
    (tmp_path / "lab").write_text("in the way")
    lab = wl.Lab(SMALL.with_(generations=1), tmp_path / "lab", executor=pool)
    press(lab, "start")
    wait_until(lambda: lab.transport.state == "finished")
    assert "will not be saved" in lab.runs.drawer.words
    assert lab.run.n_generations == 1
    lab.close()


def test_an_invalid_operator_is_named_and_nothing_starts(lab):
    def halve(genomes, genes, *, rng):
        return genomes[::2]

    lab.settings = SMALL.with_(mutation=halve)
    press(lab, "start")
    assert "halve" in lab.transport.words
    assert lab.run is None


def test_two_panels_are_independent(lab, pool, tmp_path):
    other = wl.Lab(SMALL.with_(seed=5), tmp_path / "lab", executor=pool)
    for panel in (lab, other):
        press(panel, "start")
    for panel in (lab, other):
        wait_until(lambda panel=panel: panel.transport.state == "finished")
    for panel, settings in ((lab, SMALL), (other, SMALL.with_(seed=5))):
        alone = wl.evolve(settings, executor=pool, progress=False)
        pd.testing.assert_frame_equal(panel.run.records, alone.records)
    other.close()


def test_an_edited_gene_stays_while_the_run_continues(lab):
    press(lab, "step")
    wait_until(lambda: lab.transport.state == "paused")
    wait_for_drawings(lab)
    lab.robot.editor.text = edited = str(wl.Genome.random(SMALL.robot, rng=np.random.default_rng(3)))
    press(lab, "continue")
    wait_until(lambda: lab.transport.state == "finished")
    wait_for_drawings(lab)
    assert lab.robot.editor.text == edited
    number = int(lab.run.records.individual.iloc[-1])
    lab.population.selected = number
    wait_for_drawings(lab)
    assert lab.robot.editor.text != edited
    assert f"Robot {number}" in lab.robot.card.value


def test_before_a_run_an_edited_gene_walks_in_the_world_of_the_form(lab):
    lab.settings = SMALL.with_(gravity="moon")
    lab.robot.editor._handle_message(None, {"press": "walk"}, [])
    assert lab.robot.frame._make().settings.terrain.gravity == lab.settings.terrain.gravity


def test_the_settings_of_a_run_are_copied_to_the_form(lab):
    press(lab, "step")
    lab.settings = SMALL.with_(mutation="macro")
    lab.runs.drawer._handle_message(None, {"settings": True}, [])
    assert lab.settings == SMALL


def test_a_closed_panel_leaves_no_widget_and_no_thread(pool, tmp_path):
    registry = ipywidgets.widgets.widget._instances
    before = set(registry)
    threads = set(threading.enumerate())
    lab = wl.Lab(SMALL, tmp_path / "lab", executor=pool)
    press(lab, "start")
    lab.close()
    wait_until(lambda: {one.name for one in set(threading.enumerate()) - threads} <= {"walkerlab pool"})
    left = [registry[key] for key in set(registry) - before]
    assert all(type(widget).__name__.endswith(("Layout", "Style")) for widget in left), left


@pytest.mark.parametrize(
    "close", [wl.Lab.close, lambda lab: lab.runs.run_list.remove("run 1")], ids=["closed", "removed"]
)
def test_a_running_run_that_is_closed_or_removed_ends_at_once_without_errors(lab, monkeypatch, close):
    errors = []
    monkeypatch.setattr(threading, "excepthook", errors.append)
    lab.settings = LONG
    press(lab, "start")
    live = lab._active
    wait_until(lambda: live.n_done > 0)
    close(lab)
    assert live.state == State.stopped
    live._thread.join(TIMEOUT)
    assert not live._thread.is_alive()
    assert errors == []


def test_after_the_last_run_is_removed_none_is_selected(lab):
    step(lab)
    lab.runs.run_list.remove("run 1")
    assert lab.run is None
    wait_for_drawings(lab)
    assert not lab.runs.drawer.code
    assert not lab.population.generation


def test_closing_does_not_wait_for_a_fitness_that_hangs(lab):
    hangs = threading.Event()
    resume = threading.Event()

    def hang(rollout):
        if lab.run and lab.run.n_generations:
            hangs.set()
            resume.wait(15)
        return rollout.distance

    lab.settings = SMALL.with_(fitness=hang)
    press(lab, "start")
    assert hangs.wait(TIMEOUT)
    before = time.monotonic()
    lab.close()
    took = time.monotonic() - before
    resume.set()
    assert took < 3


def test_a_run_that_would_equal_another_one_is_announced(lab):
    step(lab)
    press(lab, "stop")
    wait_until(lambda: lab.transport.forecast.endswith("It would repeat run 1."))
    lab.settings = SMALL.with_(seed=5)
    wait_until(lambda: "run 1" not in lab.transport.forecast)


def test_a_run_with_a_robot_made_by_hand_is_not_said_to_be_repeated(lab):
    step(lab)
    insert(lab)
    step(lab)
    assert lab.runs.describe_equal_run(SMALL) == ""


def test_no_forecast_is_made_during_a_run(lab, monkeypatch):
    wait_for_drawings(lab)
    lab.settings = LONG
    wait_for_drawings(lab)
    press(lab, "start")
    forecasts = []
    monkeypatch.setattr("walkerlab.widgets.panel.run_status.estimate_seconds", forecasts.append)
    lab._show_forecast()
    assert forecasts == []


def test_a_gene_can_be_inserted_only_if_another_generation_follows(lab):
    editor = lab.robot.editor
    assert not editor.can_insert
    assert insert(lab) == "No run is in progress."
    step(lab)
    assert editor.can_insert
    for _ in range(SMALL.algorithm.population_size - SMALL.algorithm.n_elites):
        assert "generation 1" in insert(lab)
    assert "4 places for children" in insert(lab)
    press(lab, "continue")
    wait_until(lambda: lab.transport.state == "finished")
    assert not editor.can_insert
    assert "is over" in insert(lab)


def test_a_gene_inserted_during_a_generation_is_in_the_reported_later_one(lab):
    messages = []

    def insert_once(rollout):
        if lab.run and lab.run.n_generations == 1 and not messages:
            messages.append(insert(lab))
        return rollout.distance

    lab.settings = SMALL.with_(fitness=insert_once)
    press(lab, "start")
    wait_until(lambda: lab.transport.state == "finished")
    born = lab.run.records[lab.run.records.operators == "by hand"].born
    assert set(born) == {2}
    assert messages[0].startswith("The genome will be in generation 2,")


def test_finish_waits_for_the_run_in_progress_or_evolves_one(lab):
    first = lab.finish()
    assert first.n_generations == SMALL.algorithm.generations
    assert not lab.runs.entries
    step(lab)
    assert lab.finish().records.equals(first.records)
    assert lab.transport.state == "finished"
    assert lab.finish().path == lab.run.path


def test_a_new_panel_of_the_same_cell_takes_over_the_runs(lab, pool, tmp_path):
    step(lab)
    lab.runs.run_list.update("run 1", name="mine")
    new = wl.Lab(SMALL, tmp_path / "lab", executor=pool)
    new._take_over(lab)
    assert lab.comm is None
    assert [run["name"] for run in new.runs.run_list.runs] == ["mine"]
    assert new.finish().n_generations == SMALL.algorithm.generations
    assert new.transport.state == "finished"
    step(new)
    assert new.runs.run_list.selected == "run 2"
    new.close()


def test_a_robot_can_be_continued_with_only_if_a_run_has_ended(lab):
    editor = lab.robot.editor
    assert not editor.can_continue
    step(lab)
    assert not editor.can_continue
    press(lab, "stop")
    wait_until(lambda: editor.can_continue)


def test_a_genome_that_was_inserted_before_a_run_was_stopped_is_in_its_next_generation(lab):
    step(lab)
    assert "generation 1" in insert(lab)
    press(lab, "stop")
    wait_for_drawings(lab)
    further(lab, 1)
    assert (lab.run.records.operators == "by hand").sum() == 1


def test_a_name_given_by_the_user_is_stored_with_the_run(lab):
    step(lab)
    lab.runs.run_list._handle_message(None, {"name": "mine", "of": "run 1"}, [])
    assert run_name(lab.run.path) == "mine"


def test_settings_that_are_changed_during_a_run_are_said_to_be_for_a_new_one(lab):
    step(lab)
    assert lab.transport.note == ""
    lab.settings = SMALL.with_(mutation_rate=0.3)
    assert "a new run" in lab.transport.note
    lab.settings = SMALL
    assert lab.transport.note == ""


def test_a_failed_run_reports_the_error(lab):
    def fail_later(rollout):
        if lab.run:
            raise ArithmeticError("not today")
        return rollout.distance

    lab.settings = SMALL.with_(fitness=fail_later)
    press(lab, "start")
    wait_until(lambda: lab.transport.state == "failed")
    assert "ArithmeticError: not today" in lab.transport.words


def test_the_curve_has_space_for_coming_generations_and_the_looks_of_the_list(lab, monkeypatch):
    for last in (False, False, True):
        step(lab)
        if not last:
            press(lab, "stop")
    wait_for_drawings(lab)
    pictures = []
    monkeypatch.setattr(lab.runs.curve, "draw", lambda *args: pictures.append(args))
    lab.runs.run_list.update("run 2", shown=False)
    wait_for_drawings(lab)
    tables, n_generations, looks = pictures[-1]
    assert (list(tables), n_generations, looks) == (["run 1", "run 3"], SMALL.algorithm.generations, [0, 2])
    lab.runs.run_list.remove("run 1")
    wait_for_drawings(lab)
    assert pictures[-1][2] == [2]


def test_the_champion_of_a_newly_selected_run_is_shown(lab, capsys):
    for seed in (1, 2):
        lab.settings = SMALL.with_(seed=seed)
        step(lab)
        press(lab, "stop")
    lab.runs.run_list.selected = "run 1"
    assert lab.transport.words == "", "the controls say nothing about a run that is not selected"
    lab.runs.run_list.selected = "run 2"
    assert lab.transport.words.startswith("Stopped: 1 of")
    wait_for_drawings(lab)
    lab.population.selected = 3
    lab.runs.run_list.selected = "run 1"
    assert lab.population.selected == -1
    wait_for_drawings(lab)
    assert f"Robot {lab.run.champion.individual}, the champion so far" in lab.robot.card.value
    assert lab.robot.editor.genome == lab.run.champion.genome
    lab.finish()
    assert capsys.readouterr().out == "Run selected in the panel: run 1\n"
    wait_until(lambda: "Best of run 1: robot" in lab.walker.caption.words)
    assert lab.walker.frame.alt.startswith(
        f"Robot {lab.run.champion.individual}, born in generation 0, run 1, walking."
    )


def test_a_run_without_generations_shows_nothing_of_another_run(lab):
    resume = threading.Event()

    def wait(rollout):
        if lab.runs.run_list.selected == "run 2":
            resume.wait(TIMEOUT)
        return rollout.distance

    lab.settings = SMALL.with_(fitness=wait)
    step(lab)
    press(lab, "stop")
    wait_for_drawings(lab)
    assert lab.population.generation
    assert lab.runs.drawer.code
    press(lab, "start")
    wait_for_drawings(lab)
    assert lab.run.n_generations == 0
    assert not lab.population.generation
    assert not lab.runs.drawer.code
    press(lab, "stop")
    resume.set()


def test_a_file_that_has_grown_is_shown_with_its_new_generations(lab, pool, tmp_path):
    path = tmp_path / "grows.walk"
    wl.evolve(SMALL.with_(generations=1), path, executor=pool, progress=False)
    load(lab, path)
    wait_for_drawings(lab)
    wl.resume(path, 3, executor=pool, progress=False)
    load(lab, path)
    wait_for_drawings(lab)
    assert lab.population.generation["title"].startswith("Generation 2")
    assert len(lab.runs.run_list.runs) == 1


def test_a_run_with_damaged_genes_is_rejected_and_the_list_still_works(lab, pool, tmp_path):
    path = tmp_path / "bad.walk"
    wl.evolve(SMALL.with_(generations=1), path, executor=pool, progress=False)
    with sqlite3.connect(path) as db:
        db.execute("UPDATE records SET genome = 'wl1'")
    db.close()
    load(lab, path)
    assert "gen" in lab.runs.drawer.words
    step(lab)
    wait_for_drawings(lab)
    [entry] = lab.runs.run_list.runs
    assert entry["key"] == "run 1"
    assert entry["best"]


def test_a_loaded_file_never_replaces_another_run(lab, pool, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wl.evolve(SMALL.with_(generations=1), "run 1", executor=pool, progress=False)
    step(lab)
    load(lab, "run 1")
    assert len(lab.runs.entries) == len(lab.runs.run_list.runs) == 2
    assert lab.runs.entries["run 1"].live is lab._active


def test_a_loaded_run_without_generations_can_be_continued(lab, tmp_path):
    path = tmp_path / "begun.walk"
    wl.Evolution(SMALL.with_(seed=9), path)
    load(lab, path)
    wait_for_drawings(lab)
    assert lab.runs.drawer.words.startswith(f"Loaded {path}. No generation is complete yet")
    assert lab.runs.drawer.n_further == SMALL.algorithm.generations
    assert lab.run.settings == SMALL.with_(seed=9)
    [entry] = lab.runs.run_list.runs
    assert (entry["state"], entry["best"]) == ("loaded, 0 of 4", "")
    assert not lab.runs.drawer.can_export


def further(lab, n_generations, *, with_form=False):
    """Continue the selected run and wait until it is finished."""
    before = lab.run.n_generations
    lab.runs.drawer._handle_message(None, {"further": n_generations, "with_form": with_form}, [])
    wait_until(lambda: lab.transport.state == "finished" and lab.run.n_generations == before + n_generations)


def test_a_run_that_is_continued_equals_one_that_is_resumed(lab, pool, tmp_path):
    press(lab, "start")
    wait_until(lambda: lab.transport.state == "finished")
    wait_for_drawings(lab)
    assert lab.runs.drawer.n_further > 0
    lab.runs._exported = {lab.runs.run_list.selected: ["report.html"]}
    lab.runs.drawer.exported = ["report.html"]
    copy = tmp_path / "copy.walk"
    shutil.copyfile(lab.run.path, copy)
    further(lab, 2)
    wait_until(lambda: lab.transport.words.startswith("Finished: 6 generations, the last 2 in"))
    assert lab.runs.drawer.exported == [], "these files are of the shorter run"
    lab.settings = SMALL.with_(structure="stairs", step_height=0.02, mutation="micro")
    further(lab, 2, with_form=True)
    wl.resume(copy, 6, pool, progress=False)
    resumed = wl.resume(copy, 8, pool, progress=False, structure="stairs", step_height=0.02, mutation="micro")
    pd.testing.assert_frame_equal(lab.run.records, resumed.records)
    pd.testing.assert_frame_equal(wl.load(lab.run.path).records, resumed.records)
    assert lab.run.stages == resumed.stages
    wait_for_drawings(lab)
    [entry] = lab.runs.run_list.runs
    assert (entry["name"], entry["state"]) == ("run 1", "finished")


def test_a_stopped_and_a_loaded_run_are_continued(lab):
    step(lab)
    press(lab, "stop")
    path = lab.run.path
    wait_for_drawings(lab)
    assert lab.runs.drawer.n_further == SMALL.algorithm.generations - 1
    lab.runs.run_list.remove("run 1")
    load(lab, path)
    further(lab, 1)
    assert lab.runs.run_list.runs[0]["name"] == run_name(path)


def test_an_edited_genome_continues_a_run_that_is_over(lab):
    genome = wl.Genome.random(SMALL.robot, rng=np.random.default_rng(5))
    assert lab._continue_with(genome).startswith("No run that can be continued is selected.")
    step(lab)
    press(lab, "stop")
    wait_for_drawings(lab)
    assert lab._continue_with(genome) == "The genome will be in generation 1, in place of a child. It is marked with ✎."
    wait_until(lambda: lab.transport.state == "finished")
    born = lab.run.records[lab.run.records.generation == 1]
    inserted = born[(born.born == 1) & (born.parents == "")]
    assert inserted.genome.tolist() == [str(genome.within(SMALL.robot))]


def test_a_setting_that_cannot_change_is_named_and_the_run_is_unchanged(lab):
    step(lab)
    press(lab, "stop")
    lab.settings = SMALL.with_(population_size=7)
    lab.runs.drawer._handle_message(None, {"further": 2, "with_form": True}, [])
    assert lab.runs.drawer.words.startswith("⚠ Population size cannot change")
    assert lab.transport.state == "stopped"


def test_an_earlier_generation_is_shown(lab):
    for _ in range(2):
        step(lab)
    wait_for_drawings(lab)
    lab.runs.generation.selected = 0
    wait_for_drawings(lab)
    assert lab.population.generation["title"].startswith("Generation 0:")
    best = find_champion(lab.run.records[lab.run.records.generation == 0])
    wait_until(lambda: f"Best of generation 0: robot {best.individual}, " in lab.walker.caption.words)
    step(lab)
    wait_for_drawings(lab)
    assert lab.population.generation["title"].startswith("Generation 0:")


def test_the_panel_opens_with_a_walker_that_walks(lab):
    walker = load_pre_evolved_walker()
    wait_until(lambda: f"{walker.n_trials:,} trials" in lab.walker.caption.words)
    assert wl.simulate(walker.genome, walker.settings).distance == pytest.approx(walker.distance, rel=0.05)
    moving = b64decode(lab.walker.frame.preview.partition(",")[2])
    assert b"<animate" in moving
    lab.walker.caption.moves = False
    assert b"<animate" not in b64decode(lab.walker.frame.preview.partition(",")[2])


def test_robots_are_shown_as_they_finish(lab):
    may_finish = threading.Event()
    n_rated = []

    def rate(rollout):
        n_rated.append(1)
        if len(n_rated) > 3:
            may_finish.wait(TIMEOUT)
        return rollout.distance

    lab.settings = SMALL.with_(fitness=rate)
    press(lab, "step")
    wait_until(lambda: lab.population.generation)
    wait_until(lambda: "Best of the first " in lab.walker.caption.words)
    assert lab.walker.caption.words.endswith(" (provisional).")
    assert 1 <= len(lab.population.generation["rows"]) <= 3
    shown = {row["individual"]: row["label"] for row in lab.population.generation["rows"]}
    may_finish.set()
    wait_until(lambda: lab.transport.state == "paused")
    wait_for_drawings(lab)
    assert lab.walker.caption.words.startswith(f"Best so far: robot {lab.run.champion.individual}, ")
    complete = {row["individual"]: row["label"] for row in lab.population.generation["rows"]}
    assert shown.items() <= complete.items()


def test_a_run_ends_early_under_the_conditions_of_the_panel(lab):
    lab.transport.end_early = {"target": -10, "patience": "many", "minutes": -1}
    assert lab.transport.stop == wl.Stop(target=-10)
    press(lab, "start")
    wait_until(lambda: lab.transport.state == "finished")
    assert lab.run.n_generations == 1
    assert "because the best fitness reached the target" in lab.transport.words
    lab.transport.end_early = {}
    assert lab.transport.stop is None
