"""What this machine can do, and the mend for what it cannot. All that could crash is tried in another process."""

import os
import platform
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import Literal

from packaging.requirements import Requirement

from walkerlab import graphics

OLDEST_PYTHON = (3, 11)
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
    yield drawing()


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
    from walkerlab.workers import n_cores

    usable, all_of_them = n_cores(), os.cpu_count() or 1
    return Finding("ok", f"{usable} of {all_of_them} cores may be used")


def walk() -> Finding:
    """Let one robot walk."""
    done, answer = graphics.try_out(WALK)
    if done:
        return Finding("ok", f"a robot walks, {answer} times faster than in real time on one core")
    return Finding(
        "fault", f"no robot can walk: {answer}", f'"{sys.executable}" -m pip install --force-reinstall walkerlab'
    )


def drawing() -> Finding:
    """Look for a GL that draws without a screen."""
    if found := graphics.find_gl():
        backend, renderer = found
        tip = f" (pictures of your own: set MUJOCO_GL={backend} before Python starts)" if backend else ""
        return Finding("ok", f"films and 3D pictures can be drawn by {renderer}{tip}")
    return Finding("note", f"{graphics.missing_gl()}: only films and 3D pictures need it", graphics.mend())
