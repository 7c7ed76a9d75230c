"""Checks of the folder, the disk, the cores, the worker processes and the graphics."""

from __future__ import annotations  # old versions of Python must be able to import this file

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from walkerlab.commands.doctor import fixes
from walkerlab.commands.doctor.finding import Finding
from walkerlab.view import opengl

MB = 1e6  # bytes
RUN_SIZE = 5 * MB  # size of the folder of one run
ENOUGH_SPACE = 200 * MB  # enough for a course
SPACE_ADVICE = "a run needs about 5 MB, and a long one 0.9 kB for each robot"

WRITE_RUN = """
from concurrent.futures import ThreadPoolExecutor
import walkerlab as wl
small = wl.Settings().with_(population_size=4, generations=2, duration=1)
wl.evolve(small, {path!r}, ThreadPoolExecutor(1), progress=False)
print(wl.load({path!r}).n_generations)
"""

USE_WORKER = """
from walkerlab.simulation.workers import default_executor
print(default_executor().submit(abs, -1).result())
"""


def check_current_folder() -> Iterator[Finding]:
    """Check that the current folder exists and contains no file that hides a package."""
    try:
        here = Path.cwd()
    except FileNotFoundError:
        yield Finding("fault", "the current folder has been removed", f"cd {_writable_folder()}")
        return
    if files := sorted(_hiding_files(here)):
        message = (
            f"Python would import your {' and '.join(files)} in this folder instead of the packages of these names"
        )
        yield Finding("fault", message, "rename your files")


def check_writing() -> Iterator[Finding]:
    """Check that the current folder can be written to, and the free space on its disk."""
    here = Path.cwd()
    try:
        with tempfile.TemporaryFile(dir=here) as file:
            file.write(b"walk")
    except OSError as error:
        yield Finding("fault", f"{here} cannot be written to: {error.strerror}", f"cd {_writable_folder()}")
        return
    free = shutil.disk_usage(here).free
    if free > ENOUGH_SPACE:
        yield Finding("ok", f"this folder can be written to: {here}")
    else:
        message = f"only {free / MB:.0f} MB are free on the disk; {SPACE_ADVICE}"
        level = "note" if free > RUN_SIZE else "fault"
        yield Finding(level, message, f"delete files that you no longer need, or cd {_writable_folder()}")


def _hiding_files(here: Path) -> set[str]:
    """Return the names of the files in a folder that a notebook in it would import instead of a package."""
    packages = {"walkerlab", "mujoco", "dm_control", "numpy", "pandas", "matplotlib", "scipy", "pydantic", "random"}
    return {path.name for path in here.glob("*.py") if path.stem in packages}


def _writable_folder() -> str:
    """Return a folder that this user can write to, or a description of one."""
    candidates = (Path.home(), Path(tempfile.gettempdir()))
    return next((str(path) for path in candidates if os.access(path, os.W_OK)), "a folder that you can write to")


def check_cores() -> Iterator[Finding]:
    """Count the cores that an evolution may use, and give the reason if some may not be used."""
    setting = os.environ.get("LOKY_MAX_CPU_COUNT")
    total = os.cpu_count() or 1
    if setting is not None and not setting.strip().isdecimal():
        fix = fixes.unset_variable("LOKY_MAX_CPU_COUNT")
        yield Finding("fault", f"LOKY_MAX_CPU_COUNT is {setting!r}; it must be a whole number", fix)
        return
    from walkerlab.simulation.workers import n_cores

    usable = n_cores()
    n_affinity = len(os.sched_getaffinity(0)) if sys.platform == "linux" else total
    if usable == total:
        limit = "machine"
    elif setting and int(setting) <= usable:
        limit = "LOKY_MAX_CPU_COUNT"
    elif n_affinity <= usable:
        limit = "affinity"
    else:
        limit = "limit"
    description, fix = fixes.CORE_LIMITS[limit]
    reason = f": {description}" if description else ""
    message = f"{usable} of {total} cores may be used" if total > 1 else "this computer has one core"
    if usable > 1:
        yield Finding("ok", f"{message}{reason}")
    else:
        yield Finding("note", f"{message}, so robots are simulated one after another{reason}", fix)


def check_run_file() -> Iterator[Finding]:
    """Write a small run in the current folder; some network drives cannot lock files."""
    with tempfile.TemporaryDirectory(prefix="walkerlab-", dir=Path.cwd(), ignore_cleanup_errors=True) as folder:
        succeeded, output = opengl.run_python(WRITE_RUN.format(path=str(Path(folder, "run.walk"))))
    if succeeded:
        yield Finding("ok", "a run file can be written in this folder")
    else:
        error = output.rpartition("Error: ")[2].replace(f"{folder}{os.sep}", "")
        message = f"a run file cannot be written in this folder: {error}"
        yield Finding("fault", message, f"cd {_writable_folder()}, or to another disk")


def check_workers() -> Iterator[Finding]:
    """Start a worker process and wait for its result."""
    succeeded, output = opengl.run_python(USE_WORKER, {"LOKY_MAX_CPU_COUNT": "1"})
    if succeeded:
        yield Finding("ok", "worker processes start")
    else:
        yield Finding("fault", f"worker processes do not start: {output}", fixes.allow_workers(output))


def check_graphics() -> Iterator[Finding]:
    """Find an OpenGL backend that renders without a screen."""
    if found := opengl.find_backend():
        backend, renderer = found
        tip = f" (for your own pictures, set MUJOCO_GL={backend} before Python starts)" if backend else ""
        yield Finding("ok", f"films and 3D pictures can be rendered by {renderer}{tip}")
    else:
        yield Finding(
            "note", f"{opengl.unavailable_message()}: only films and 3D pictures need it", opengl.how_to_fix()
        )
