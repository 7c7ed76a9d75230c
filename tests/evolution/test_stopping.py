"""Runs that stop before their last generation: where they stop, what the file records, and how they continue."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from tests.faults.standins import evaluate
from walkerlab.__main__ import main
from walkerlab.evolution import evolution as evolving
from walkerlab.evolution import outputs
from walkerlab.evolution.stopping import Improvement, find_stop_reason

SETTINGS = wl.Settings().with_(duration=1, population_size=4, generations=6, n_elites=1, seed=1)
same = partial(pd.testing.assert_frame_equal, check_exact=True)


@pytest.fixture(autouse=True)
def fast_walks(monkeypatch):
    monkeypatch.setattr(evolving, "evaluate", evaluate)


@pytest.fixture
def whole():
    return evolve()


def evolve(settings=SETTINGS, path=None, **options):
    return wl.evolve(settings, path, progress=False, **options)


def best_so_far(run):
    return run.records.groupby("generation").fitness.max().cummax().tolist()


def test_a_run_stops_in_the_first_generation_that_reaches_the_target(whole):
    best = best_so_far(whole)
    stop = next(number for number in range(1, 6) if best[number] > best[0])
    run = evolve(stop=wl.Stop(target=best[stop]))
    assert run.n_generations == stop + 1
    assert run.stop_reason.startswith("the best fitness reached the target")
    same(run.records, whole.records.head(len(run.records)))
    assert f"; stopped because {run.stop_reason})" in repr(run)


@pytest.mark.parametrize("patience", [1, 3])
def test_patience_counts_the_generations_without_a_fitter_robot(patience):
    settings = SETTINGS.with_(mutation_rate=0, crossover="none")
    run = evolve(settings, stop=wl.Stop(patience=patience))
    assert run.n_generations == 1 + patience
    assert "had no fitter robot" in run.stop_reason


def test_after_the_time_limit_no_generation_begins(whole, monkeypatch):
    times = iter(range(0, 1000, 10))
    monkeypatch.setattr(evolving.time, "monotonic", lambda: next(times))
    run = evolve(stop=wl.Stop(after="20s"))
    assert run.n_generations == 2
    assert run.stop_reason == "the time limit of 20 s was reached"
    same(run.records, whole.records.head(8))


@pytest.mark.parametrize(("after", "seconds"), [
    ("90s", 90), ("10min", 600), ("2 h", 7200), ("1h 30min", 5400), ("0.5min", 30), (12, 12),
    (np.int64(12), 12),
])  # fmt: skip
def test_times_are_read_with_their_unit(after, seconds):
    assert wl.Stop(after=after).after == seconds


@pytest.mark.parametrize(("conditions", "message"), [
    ({}, "Stop has no condition"), ({"after": "10 parsecs"}, "after is '10 parsecs'; it must be a time above 0"),
    ({"after": 0}, "after is 0"), ({"after": True}, "after is True"), ({"target": "8"}, "target is '8'"),
    ({"target": float("nan")}, "target is nan"), ({"patience": 0}, "patience is 0"),
    ({"patience": 2.5}, "patience is 2.5"),
])  # fmt: skip
def test_wrong_conditions_are_explained(conditions, message):
    with pytest.raises(ValueError, match=message):
        wl.Stop(**conditions)


def test_a_stop_that_is_not_a_stop_is_explained_before_a_file_is_made(tmp_path):
    with pytest.raises(TypeError, match=r"stop must be a Stop, as in stop=wl.Stop\(after="):
        evolve(path=tmp_path / "a.walk", stop="10min")
    assert not list(tmp_path.iterdir())


def test_of_several_conditions_the_first_that_holds_stops():
    stop = wl.Stop(target=3, patience=2, after=60)
    course = Improvement()
    reasons = []
    for best in (1, 2, 2, 2, 5):
        course = course.after(best)
        reasons.append(find_stop_reason(stop, course, seconds=1))
    assert [bool(reason) for reason in reasons] == [False, False, False, True, True]
    assert "2 generations" in reasons[3]
    assert "target 3" in reasons[4]
    assert find_stop_reason(stop, Improvement(2.0), seconds=60) == "the time limit of 1 min was reached"


def test_a_resumed_run_equals_an_uninterrupted_one_and_has_no_reason(whole, tmp_path):
    path = tmp_path / "a.walk"
    stopped = evolve(path=path, stop=wl.Stop(target=-1e9))
    assert stopped.n_generations == 1
    assert wl.load(path).stop_reason == stopped.stop_reason != ""
    again = wl.resume(path, progress=False, stop=wl.Stop(patience=1))
    assert wl.load(path).stop_reason == again.stop_reason
    resumed = wl.resume(path, progress=False)
    same(resumed.records, whole.records)
    assert resumed.stop_reason == wl.load(path).stop_reason == ""


def test_patience_counts_from_the_resume(tmp_path):
    settings = SETTINGS.with_(mutation_rate=0, crossover="none")
    path = tmp_path / "a.walk"
    evolve(settings, path, stop=wl.Stop(patience=2))
    run = wl.resume(path, progress=False, stop=wl.Stop(patience=2))
    assert run.n_generations == 5


def test_each_generation_is_passed_to_the_callback_once_it_is_stored(tmp_path):
    path = tmp_path / "a.walk"
    seen = []

    def note(generation):
        seen.append((generation.number, wl.load(path).n_generations, generation.champion.fitness))

    run = evolve(path=path, on_generation=note)
    assert [entry[:2] for entry in seen] == [(number, number + 1) for number in range(6)]
    assert seen[-1][2] == run.champion.fitness


def test_an_error_of_the_callback_ends_the_run_which_is_saved(whole, tmp_path):
    path = tmp_path / "a.walk"

    def fails(generation):
        if generation.number == 2:
            raise LookupError("mine")

    with pytest.raises(LookupError, match="mine") as caught:
        evolve(path=path, on_generation=fails)
    assert caught.value.saved_path == path
    assert "resume with" in caught.value.__notes__[-1]
    assert wl.load(path).n_generations == 3
    same(wl.resume(path, progress=False).records, whole.records)


@pytest.fixture
def empty_outputs(monkeypatch):
    """Write no output files, because drawing is slow."""
    monkeypatch.setattr(outputs, "write_outputs", lambda run, folder: None)


@pytest.mark.usefixtures("empty_outputs")
@pytest.mark.parametrize(("flags", "reason"), [
    (["--target", "-1000"], "the best fitness reached the target -1000"),
    (["--stop-after", "0.001s"], "the time limit of 0.001 s was reached"),
])  # fmt: skip
def test_the_command_line_stops_where_its_flags_say_and_resumes(flags, reason, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = ["--population-size", "4", "--generations", "3", "--duration", "1"]
    assert main(["evolve", *arguments, *flags]) == 0
    assert f"Stopped after 1 of 3 generations, which are saved, because {reason}." in capsys.readouterr().out
    assert wl.load("walk").stop_reason == reason
    assert main(["show", "walk"]) == 0
    assert f"stopped because {reason}" in capsys.readouterr().out.splitlines()
    assert main(["resume", "walk", "--quiet", "--patience", "50"]) == 0
    assert wl.load("walk").n_generations == 3
    assert wl.load("walk").stop_reason == ""


def test_a_wrong_condition_on_the_command_line_is_explained(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["evolve", "--patience", "many"]) == 2
    assert "Stop.patience is 'many'; it must be a whole number of generations" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_real_walks_stop_and_resume_to_the_same_table(monkeypatch):
    monkeypatch.undo()
    settings = SETTINGS.with_(generations=3)
    with ThreadPoolExecutor(1) as pool:
        whole = wl.evolve(settings, executor=pool, progress=False)
        evolution = wl.Evolution(settings, executor=pool, stop=wl.Stop(target=-1e9))
        counts = [len(list(evolution)) for _ in range(3)]
    assert counts == [1, 1, 1]
    same(evolution.run.records, whole.records)
