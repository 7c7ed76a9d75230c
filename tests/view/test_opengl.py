"""An OpenGL backend is found without risk to the calling process, and otherwise the user learns how to install one."""

import subprocess

import pytest

from walkerlab.view import opengl


@pytest.mark.parametrize(
    ("program", "expected_success", "expected_output"),
    [
        ("print('first'); print('last')", True, "last"),
        ("raise ValueError('why')", False, "ValueError: why"),
        ("import os; os.abort()", False, "the process ended with code"),
    ],
)
def test_a_program_that_crashes_is_reported_as_failed(program, expected_success, expected_output):
    succeeded, output = opengl.run_python(program)
    assert succeeded is expected_success
    assert expected_output in output


def test_a_program_that_hangs_is_reported_as_failed(monkeypatch):
    def hang(command: list[str], **_: object) -> None:
        raise subprocess.TimeoutExpired(command, 1)

    monkeypatch.setattr(subprocess, "run", hang)
    assert opengl.run_python("") == (False, f"no answer within {opengl.MAX_CHILD_SECONDS} s")


@pytest.mark.parametrize(
    ("chosen", "system", "candidates"),
    [
        (None, "Linux", ["egl", "osmesa"]),
        (None, "Windows", [""]),
        (None, "Darwin", [""]),
        ("glfw", "Linux", ["glfw"]),
        ("", "Linux", ["egl", "osmesa"]),
    ],
)
def test_a_backend_set_by_the_user_is_the_only_candidate(monkeypatch, chosen, system, candidates):
    monkeypatch.setattr(opengl.platform, "system", lambda: system)
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    if chosen is not None:
        monkeypatch.setenv("MUJOCO_GL", chosen)
    assert opengl.candidate_backends() == candidates


def test_backends_are_tried_until_one_succeeds(monkeypatch):
    monkeypatch.setattr(opengl, "candidate_backends", lambda: ["first", "egl", "never tried"])
    results = {"first": (False, "ImportError"), "egl": (True, "a renderer")}
    monkeypatch.setattr(opengl, "run_python", lambda _, environment: results[environment["MUJOCO_GL"]])
    assert opengl.find_backend() == ("egl", "a renderer")
    monkeypatch.setattr(opengl, "run_python", lambda *_: (False, "no"))
    assert opengl.find_backend() is None


def test_mujoco_and_pyopengl_use_the_same_backend():
    assert opengl.backend_environment("egl") == {"MUJOCO_GL": "egl", "PYOPENGL_PLATFORM": "egl"}
    assert opengl.backend_environment("glfw") == {"MUJOCO_GL": "glfw"}
    assert opengl.backend_environment("") == {}


@pytest.mark.parametrize(
    ("system", "release", "phrase"),
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
def test_the_install_advice_fits_the_system(system, release, phrase):
    assert phrase in opengl.install_advice(system, release)


def test_a_chosen_backend_that_fails_is_to_be_unset(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    assert opengl.how_to_fix().startswith("unset MUJOCO_GL, which is 'glfw' here")
    assert opengl.unavailable_message().endswith("with MUJOCO_GL=glfw")
    monkeypatch.delenv("MUJOCO_GL")
    assert "MUJOCO_GL" not in opengl.unavailable_message()
