"""A process that writes output files is killed at random moments: all files show the same state of the run."""

import os
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from tests.faults import number
from walkerlab.evolution import outputs
from walkerlab.runfile.paths import RUN_FILE
from walkerlab.view.report.pictures import FORMATS, PICTURES

pytestmark = pytest.mark.skipif(os.name == "nt", reason="nothing there kills like SIGKILL")

SMALL = wl.Settings().with_(population_size=4, generations=2, duration=1)
WRITERS = {
    "command": "from walkerlab.__main__ import main; main(['resume', folder, '--quiet'])",
    "export": (
        "from pathlib import Path; from walkerlab.evolution import outputs; import walkerlab as wl\n"
        "outputs.write_outputs(wl.load(folder), Path(folder))"
    ),
    "report": "import walkerlab as wl; wl.load(folder).save_report(folder)",
}
CHILD = """
import sys; sys.path.insert(0, sys.argv[1]); folder = sys.argv[2]
import walkerlab.evolution.evolution, walkerlab.evolution.outputs, walkerlab.view.report
print("ready", flush=True)
{}
print("done", flush=True)
"""


@pytest.fixture(scope="module")
def states(tmp_path_factory):
    """Folder with all files of a run of two generations, whose run file then received a third; times [s]."""
    folder = tmp_path_factory.mktemp("states") / "walk"
    with ThreadPoolExecutor(2) as pool:
        run = wl.evolve(SMALL, folder / RUN_FILE, pool, progress=False)
        report_s = measure(lambda: run.save_report(folder))
        export_s = measure(lambda: outputs.write_outputs(run, folder))
        wl.resume(folder, 3, pool, progress=False)
    return folder, {"command": export_s, "export": export_s, "report": report_s}


def measure(write):
    """Return the duration of a call [s]."""
    began = time.monotonic()
    write()
    return time.monotonic() - began


def names_of(writer):
    if writer != "report":
        return outputs.OUTPUT_FILES.keys() - {RUN_FILE}
    pictures = {f"pictures/{picture.name}.{kind}" for picture in PICTURES for kind in FORMATS}
    return {"report.html", "replay.html", "records.csv", "tables/generations.csv", "tables/champion.csv", *pictures}


def go(writer, folder, root, seconds=None):
    """Write the files in a process that is killed after some seconds; return its duration [s]."""
    command = [sys.executable, "-c", CHILD.format(WRITERS[writer]), str(root), str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, start_new_session=True) as process:
        assert process.stdout.readline() == b"ready\n"
        began = time.monotonic()
        if seconds is not None:
            time.sleep(seconds)
            os.killpg(process.pid, signal.SIGKILL)
        assert process.stdout.readline() == b"done\n" or seconds is not None
        return time.monotonic() - began


def times(folder, names):
    return {name: (folder / name).stat().st_mtime_ns for name in names}


@pytest.mark.parametrize("writer", WRITERS)
def test_all_files_show_one_state_after_a_kill(writer, states, tmp_path, request):
    names = names_of(writer)
    root = request.config.rootpath
    found = []
    complete, seconds = states
    shutil.copytree(complete, tmp_path / "timed", copy_function=shutil.copy2)
    longest = number(seconds[writer], 0) or go(writer, tmp_path / "timed", root)
    rng = np.random.default_rng([2026, len(writer)])
    for n in range(number(1, 20)):
        folder = tmp_path / f"{n}"
        shutil.copytree(complete, folder, copy_function=shutil.copy2)
        others = {path.name for path in folder.iterdir()}
        before = times(folder, names)
        go(writer, folder, root, rng.uniform(0, longest))
        seen = times(folder, names)
        wl.load(folder)
        after = times(folder, names)
        n_new = sum(after[name] != before[name] for name in names)
        found.append(("old" if not n_new else "new", seen == after))
        assert n_new in (0, len(names)), "a mixture"
        assert {path.name for path in folder.iterdir()} == others
        assert pd.read_csv(folder / "records.csv").generation.max() == (2 if n_new else 1)
    print(f"\n{writer}: {len(found)} kills within {longest:.1f} s; sets found {[one for one, _ in found]}")
    print(f"of these, consistent before the run was loaded: {sum(same for _, same in found)}")
