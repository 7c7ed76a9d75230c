"""A class lock fixes settings and limits the walks of a run, for the form and for typed requests alike."""

import json

import numpy as np
import pytest

import walkerlab as wl
from tests.widgets.panel.test_lab import wait_until
from walkerlab.evolution.live import State
from walkerlab.settings.classroom import CLASS_VARIABLE
from walkerlab.widgets.form import Form
from walkerlab.widgets.panel.class_lock import count_walks, make_lock

S = wl.Settings().with_(population_size=6, generations=4, duration=1)
LOCKED = {"population_size": 6, "texture": "grass", "duration": 1}


@pytest.fixture
def lab(pool, tmp_path):
    panel = wl.Lab(S, tmp_path / "lab", pool, only=["terrain", "algorithm"], budget=20, locked=LOCKED, student="Ada")
    yield panel
    panel.close()


def test_fixed_settings_are_shown_with_the_reason_and_hidden_ones_are_not(lab):
    controls = {f"{tab['domain']}.{one['name']}": one["fixed"] for tab in lab.form.tabs for one in tab["controls"]}
    assert controls["terrain.texture"] == controls["algorithm.population_size"] == "fixed by your teacher"
    assert controls["terrain.structure"] == ""
    assert not any(setting.startswith(("robot", "simulation")) for setting in controls)
    assert lab.settings == S.with_(**LOCKED)
    assert "fixed by your teacher" in lab.form.snapshot()


@pytest.mark.parametrize("change", [{"population_size": 60}, {"texture": "ice"}, {"duration": 8}, {"legs": (2, 4)}])
def test_a_typed_request_cannot_change_a_fixed_or_hidden_setting(lab, change):
    before = lab.settings
    (name,) = change
    for owner in (lab, lab.form):
        with pytest.raises(wl.SettingsError, match=f"{name} is .* it must stay"):
            owner.settings = before.with_(**change)
    values = {
        domain: {name: value} for domain in ("terrain", "robot", "algorithm", "simulation") for value in change.values()
    }
    lab.form.set_state({"values": values})
    assert lab.settings == before


def test_a_setting_that_is_free_can_be_changed(lab):
    lab.settings = lab.settings.with_(structure="stairs", selection="rank")
    assert lab.form.values["terrain"]["structure"] == "stairs"


def test_a_run_over_the_budget_does_not_start_and_the_message_gives_a_size_that_does(lab):
    assert "18 of at most 20 walks" in lab.lock.describe_budget(lab.settings)
    lab.settings = lab.settings.with_(generations=30)
    assert "122 walks (6 robots, 30 generations)" in lab.transport.fault
    assert "Reduce generations to 4." in lab.transport.fault
    lab._press("start")
    assert not lab.runs.entries
    lab.settings = lab.settings.with_(generations=4)
    assert lab.transport.fault == ""
    lab._press("step")
    wait_until(lambda: lab._active.state == State.paused)
    lab._press("stop")
    wait_until(lambda: lab._active.state == State.stopped)
    lab._evolve_further(30, with_form=False)
    assert "walks" in lab.runs.drawer.words
    assert lab.run.n_generations == 1


@pytest.mark.parametrize("budget", [10, 57, 58, 59, 300, 1461, 1462])
def test_each_proposed_size_is_the_largest_within_the_budget(budget):
    lock = make_lock(None, budget=budget)
    for starts in (1, 3):
        settings = wl.Settings().with_(n_starts=starts)
        message = lock.describe_excess(settings)
        assert bool(message) == (count_walks(settings) > budget)
        for name, text in (("generations", "generations to "), ("population_size", "population size to ")):
            if text in message:
                proposed = int(message.partition(text)[2].split(" ")[0].rstrip("."))
                assert count_walks(settings.with_(**{name: proposed})) <= budget
                assert count_walks(settings.with_(**{name: proposed + 1})) > budget


def test_the_file_of_the_class_limits_every_panel_and_gives_each_student_a_seed(tmp_path, monkeypatch):
    (tmp_path / "hand-in").mkdir()
    presets = {"Low stairs": {"structure": "stairs"}}
    content = {"locked": {"texture": "ice"}, "budget": 50, "shared_folder": "hand-in", "seed_per_student": True}
    (tmp_path / "class.json").write_text(json.dumps(content | {"presets": presets, "name": "10b"}))
    monkeypatch.setenv(CLASS_VARIABLE, str(tmp_path / "class.json"))
    ada = make_lock(S, budget=90, locked={"texture": "sand"}, student="Ada")
    assert ada.settings.terrain.texture == wl.Texture.ice
    assert ada.classroom.budget == 50
    assert (
        ada.settings.algorithm.seed == wl.lessons.my_seed("ada") != make_lock(S, student="Bo").settings.algorithm.seed
    )
    with pytest.raises(ValueError, match="with your name"):
        make_lock(S)
    genome = wl.Genome.random(S.robot, rng=np.random.default_rng(0))
    path = make_lock(S, student="../Ada/..").hand_in(genome)
    assert path.parent == tmp_path / "hand-in"
    assert wl.Genome.parse(path.read_text()) == genome
    panel = wl.Lab(S, tmp_path / "lab", student="Bo")
    panel.runs.drawer._handle_message(None, {"hand_in": True}, None)
    assert "there is no run" in panel.runs.drawer.words
    panel.hand_in(genome)
    assert (tmp_path / "hand-in" / "Bo.txt").exists()
    panel.close()
    form = ada.make_form()
    assert [preset["name"] for preset in form.presets] == ["start", "Low stairs"]
    form.preset = "Low stairs"
    assert form.settings.terrain == ada.settings.with_(structure="stairs").terrain


def test_presets_that_contradict_a_fixed_setting_are_not_offered():
    names = [preset["name"] for preset in Form(fixed={"gravity": "fixed"}).presets]
    assert "Ice" in names
    assert "Moon" not in names
    form = Form(S.with_(step_depth=1.2), fixed={"step_depth": "fixed"})
    form.preset = "Sandy stairs" if "Sandy stairs" in names else "Ice"
    assert form.settings.terrain.step_depth == 1.2
