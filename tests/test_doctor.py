import subprocess
from pathlib import Path

from walkerlab import graphics
from walkerlab.__main__ import main
from walkerlab.commands import doctor
from walkerlab.commands.doctor import Finding


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


def test_an_old_python_is_a_fault():
    assert doctor.python((3, 10)).level == "fault"
    assert doctor.python((3, 11)).level == "ok"


def test_mujoco_4_is_a_fault_with_its_reason_and_its_mend(monkeypatch):
    monkeypatch.setattr(doctor, "version", lambda package: {"mujoco": "4.0.0"}.get(package, "9.9"))
    fault, good = doctor.packages(["mujoco<4,>=3.17", "numpy>=2.1", 'pytest>=8; extra == "test"'])
    assert fault.level == "fault"
    assert "mujoco 4.0.0" in fault.says
    assert "dm_control" in fault.says
    assert fault.mend.endswith('-m pip install "mujoco<4,>=3.17"')
    assert "numpy 9.9" in good.says
    assert "pytest" not in good.says


def test_what_only_notebooks_need_is_a_note():
    missing, _ = doctor.packages(["jupyterlab>=999"])
    assert missing.level == "note"


def test_a_folder_that_cannot_be_written_to_is_a_fault(tmp_path):
    assert doctor.folder(tmp_path).level == "ok"
    assert doctor.folder(tmp_path / "missing").level == "fault"
    assert not list(tmp_path.iterdir())


def test_a_probe_that_hangs_is_given_up(monkeypatch):
    def hang(command: list[str], **_: object) -> None:
        raise subprocess.TimeoutExpired(command, 1)

    monkeypatch.setattr(subprocess, "run", hang)
    assert doctor.walk().level == "fault"


def test_missing_gl_is_a_note_that_films_need_it(monkeypatch):
    monkeypatch.setattr(graphics, "find_gl", lambda: None)
    finding = doctor.drawing()
    assert finding.level == "note"
    assert "only films and 3D pictures need it" in finding.says
    assert finding.mend


def test_a_gl_is_named_with_what_to_set(monkeypatch):
    monkeypatch.setattr(graphics, "find_gl", lambda: ("egl", "some GL"))
    finding = doctor.drawing()
    assert finding.level == "ok"
    assert "some GL" in finding.says
    assert "MUJOCO_GL=egl" in finding.says


def test_the_advice_of_environment_md_is_the_doctors():
    text = (Path(__file__).parents[1] / "environment.md").read_text(encoding="utf-8")
    for command in ("debian", "fedora"):
        assert graphics.GL_PACKAGES[command].removeprefix("sudo ") in text
