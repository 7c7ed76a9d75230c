"""Runs in stages: resumed with changed settings, with the lineage kept and the changes recorded."""

import signal
import sqlite3
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from functools import partial

import pandas as pd
import pytest
from matplotlib.figure import Figure

import walkerlab as wl
from tests.faults import standins
from walkerlab.__main__ import main
from walkerlab.evolution import evolution as evolving
from walkerlab.evolution import outputs
from walkerlab.evolution.stages import plan_stages
from walkerlab.runfile import schema
from walkerlab.view.plots.style import alt_text
from walkerlab.view.report.code import as_python

SETTINGS = wl.Settings().with_(duration=1, population_size=4, generations=2, n_elites=1, seed=1, mutation_rate=0.3)
SETTINGS = SETTINGS.with_(forgive="fragile")  # one call of evaluate for each generation
NEW = {"structure": "stairs", "mutation_rate": 0.2, "mutation": "randomized"}
same = partial(pd.testing.assert_frame_equal, check_exact=True)


def evaluate(genomes, settings, executor=None, *, on_done=lambda n: None, starts=None, **_):
    """Stand-in for walks whose fitness depends on the terrain."""
    walked = standins.evaluate(genomes, settings, executor, on_done=on_done)
    factor = 1 + settings.terrain.structure
    return [one.__class__(**{**vars(one), "fitness": factor * one.fitness}) for one in walked]


@pytest.fixture(autouse=True)
def fast_walks(monkeypatch):
    monkeypatch.setattr(evolving, "evaluate", evaluate)


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "run.walk"
    wl.evolve(SETTINGS, path, progress=False)
    return path


def resume(path, *arguments, **changes):
    return wl.resume(path, *arguments, progress=False, **changes)


def test_the_settings_change_from_the_next_generation_on_and_are_recorded(path):
    before = wl.load(path)
    run = resume(path, 4, **NEW)
    loaded = wl.load(path)
    for one in (run, loaded):
        assert one.settings == SETTINGS.with_(generations=4, **NEW)
        assert [stage.first for stage in one.stages] == [0, 2]
        assert one.stages[0].settings == SETTINGS
        assert one.stages[1].settings == one.settings
        assert one.stages[1].changes == {
            "structure": wl.Structure.stairs, "mutation": wl.Mutation.randomized, "mutation_rate": 0.2,
        }  # fmt: skip
        assert one.rated_since == 2
        assert one.champion.generation >= 0
        assert one.champion.fitness == one.records.fitness[one.records.generation >= 2].max()
    same(loaded.records, run.records)
    same(run.records.head(8), before.records)


def test_the_last_generation_walks_again_and_its_robots_are_parents(path):
    run = resume(path, 4, **NEW)
    table = run.records
    counted = table[table.verdict == "ok"]
    factors = (counted.fitness / counted.distance / 3).round(6)
    expected = {0: [1.0], 1: [1.0], 2: [3.0], 3: [3.0]}
    assert factors.groupby(counted.generation).unique().map(list).to_dict() == expected
    children = table[table.born == 2]
    parents = {int(number) for text in children.parents for number in text.split()}
    assert parents <= set(table.individual[table.generation == 1])
    assert (run.lineage(int(children.individual.iloc[0])).generation < 2).any()


def test_an_elite_keeps_the_operators_that_made_it(path):
    run = resume(path, 4, **NEW)
    first = run.records.drop_duplicates("individual").set_index("individual").operators
    assert all(first[row.individual] == row.operators for row in run.records.itertuples())
    assert {"randomized" in text for text in run.records.operators[run.records.born >= 2]} == {True}


def test_a_change_of_operators_alone_does_not_rate_again(path):
    run = resume(path, 4, mutation="randomized")
    assert run.rated_since == 0
    assert len(run.stages) == 2
    assert resume(path, 5).stages[1].first == 2


