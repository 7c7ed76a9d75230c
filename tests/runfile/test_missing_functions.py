"""Loaded runs without their user functions: viewing works, and everything else reports how to supply them."""

import ast
import pickle
import re
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import pytest

import walkerlab as wl
from walkerlab.evolution import outputs
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.simulation.validity import REJECTED
from walkerlab.view.plots.appearance import offscreen_axes

TINY = wl.Settings().with_(population_size=6, generations=1, duration=1, n_starts=3)


def backward(rollout, at_least=-10.0):
    return None if -rollout.distance < at_least else -rollout.distance


def made(path, fitness):
    with ThreadPoolExecutor(1) as thread:
        return wl.evolve(TINY.with_(fitness=fitness), path, thread, progress=False), wl.load(path)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A run in memory with its function, and the same run loaded without it."""
    return made(tmp_path_factory.mktemp("run") / "own.walk", partial(backward, at_least=-0.05))


def test_the_counted_walk_is_found_without_the_function(runs):
    run, loaded = runs
    assert run.records.equals(loaded.records)
    for again in (loaded.settings, loaded.settings.with_(camera="top"), pickle.loads(pickle.dumps(loaded)).settings):
        for row in run.records.itertuples():
            walk = poorest_walk(row.genome, again, poses=False)
            expected = poorest_walk(row.genome, run.settings, poses=False)
            recorded = ("ok", "") if row.verdict == "fragile" else (row.verdict, row.reason)
            assert (walk.distance, walk.verdict, walk.reason) == (row.distance, *recorded)
            assert (walk.distance, walk.verdict, walk.reason) == (expected.distance, expected.verdict, expected.reason)


def test_a_rejected_robot_stays_rejected_but_not_with_other_settings(tmp_path):
    with pytest.warns(UserWarning, match="returned None for every robot"):
        run, loaded = made(tmp_path / "none.walk", lambda rollout: None)
    genome = loaded.champion.genome
    assert set(run.records.verdict) == {REJECTED}
    assert poorest_walk(genome, loaded.settings, poses=False).verdict == REJECTED
    elsewhere = poorest_walk(genome, loaded.settings.with_(duration=1.5), poses=False)
    walks = [poorest_walk(genome, TINY.with_(duration=1.5, n_starts=n), poses=False) for n in (1, 2, 3)]
    assert elsewhere.verdict != REJECTED
    assert elsewhere.distance == min(walk.distance for walk in walks)


def test_viewing_a_loaded_run_requires_no_function(runs, tmp_path):
    run, loaded = runs
    assert loaded.replay().walks[0].rollout.distance == run.replay().walks[0].rollout.distance
    wl.plots.stride(loaded.champion.genome, loaded.settings, offscreen_axes(4, 2))
    wl.plots.gait(loaded.champion.genome, loaded.settings, offscreen_axes(4, 2))
    outputs.write_outputs(loaded, tmp_path)
    assert (tmp_path / "report.html").is_file()


def test_confirm_requires_the_function(runs):
    run, loaded = runs
    assert loaded.confirm(1, fitness=backward).nudged == run.confirm(1, fitness=backward).nudged
    assert loaded.confirm(1, fitness="velocity").measure == "velocity m/s"
    with pytest.raises(wl.RunFileError, match=r"confirm\(fitness=") as caught:
        loaded.confirm(1)
    assert_python(str(caught.value), r"settings\.with_\(.*?\), or|run\.confirm\(.*\)$")


def test_resume_accepts_any_function_for_a_lambda_and_suggests_valid_code(tmp_path):
    made(tmp_path / "own.walk", lambda rollout: backward(rollout))
    with pytest.raises(wl.RunFileError) as caught:
        wl.resume(tmp_path / "own.walk")
    assert_python(str(caught.value), r"wl\.resume\(.*?\)\.")
    with ThreadPoolExecutor(1) as thread:
        run = wl.resume(tmp_path / "own.walk", 2, thread, progress=False, fitness=backward)
    assert run.n_generations == 2
    with pytest.raises(wl.RunFileError, match="fitness=backward"):
        wl.resume(tmp_path / "own.walk", fitness=assert_python)


def assert_python(text, pattern):
    found = re.findall(pattern, text)
    assert found
    for code in found:
        ast.parse(code.removesuffix(", or").removesuffix("."))
