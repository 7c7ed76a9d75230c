import subprocess

import pytest

from walkerlab import graphics


@pytest.mark.parametrize(
    ("code", "verdict", "answer"),
    [
        ("print('first'); print('last')", True, "last"),
        ("raise ValueError('why')", False, "ValueError: why"),
        ("import os; os.abort()", False, "it ended with code"),
    ],
)
def test_what_crashes_when_it_is_tried_out_hurts_nobody(code, verdict, answer):
    done, said = graphics.try_out(code)
    assert done is verdict
    assert answer in said


def test_what_hangs_is_given_up(monkeypatch):
    def hang(command: list[str], **_: object) -> None:
        raise subprocess.TimeoutExpired(command, 1)

    monkeypatch.setattr(subprocess, "run", hang)
    assert graphics.try_out("") == (False, f"gave up after {graphics.PATIENCE} s")


@pytest.mark.parametrize(
    ("chosen", "system", "tried"),
    [
        (None, "Linux", ["egl", "osmesa"]),
        (None, "Windows", [""]),
        (None, "Darwin", [""]),
        ("glfw", "Linux", ["glfw"]),
        ("", "Linux", ["egl", "osmesa"]),
    ],
)
def test_what_the_user_has_chosen_is_tried_alone(monkeypatch, chosen, system, tried):
    monkeypatch.setattr(graphics.platform, "system", lambda: system)
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    if chosen is not None:
        monkeypatch.setenv("MUJOCO_GL", chosen)
    assert graphics.backends() == tried


def test_backends_are_tried_until_one_draws(monkeypatch):
    monkeypatch.setattr(graphics, "backends", lambda: ["first", "egl", "never"])
    draws = {"first": (False, "ImportError"), "egl": (True, "some GL")}
    monkeypatch.setattr(graphics, "try_out", lambda _, variables: draws[variables["MUJOCO_GL"]])
    assert graphics.find_gl() == ("egl", "some GL")
    monkeypatch.setattr(graphics, "try_out", lambda *_: (False, "no"))
    assert graphics.find_gl() is None


def test_mujoco_and_pyopengl_are_told_the_same():
    assert graphics.variables("egl") == {"MUJOCO_GL": "egl", "PYOPENGL_PLATFORM": "egl"}
    assert graphics.variables("glfw") == {"MUJOCO_GL": "glfw"}
    assert graphics.variables("") == {}


@pytest.mark.parametrize(
    ("system", "release", "word"),
    [
        ("Linux", {"ID": "debian"}, "apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri"),
        ("Linux", {"ID": "ubuntu", "ID_LIKE": "debian"}, "apt-get"),
        ("Linux", {"ID": "linuxmint", "ID_LIKE": "ubuntu"}, "apt-get"),
        ("Linux", {"ID": "fedora"}, "dnf install mesa-libEGL"),
        ("Linux", {"ID": "rocky", "ID_LIKE": "rhel centos fedora"}, "dnf"),
        ("Linux", {"ID": "opensuse-leap", "ID_LIKE": "suse opensuse"}, "zypper"),
        ("Linux", {"ID": "arch"}, "pacman"),
        ("Linux", {}, "package manager"),
        ("Windows", {}, "graphics driver"),
        ("Darwin", {}, "SSH"),
    ],
)
def test_each_system_gets_its_own_mend(system, release, word):
    assert word in graphics.mend_for_gl(system, release)


def test_a_choice_that_does_not_draw_is_to_be_taken_back(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    assert graphics.mend().startswith("unset MUJOCO_GL, which is 'glfw' here")
    assert graphics.missing_gl().endswith("with MUJOCO_GL=glfw")
    monkeypatch.delenv("MUJOCO_GL")
    assert "MUJOCO_GL" not in graphics.missing_gl()
