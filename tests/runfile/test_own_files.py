"""Run files that walkerlab writes: all of them can be loaded, resumed and rescued, with the same table."""

import json
import sqlite3
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from functools import partial
from itertools import cycle

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from tests.faults.standins import walk
from walkerlab.evolution import evolution
from walkerlab.runfile import records, schema
from walkerlab.settings.fields import OneOf
from walkerlab.simulation.validity import VERDICTS

SETTINGS = wl.Settings().with_(population_size=12, generations=2, duration=1, n_elites=2, seed=4)
FIELD_LOCATIONS = wl.Settings.field_locations()
CHOICES = [
    (name, member)
    for name, (domain, field) in FIELD_LOCATIONS.items()
    if isinstance(declared := type(getattr(SETTINGS, domain)).declared()[field], OneOf)
    for member in declared.choices
]
same = partial(pd.testing.assert_frame_equal, check_exact=True)


@pytest.fixture(autouse=True)
def replaced_walks(monkeypatch):
    """Replace walks by evaluations with all verdicts in turn."""
    verdicts = cycle(VERDICTS)

    def evaluate(genomes, settings, executor=None, *, on_done=lambda n: None, starts=None, **_):
        on_done(len(genomes))
        walks = [walk(values) for values in genomes]
        if starts is not None:  # each robot does as well from other starts
            return [type(one)(**vars(one) | {"verdict": "ok", "fitness": 1.0, "reason": ""}) for one in walks]
        for one, verdict in zip(walks, verdicts, strict=False):
            fitness = 1.0 if verdict == "ok" else -np.inf
            vars(one).update(verdict=verdict, fitness=fitness, reason="" if verdict == "ok" else "0.5; 0.2 is allowed")
        return walks

    monkeypatch.setattr(evolution, "evaluate", evaluate)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.walk"


def test_every_verdict_is_stored_loaded_resumed_and_rescued(path, tmp_path):
    run = wl.evolve(SETTINGS, path, progress=False)
    assert set(run.records.verdict) == set(VERDICTS)
    same(wl.load(path).records, run.records)
    same(wl.rescue(path, tmp_path / "rescued.walk").records, run.records)
    resumed = wl.resume(path, 3, progress=False).records
    same(resumed[resumed.generation < 2], run.records)


@pytest.mark.parametrize(("name", "member"), CHOICES, ids=[f"{name}-{member.name}" for name, member in CHOICES])
def test_every_choice_of_every_setting_is_stored_and_loaded(path, name, member):
    settings = SETTINGS.with_(**{name: member})
    population = [wl.Genome.random(settings.robot, rng=np.random.default_rng(0))]  # frozen features require one
    list(wl.Evolution(settings, path, population=population))
    loaded = wl.load(path)
    assert loaded.settings == settings
    assert loaded.n_generations == 2


def test_an_unknown_verdict_is_rejected_with_the_fix(path):
    table = wl.evolve(SETTINGS, path, progress=False).records
    for verdict in ("on fire", "ok\x1b[2J"):
        with pytest.raises(ValueError, match="pip install --upgrade walkerlab") as caught:
            records.check_table(table.assign(verdict=verdict))
        assert repr(verdict) in str(caught.value)


# ------------------------------------------------------------------- settings that a file cannot hold, before a walk


def max(rollout):
    """Shadow a built-in function."""
    return 1.0


def height(rollout, **_):
    return 1.0


def spaced(rollout):
    return 1.0


spaced.__name__ = "my height"


@pytest.mark.parametrize(
    "fitness",
    [max, spaced, partial(height, **{"a b": 1}), partial(height, k="x" * 10**6), partial(height, k=10**5000)],
    ids=["built-in", "name", "argument", "long", "huge"],
)
def test_settings_that_cannot_be_stored_raise_before_any_walk(path, fitness, monkeypatch):
    monkeypatch.setattr(evolution, "evaluate", None)
    with pytest.raises(wl.SettingsError, match=r"cannot be stored|a run file cannot store"):
        wl.evolve(SETTINGS.with_(fitness=fitness), path, progress=False)
    assert not path.exists()


# ------------------------------------------------------------------------------------------- before generation 0


def interrupted(*_, **__):
    raise KeyboardInterrupt


