"""The command line parses its flags, runs its commands and reports errors without a traceback."""

import argparse
import os
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace

import mujoco
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.__main__ import main
from walkerlab.commands import flags, lab
from walkerlab.evolution import outputs
from walkerlab.system.package_files import find_package_file
from walkerlab.text.numbers import with_unit

TINY = ["--population-size", "6", "--generations", "2", "--duration", "1", "--quiet"]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def empty_outputs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Write the table and otherwise empty output files, because drawing is slow."""

    def write(run: wl.Run, folder: Path) -> None:
        for name in outputs.OUTPUT_FILES.keys() - {"run.walk"}:
            (folder / name).touch()
        run.records.to_csv(folder / "records.csv", index=False)

    monkeypatch.setattr(outputs, "write_outputs", write)


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("done") / "walk"
    assert main(["evolve", "--out", str(folder), *TINY]) == 0
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    """Return the bytes of each file in a folder."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if not path.is_dir()}


def names_in(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


# ----------------------------------------------------------------------------------------------------- flags


def help_of(command: str, capsys: pytest.CaptureFixture[str]) -> str:
    with pytest.raises(SystemExit) as stopped:
        main([command, "--help"])
    assert stopped.value.code == 0
    return " ".join(capsys.readouterr().out.split())


def test_every_setting_has_a_flag_and_every_flag_a_setting(capsys):
    declared = {(name, field) for name, domain in wl.Settings() for field in type(domain).declared()}
    assert set(flags.flag_names()) == declared
    general = {"--help", "--out", "--quiet", *flags.STOP_FLAGS}
    shown = set(re.findall(r" (--[a-z][a-z-]*)", help_of("evolve", capsys).partition("options:")[2]))
    assert shown - general == set(flags.flag_names().values())


def test_the_help_describes_each_setting_with_its_range_and_default(capsys):
    output = help_of("evolve", capsys)
    for _, domain in wl.Settings():
        for declared in type(domain).declared().values():
            assert f"{declared.about}: {declared.range}" in output
    assert "the rise of each stair: 0.01 to 0.4 m [0.08]" in output


def test_a_field_that_two_domains_share_gets_a_flag_for_each():
    both = parsed("--seed", "3", "--terrain-seed", "4")
    assert (both.algorithm.seed, both.terrain.seed) == (3, 4)


def test_a_preset_is_given_by_its_name():
    assert parsed("--gravity", "moon") == parsed("--gravity", "0", "0", "-1.62")


def parsed(*words: str) -> wl.Settings:
    parser = argparse.ArgumentParser()
    flags.add_flags(parser)
    arguments, unknown_words = parser.parse_known_args(words)
    return flags.build_settings(vars(arguments), unknown_words)


def test_flags_give_the_same_settings_as_python():
    words = "--structure 2 --step-height 0.1 --segments 2 3 --gravity 0 0 -3.7 --selection top_half 0 --camera front"
    assert parsed(*words.split()) == wl.Settings().with_(
        structure="stairs",
        step_height=0.1,
        segments=(2, 3),
        gravity=(0, 0, -3.7),
        selection=["top_half", "gradient"],
        camera="front",
    )
    assert parsed() == wl.Settings()


@pytest.mark.parametrize("number", ["-1", "-1.", "-.5", "-1e0", "-1E+0", "-.5e-3", "-1_0.0", "-1_0e-1", "5", "+5.e-1"])
def test_every_notation_of_a_number_is_accepted(number):
    assert parsed("--incline", number).terrain.incline == float(number)
    assert parsed("--gravity", "0", number, "-1").terrain.gravity == (0, float(number), -1)
    assert parsed("--gravity", number, number, number, "--incline", "2") == wl.Settings().with_(
        gravity=(float(number),) * 3, incline=2
    )


@pytest.mark.parametrize("number", ["-inf", "-Infinity", "-nan", "-1e999", "-1x"])
def test_a_negative_value_out_of_range_is_not_taken_for_a_flag(number):
    with pytest.raises(wl.SettingsError, match=r"Terrain.incline is .*; it must be ") as caught:
        parsed("--incline", number)
    assert "flag" not in str(caught.value)


def test_all_errors_are_reported_together_and_nothing_is_written(here, capsys):
    words = "evolve --step-height 0.9 --segments 2 --gravity 0 0 down --selection best --step-hight 1 --duration nan"
    assert main(words.split()) == 2
    output = capsys.readouterr().err
    for fault in (
        "Terrain.step_height is 0.9 m; it must be between 0.01 and 0.4 m.",
        "Robot.segments is [2]; it must be 2 numbers: min, max.",
        "Terrain.gravity's z is 'down'; it must be a number between -30 and 30 m/s².",
        "Algorithm.selection is 'best'; it must be one of gradient (0)",
        "Simulation.duration is nan s;",
        "There is no flag '--step-hight'. Did you mean --step-height?",
    ):
        assert fault in output
    assert "Traceback" not in output
    assert not list(here.iterdir())


# ---------------------------------------------------------------------------------------------------- evolve


def test_a_run_writes_its_files_and_no_others(done):
    assert names_in(done) == set(outputs.OUTPUT_FILES)
    run = wl.load(done / "run.walk")
    assert run.n_generations == 2
    pd.testing.assert_frame_equal(pd.read_csv(done / "records.csv", keep_default_na=False), run.records)
    assert wl.Genome.parse((done / "champion.txt").read_text(encoding="utf-8")) == run.champion.genome
    n_legs = wl.express(run.champion.genome).n_legs
    assert mujoco.MjModel.from_xml_path(str(done / "champion.xml")).nu == 2 * n_legs
    assert "generation</text>" in (done / "fitness.svg").read_text(encoding="utf-8")
    assert (done / "fitness.png").read_bytes().startswith(b"\x89PNG")
    report = (done / "report.html").read_text(encoding="utf-8")
    assert 'href="replay.html"' in report
    assert str(run.champion.genome) in report
    assert "<html" in (done / "replay.html").read_text(encoding="utf-8")


def test_quiet_prints_nothing_and_otherwise_a_summary_and_the_next_commands_are_printed(here, empty_outputs, capfd):
    assert main(["evolve", *TINY]) == 0
    assert capfd.readouterr() == ("", "")
    assert main(["evolve", *TINY[:-1], "--out", "loud"]) == 0
    output = capfd.readouterr().out
    champion = wl.load("loud/run.walk").champion
    assert f"robot {champion.individual}, born in generation {champion.generation}" in output
    assert with_unit(champion.fitness, "m") in output
    for word in [*outputs.OUTPUT_FILES, "walkerlab show loud", "walkerlab resume loud --generations", "walkerlab lab"]:
        assert word in output


def test_the_next_commands_are_aligned_for_a_long_folder_name(here, empty_outputs, capsys):
    folder = "a folder with a name that is longer than a column ever was"
    assert main(["evolve", *TINY[:-1], "--out", folder]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("  walkerlab ")]
    assert f'  walkerlab resume "{folder}" --generations 4   evolve more generations' in lines
    assert len({line.rindex("   ") for line in lines}) == 1


def test_a_run_is_never_overwritten(done, capsys):
    before = contents(done)
    assert main(["evolve", "--out", str(done), *TINY]) == 2
    output = capsys.readouterr().err
    assert f"walkerlab resume {done} --generations 4\n" in output
    assert "--out" in output
    assert contents(done) == before


def test_an_invalid_folder_is_reported_without_a_traceback(here, capsys):
    Path("walk").write_text("a file, not a folder")
    assert main(["evolve", *TINY]) == 2
    assert "walk" in capsys.readouterr().err


def test_a_run_in_which_no_walk_counts_writes_all_files(here, capsys):
    assert main(["evolve", *TINY[:-1], "--forgive", "restless", "too_high", "--gravity", "0", "0", "1"]) == 0
    output = capsys.readouterr().out
    assert "No walk counted" in output
    assert "airborne" in output
    assert names_in(here / "walk") == set(outputs.OUTPUT_FILES)
    assert main(["show", "walk"]) == 0


# ---------------------------------------------------------------------------------------------------- Ctrl-C


def start_long_run(folder: Path) -> subprocess.Popen[str]:
    """Start a very long run in a new process group, as a terminal does."""
    command = [sys.executable, "-m", "walkerlab", "evolve", "--out", str(folder)]
    command += ["--population-size", "4", "--n-elites", "0", "--generations", "10000", "--duration", "1"]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, encoding="utf-8", start_new_session=True)


