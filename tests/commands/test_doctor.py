import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from walkerlab.__main__ import main
from walkerlab.commands import doctor
from walkerlab.commands.doctor import Finding, fixes, hardware, software
from walkerlab.view import opengl


@pytest.fixture
def versions(monkeypatch):
    """What is installed, and what walkerlab needs; to be filled."""
    installed, needed = {"walkerlab": "1.0"}, []
    monkeypatch.setattr(software, "requires", lambda _: needed)
    monkeypatch.setattr(software, "_version", installed.get)
    monkeypatch.setattr(fixes, "takes_packages", lambda: True)
    return installed, needed


def only(findings):
    (finding,) = findings
    return finding


def tried(monkeypatch, done, answer):
    monkeypatch.setattr(opengl, "run_python", lambda code, environment=None: (done, answer))


def test_a_machine_on_which_these_tests_run_can_evolve(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    for word in ("Python 3.", "mujoco 3.", "dm-control", "cores", "times faster than in real time", "This machine can"):
        assert word in said
    assert not list(tmp_path.iterdir())


def test_only_a_fault_makes_it_fail_and_every_fault_comes_with_a_mend(monkeypatch, capsys):
    monkeypatch.setattr(doctor, "examine", lambda: iter([Finding("note", "no GL", "get GL")]))
    assert main(["doctor"]) == 0
    monkeypatch.setattr(doctor, "examine", lambda: iter([Finding("fault", "no mujoco", "get mujoco")]))
    assert main(["doctor"]) == 1
    assert "mend: get mujoco" in capsys.readouterr().out


def test_what_is_found_is_laid_out_in_lines_and_what_is_to_be_typed_stays_whole(monkeypatch):
    monkeypatch.setenv("COLUMNS", "70")
    command = "python -m pip install " + "x" * 100
    lines = str(Finding("fault", "much is wrong " * 20, f"{command}\nthen ask again")).splitlines()
    assert max(map(len, lines[:-2])) <= 70
    assert all(line.startswith("      ") for line in lines[1:])
    assert lines[-2:] == [f"      mend: {command}", "            then ask again"]


# --------------------------------------------------------------------------------------------- it survives all

ALONE = """
import sys
sys.modules[sys.argv[1]] = None
from walkerlab.view import opengl
from walkerlab.__main__ import main
opengl.run_python = lambda *_: (False, "not tried")
sys.exit(main(["doctor"]))
"""


@pytest.mark.parametrize("missing", ["pydantic", "numpy", "packaging", "mujoco", "loky"])
def test_it_speaks_where_no_package_can_be_loaded(missing, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", ALONE, missing], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert not done.stderr
    assert done.returncode == 1
    assert "Python 3." in done.stdout
    assert "mend: " in done.stdout


def test_where_a_package_is_missing_every_command_names_the_doctor(monkeypatch, capsys):
    monkeypatch.delitem(sys.modules, "walkerlab.commands.flags", raising=False)
    monkeypatch.setitem(sys.modules, "pydantic", None)
    monkeypatch.delitem(sys.modules, "walkerlab.settings.model", raising=False)
    monkeypatch.delattr("walkerlab.commands.flags", raising=False)
    assert main(["evolve"]) == 1
    assert "walkerlab doctor" in capsys.readouterr().err


def test_a_look_that_fails_is_a_fault_and_the_others_go_on(monkeypatch):
    def broken():
        raise ZeroDivisionError("by chance")
        yield

    def sound():
        yield Finding("ok", "sound")

    def in_vain():
        raise AssertionError

    monkeypatch.setattr(doctor, "LOOKS", {broken: (), in_vain: ("broken",), sound: ()})
    fault, good = doctor.examine()
    assert fault.level == "fault"
    assert "ZeroDivisionError: by chance" in fault.says
    assert good.says == "sound"


def test_a_look_needs_only_what_was_looked_at_before():
    seen = set()
    for look, needs in doctor.LOOKS.items():
        assert seen.issuperset(needs)
        seen.add(look.__name__)


def test_letters_that_a_terminal_has_not_end_nothing(tmp_path):
    there = tmp_path / "Ωmega"
    there.mkdir()
    code = (
        "from walkerlab.view import opengl; opengl.run_python = lambda *_: (True, '');"
        "opengl.find_backend = lambda: ('', '');"
        "from walkerlab.__main__ import main; main(['doctor'])"
    )
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=there, env=environment, capture_output=True, text=True, check=True
    )
    assert r"\u03a9mega" in done.stdout


# ------------------------------------------------------------------------------------------ Python and packages


def test_an_old_python_is_a_fault(monkeypatch):
    monkeypatch.setattr(software, "sys", SimpleNamespace(version_info=(3, 10, 4)))
    assert only(software.python()).level == "fault"
    monkeypatch.setattr(software, "sys", SimpleNamespace(version_info=(3, 11, 0)))
    assert only(software.python()).level == "ok"


def test_mujoco_4_is_a_fault_with_its_reason_and_its_mend(versions):
    installed, needed = versions
    installed |= {"mujoco": "4.0.0", "numpy": "2.4"}
    needed += ["mujoco<4,>=3.17", "numpy>=2.1", 'pytest>=8; extra == "test"']
    good, fault = software.packages()
    assert fault.level == "fault"
    assert "mujoco 4.0.0; walkerlab needs 3.17 or newer, under 4" in fault.says
    assert "dm_control" in fault.says
    assert fault.mend.endswith('-m pip install "mujoco<4,>=3.17"')
    assert "numpy 2.4" in good.says
    assert "mujoco" not in good.says
    assert "pytest" not in good.says


def test_what_a_robot_can_walk_without_is_a_note_and_all_of_it_has_one_mend(versions):
    _, needed = versions
    needed += ["jupyterlab>=4", "k3d>=3.2", "scipy>=1"]
    _, fault, note = software.packages()
    assert (fault.level, note.level) == ("fault", "note")
    assert fault.mend.endswith('pip install "scipy>=1"')
    assert note.mend.endswith('pip install "jupyterlab>=4" "k3d>=3.2"')


@pytest.mark.parametrize(("found", "levels"), [(None, ["ok"]), ("2026.1", ["ok"]), ("2020.1", ["ok", "note"])])
def test_of_a_cluster_nothing_is_said_unless_it_is_there_and_too_old(versions, found, levels):
    installed, needed = versions
    installed |= {"distributed": found} if found else {}
    needed += ["numpy>=2", "distributed>=2025.1; extra == 'cluster'"]
    installed["numpy"] = "2.4"
    assert [finding.level for finding in software.packages()] == levels


@pytest.mark.parametrize(
    ("broken", "mend"),
    [
        ("numpy is broken (ModuleNotFoundError: No module named 'numpy')", "--no-deps numpy=="),
        ("dm-control is broken (ImportError: no arena)", "--no-deps dm-control=="),
        ("dm-control is broken (ModuleNotFoundError: No module named 'lxml')", fixes.source()),
    ],
)
def test_the_package_that_is_broken_is_named_and_mended(monkeypatch, broken, mend):
    monkeypatch.setattr(fixes, "takes_packages", lambda: True)
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    tried(monkeypatch, False, broken)
    finding = only(software.walk())
    assert finding.level == "fault"
    assert broken in finding.says
    assert mend in finding.mend


def test_a_variable_that_keeps_robots_from_walking_is_to_be_taken_away(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "bogus")
    monkeypatch.setattr(opengl, "run_python", lambda code, environment=None: (bool(environment), "no such GL"))
    finding = only(software.walk())
    assert finding.level == "fault"
    assert finding.mend == fixes.unset("MUJOCO_GL")


def test_a_probe_that_hangs_is_given_up(monkeypatch):
    def hang(command, **_):
        raise subprocess.TimeoutExpired(command, 1)

    monkeypatch.setattr(subprocess, "run", hang)
    assert only(software.walk()).level == "fault"


@pytest.mark.parametrize("is_own", [True, False])
def test_a_python_that_takes_no_packages_is_mended_by_another(monkeypatch, tmp_path, is_own):
    prefix = sys.prefix if is_own else sys.base_prefix
    monkeypatch.setattr(fixes.sys, "prefix", prefix)
    monkeypatch.setattr(fixes.sys, "base_prefix", sys.base_prefix if is_own else prefix)
    monkeypatch.setattr(fixes.os, "access", lambda *_: False)
    monkeypatch.setattr(fixes.sysconfig, "get_path", lambda _: str(tmp_path))
    (tmp_path / "EXTERNALLY-MANAGED").touch()
    *_, made, filled = fixes.install("numpy>=2").splitlines()
    assert made.endswith(f"-m venv {fixes.HOME}")
    assert filled.endswith(f"-m pip install {fixes.source()}")
    (tmp_path / "EXTERNALLY-MANAGED").unlink()
    monkeypatch.setattr(fixes.os, "access", lambda *_: True)
    assert fixes.install("numpy>=2").endswith('-m pip install "numpy>=2"')


def test_debian_s_python_gets_its_venv_first(monkeypatch):
    monkeypatch.setattr(fixes.platform, "system", lambda: "Linux")
    monkeypatch.setattr(fixes, "find_spec", lambda name: None)
    assert "python3-venv" in fixes.new_environment("python3").splitlines()[0]
    assert len(fixes.new_environment("python3").splitlines()) == 3


def test_what_is_installed_again_is_what_was_installed(monkeypatch):
    monkeypatch.setattr(fixes, "__file__", "/nowhere/walkerlab/commands/doctor/mends.py")
    url = {"url": Path("/srv/our course").as_uri()}
    monkeypatch.setattr(fixes, "distribution", lambda _: SimpleNamespace(read_text=lambda _: json.dumps(url)))
    assert fixes.source() == f'"{Path("/srv/our course")}"'


# ------------------------------------------------------------------------------------------------ this computer


def test_a_folder_that_cannot_be_written_to_is_a_fault(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert only(hardware.folder()).level == "ok"
    assert not list(tmp_path.iterdir())
    monkeypatch.setattr(hardware.Path, "cwd", lambda: tmp_path / "missing")
    assert only(hardware.folder()).level == "fault"


@pytest.mark.parametrize(("free", "level"), [(1e6, "fault"), (50e6, "note"), (1e9, "ok")])
def test_a_disk_that_is_nearly_full_is_told_with_what_a_run_takes(tmp_path, monkeypatch, free, level):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(hardware.shutil, "disk_usage", lambda _: SimpleNamespace(free=free))
    finding = only(hardware.folder())
    assert finding.level == level
    assert level == "ok" or "0.9 kB for each robot" in finding.says


def test_files_that_hide_packages_are_a_fault(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "walk.py").touch()
    assert not list(hardware.place())
    (tmp_path / "mujoco.py").touch()
    assert "mujoco.py" in only(hardware.place()).says


@pytest.mark.skipif(sys.platform == "win32", reason="Windows keeps a folder that somebody is in")
def test_a_folder_that_is_gone_is_a_fault(tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    assert only(hardware.place()).level == "fault"


@pytest.mark.parametrize(
    ("usable", "there", "granted", "bound", "word"),
    [
        (1, 1, None, 1, "nothing is broken"),
        (1, 8, "1", 8, fixes.unset("LOKY_MAX_CPU_COUNT")),
        (1, 8, None, 1, "taskset"),
        (1, 8, "4", 8, "Docker"),
        (2, 8, None, 2, ""),
        (8, 8, "8", 8, ""),
    ],
)
def test_each_reason_for_a_single_core_has_its_own_mend(monkeypatch, usable, there, granted, bound, word):
    monkeypatch.delenv("LOKY_MAX_CPU_COUNT", raising=False)
    if granted:
        monkeypatch.setenv("LOKY_MAX_CPU_COUNT", granted)
    monkeypatch.setattr("walkerlab.simulation.workers.n_cores", lambda: usable)
    monkeypatch.setattr(hardware.os, "cpu_count", lambda: there)
    monkeypatch.setattr(hardware.os, "sched_getaffinity", lambda _: range(bound), raising=False)
    monkeypatch.setattr(hardware.sys, "platform", "linux")
    finding = only(hardware.cores())
    assert finding.level == ("note" if usable == 1 else "ok")
    assert word in finding.mend
    assert bool(word) == bool(finding.mend)


def test_a_number_of_cores_that_is_none_is_a_fault(monkeypatch):
    monkeypatch.setenv("LOKY_MAX_CPU_COUNT", "many")
    finding = only(hardware.cores())
    assert finding.level == "fault"
    assert finding.mend == fixes.unset("LOKY_MAX_CPU_COUNT")


def test_a_folder_in_which_no_run_can_be_kept_is_a_fault_and_nothing_is_left_there(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tried(monkeypatch, False, "RunFileError: run.walk cannot be used as a run file: disk I/O error")
    finding = only(hardware.keep())
    assert finding.level == "fault"
    assert finding.says.endswith("disk I/O error")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("died_of", "word"),
    [("[Errno 13] Permission denied", "chmod 1777 /dev/shm"), ("Resource temporarily unavailable", "ulimit -u")],
)
def test_workers_that_cannot_start_are_a_fault_with_the_mend(monkeypatch, died_of, word):
    tried(monkeypatch, False, f"OSError: {died_of}")
    finding = only(hardware.workers())
    assert finding.level == "fault"
    assert word in finding.mend
    assert "ThreadPoolExecutor" in finding.mend


def test_missing_gl_is_a_note_that_films_need_it(monkeypatch):
    monkeypatch.setattr(opengl, "find_backend", lambda: None)
    finding = only(hardware.drawing())
    assert finding.level == "note"
    assert "only films and 3D pictures need it" in finding.says
    assert finding.mend


def test_a_gl_is_named_with_what_to_set(monkeypatch):
    monkeypatch.setattr(opengl, "find_backend", lambda: ("egl", "some GL"))
    finding = only(hardware.drawing())
    assert finding.level == "ok"
    assert "some GL" in finding.says
    assert "MUJOCO_GL=egl" in finding.says


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no root")
def test_root_needs_no_sudo_and_who_has_none_must_ask(monkeypatch):
    command = "sudo apt-get update && sudo apt-get install x"
    monkeypatch.setattr(opengl.os, "geteuid", lambda: 0)
    assert opengl.adapt_sudo(command) == "apt-get update && apt-get install x"
    monkeypatch.setattr(opengl.os, "geteuid", lambda: 1000)
    monkeypatch.setattr(opengl.shutil, "which", lambda _: "/usr/bin/sudo")
    assert opengl.adapt_sudo(command) == command
    monkeypatch.setattr(opengl.shutil, "which", lambda _: None)
    assert opengl.adapt_sudo(command).startswith("ask the administrator of this computer to run: apt-get update")
    assert opengl.adapt_sudo("update the driver") == "update the driver"


def test_the_advice_of_environment_md_is_the_doctors():
    text = (Path(__file__).parents[1] / "environment.md").read_text(encoding="utf-8")
    for family in ("debian", "fedora"):
        assert opengl.INSTALL_COMMANDS[family].rpartition("sudo ")[2] in text
