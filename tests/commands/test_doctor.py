"""The doctor reports each fault with a way to fix it, and runs even where packages are missing."""

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
    """Installed versions by name, and requirements of walkerlab; tests fill them."""
    installed = {"walkerlab": "1.0"}
    needed = []
    monkeypatch.setattr(software, "requires", lambda _: needed)
    monkeypatch.setattr(software, "_installed_version", installed.get)
    monkeypatch.setattr(fixes, "allows_packages", lambda: True)
    return installed, needed


def only(findings):
    """Return the only finding of a check."""
    (finding,) = findings
    return finding


def set_result(monkeypatch, succeeded, output):
    """Set the result of all code that a check runs in another process."""
    monkeypatch.setattr(opengl, "run_python", lambda code, environment=None: (succeeded, output))


def test_the_computer_that_runs_these_tests_has_no_fault(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["doctor"]) == 0
    output = capsys.readouterr().out
    for word in (
        "Python 3.",
        "mujoco 3.",
        "dm-control",
        "cores",
        "times faster than in real time",
        "This computer can",
    ):
        assert word in output
    assert not list(tmp_path.iterdir())


def test_only_a_fault_gives_exit_code_1_and_it_is_printed_with_its_fix(monkeypatch, capsys):
    monkeypatch.setattr(doctor, "run_checks", lambda: iter([Finding("note", "no GL", "get GL")]))
    assert main(["doctor"]) == 0
    monkeypatch.setattr(doctor, "run_checks", lambda: iter([Finding("fault", "no mujoco", "get mujoco")]))
    assert main(["doctor"]) == 1
    assert "fix: get mujoco" in capsys.readouterr().out


def test_messages_are_wrapped_and_commands_are_not(monkeypatch):
    monkeypatch.setenv("COLUMNS", "70")
    command = "python -m pip install " + "x" * 100
    lines = str(Finding("fault", "much is wrong " * 20, f"{command}\nthen ask again")).splitlines()
    assert max(map(len, lines[:-2])) <= 70
    assert all(line.startswith("      ") for line in lines[1:])
    assert lines[-2:] == [f"      fix: {command}", "           then ask again"]


# ------------------------------------------------------------------------------------- missing packages and errors

WITHOUT_PACKAGE = """
import sys
sys.modules[sys.argv[1]] = None
from walkerlab.view import opengl
from walkerlab.__main__ import main
opengl.run_python = lambda *_: (False, "not tried")
sys.exit(main(["doctor"]))
"""


@pytest.mark.parametrize("missing", ["pydantic", "numpy", "packaging", "mujoco", "loky"])
def test_the_doctor_runs_without_packages(missing, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_PACKAGE, missing], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert not done.stderr
    assert done.returncode == 1
    assert "Python 3." in done.stdout
    assert "fix: " in done.stdout


def test_a_command_that_lacks_a_package_names_the_doctor(monkeypatch, capsys):
    monkeypatch.delitem(sys.modules, "walkerlab.commands.flags", raising=False)
    monkeypatch.setitem(sys.modules, "pydantic", None)
    monkeypatch.delitem(sys.modules, "walkerlab.settings.model", raising=False)
    monkeypatch.delattr("walkerlab.commands.flags", raising=False)
    assert main(["evolve"]) == 1
    assert "walkerlab doctor" in capsys.readouterr().err


def test_a_check_that_raises_is_a_fault_and_the_others_run(monkeypatch):
    def broken():
        raise ZeroDivisionError("by chance")
        yield

    def sound():
        yield Finding("ok", "sound")

    def skipped():
        raise AssertionError

    monkeypatch.setattr(doctor, "CHECKS", {broken: (), skipped: (broken,), sound: ()})
    fault, good = doctor.run_checks()
    assert fault.level == "fault"
    assert "ZeroDivisionError: by chance" in fault.message
    assert good.message == "sound"


