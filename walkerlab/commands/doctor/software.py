"""Looks at Python, at its packages, and at whether they let a robot walk."""

from __future__ import annotations  # a Python that is too old must be able to read this file, and say so

import os
import platform
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version

from walkerlab.commands.doctor import fixes
from walkerlab.commands.doctor.finding import Finding
from walkerlab.view import opengl

OLDEST_PYTHON = (3, 11)

CAN_WAIT = {
    "jupyterlab": "only the notebooks need it",
    "ipywidgets": "robots evolve without it, but there are no notebooks, replays and reports",
    "anywidget": "robots evolve without it, but there are no notebooks, replays and reports",
    "k3d": "robots evolve without it, but there are no replays and reports",
    "av": "only films need it",
    "distributed": "only a cluster needs it",
    "dask-jobqueue": "only a cluster needs it",
}
"""Packages without which a robot can walk."""

NAMED = ("mujoco", "dm-control", "numpy", "jupyterlab")
"""Packages whose versions whoever is asked for help wants to know."""

WHY = {"mujoco": "dm_control reads what mujoco 4 no longer has"}
MODULES = {
    "numpy": "numpy",
    "scipy": "scipy",
    "pandas": "pandas",
    "pydantic": "pydantic",
    "loky": "loky",
    "mujoco": "mujoco",
    "dm-control": "dm_control.composer",
}
"""What is imported of each package without which no robot walks, each before those that need it."""

LOAD = """
import sys
from importlib import import_module
for package, module in {modules!r}.items():
    try:
        import_module(module)
    except BaseException as error:
        sys.exit(f"{{package}} is broken ({{type(error).__name__}}: {{' '.join(str(error).split())}})"[:300])
"""

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


def python() -> Iterator[Finding]:
    """Check the age of Python."""
    name, needed = f"Python {platform.python_version()}", ".".join(map(str, OLDEST_PYTHON))
    if sys.version_info[:2] >= OLDEST_PYTHON:
        yield Finding("ok", f"{name}, {platform.system()} {platform.machine()}")
    else:
        yield Finding("fault", f"{name} is too old; walkerlab needs {needed} or newer", fixes.newer_python(needed))


def packages() -> Iterator[Finding]:
    """Hold what is installed against walkerlab's own list of requirements, as lines like ``mujoco<4,>=3.17``."""
    try:
        needed = requires("walkerlab") or []
        from packaging.requirements import Requirement
    except PackageNotFoundError:
        yield Finding("fault", "walkerlab itself is not installed", fixes.install(fixes.source()))
        return
    except ImportError:
        yield Finding("fault", "packaging is not installed; walkerlab needs it", fixes.install("packaging"))
        return
    wrong, n_good = dict[str, Requirement](), 0
    for one in map(Requirement, needed):
        found, extra = _version(one.name), "cluster" if "cluster" in str(one.marker or "") else ""
        if (extra and not found) or not (one.marker is None or one.marker.evaluate({"extra": extra})):
            continue
        if found and one.specifier.contains(found, prereleases=True):
            n_good += 1
        else:
            one.marker = None
            wrong[one.name] = one
    named = [f"{name} {_version(name)}" for name in NAMED if name not in wrong and _version(name)]
    yield Finding(
        "ok", f"walkerlab {_version('walkerlab')}, {', '.join(named)} and {n_good - len(named)} more packages"
    )
    for can_wait in (False, True):
        if names := [name for name in wrong if (name in CAN_WAIT) == can_wait]:
            said = "\n".join(_wrong(name, str(wrong[name].specifier)) for name in names)
            yield Finding("note" if can_wait else "fault", said, fixes.install(*(str(wrong[name]) for name in names)))


def _wrong(name: str, specifier: str) -> str:
    found, why = _version(name), WHY.get(name) or CAN_WAIT.get(name)
    bounds = sorted(specifier.split(","), reverse=True)
    wanted = ", ".join(f"{one[2:]} or newer" if one[0] == ">" else f"under {one[1:]}" for one in bounds)
    return f"{name} {found or 'is not installed'}; walkerlab needs {wanted}{f': {why}' if why else ''}"


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def walk() -> Iterator[Finding]:
    """Let one robot walk."""
    done, answer = opengl.run_python(WALK)
    chosen = os.environ.get("MUJOCO_GL")
    if done:
        yield Finding("ok", f"a robot walks, {answer} times faster than in real time on one core")
    elif chosen and opengl.run_python(WALK, {"MUJOCO_GL": ""})[0]:
        yield Finding("fault", f"no robot can walk while MUJOCO_GL is {chosen!r}: {answer}", fixes.unset("MUJOCO_GL"))
    else:
        are_sound, broken = opengl.run_python(LOAD.format(modules=MODULES))
        culprit = broken.partition(" is broken")[0]
        if are_sound or culprit not in MODULES:
            yield Finding("fault", f"no robot can walk: {answer}", fixes.install("--force-reinstall", fixes.source()))
        else:
            yield Finding("fault", f"no robot can walk: {broken}", fixes.repair(culprit, broken))