def n_generations(folder: Path) -> int:
    return wl.load(folder / "run.walk").n_generations


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no process groups to send Ctrl-C to")
def test_ctrl_c_saves_complete_generations_and_the_run_can_be_resumed(tmp_path, capsys):
    folder = tmp_path / "walk"
    process = start_long_run(folder)
    assert process.stderr
    assert any("generation 2" in line for line in process.stderr)  # the bar ends its lines with a carriage return
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert f"walkerlab resume {folder}" in out
    assert names_in(folder) == set(outputs.OUTPUT_FILES)
    kept = n_generations(folder)
    assert kept > 2
    assert f"Stopped after {kept} of 10000 generations, which are saved" in out
    assert main(["resume", str(folder), "--generations", str(kept + 1), "--quiet"]) == 0
    assert n_generations(folder) == kept + 1
    assert pd.read_csv(folder / "records.csv").generation.nunique() == kept + 1


def test_ctrl_c_before_the_first_generation_saves_the_settings(here, empty_outputs, monkeypatch, capsys):
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("walkerlab.evolution.evolution.evaluate", interrupted)
        assert main(["evolve", *TINY]) == 130
        kept = (
            "Stopped before the first generation was complete; the settings are saved.\n"
            "Resume with: walkerlab resume walk\n"
        )
        assert capsys.readouterr().err.endswith(kept)
        assert main(["resume", "walk", "--quiet"]) == 130
        assert capsys.readouterr().err.endswith(kept)
    assert names_in(here / "walk") == {"run.walk"}
    assert main(["show", "walk"]) == 0
    shown = capsys.readouterr().out
    assert "0 of 2 generations" in shown
    assert "population_size = 6" in shown
    assert "No generation is complete yet. Start the first one: walkerlab resume walk" in shown
    assert main(["evolve", *TINY]) == 2
    assert "Resume it:        walkerlab resume walk\n" in capsys.readouterr().err
    assert main(["rescue", "walk", "--out", "saved"]) == 0
    assert "No generation is intact; the settings are saved in saved" in capsys.readouterr().out
    for folder in ("walk", "saved"):
        assert main(["resume", folder, "--quiet"]) == 0
    assert main(["evolve", *TINY, "--out", "uninterrupted"]) == 0
    tables = [contents(here / name)["records.csv"] for name in ("walk", "saved", "uninterrupted")]
    assert tables[0] == tables[1] == tables[2]


