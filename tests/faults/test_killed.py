"""Runs that are killed at random moments, and resumed: the very tables that they would have had."""

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
    wl.evaluate(wl.generate_robot_population(settings.robot, 4, seed=0), settings)  # so that workers are there
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


def go(kind, path, root, seconds=None):
    """Start or resume a run in a process, kill that after so many seconds, and say whether it had come to its end."""
    with subprocess.Popen([sys.executable, "-c", CHILD, root, path, kind], stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"ready\n"
        if seconds:
            time.sleep(seconds)
            process.kill()
        return process.stdout.readline() == b"done\n"


def usable(path):
    """Say whether there is a run file, which is whole from the moment at which it is there."""
    return path.exists() and bool(wl.load(path))


@pytest.mark.skipif(sys.platform == "win32", reason="nothing there kills like SIGKILL")
@pytest.mark.parametrize("kind", ["walks", "stand-ins"])
def test_killed_and_resumed_as_often_as_one_likes_it_is_the_same_table(kind, tmp_path, request, monkeypatch):
    if kind == "walks":
        with ThreadPoolExecutor(2) as pool:
            whole = text(wl.evolve(REAL, executor=pool, progress=False).records)
    else:
        monkeypatch.setattr(evolution, "evaluate", evaluate)
        whole = text(wl.evolve(SETTINGS, progress=False).records)
    began = time.monotonic()
    wl.evolve(REAL if kind == "walks" else SETTINGS, tmp_path / "uninterrupted.walk", progress=False)
    longest, root = time.monotonic() - began, request.config.rootpath

    rng, found = np.random.default_rng(7), []
    for run in range(number(1, 50)):
        path = tmp_path / f"{run}.walk"
        while go(kind, path, root, rng.uniform(0, longest)):  # too late: it had come to its end
            path.unlink()
        for seconds in [*rng.uniform(0, longest, rng.integers(3)), None]:
            done = text(wl.load(path).records) if usable(path) else b""
            found.append(done.count(b"\n"))
            assert whole.startswith(done)
            assert go(kind, path, root, seconds) or seconds
        assert text(wl.load(path).records) == whole
        assert not path.with_name(f"{path.name}-journal").exists()
    print(f"\n{kind}: {run + 1} runs, killed {len(found)} times; rows found then {sorted(found)}")
