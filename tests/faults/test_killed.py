"""Runs that are killed at random moments and resumed have the same table as uninterrupted runs."""

import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import walkerlab as wl
from tests.faults import number
from tests.faults.standins import SETTINGS, evaluate, text
from walkerlab.evolution import evolution

REAL = SETTINGS.with_(population_size=8, generations=8)
CHILD = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
import walkerlab as wl
from tests.faults import standins
from tests.faults.test_killed import REAL

path, settings = Path(sys.argv[2]), REAL
if sys.argv[3] == "walks":
    wl.evaluate(wl.generate_robot_population(settings.robot, 4, seed=0), settings)  # starts the workers
else:
    settings = standins.SETTINGS
    standins.stand_in()
print("ready", flush=True)
if path.exists():
    wl.resume(path, progress=False)
else:
    wl.evolve(settings, path, progress=False)
print("done", flush=True)
"""


def run_process(kind, path, root, seconds=None):
    """Start or resume a run in a process, kill it after some seconds, and return whether it was complete."""
    with subprocess.Popen([sys.executable, "-c", CHILD, root, path, kind], stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"ready\n"
        if seconds:
            time.sleep(seconds)
            process.kill()
        return process.stdout.readline() == b"done\n"


def usable(path):
    """Return whether there is a run file; it must be readable as soon as it exists."""
    return path.exists() and bool(wl.load(path))


@pytest.mark.skipif(sys.platform == "win32", reason="nothing there kills like SIGKILL")
@pytest.mark.parametrize("kind", ["walks", "stand-ins"])
def test_a_run_killed_several_times_has_the_same_table(kind, tmp_path, request, monkeypatch):
    if kind == "walks":
        with ThreadPoolExecutor(2) as pool:
            whole = text(wl.evolve(REAL, executor=pool, progress=False).records)
    else:
        monkeypatch.setattr(evolution, "evaluate", evaluate)
        whole = text(wl.evolve(SETTINGS, progress=False).records)
    began = time.monotonic()
    wl.evolve(REAL if kind == "walks" else SETTINGS, tmp_path / "uninterrupted.walk", progress=False)
    longest = time.monotonic() - began
    root = request.config.rootpath

    rng = np.random.default_rng(7)
    found = []
    for run in range(number(1, 50)):
        path = tmp_path / f"{run}.walk"
        while run_process(kind, path, root, rng.uniform(0, longest)):  # it was complete before it was killed
            path.unlink()
        for seconds in [*rng.uniform(0, longest, rng.integers(3)), None]:
            done = text(wl.load(path).records) if usable(path) else b""
            found.append(done.count(b"\n"))
            assert whole.startswith(done)
            assert run_process(kind, path, root, seconds) or seconds
        assert text(wl.load(path).records) == whole
        assert not path.with_name(f"{path.name}-journal").exists()
    print(f"\n{kind}: {run + 1} runs, killed {len(found)} times; rows found then {sorted(found)}")