CHILD = """
import os, signal, sys
sys.path.insert(0, sys.argv[2])
import walkerlab as wl
from tests.evolution import test_stages
from walkerlab.evolution import evolution

def evaluate(*arguments, calls=[], **options):
    calls.append(1)
    if len(calls) == int(sys.argv[3]):
        os.kill(os.getpid(), signal.SIGKILL)
    return test_stages.evaluate(*arguments, **options)

evolution.evaluate = evaluate
wl.resume(sys.argv[1], 4, progress=False, **test_stages.NEW)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="nothing there kills like SIGKILL")
@pytest.mark.parametrize(("n_calls", "n_done"), [(1, 2), (2, 2), (3, 3)])
def test_a_run_with_two_stages_killed_and_resumed_has_the_same_table(n_calls, n_done, path, tmp_path, request):
    whole_path = tmp_path / "whole.walk"
    wl.evolve(SETTINGS, whole_path, progress=False)
    whole = resume(whole_path, 4, **NEW)
    command = [sys.executable, "-c", CHILD, path, request.config.rootpath, str(n_calls)]
    killed = subprocess.run(command, capture_output=True, check=False)
    assert killed.returncode == -signal.SIGKILL, killed.stderr.decode()
    done = wl.load(path)
    assert done.n_generations == n_done
    resumed = resume(path, 4, **(NEW if n_calls == 1 else {}))  # the first kill comes before the stage is recorded
    same(resumed.records, whole.records)
    assert resumed.stages == wl.load(path).stages == whole.stages
    assert resumed.rated_since == wl.load(path).rated_since == 2


def begin_stage(path, **changes):
    """Begin a stage as if the process were killed before its first generation."""
    run = wl.load(path)
    stages = plan_stages(run.stages, SETTINGS.with_(generations=4, **changes), run.n_generations)
    wl.Evolution.continue_run(run, path, stages, {}, False)


def test_a_stage_without_a_generation_is_replaced(path):
    begin_stage(path, structure="gaps")
    assert len(wl.load(path).stages) == 2
    run = resume(path, 4, structure="stairs")
    assert [stage.changes for stage in run.stages] == [{}, {"structure": wl.Structure.stairs}]
    assert resume(path, 5).stages[-1].first == 2


def test_settings_set_back_before_any_generation_make_no_stage(path):
    begin_stage(path, structure="gaps")
    run = resume(path, 4, structure="flat")
    assert len(run.stages) == 1
    assert run.rated_since == 0


def test_three_stages_are_listed_in_order(path):
    resume(path, 3, structure="stairs")
    run = resume(path, 4, structure="flat", duration=2)
    assert [stage.first for stage in wl.load(path).stages] == [0, 2, 3]
    assert [str(stage) for stage in run.stages] == ["", "structure='stairs'", "structure='flat', duration=2.0"]
    assert run.records.attrs["stages"] == {2: "structure='stairs'", 3: "structure='flat', duration=2.0"}


@pytest.mark.parametrize(("changes", "message"), [
    ({"population_size": 8}, "Algorithm.population_size cannot change when a run is resumed"),
    ({"seed": 4}, "Algorithm.seed cannot change .* random numbers"),
    ({"segments": (1, 4)}, r"Robot.segments cannot change .* population=run"),
    ({"frozen": ["mass"]}, "Algorithm.frozen cannot change"),
    ({"sturcture": "stairs"}, "no setting 'sturcture'.* Did you mean 'structure'"),
    ({"structure": "stair"}, "Terrain.structure is 'stair'"),
])  # fmt: skip
def test_settings_that_cannot_change_are_named_and_the_file_is_unchanged(changes, message, path):
    before = path.read_bytes()
    with pytest.raises(wl.SettingsError, match=message):
        resume(path, 4, **changes)
    assert path.read_bytes() == before


def test_a_stage_needs_a_generation_that_is_not_done(path):
    with pytest.raises(wl.SettingsError, match="none would have the new settings; pass a larger total: generations=4"):
        resume(path, structure="stairs")


def test_a_user_function_may_begin_and_end_a_stage(path):
    def halve(genomes, genes, *, rng):
        return 0.5 * genomes

    resume(path, 3, mutation=halve)
    assert wl.load(path).stages[1].changes["mutation"].__name__ == "halve"
    with pytest.raises(wl.RunFileError, match="was made with user functions"):
        resume(path, 4)
    assert len(resume(path, 4, mutation=halve).stages) == 2
    run = resume(path, 5, mutation="macro")
    assert [stage.first for stage in run.stages] == [0, 2, 4]


@pytest.mark.parametrize("damage", [
    "UPDATE run SET value = '{}' WHERE fact = 'history'", "DELETE FROM run WHERE fact = 'history'",
    "UPDATE run SET value = replace(value, '\"last_first\": 2', '\"last_first\": 9') WHERE fact = 'history'",
])  # fmt: skip
@pytest.mark.parametrize("is_resealed", [False, True])
def test_a_damaged_history_is_reported(damage, is_resealed, path):
    resume(path, 3, structure="stairs")
    with closing(sqlite3.connect(path)) as db, db:
        db.execute(damage)
        if is_resealed and "UPDATE" in damage:
            schema.write_history(db, schema.read_fact(db, "history"))
    with pytest.raises(wl.RunFileError, match="damaged"):
        wl.load(path)


def test_a_rescued_run_keeps_its_stages(path, tmp_path):
    run = resume(path, 3, structure="stairs")
    rescued = wl.rescue(path, tmp_path / "rescued.walk")
    assert rescued.stages == run.stages
    same(rescued.records, run.records)


def test_real_robots_walk_again_on_the_new_terrain(path, tmp_path, monkeypatch):
    monkeypatch.undo()
    with ThreadPoolExecutor(1) as pool:
        wl.evolve(SETTINGS, tmp_path / "real.walk", pool, progress=False)
        run = wl.resume(tmp_path / "real.walk", 3, pool, progress=False, gravity="moon")
    [elite] = run.records[(run.records.generation == 2) & (run.records.born < 2)].itertuples()
    walked = wl.evaluate([elite.genome], run.settings)
    assert elite.fitness == walked[0].fitness


def test_the_command_line_begins_a_stage_and_shows_it(path, capsys, monkeypatch):
    monkeypatch.setattr(outputs, "write_outputs", lambda run, folder: None)
    assert main(["resume", str(path), "--generations", "4", "--structure", "stairs", "--gravity", "moon"]) == 0
    assert [stage.first for stage in wl.load(path).stages] == [0, 2]
    capsys.readouterr()
    assert main(["show", str(path)]) == 0
    assert "from generation 2 on with structure='stairs', gravity=" in capsys.readouterr().out
    assert main(["resume", str(path), "--generations", "5", "--seed", "4"]) == 2
    assert "Algorithm.seed cannot change" in capsys.readouterr().err


def test_the_fitness_curve_marks_the_stages(path):
    run = resume(path, 4, **NEW)
    axes = wl.plots.fitness_curve(run.records, Figure().subplots())
    boundaries = [line for line in axes.lines if line.get_linestyle() == ":" or len(set(line.get_xdata())) == 1]
    assert [line.get_xdata()[0] for line in boundaries] == [1.5]
    assert [text.get_text()[:18] for text in axes.texts] == ["structure='stairs'"]
    assert "New settings from generation 2 on: structure='stairs'" in alt_text(axes)


def test_the_fitness_curve_leaves_out_generations_rated_by_another_function(path):
    run = resume(path, 4, fitness="velocity")
    axes = wl.plots.fitness_curve(run.records, Figure().subplots())
    assert min(axes.lines[0].get_xdata()) == 2
    assert axes.get_ylabel() == "velocity [m/s]"


def test_the_code_of_a_run_names_its_stages_and_its_given_genomes(path):
    run = resume(path, 4, structure="stairs")
    code = as_python(run.settings, run.records)
    assert "# From generation 2 on, the run was resumed with structure='stairs'" in code
    given = wl.evolve(SETTINGS, population=run, progress=False)
    names = {}
    exec(as_python(given.settings, given.records).replace("=population)", "=population, progress=False)"), names)
    columns = ["genome", "fitness", "parents"]
    same(names["run"].records[columns], given.records[columns])


def test_conditions_compare_only_with_the_ratings_of_the_stage(path):
    before = wl.load(path).champion.fitness
    run = resume(path, 9, structure="stairs", stop=wl.Stop(target=2 * before))
    assert run.n_generations == 3
    assert run.stop_reason.startswith("the best fitness reached the target")
    run = resume(path, 9, structure="gaps", mutation_rate=0, crossover="none", stop=wl.Stop(patience=2))
    assert run.n_generations == 5
    assert run.stop_reason == "2 generations had no fitter robot"