def test_ctrl_c_before_the_start_writes_no_run_file(here, monkeypatch, capsys):
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("walkerlab.evolution.running.evolve", interrupted)
    assert main(["evolve", *TINY]) == 130
    assert "there is no run file" in capsys.readouterr().err
    assert not (here / "walk" / "run.walk").exists()


# --------------------------------------------------------------------------------------------- resume and show


def test_resume_accepts_a_folder_or_file_and_equals_an_uninterrupted_run(here, empty_outputs):
    assert main(["evolve", "--out", "whole", *TINY[:2], "--generations", "4", *TINY[4:]]) == 0
    assert main(["evolve", "--out", "parts", *TINY]) == 0
    assert main(["resume", "parts", "--generations", "3", "--quiet"]) == 0
    assert main(["resume", "parts/run.walk", "--generations", "4", "--quiet"]) == 0
    whole, parts = wl.load("whole/run.walk"), wl.load("parts/run.walk")
    pd.testing.assert_frame_equal(whole.records, parts.records)
    assert contents(Path("whole"))["records.csv"] == contents(Path("parts"))["records.csv"]


def test_resuming_a_complete_run_prints_how_to_continue_and_changes_nothing(done, capfd):
    before = contents(done)
    assert main(["resume", str(done)]) == 0
    message = f"All 2 generations are done; to continue: walkerlab resume {done} --generations 4\n"
    assert capfd.readouterr() == (message, "")
    assert main(["resume", str(done), "--quiet"]) == 0
    assert capfd.readouterr() == ("", "")
    assert contents(done) == before


def test_resuming_a_complete_run_writes_missing_files(here, empty_outputs):
    assert main(["evolve", *TINY]) == 0
    Path("walk/fitness.svg").unlink()
    assert main(["resume", "walk", "--quiet"]) == 0
    assert names_in(here / "walk") == set(outputs.OUTPUT_FILES)