def test_a_run_stopped_before_generation_0_resumes_to_the_same_table(path, monkeypatch):
    monkeypatch.undo()
    settings = SETTINGS.with_(population_size=4, n_elites=1)
    with ThreadPoolExecutor(1) as pool:
        whole = wl.evolve(settings, executor=pool, progress=False).records
        wl.Evolution(settings, path)  # as if its process were killed
        run = wl.load(path)
        assert repr(run) == f"Run(no generation is complete yet, in {path})"
        assert "no" in run._repr_html_().lower()
        assert run.settings == settings
        assert run.n_generations == len(run.records) == 0
        same(wl.resume(path, executor=pool, progress=False).records, whole)


def test_the_file_is_created_before_any_walk_and_a_second_run_is_rejected(path, monkeypatch):
    n_walks = []

    def evaluate(*_, **__):
        n_walks.append(1)
        assert wl.load(path).settings == SETTINGS
        with pytest.raises(wl.RunFileError, match="exists already"):
            wl.evolve(SETTINGS, path, progress=False)
        raise wl.OperatorError("error of an operator")

    monkeypatch.setattr(evolution, "evaluate", evaluate)
    with pytest.raises(wl.OperatorError) as caught:
        wl.evolve(SETTINGS, path, progress=False)
    assert len(n_walks) == 1
    assert caught.value.saved_path == path
    assert f"No generation was completed; the settings are saved in {path}." in caught.value.__notes__[0]
    assert f"wl.resume({str(path)!r})" in caught.value.__notes__[0]


def test_ctrl_c_before_generation_0_reports_what_is_saved_and_how_to_resume(path, monkeypatch):
    monkeypatch.setattr(evolution, "evaluate", interrupted)
    with pytest.raises(KeyboardInterrupt, match="the run has no file"):
        wl.evolve(SETTINGS, progress=False)
    for attempt in (lambda: wl.evolve(SETTINGS, path, progress=False), lambda: wl.resume(path, progress=False)):
        with pytest.raises(KeyboardInterrupt) as caught:
            attempt()
        assert f"the settings are saved, resume with: wl.resume({str(path)!r})" in str(caught.value)


@pytest.mark.parametrize("wrong", ["fitness", "executor", "patience", "path", "settings"])
def test_invalid_arguments_leave_no_file(tmp_path, wrong, monkeypatch):
    monkeypatch.undo()
    settings = SETTINGS
    path = tmp_path / "run.walk"
    executor = ThreadPoolExecutor(1)
    match wrong:
        case "fitness":
            settings = settings.with_(fitness=lambda rollout: "far")
        case "executor":
            executor.shutdown()
        case "patience":
            monkeypatch.setenv("WALKERLAB_PATIENCE", "soon")
        case "path":
            path = "a\0b"
        case _:
            settings = {"generations": 3}
    with pytest.raises((ValueError, TypeError, RuntimeError)):
        wl.evolve(settings, path, executor, progress=False)
    assert not list(tmp_path.iterdir())


def test_a_run_without_generations_can_be_rescued(path, tmp_path):
    wl.Evolution(SETTINGS, path)
    assert wl.rescue(path, tmp_path / "rescued.walk").settings == SETTINGS
    same(wl.resume(tmp_path / "rescued.walk", progress=False).records, wl.load(tmp_path / "rescued.walk").records)


# ------------------------------------------------------------------ duplicate keys and progress bars


def test_a_duplicate_key_is_rejected_with_its_name(path):
    text = SETTINGS.model_dump_json()
    assert wl.Settings.model_validate_json(text) == SETTINGS
    twice = text.replace('"seed":4', '"seed":4,"seed":5')
    assert twice != text
    with pytest.raises(wl.SettingsError, match="'seed' occurs more than once"):
        wl.Settings.model_validate_json(twice)
    wl.Evolution(SETTINGS, path)
    with closing(sqlite3.connect(path)) as db, db:
        schema.write_settings(db, json.dumps(SETTINGS.model_dump()).replace('"seed": 4', '"seed": 4, "seed": 5'))
    with pytest.raises(wl.RunFileError, match="'seed' occurs more than once"):
        wl.load(path)


def test_a_run_without_further_walks_shows_no_progress_bar(path, capfd):
    wl.evolve(SETTINGS, path, progress=False)
    wl.resume(path)
    assert capfd.readouterr() == ("", "")
    wl.resume(path, 3)
    assert "10/10" in capfd.readouterr().err