def test_a_check_requires_only_earlier_checks():
    earlier = set()
    for check, required in doctor.CHECKS.items():
        assert earlier.issuperset(required)
        earlier.add(check)


def test_characters_that_the_terminal_cannot_print_are_escaped(tmp_path):
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
    assert only(software.check_python()).level == "fault"
    monkeypatch.setattr(software, "sys", SimpleNamespace(version_info=(3, 11, 0)))
    assert only(software.check_python()).level == "ok"


def test_mujoco_4_is_a_fault_with_a_reason_and_a_fix(versions):
    installed, needed = versions
    installed |= {"mujoco": "4.0.0", "numpy": "2.4"}
    needed += ["mujoco<4,>=3.17", "numpy>=2.1", 'pytest>=8; extra == "test"']
    good, fault = software.check_packages()
    assert fault.level == "fault"
    assert "mujoco 4.0.0; walkerlab needs 3.17 or newer, below 4" in fault.message
    assert "dm_control" in fault.message
    assert fault.fix.endswith('-m pip install "mujoco<4,>=3.17"')
    assert "numpy 2.4" in good.message
    assert "mujoco" not in good.message
    assert "pytest" not in good.message


def test_optional_packages_are_a_note_with_one_fix(versions):
    _, needed = versions
    needed += ["jupyterlab>=4", "k3d>=3.2", "scipy>=1"]
    _, fault, note = software.check_packages()
    assert (fault.level, note.level) == ("fault", "note")
    assert fault.fix.endswith('pip install "scipy>=1"')
    assert note.fix.endswith('pip install "jupyterlab>=4" "k3d>=3.2"')


@pytest.mark.parametrize(("found", "levels"), [(None, ["ok"]), ("2026.1", ["ok"]), ("2020.1", ["ok", "note"])])
def test_packages_of_the_cluster_are_reported_only_if_they_are_installed_and_too_old(versions, found, levels):
    installed, needed = versions
    installed |= {"distributed": found} if found else {}
    needed += ["numpy>=2", "distributed>=2025.1; extra == 'cluster'"]
    installed["numpy"] = "2.4"
    assert [finding.level for finding in software.check_packages()] == levels


@pytest.mark.parametrize(
    ("error", "fix"),
    [
        ("numpy is broken (ModuleNotFoundError: No module named 'numpy')", "--no-deps numpy=="),
        ("dm-control is broken (ImportError: no arena)", "--no-deps dm-control=="),
        ("dm-control is broken (ModuleNotFoundError: No module named 'lxml')", fixes.find_source()),
    ],
)
def test_a_broken_package_is_named_with_its_fix(monkeypatch, error, fix):
    monkeypatch.setattr(fixes, "allows_packages", lambda: True)
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    set_result(monkeypatch, False, error)
    finding = only(software.check_walk())
    assert finding.level == "fault"
    assert error in finding.message
    assert fix in finding.fix


def test_an_environment_variable_that_prevents_walks_is_to_be_unset(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "bogus")
    monkeypatch.setattr(opengl, "run_python", lambda code, environment=None: (bool(environment), "no such GL"))
    finding = only(software.check_walk())
    assert finding.level == "fault"
    assert finding.fix == fixes.unset_variable("MUJOCO_GL")


def test_a_check_that_hangs_is_a_fault(monkeypatch):
    def hang(command, **_):
        raise subprocess.TimeoutExpired(command, 1)

    monkeypatch.setattr(subprocess, "run", hang)
    assert only(software.check_walk()).level == "fault"