def test_an_outdated_report_is_written_again(here: Path, empty_outputs: None) -> None:
    main(["evolve", *TINY])
    wl.resume("walk", 3, progress=False)  # without its output files
    assert len(pd.read_csv("walk/records.csv")) == 12
    assert main(["resume", "walk", "--quiet"]) == 0
    assert len(pd.read_csv("walk/records.csv")) == 18


def test_resume_prints_the_settings_and_the_path_of_a_renamed_file(here, empty_outputs, capsys):
    assert main(["evolve", *TINY]) == 0
    Path("walk/run.walk").rename("mine.walk")
    assert main(["resume", "mine.walk", "--generations", "3"]) == 0
    output = capsys.readouterr().out
    assert output.startswith("6 robots, 3 generations (2 completed), ")
    assert "walkerlab show mine.walk " in output
    assert "walkerlab resume mine.walk --generations 6 " in output


@pytest.mark.parametrize("command", ["resume", "show"])
def test_a_missing_run_is_reported_without_a_traceback(here, command, capsys):
    assert main([command, "nowhere"]) == 2
    assert "there is no run file at nowhere" in capsys.readouterr().err
    Path("text.walk").write_text("hello, I am no run")
    assert main([command, "text.walk"]) == 2
    assert "text.walk" in capsys.readouterr().err


def test_resume_does_not_accept_fewer_generations(done, capsys):
    assert main(["resume", str(done), "--generations", "1"]) == 2
    assert "2 generations already" in capsys.readouterr().err
    assert n_generations(done) == 2


def test_show_prints_settings_versions_generations_verdicts_champion_and_descent(done, capsys):
    assert main(["show", str(done)]) == 0
    output = capsys.readouterr().out
    champion = wl.load(done / "run.walk").champion
    for word in (
        "2 of 2 generations",
        f"mujoco {mujoco.__version__}",
        "Algorithm.population_size = 6  (default 60)",
        "ok: The walk counts, because no rule was broken",
        str(champion.genome),
        "line of descent",
    ):
        assert word in output
    assert "step_height" not in output  # has its default value
    n_expressed, n_carried = len(wl.express(champion.genome).segments), champion.genome.n_parts
    assert (f"beyond the first {n_expressed} are not expressed" in output) == (n_expressed < n_carried)


def test_rescue_saves_the_intact_generations_and_the_run_can_be_resumed(
    done: Path, here: Path, empty_outputs: None, capsys: pytest.CaptureFixture[str]
) -> None:
    damaged = here / "damaged"
    shutil.copytree(done, damaged)
    with closing(sqlite3.connect(damaged / "run.walk")) as db, db:
        db.execute("UPDATE records SET fitness = 99 WHERE generation = 1 AND individual = 8")
    before = (damaged / "run.walk").read_bytes()
    assert main(["show", "damaged"]) == 2
    message = capsys.readouterr().err
    assert "generation 1 was changed or damaged after it was written" in message
    assert main(re.search(r"walkerlab (rescue \S+),", message).group(1).replace('"', "").split()) == 0
    assert "1 of 2 intact generations are saved in rescued" in capsys.readouterr().out
    assert main(["rescue", "damaged"]) == 2
    assert "--out ANOTHER-FOLDER" in capsys.readouterr().err
    assert main(["rescue", "nowhere", "--out", "new"]) == 2
    assert "there is no run file at nowhere" in capsys.readouterr().err
    assert (damaged / "run.walk").read_bytes() == before
    assert main(["resume", "rescued", "--quiet"]) == 0
    assert wl.load("rescued").records.equals(wl.load(done).records)


def test_verdicts_are_counted_once_for_each_robot(done):
    from walkerlab.view.summary import tabulate_verdicts

    assert tabulate_verdicts(wl.load(done).records).startswith(
        "Verdicts of 10 robots (12 rows in the table, where elites occur once in each generation):"
    )


