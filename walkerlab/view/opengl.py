"""Off-screen OpenGL: which backend is available, and how to install one on this system.

MuJoCo reads its OpenGL backend from the environment variable ``MUJOCO_GL`` when it is first imported, and a broken
driver can crash the process. Therefore each attempt to use OpenGL runs in a separate process.
"""

from __future__ import annotations  # the doctor also imports this in versions of Python that are too old

import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Mapping

MAX_CHILD_SECONDS = 120  # s after which a child process is considered to hang

RENDERER_PROGRAM = """
import mujoco
context = mujoco.GLContext(64, 64)
context.make_current()
from OpenGL import GL
print(GL.glGetString(GL.GL_RENDERER).decode())
"""
"""Program that creates an OpenGL context and prints the name of its renderer."""

INSTALL_COMMANDS = {
    "debian": "sudo apt-get update && sudo apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri",
    "fedora": "sudo dnf install mesa-libEGL mesa-libGL mesa-dri-drivers",
    "suse": "sudo zypper install Mesa-libEGL1 Mesa-dri",
    "arch": "sudo pacman -S mesa",
    "alpine": "use a Linux with glibc, such as Debian: there is no MuJoCo for Alpine's musl",
}
"""How to install off-screen OpenGL, for each family of Linux distributions."""


def candidate_backends() -> list[str]:
    """Return the values of ``MUJOCO_GL`` to try, the most likely first; "" is MuJoCo's default.

    If the user has set the variable, its value is the only candidate.
    """
    if chosen := os.environ.get("MUJOCO_GL"):
        return [chosen]
    return ["egl", "osmesa"] if platform.system() == "Linux" else [""]


def backend_environment(backend: str) -> dict[str, str]:
    """Return the environment variables that select a backend."""
    environment: dict[str, str] = {}
    if backend:
        environment["MUJOCO_GL"] = backend
    if backend in ("egl", "osmesa"):  # MuJoCo and PyOpenGL must use the same backend
        environment["PYOPENGL_PLATFORM"] = backend
    return environment


def find_backend() -> tuple[str, str] | None:
    """Try the candidate backends, each in a separate process.

    Returns:
        The first available backend and the name of its renderer; None if no backend is available.
    """
    for backend in candidate_backends():
        succeeded, output = run_python(RENDERER_PROGRAM, backend_environment(backend))
        if succeeded:
            return backend, output
    return None


def unavailable_message() -> str:
    """Return the message for unavailable OpenGL."""
    chosen = os.environ.get("MUJOCO_GL")
    return f"off-screen OpenGL is not available{f' with MUJOCO_GL={chosen}' if chosen else ''}"


def how_to_fix() -> str:
    """Return how to make off-screen OpenGL available on this system."""
    chosen = os.environ.get("MUJOCO_GL")
    advice = adapt_sudo(install_advice(platform.system(), _os_release()))
    return f"unset MUJOCO_GL, which is {chosen!r} here; if that does not help, {advice}" if chosen else advice


def install_advice(system: str, release: Mapping[str, str]) -> str:
    """Return how to install off-screen OpenGL on a system.

    Args:
        system: Name of the system, as ``platform.system()`` returns it.
        release: Content of ``/etc/os-release`` on Linux; empty on other systems.
    """
    if system == "Windows":
        return "update the graphics driver, and leave MUJOCO_GL unset"
    if system == "Darwin":
        return "start Python in a desktop session, not over SSH, and leave MUJOCO_GL unset"
    families = f"{release.get('ID', '')} {release.get('ID_LIKE', '')}".replace("ubuntu", "debian").replace(
        "rhel", "fedora"
    )
    command = next((INSTALL_COMMANDS[family] for family in INSTALL_COMMANDS if family in families), None)
    return command or "install Mesa's EGL (libEGL and its software driver) with this system's package manager"


def adapt_sudo(command: str) -> str:
    """Adapt a command to the user's rights: root needs no ``sudo``, and users without it need the administrator."""
    without_sudo = command.replace("sudo ", "")
    if without_sudo == command or (sys.platform != "win32" and os.geteuid() == 0):
        return without_sudo
    return command if shutil.which("sudo") else f"ask the administrator of this computer to run: {without_sudo}"


def _os_release() -> Mapping[str, str]:
    try:
        return platform.freedesktop_os_release()
    except OSError:
        return {}


def run_python(program: str, environment: Mapping[str, str] | None = None) -> tuple[bool, str]:
    """Run a Python program in a separate process.

    Args:
        program: Source code.
        environment: Environment variables to add or replace.

    Returns:
        Whether the program succeeded, and the last line of its output, or of its error messages if it failed.
    """
    command = [sys.executable, "-c", program]
    try:
        child = subprocess.run(
            command,
            capture_output=True,
            text=True,
            timeout=MAX_CHILD_SECONDS,
            env={**os.environ, **(environment or {})},
        )
    except subprocess.TimeoutExpired:
        return False, f"no answer within {MAX_CHILD_SECONDS} s"
    succeeded = child.returncode == 0
    lines = (child.stdout if succeeded else child.stderr).strip().splitlines()
    return succeeded, lines[-1] if lines else f"the process ended with code {child.returncode}"