@pytest.mark.parametrize("is_virtual", [True, False])
def test_a_python_without_permission_to_install_needs_a_new_environment(monkeypatch, tmp_path, is_virtual):
    prefix = sys.prefix if is_virtual else sys.base_prefix
    monkeypatch.setattr(fixes.sys, "prefix", prefix)
    monkeypatch.setattr(fixes.sys, "base_prefix", sys.base_prefix if is_virtual else prefix)
    monkeypatch.setattr(fixes.os, "access", lambda *_: False)
    monkeypatch.setattr(fixes.sysconfig, "get_path", lambda _: str(tmp_path))
    (tmp_path / "EXTERNALLY-MANAGED").touch()
    monkeypatch.setattr(fixes, "FIRST_PYTHON_WITHOUT_LABMAZE", (4,))
    *_, create, install = fixes.install_commands("numpy>=2").splitlines()
    assert create.endswith(f"-m venv {fixes.ENVIRONMENT_FOLDER}")
    assert install.endswith(f"-m pip install {fixes.find_source()}")
    (tmp_path / "EXTERNALLY-MANAGED").unlink()
    monkeypatch.setattr(fixes.os, "access", lambda *_: True)
    assert fixes.install_commands("numpy>=2").endswith('-m pip install "numpy>=2"')


def test_debian_needs_a_package_for_venv(monkeypatch):
    monkeypatch.setattr(fixes.platform, "system", lambda: "Linux")
    monkeypatch.setattr(fixes, "find_spec", lambda name: None)
    monkeypatch.setattr(fixes, "FIRST_PYTHON_WITHOUT_LABMAZE", (4,))
    assert "python3-venv" in fixes.create_environment("python3").splitlines()[0]
    assert len(fixes.create_environment("python3").splitlines()) == 3


def test_where_labmaze_cannot_be_installed_dm_control_is_installed_first(monkeypatch):
    monkeypatch.setattr(fixes, "FIRST_PYTHON_WITHOUT_LABMAZE", (3,))
    for commands in (fixes.install_commands(fixes.find_source()), fixes.create_environment("python3")):
        dm_control, walkerlab = commands.splitlines()[-2:]
        assert dm_control.endswith("-m pip install --no-deps dm-control")
        assert walkerlab.endswith(f"-m pip install {fixes.find_source()}")


def test_the_source_is_the_folder_from_which_walkerlab_was_installed(monkeypatch):
    monkeypatch.setattr(fixes, "__file__", "/nowhere/walkerlab/commands/doctor/fixes.py")
    url = {"url": Path("/srv/our course").as_uri()}
    monkeypatch.setattr(fixes, "distribution", lambda _: SimpleNamespace(read_text=lambda _: json.dumps(url)))
    assert fixes.find_source() == f'"{Path("/srv/our course")}"'


# ----------------------------------------------------------------------------------------------------- hardware