@pytest.mark.parametrize(
    ("n_generations", "shown"),
    [
        (1, [0]),
        (12, list(range(12))),
        (13, [0, 2, 4, 6, 8, 10, 12]),
        (25, [0, 5, 10, 15, 20, 24]),
        (1000, [*range(0, 1000, 100), 999]),
    ],
)
def test_generations_are_listed_in_round_steps_with_the_last(done, n_generations, shown):
    from walkerlab.view.summary import tabulate_generations

    one = wl.load(done).records.query("generation == 0")
    records = pd.concat([one.assign(generation=number) for number in range(n_generations)])
    _, header, *rows = tabulate_generations(records, wl.Settings().model_dump()).splitlines()
    assert header.split() == ["generation", "best", "[m]", "median", "[m]", "counted"]
    assert [int(row.split()[0]) for row in rows] == shown


def test_a_line_of_descent_follows_the_fitter_parent_to_a_random_robot(done):
    from walkerlab.view.summary import tabulate_descent

    run = wl.load(done / "run.walk")
    births = run.records[run.records.generation == run.records.born].set_index("individual")
    child = int(births.index.max())
    (first, *rest) = [int(line.split()[0]) for line in tabulate_descent(run.records, child).splitlines()[2:]]
    assert first == child
    assert births.born[rest[-1]] == 0
    parents = [int(parent) for parent in births.parents[child].split()]
    assert rest[0] in parents
    assert births.fitness[rest[0]] == max(births.fitness[parent] for parent in parents)


# ------------------------------------------------------------------------------------------------------- lab


def test_lab_never_overwrites_a_changed_notebook(here, monkeypatch, capsys):
    calls: list[list[str]] = []
    server = SimpleNamespace(identity_provider=SimpleNamespace(token="a token"), start=lambda: None)
    monkeypatch.setattr(
        "jupyterlab.labapp.LabApp.initialize_server", lambda options: (calls.append(options), server)[1]
    )
    assert main(["lab", "--no-browser", "--port", "8899"]) == 0
    folder = here / lab.NOTEBOOKS_FOLDER
    originals = contents(find_package_file(lab.SOURCE_FOLDER))
    copied = contents(folder)
    assert f"New in {lab.NOTEBOOKS_FOLDER}: {len(copied)} files. " in capsys.readouterr().out
    assert copied == {name: originals[name] for name in copied}
    assert {lab.INDEX, "glossary.md", "pictures/03_selection.png"} <= copied.keys()
    assert not any(name.startswith("teacher") for name in copied)
    first = folder / lab.INDEX
    first.write_text("mine")
    assert main(["lab"]) == 0
    assert f"All notebooks are in {lab.NOTEBOOKS_FOLDER} already. " in capsys.readouterr().out
    assert first.read_text() == "mine"
    assert main(["lab", "--teacher"]) == 0
    assert {"teacher/03_selection.ipynb", "teacher/sheets/03_selection.md"} <= contents(folder).keys()
    assert first.read_text() == "mine"
    assert all("--ServerApp.ip=127.0.0.1" in call for call in calls)
    assert calls[0][-2:] == ["--no-browser", "--port=8899"]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signal that lets a server end in good order")
def test_lab_prints_the_address_of_the_index(here):
    command = [sys.executable, "-m", "walkerlab", "lab", "--no-browser", "--allow-root"]
    own = {name: str(here) for name in ("HOME", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR")}
    with subprocess.Popen(command, env={**os.environ, **own}, stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr
        address = next(line for line in server.stderr if "http://127.0.0.1" in line)
        server.terminate()
        server.stderr.read()
    assert f"/lab/tree/{lab.INDEX}?token=" in address


# ---------------------------------------------------------------------------------------------------- parser


def test_without_arguments_the_help_is_printed(capsys):
    assert main([]) == 0
    assert "evolve robots and write the run into a new folder" in capsys.readouterr().out


def test_an_unknown_command_is_reported_with_a_similar_one(capsys):
    assert main(["evovle", "--quiet"]) == 2
    assert capsys.readouterr().err == "There is no command 'evovle'. Did you mean: walkerlab evolve?\n"
    assert main(["dance"]) == 2
    known = "The commands are evolve, resume, compare, league, show, table, rescue, doctor, lab."
    assert known in capsys.readouterr().err


def test_the_parser_imports_no_large_package():
    code = (
        "import sys; from walkerlab.commands.parser import create_parser; create_parser();"
        "print({'mujoco', 'pandas', 'matplotlib', 'dm_control'} & set(sys.modules))"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "set()"
