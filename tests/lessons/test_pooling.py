"""The runs of a shared folder are pooled in one table; files that cannot be used are named."""

import shutil
from concurrent.futures import ThreadPoolExecutor

import pytest

import walkerlab as wl
from walkerlab.lessons.saved_runs import FOLDER, RUN_CHANGES
from walkerlab.system.package_files import find_package_file

RUNS = find_package_file(FOLDER)


def test_each_run_is_a_row_with_the_name_of_its_file_or_folder_and_its_differences(tmp_path):
    shutil.copy(RUNS / "ice.walk", tmp_path / "ada.walk")
    for name, source in {"bob": "flat", "zoë": "gravel"}.items():
        (tmp_path / name).mkdir()
        shutil.copy(RUNS / f"{source}.walk", tmp_path / name / "run.walk")
    table = wl.lessons.pool(tmp_path)
    assert set(table.name) == {"ada", "bob", "zoë"}
    assert list(table.fitness) == sorted(table.fitness, reverse=True)
    by_name = table.set_index("name")
    assert by_name.condition.to_dict() == {"ada": "texture='ice'", "bob": "default", "zoë": "texture='gravel'"}
    assert (table.seed == 1).all()
    assert by_name.loc["bob", "fitness"] == wl.lessons.saved_champion("flat").fitness
    assert by_name.loc["bob", "file"] == "bob/run.walk"
    assert "ice" in wl.plots.alt_text(wl.plots.best_of_each_run(table))


def test_files_that_cannot_be_used_are_left_out_and_named(tmp_path):
    shutil.copy(RUNS / "flat.walk", tmp_path / "ada.walk")
    shutil.copy(RUNS / "flat.walk", tmp_path / "copy.walk")
    shutil.copy(RUNS / "ice.walk", tmp_path / "ice.walk")
    (tmp_path / "text.walk").write_text("not a run")
    settings = wl.Settings().with_(population_size=4, generations=1, duration=1, fitness="velocity")
    with ThreadPoolExecutor(1) as executor:
        wl.evolve(settings, tmp_path / "velocity.walk", executor=executor, progress=False)
    wl.Evolution(settings.with_(fitness="distance"), tmp_path / "unfinished.walk")
    with pytest.warns(UserWarning, match="4 files left out") as warned:
        table = wl.lessons.pool(tmp_path)
    assert sorted(table.name) == ["ada", "ice"]
    message = str(warned[0].message)
    for part in (
        "copy.walk: the same run as ada.walk",
        "text.walk: ",
        "velocity.walk: its fitness is velocity, that of the others distance",
        "unfinished.walk: no generation is complete",
    ):
        assert part in message


def test_a_folder_without_runs_is_reported(tmp_path):
    with pytest.raises(wl.lessons.LessonError, match="has no run file"):
        wl.lessons.pool(tmp_path)
    with pytest.raises(wl.lessons.LessonError, match="there is no folder"):
        wl.lessons.pool(tmp_path / "missing")


@pytest.mark.parametrize("load", [wl.lessons.saved_run, wl.lessons.saved_champion])
def test_an_unknown_saved_run_is_reported_with_the_known_names(load):
    with pytest.raises(wl.lessons.LessonError, match=r"'stair'; the saved runs are flat, .*Did you mean 'stairs'"):
        load("stair")


def test_the_saved_runs_are_those_of_the_table_and_end_with_their_champions():
    assert {path.stem for path in RUNS.glob("*.walk")} == RUN_CHANGES.keys()
    for name, changes in RUN_CHANGES.items():
        run = wl.lessons.saved_run(name)
        assert run.settings == wl.Settings().with_(**changes)
        assert run.n_generations == changes["generations"]
        assert wl.lessons.saved_champion(name).fitness == run.records.fitness.max()
