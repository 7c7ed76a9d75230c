"""Looks at the folder, the disk, the cores, the processes and the graphics."""

from __future__ import annotations  # a Python that is too old must be able to read this file, and say so

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
ONE_RUN, ROOMY = 5 * MB, 200 * MB  # of a run's whole folder, and of what a course should have left
NEEDS = "a run takes some 5 MB, and a long one 0.9 kB for each robot"

KEEP = """
from concurrent.futures import ThreadPoolExecutor
import walkerlab as wl
small = wl.Settings().with_(population_size=4, generations=2, duration=1)
wl.evolve(small, {path!r}, ThreadPoolExecutor(1), progress=False)
print(wl.load({path!r}).n_generations)
"""

WORK = """
from walkerlab.simulation.workers import default_executor
print(default_executor().submit(abs, -1).result())
"""


def place() -> Iterator[Finding]:
    """See where we are: files of one's own must not stand in the way of packages."""
    try:
        here = Path.cwd()
    except FileNotFoundError:
        yield Finding("fault", "the folder that you are in has been removed", f"cd {_own_folder()}")
        return
    if hidden := sorted(_hidden(here)):
        said = f"Python would take your own {' and '.join(hidden)} here for the packages of these names"
        yield Finding("fault", said, "give your files other names")


def folder() -> Iterator[Finding]:
    """Try to write here, where ``walkerlab evolve`` would put its results, and see how much room there is."""
    here = Path.cwd()
    try:
        with tempfile.TemporaryFile(dir=here) as file:
            file.write(b"walk")
    except OSError as error:
        yield Finding("fault", f"nothing can be written into {here}: {error.strerror}", f"cd {_own_folder()}")
        return
    free = shutil.disk_usage(here).free
    if free > ROOMY:
        yield Finding("ok", f"this folder can be written to: {here}")
    else:
        said = f"only {free / MB:.0f} MB are free on the disk; {NEEDS}"
        yield Finding("note" if free > ONE_RUN else "fault", said, f"delete what you can spare, or cd {_own_folder()}")


def _hidden(here: Path) -> set[str]:
    """Return the files of this folder that a notebook in it would import in place of a package."""
    taken = {"walkerlab", "mujoco", "dm_control", "numpy", "pandas", "matplotlib", "scipy", "pydantic", "random"}
    return {path.name for path in here.glob("*.py") if path.stem in taken}


def _own_folder() -> str:
    """Name a folder that this user can write into, if there is one."""
    places = (Path.home(), Path(tempfile.gettempdir()))
    return next((str(place) for place in places if os.access(place, os.W_OK)), "a folder of your own")


def cores() -> Iterator[Finding]:
    """Count the cores that walks are shared out to, and say why there are not more."""
    granted, there = os.environ.get("LOKY_MAX_CPU_COUNT"), os.cpu_count() or 1
    if granted is not None and not granted.strip().isdecimal():
        unset = fixes.unset("LOKY_MAX_CPU_COUNT")
        yield Finding("fault", f"LOKY_MAX_CPU_COUNT is {granted!r}; it must be a whole number", unset)
        return
    from walkerlab.simulation.workers import n_cores

    usable = n_cores()
    bound_to = len(os.sched_getaffinity(0)) if sys.platform == "linux" else there
    why = (
        "machine"
        if usable == there
        else "LOKY_MAX_CPU_COUNT"
        if granted and int(granted) <= usable
        else "affinity"
        if bound_to <= usable
        else "limit"
    )
    said, mend = fixes.CORES[why]
    counted = f"{usable} of {there} cores may be used" if there > 1 else "this machine has one core"
    if usable > 1:
        yield Finding("ok", counted + (f": {said}" if said else ""))
    else:
        yield Finding("note", f"{counted}, so robots walk one after the other{f': {said}' if said else ''}", mend)


def keep() -> Iterator[Finding]:
    """Keep a small run here, as evolving does: some network drives cannot lock a file."""
    with tempfile.TemporaryDirectory(prefix="walkerlab-", dir=Path.cwd(), ignore_cleanup_errors=True) as inside:
        done, answer = opengl.run_python(KEEP.format(path=str(Path(inside, "run.walk"))))
    if done:
        yield Finding("ok", "a run can be kept here")
    else:
        said = answer.rpartition("Error: ")[2].replace(f"{inside}{os.sep}", "")
        yield Finding("fault", f"no run can be kept here: {said}", f"cd {_own_folder()}, or to another disk")


def workers() -> Iterator[Finding]:
    """Start a worker process, and wait for its answer."""
    done, answer = opengl.run_python(WORK, {"LOKY_MAX_CPU_COUNT": "1"})
    if done:
        yield Finding("ok", "worker processes start")
    else:
        yield Finding("fault", f"no worker process starts: {answer}", fixes.workers(answer))


def drawing() -> Iterator[Finding]:
    """Look for a GL that draws without a screen."""
    if found := opengl.find_backend():
        backend, renderer = found
        tip = f" (pictures of your own: set MUJOCO_GL={backend} before Python starts)" if backend else ""
        yield Finding("ok", f"films and 3D pictures can be drawn by {renderer}{tip}")
    else:
        yield Finding(
            "note", f"{opengl.unavailable_message()}: only films and 3D pictures need it", opengl.how_to_fix()
        )
