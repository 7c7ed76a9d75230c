"""What this machine can do, and the mend for what it cannot. All that could crash is tried in another process."""

import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import Literal

from packaging.requirements import Requirement

OLDEST_PYTHON = (3, 11)
PATIENCE = 120  # s for a probe, after which it counts as failed
FOR_NOTEBOOKS = ("ipywidgets", "jupyterlab")
WHY = {"mujoco": "dm_control reads model fields that mujoco 4 no longer has"}

WALK = """
import time
import walkerlab as wl
settings = wl.Settings().with_(duration=8)
robot = wl.generate_robot_population(settings.robot, 1, seed=0)[0]
wl.simulate(wl.Genome(robot), settings)
start = time.perf_counter()
wl.simulate(wl.Genome(robot), settings)
print(f"{8 / (time.perf_counter() - start):.0f}")
"""

DRAW = """
import mujoco
context = mujoco.GLContext(64, 64)
context.make_current()
from OpenGL import GL
print(GL.glGetString(GL.GL_RENDERER).decode())
"""

GL_PACKAGES = {
    "debian": "sudo apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri",
    "fedora": "sudo dnf install mesa-libEGL mesa-libGL mesa-dri-drivers",
    "suse": "sudo zypper install Mesa-libEGL1 Mesa-dri",
    "arch": "sudo pacman -S mesa",
    "alpine": "use a Linux with glibc, such as Debian: there is no MuJoCo for Alpine's musl",
}
"""How each family of Linux distributions gets a GL that needs no screen."""


@dataclass(frozen=True)
class Finding:
    """One thing looked at.

    Attributes:
        level: ``ok``; ``note``, something is missing that evolving does not need; ``fault``, it cannot evolve.
        says: what was found.
        mend: what to type or do about it.
    """

    level: Literal["ok", "note", "fault"]
    says: str
    mend: str = ""


def examine() -> Iterator[Finding]:
    """Look at everything, quickest first."""
    yield python(sys.version_info[:2])
    yield from packages(requires("walkerlab") or [])
    yield folder(Path.cwd())
    yield cores()
    yield walk()
    yield graphics()


def python(found: tuple[int, ...]) -> Finding:
    """Check the age of Python."""
    name, oldest = f"Python {platform.python_version()}, {platform.system()} {platform.machine()}", OLDEST_PYTHON
    if found >= oldest:
        return Finding("ok", name)
    needed = ".".join(map(str, oldest))
    return Finding("fault", name, f"install Python {needed} or newer and make a new virtual environment with it")


def packages(needed: list[str]) -> Iterator[Finding]:
    """Hold what is installed against walkerlab's own list of requirements, as lines like ``mujoco<4,>=3.17``."""
    good = [f"walkerlab {_version('walkerlab')}"]
    for requirement in map(Requirement, needed):
        if requirement.marker and not requirement.marker.evaluate({"extra": ""}):
            continue
        found = _version(requirement.name)
        if found and requirement.specifier.contains(found, prereleases=True):
            good.append(f"{requirement.name} {found}")
            continue
        wanted = f"{requirement.name} {found or 'is not installed'}; walkerlab needs {requirement.specifier}"
        why = WHY.get(requirement.name, "only the notebooks need it" if requirement.name in FOR_NOTEBOOKS else "")
        yield Finding(
            "note" if requirement.name in FOR_NOTEBOOKS else "fault",
            wanted + (f" ({why})" if why else ""),
            f'"{sys.executable}" -m pip install "{requirement}"',
        )
    yield Finding("ok", ", ".join(good))


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def folder(here: Path) -> Finding:
    """Try to write here, where ``walkerlab evolve`` would put its results."""
    try:
        with tempfile.TemporaryFile(dir=here):
            return Finding("ok", f"this folder can be written to: {here}")
    except OSError as error:
        return Finding("fault", f"this folder cannot be written to: {error.strerror}", "cd to a folder of your own")


def cores() -> Finding:
    """Count the cores that walks are shared out to."""
    from walkerlab.evaluation import n_cores

    usable, all_of_them = n_cores(), os.cpu_count() or 1
    return Finding("ok", f"{usable} of {all_of_them} cores may be used")


def walk() -> Finding:
    """Let one robot walk."""
    done, answer = _try_out(WALK)
    if done:
        return Finding("ok", f"a robot walks, {answer} times faster than in real time on one core")
    return Finding(
        "fault", f"no robot can walk: {answer}", f'"{sys.executable}" -m pip install --force-reinstall walkerlab'
    )


def graphics() -> Finding:
    """Look for a GL that draws without a screen."""
    chosen, system = os.environ.get("MUJOCO_GL"), platform.system()
    for backend in [chosen] if chosen else ["egl", "osmesa"] if system == "Linux" else [""]:
        done, answer = _try_out(DRAW, {"MUJOCO_GL": backend, "PYOPENGL_PLATFORM": backend} if backend else {})
        if done:
            tip = f", with MUJOCO_GL={backend} set before Python starts" if backend and not chosen else ""
            return Finding("ok", f"3D pictures can be drawn by {answer}{tip}")
    tried = f" with MUJOCO_GL={chosen}" if chosen else ""
    return Finding(
        "note", f"no GL that draws without a screen{tried}: only 3D pictures need it", mend_for_gl(system, _release())
    )


def mend_for_gl(system: str, release: Mapping[str, str]) -> str:
    """Say how this system gets GL.

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


def _release() -> Mapping[str, str]:
    try:
        return platform.freedesktop_os_release()
    except OSError:
        return {}


def _try_out(code: str, environment: Mapping[str, str] | None = None) -> tuple[bool, str]:
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
