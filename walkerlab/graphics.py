"""A GL that draws without a screen: where to look for one, and how this system gets it where there is none.

MuJoCo chooses its GL once, by the variable ``MUJOCO_GL``, when it is first imported, and a broken driver can end the
whole process. So all drawing is done, or tried, in a process of its own.
"""

from __future__ import annotations  # for the doctor, whom a Python that is too old must be able to read

import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping

PATIENCE = 120  # s for something tried out, after which it counts as failed

DRAW = """
import mujoco
context = mujoco.GLContext(64, 64)
context.make_current()
from OpenGL import GL
print(GL.glGetString(GL.GL_RENDERER).decode())
"""

GL_PACKAGES = {
    "debian": "sudo apt-get update && sudo apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri",
    "fedora": "sudo dnf install mesa-libEGL mesa-libGL mesa-dri-drivers",
    "suse": "sudo zypper install Mesa-libEGL1 Mesa-dri",
    "arch": "sudo pacman -S mesa",
    "alpine": "use a Linux with glibc, such as Debian: there is no MuJoCo for Alpine's musl",
}
"""How each family of Linux distributions gets a GL that needs no screen."""


def backends() -> list[str]:
    """Name what ``MUJOCO_GL`` can be here, the likeliest first; "" leaves the choice to MuJoCo.

    What the user has set comes first, and alone.
    """
    if chosen := os.environ.get("MUJOCO_GL"):
        return [chosen]
    return ["egl", "osmesa"] if platform.system() == "Linux" else [""]


def variables(backend: str) -> dict[str, str]:
    """Return the environment variables with which a process draws by this backend."""
    is_named_alike = backend in ("egl", "osmesa")  # by MuJoCo and by PyOpenGL, and both must mean the same
    return ({"MUJOCO_GL": backend} if backend else {}) | ({"PYOPENGL_PLATFORM": backend} if is_named_alike else {})


def find_gl() -> tuple[str, str] | None:
    """Try one backend after the other, each in a process of its own.

    Returns:
        The first with which something can be drawn, and what it is that draws; None if there is none.
    """
    tried: Iterator[tuple[str, tuple[bool, str]]] = (
        (backend, try_out(DRAW, variables(backend))) for backend in backends()
    )
    return next(((backend, answer) for backend, (done, answer) in tried if done), None)


def missing_gl() -> str:
    """Say that nothing draws here."""
    chosen = os.environ.get("MUJOCO_GL")
    return f"no GL that draws without a screen{f' with MUJOCO_GL={chosen}' if chosen else ''}"


def mend() -> str:
    """Say how this very system gets GL."""
    chosen, here = os.environ.get("MUJOCO_GL"), allowed(mend_for_gl(platform.system(), _release()))
    return f"unset MUJOCO_GL, which is {chosen!r} here; if that is not enough, {here}" if chosen else here


def mend_for_gl(system: str, release: Mapping[str, str]) -> str:
    """Say how a system gets GL.

    Args:
        system: as ``platform.system()`` names it.
        release: of a Linux, as ``/etc/os-release`` has it.
    """
    if system == "Windows":
        return "update the graphics driver, and leave MUJOCO_GL unset"
    if system == "Darwin":
        return "start Python from a session at the screen, not over SSH, and leave MUJOCO_GL unset"
    families = f"{release.get('ID', '')} {release.get('ID_LIKE', '')}".replace("ubuntu", "debian").replace(
        "rhel", "fedora"
    )
    known = next((GL_PACKAGES[family] for family in GL_PACKAGES if family in families), None)
    return known or "install Mesa's EGL (libEGL and its software driver) with this system's package manager"


def allowed(command: str) -> str:
    """Leave ``sudo`` out for root, who needs none and in a container has none; who has none otherwise must ask."""
    bare = command.replace("sudo ", "")
    if bare == command or (sys.platform != "win32" and os.geteuid() == 0):
        return bare
    return command if shutil.which("sudo") else f"ask whoever runs this computer for: {bare}"


def _release() -> Mapping[str, str]:
    try:
        return platform.freedesktop_os_release()
    except OSError:
        return {}


def try_out(code: str, environment: Mapping[str, str] | None = None) -> tuple[bool, str]:
    """Run some Python in a process of its own: whether it went well, and the last line that it said."""
    command = [sys.executable, "-c", code]
    try:
        tried = subprocess.run(
            command, capture_output=True, text=True, timeout=PATIENCE, env={**os.environ, **(environment or {})}
        )
    except subprocess.TimeoutExpired:
        return False, f"gave up after {PATIENCE} s"
    said = (tried.stdout if tried.returncode == 0 else tried.stderr).strip().splitlines()
    return tried.returncode == 0, said[-1] if said else f"it ended with code {tried.returncode}"
