"""Checks of Python, its packages and the simulation of a walk."""

from __future__ import annotations  # old versions of Python must be able to import this file

import os
import platform
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version

from walkerlab.commands.doctor import fixes
from walkerlab.commands.doctor.finding import Finding
from walkerlab.view import opengl

OLDEST_PYTHON = (3, 11)

OPTIONAL_PACKAGES = {
    "jupyterlab": "only the notebooks need it",
    "ipywidgets": "only notebooks, replays and reports need it",
    "anywidget": "only notebooks, replays and reports need it",
    "k3d": "only replays and reports need it",
    "av": "only films need it",
    "distributed": "only a cluster needs it",
    "dask-jobqueue": "only a cluster needs it",
}
"""Optional packages, and what requires them."""

REPORTED_PACKAGES = ("mujoco", "dm-control", "numpy", "jupyterlab")
"""Packages whose versions are printed, because they matter for support."""

VERSION_LIMIT_REASONS = {"mujoco": "dm_control uses features that mujoco 4 no longer has"}
SIMULATION_MODULES = {
    "numpy": "numpy",
    "scipy": "scipy",
    "pandas": "pandas",
    "pydantic": "pydantic",
    "loky": "loky",
    "mujoco": "mujoco",
    "dm-control": "dm_control.composer",
}
"""Module to import of each package that a simulation needs; dependencies come first."""

IMPORT_MODULES = """
import sys
from importlib import import_module
for package, module in {modules!r}.items():
    try:
        import_module(module)
    except BaseException as error:
        sys.exit(f"{{package}} is broken ({{type(error).__name__}}: {{' '.join(str(error).split())}})"[:300])
"""

SIMULATE_WALK = """
import time
import walkerlab as wl
settings = wl.Settings().with_(duration=8)
robot = wl.generate_robot_population(settings.robot, 1, seed=0)[0]
wl.simulate(wl.Genome(robot), settings)
start = time.perf_counter()
wl.simulate(wl.Genome(robot), settings)
print(f"{8 / (time.perf_counter() - start):.0f}")
"""


def check_python() -> Iterator[Finding]:
    """Check the version of Python."""
    name = f"Python {platform.python_version()}"
    needed = ".".join(map(str, OLDEST_PYTHON))
    if sys.version_info[:2] >= OLDEST_PYTHON:
        yield Finding("ok", f"{name}, {platform.system()} {platform.machine()}")
    else:
        yield Finding("fault", f"{name} is too old; walkerlab needs {needed} or newer", fixes.install_python(needed))


def check_packages() -> Iterator[Finding]:
    """Compare the installed packages with the requirements of walkerlab, such as ``mujoco<4,>=3.17``."""
    try:
        needed = requires("walkerlab") or []
        from packaging.requirements import Requirement
    except PackageNotFoundError:
        yield Finding("fault", "walkerlab itself is not installed", fixes.install_commands(fixes.find_source()))
        return
    except ImportError:
        yield Finding("fault", "packaging is not installed; walkerlab needs it", fixes.install_commands("packaging"))
        return
    unmet: dict[str, Requirement] = {}
    n_met = 0
    for requirement in map(Requirement, needed):
        installed = _installed_version(requirement.name)
        extra = "cluster" if "cluster" in str(requirement.marker or "") else ""
        applies = requirement.marker is None or requirement.marker.evaluate({"extra": extra})
        if (extra and not installed) or not applies:
            continue
        if installed and requirement.specifier.contains(installed, prereleases=True):
            n_met += 1
        else:
            requirement.marker = None
            unmet[requirement.name] = requirement
    reported = [
        f"{name} {_installed_version(name)}"
        for name in REPORTED_PACKAGES
        if name not in unmet and _installed_version(name)
    ]
    yield Finding(
        "ok",
        f"walkerlab {_installed_version('walkerlab')}, {', '.join(reported)} and {n_met - len(reported)} more packages",
    )
    for is_optional in (False, True):
        if names := [name for name in unmet if (name in OPTIONAL_PACKAGES) == is_optional]:
            message = "\n".join(_describe_unmet(name, str(unmet[name].specifier)) for name in names)
            fix = fixes.install_commands(*(str(unmet[name]) for name in names))
            yield Finding("note" if is_optional else "fault", message, fix)


def _describe_unmet(name: str, specifier: str) -> str:
    """Describe a requirement that is not met: installed version, required versions and reason."""
    installed = _installed_version(name)
    reason = VERSION_LIMIT_REASONS.get(name) or OPTIONAL_PACKAGES.get(name)
    bounds = sorted(specifier.split(","), reverse=True)
    versions = ", ".join(f"{one[2:]} or newer" if one[0] == ">" else f"below {one[1:]}" for one in bounds)
    return f"{name} {installed or 'is not installed'}; walkerlab needs {versions}{f': {reason}' if reason else ''}"


def _installed_version(package: str) -> str | None:
    """Return the installed version of a package; None if it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def check_walk() -> Iterator[Finding]:
    """Simulate the walk of one robot; if it fails, find the package that cannot be imported."""
    succeeded, output = opengl.run_python(SIMULATE_WALK)
    backend = os.environ.get("MUJOCO_GL")
    if succeeded:
        yield Finding("ok", f"a walk is simulated {output} times faster than in real time on one core")
        return
    if backend and opengl.run_python(SIMULATE_WALK, {"MUJOCO_GL": ""})[0]:
        message = f"walks cannot be simulated while MUJOCO_GL is {backend!r}: {output}"
        yield Finding("fault", message, fixes.unset_variable("MUJOCO_GL"))
        return
    imports_succeed, import_error = opengl.run_python(IMPORT_MODULES.format(modules=SIMULATION_MODULES))
    package = import_error.partition(" is broken")[0]
    if imports_succeed or package not in SIMULATION_MODULES:
        fix = fixes.install_commands("--force-reinstall", fixes.find_source())
        yield Finding("fault", f"walks cannot be simulated: {output}", fix)
    else:
        yield Finding(
            "fault", f"walks cannot be simulated: {import_error}", fixes.reinstall_command(package, import_error)
        )
