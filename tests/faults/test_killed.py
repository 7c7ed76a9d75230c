"""Runs that are killed at random moments, and resumed: the very tables that they would have had."""

import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import walkerlab as wl
from tests.faults import number
from tests.faults.standins import SETTINGS, attempt, evaluate, text
from walkerlab import evolution

REAL = wl.Settings().with_(duration=1.0, population_size=8, generations=5, seed=11)
START = "import sys; sys.path.insert(0, sys.argv[1]); import walkerlab as wl; from tests.faults import standins\n"
WALKS = "settings, executor = wl.Settings().with_(duration=1.0, population_size=8, generations=5, seed=11), None\n"
STAND_INS = "settings, executor = standins.SETTINGS, None; standins.stand_in()\n"
GO = """
from pathlib import Path
path = Path(sys.argv[2])
print("ready", flush=True)
if path.exists():
    wl.resume(path, progress=False)
else:
    wl.evolve(settings, path, progress=False)
"""


def go(kind, path, root, seconds=None):
    """Start or resume a run in a process, kill that after so many seconds, and say whether it had come to its end."""
    program = START + (WALKS if kind == "walks" else STAND_INS) + GO
    process = subprocess.Popen([sys.executable, "-c", program, root, path], stdout=subprocess.PIPE)
    with process:
        process.stdout.readline()
        try:
            assert process.wait(seconds) == 0
            return True
        except subprocess.TimeoutExpired:
            process.kill()
            return False


def usable(path):
    """Say whether a run can be resumed; one that ended before it began is told to be deleted, and is."""
    if not path.exists():
        return False
    _, refusal = attempt(wl.load, path)
    if refusal:
        assert "Delete it, and evolve anew" in refusal
        path.unlink()
    return path.exists()


@pytest.mark.skipif(sys.platform == "win32", reason="nothing there kills like SIGKILL")
@pytest.mark.parametrize("kind", ["walks", "stand-ins"])
def test_killed_and_resumed_as_often_as_one_likes_it_is_the_same_table(kind, tmp_path, request, monkeypatch):
    if kind == "walks":
        with ThreadPoolExecutor(2) as pool:
            whole = text(wl.evolve(REAL, executor=pool, progress=False).records)
    else:
        monkeypatch.setattr(evolution, "evaluate", evaluate)
        whole = text(wl.evolve(SETTINGS, progress=False).records)
    root, began = request.config.rootpath, time.monotonic()
    assert go(kind, tmp_path / "uninterrupted.walk", root)
    longest = time.monotonic() - began
    assert text(wl.load(tmp_path / "uninterrupted.walk").records) == whole

    rng, found = np.random.default_rng(7), []
    for run in range(number(2, 50)):
        path = tmp_path / f"{run}.walk"
        while go(kind, path, root, rng.uniform(0, longest)):  # too late: it had come to its end
            path.unlink()
        for seconds in [*rng.uniform(0, longest, rng.integers(3)), None]:
            done = text(wl.load(path).records) if usable(path) else b""
            found.append(done.count(b"\n"))
            assert whole.startswith(done)
            go(kind, path, root, seconds)
        assert text(wl.load(path).records) == whole
        assert not path.with_name(f"{path.name}-journal").exists()
    print(f"\n{kind}: {run + 1} runs, killed {len(found)} times; rows found then {sorted(found)}")