def test_a_folder_that_cannot_be_written_to_is_a_fault(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert only(hardware.check_writing()).level == "ok"
    assert not list(tmp_path.iterdir())
    monkeypatch.setattr(hardware.Path, "cwd", lambda: tmp_path / "missing")
    assert only(hardware.check_writing()).level == "fault"


@pytest.mark.parametrize(("free", "level"), [(1e6, "fault"), (50e6, "note"), (1e9, "ok")])
def test_little_free_space_is_reported_with_the_size_of_a_run(tmp_path, monkeypatch, free, level):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(hardware.shutil, "disk_usage", lambda _: SimpleNamespace(free=free))
    finding = only(hardware.check_writing())
    assert finding.level == level
    assert level == "ok" or "0.9 kB for each robot" in finding.message


def test_files_that_hide_packages_are_a_fault(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "walk.py").touch()
    assert not list(hardware.check_current_folder())
    (tmp_path / "mujoco.py").touch()
    assert "mujoco.py" in only(hardware.check_current_folder()).message


@pytest.mark.skipif(sys.platform == "win32", reason="Windows does not remove a folder that is in use")
def test_a_removed_folder_is_a_fault(tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    assert only(hardware.check_current_folder()).level == "fault"


@pytest.mark.parametrize(
    ("usable", "total", "setting", "n_affinity", "word"),
    [
        (1, 1, None, 1, "this is not a fault"),
        (1, 8, "1", 8, fixes.unset_variable("LOKY_MAX_CPU_COUNT")),
        (1, 8, None, 1, "taskset"),
        (1, 8, "4", 8, "Docker"),
        (2, 8, None, 2, ""),
        (8, 8, "8", 8, ""),
    ],
)
def test_each_reason_for_a_single_core_has_its_fix(monkeypatch, usable, total, setting, n_affinity, word):
    monkeypatch.delenv("LOKY_MAX_CPU_COUNT", raising=False)
    if setting:
        monkeypatch.setenv("LOKY_MAX_CPU_COUNT", setting)
    monkeypatch.setattr("walkerlab.simulation.workers.n_cores", lambda: usable)
    monkeypatch.setattr(hardware.os, "cpu_count", lambda: total)
    monkeypatch.setattr(hardware.os, "sched_getaffinity", lambda _: range(n_affinity), raising=False)
    monkeypatch.setattr(hardware.sys, "platform", "linux")
    finding = only(hardware.check_cores())
    assert finding.level == ("note" if usable == 1 else "ok")
    assert word in finding.fix
    assert bool(word) == bool(finding.fix)


def test_an_invalid_number_of_cores_is_a_fault(monkeypatch):
    monkeypatch.setenv("LOKY_MAX_CPU_COUNT", "many")
    finding = only(hardware.check_cores())
    assert finding.level == "fault"
    assert finding.fix == fixes.unset_variable("LOKY_MAX_CPU_COUNT")


def test_a_run_file_that_cannot_be_written_is_a_fault_and_leaves_no_files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    set_result(monkeypatch, False, "RunFileError: run.walk cannot be used as a run file: disk I/O error")
    finding = only(hardware.check_run_file())
    assert finding.level == "fault"
    assert finding.message.endswith("disk I/O error")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("error", "word"),
    [("[Errno 13] Permission denied", "chmod 1777 /dev/shm"), ("Resource temporarily unavailable", "ulimit -u")],
)
def test_workers_that_do_not_start_are_a_fault_with_a_fix(monkeypatch, error, word):
    set_result(monkeypatch, False, f"OSError: {error}")
    finding = only(hardware.check_workers())
    assert finding.level == "fault"
    assert word in finding.fix
    assert "ThreadPoolExecutor" in finding.fix


def test_missing_opengl_is_a_note(monkeypatch):
    monkeypatch.setattr(opengl, "find_backend", lambda: None)
    finding = only(hardware.check_graphics())
    assert finding.level == "note"
    assert "only films and 3D pictures need it" in finding.message
    assert finding.fix


def test_opengl_is_reported_with_the_variable_to_set(monkeypatch):
    monkeypatch.setattr(opengl, "find_backend", lambda: ("egl", "some GL"))
    finding = only(hardware.check_graphics())
    assert finding.level == "ok"
    assert "some GL" in finding.message
    assert "MUJOCO_GL=egl" in finding.message


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no root")
def test_commands_are_adapted_for_root_and_for_users_without_sudo(monkeypatch):
    command = "sudo apt-get update && sudo apt-get install x"
    monkeypatch.setattr(opengl.os, "geteuid", lambda: 0)
    assert opengl.adapt_sudo(command) == "apt-get update && apt-get install x"
    monkeypatch.setattr(opengl.os, "geteuid", lambda: 1000)
    monkeypatch.setattr(opengl.shutil, "which", lambda _: "/usr/bin/sudo")
    assert opengl.adapt_sudo(command) == command
    monkeypatch.setattr(opengl.shutil, "which", lambda _: None)
    assert opengl.adapt_sudo(command).startswith("ask the administrator of this computer to run: apt-get update")
    assert opengl.adapt_sudo("update the driver") == "update the driver"


def test_environment_md_contains_the_commands_of_the_doctor():
    text = (Path(__file__).parents[2] / "environment.md").read_text(encoding="utf-8")
    for family in ("debian", "fedora"):
        assert opengl.INSTALL_COMMANDS[family].rpartition("sudo ")[2] in text
