"""The files beside a run: replaced as one set; where a run goes does not depend on where Python goes meanwhile."""

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mujoco
import pytest

import walkerlab as wl
from walkerlab.__main__ import main
from walkerlab.evolution import outputs
from walkerlab.runfile.paths import RUN_FILE
from walkerlab.system.file_sets import HIDDEN_FOLDER, OutputError
from walkerlab.system.files import PathError

SMALL = wl.Settings().with_(population_size=4, generations=2, duration=1)


@pytest.fixture(scope="module")
def threads():
    with ThreadPoolExecutor(1) as pool:
        yield pool


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("USERPROFILE", str(tmp_path / "home"))
    return tmp_path


@pytest.fixture
def written(here, threads, monkeypatch):
    """A run and old output files, which contain "old"; slow parts of the new ones are replaced by a text."""
    monkeypatch.setattr(outputs.plots, "save", lambda _axes, *paths: [path.write_text("new") for path in paths])
    monkeypatch.setattr(outputs.report, "write_report", lambda *_, **__: None)
    monkeypatch.setattr(outputs, "build_page", lambda *_: "new")
    run = wl.evolve(SMALL, here / "walk" / RUN_FILE, threads, progress=False)
    for name in outputs.OUTPUT_FILES.keys() - {RUN_FILE}:
        (here / "walk" / name).write_text("old")
        os.utime(here / "walk" / name, (0, 0))
    return run


def texts(folder):
    return {path.name: path.read_text() for path in folder.iterdir() if path.name != RUN_FILE}


def unreadable(*_):
    raise ValueError("XML Error: cannot be read")


def test_if_a_part_fails_the_old_files_stay_and_the_error_names_it(written, here, monkeypatch):
    monkeypatch.setattr(mujoco.MjModel, "from_xml_string", unreadable)
    monkeypatch.setattr(mujoco.MjModel, "from_xml_path", unreadable)
    before = texts(here / "walk")
    with pytest.raises(OutputError, match=r"walk\. No file was changed\.\n  champion\.xml: ValueError: XML Error"):
        outputs.write_outputs(written, here / "walk")
    assert texts(here / "walk") == before
    os.utime(here / "walk" / "champion.xml")
    with pytest.raises(OutputError, match="All other files were written"):
        outputs.write_outputs(wl.load("walk"), Path("walk"))
    assert texts(here / "walk")["champion.xml"] == "old", "it is up to date"
    assert texts(here / "walk")["champion.png"] == "new"


def test_in_a_new_folder_all_parts_that_succeed_are_written(written, here, monkeypatch):
    monkeypatch.setattr(mujoco.MjModel, "from_xml_string", unreadable)
    monkeypatch.setattr(mujoco.MjModel, "from_xml_path", unreadable)
    with pytest.raises(OutputError, match=r"champion\.xml"):
        outputs.write_outputs(written, here / "new")
    assert {"champion.txt", "champion.png", "champion.html", "fitness.svg", "fitness.png"} == texts(here / "new").keys()


def test_the_command_names_the_part_that_failed_and_the_command_that_repeats_it(written, here, monkeypatch, capsys):
    monkeypatch.setattr(mujoco.MjModel, "from_xml_string", unreadable)
    monkeypatch.setattr(mujoco.MjModel, "from_xml_path", unreadable)
    assert main(["resume", "walk", "--quiet"]) == 2
    message = capsys.readouterr().err
    assert "The run is complete" in message
    assert "champion.xml: ValueError: XML Error" in message
    assert "write them with: walkerlab resume walk\n" in message
    assert "None" not in message


def test_a_folder_that_cannot_be_written_to_raises_an_explained_error(written, here):
    (here / "file").touch()
    with pytest.raises(PathError, match="which is a file"):
        outputs.write_outputs(written, here / "file")
    (here / "walk" / HIDDEN_FOLDER).write_text("in the way")
    with pytest.raises(OutputError, match="no files can be written into walk: "):
        outputs.write_outputs(written, here / "walk")


# ---------------------------------------------------------------------------------------------------------- paths


def test_changing_the_current_folder_does_not_change_the_run_file(here, threads, monkeypatch):
    (here / "elsewhere").mkdir()
    evolution = wl.Evolution(SMALL, "walk/run.walk", threads)
    for _ in evolution:
        monkeypatch.chdir(here / "elsewhere")
    run = evolution.run
    assert run.path == here / "walk" / "run.walk"
    assert len(run.records) == 8
    assert str(here / "walk" / "run.walk") in repr(run)
    assert not list((here / "elsewhere").iterdir())
    assert wl.resume(here / "walk", 3, threads, progress=False).n_generations == 3
    monkeypatch.chdir(here)
    assert ", in walk" + os.sep + "run.walk)" in repr(run)


def test_every_function_expands_the_home_folder(here, threads, monkeypatch):
    run = wl.evolve(SMALL, "~/runs/run.walk", threads, progress=False)
    assert run.path == here / "home" / "runs" / "run.walk"
    assert wl.load("~/runs").path == run.path
    genome = run.champion.genome
    assert wl.export_mjcf(genome, SMALL, "~/x").parent == here / "home" / "x"
    assert wl.replay(genome, SMALL).to_html("~/x/walk.html").parent == here / "home" / "x"
    wl.plots.save(wl.plots.body(genome), "~/x/body.svg")
    assert (here / "home" / "x" / "body.svg").is_file()
    lab = wl.Lab(SMALL, "~/runs", executor=threads)
    assert [file["path"] for file in lab.runs.drawer.files] == [os.path.join("home", "runs", "run.walk")]
    monkeypatch.chdir(here / "home")
    lab.runs.drawer._handle_message(None, {"load": lab.runs.drawer.files[0]["path"]}, [])
    assert lab.run.path == run.path, "a listed run can be loaded from any folder"
    lab.close()
    monkeypatch.chdir(here)
    assert main(["show", "~/runs"]) == 0
    assert main(["rescue", "~/runs", "--out=~/saved"]) == 0
    assert (here / "home" / "saved" / RUN_FILE).is_file()
    assert {path.name for path in here.iterdir()} == {"home"}


@pytest.mark.parametrize("path", [":memory:", "file:y.walk", "", "a\0b", "new/"])
def test_an_invalid_path_raises_before_any_walk(here, path, monkeypatch):
    monkeypatch.setattr("walkerlab.evolution.evolution.evaluate", None)
    for use in (wl.load, lambda path: wl.evolve(SMALL, path), lambda path: wl.rescue("x.walk", path)):
        with pytest.raises(wl.RunFileError):
            use(path)
    assert not list(here.iterdir())


@pytest.mark.parametrize("path", [":memory:", "file:y", ""])
def test_an_invalid_folder_raises_also_on_the_command_line(here, path, capsys):
    for use in (
        lambda: wl.Lab(SMALL, path),
        lambda: wl.export_mjcf("", SMALL, path),
    ):
        with pytest.raises(PathError):
            use()
    with pytest.raises(SystemExit):
        main(["evolve", f"--out={path}"])
    assert f"the path is {path!r}" in capsys.readouterr().err
    assert not list(here.iterdir())
