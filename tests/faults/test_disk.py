"""A full disk, a folder that cannot be written to, files cut off, copied half written, and with bytes that flipped."""

import os
import shutil
import subprocess
import sys
import tempfile
import threading
from collections import Counter
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import walkerlab as wl
from tests.faults import number
from tests.faults.standins import SETTINGS, attempt, evaluate, text
from tests.runfile.test_store import KILLED_DURING_APPEND
from walkerlab.__main__ import main
from walkerlab.evolution import evolution

as_root = pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root may do that")
NOBODY = 65534


@pytest.fixture(autouse=True)
def standing_in(monkeypatch):
    monkeypatch.setattr(evolution, "evaluate", evaluate)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run that nothing happened to: its file, and its table as text."""
    path = tmp_path_factory.mktemp("whole") / "run.walk"
    patch = pytest.MonkeyPatch()
    with patch.context() as patched:
        patched.setattr(evolution, "evaluate", evaluate)
        run = wl.evolve(SETTINGS, path, progress=False)
    return path, text(run.records)


def what_is_left(path, truth):
    """Load and rescue a file that something happened to, and say what came of it: never anything but the truth."""
    run, refusal = attempt(wl.load, path)
    if run:
        assert truth.startswith(text(run.records))
        assert run.settings == SETTINGS
        return "all" if run.n_generations == SETTINGS.algorithm.generations else "what was done"
    assert str(path) in refusal
    assert main(["show", str(path)]) == 2
    rescued = path.with_suffix(".rescued")
    run, refusal = attempt(wl.rescue, path, rescued)
    if run:
        assert truth.startswith(text(run.records))
        assert run.settings == SETTINGS
        rescued.unlink()
        return "a prefix"
    assert str(path) in refusal
    assert not rescued.exists()
    return "nothing"


def test_a_file_with_flipped_bytes_is_the_run_or_an_error(whole, tmp_path):
    path, truth = whole
    rng = np.random.default_rng(3)
    found = []
    intact = path.read_bytes()
    copy = tmp_path / "copy.walk"
    for _ in range(number(20, 200)):
        hurt = bytearray(intact)
        for place in rng.integers(len(hurt), size=rng.integers(1, 4)):
            hurt[place] ^= rng.integers(1, 256)
        copy.write_bytes(hurt)
        found.append(what_is_left(copy, truth))
        copy.unlink()
    print(f"\n{len(found)} copies with flipped bytes: {Counter(found)}")
    assert found.count("a prefix") > found.count("nothing")


def test_a_file_that_is_cut_off_is_an_error_and_what_is_before_the_cut_is_saved(whole, tmp_path):
    path, truth = whole
    copy = tmp_path / "copy.walk"
    intact = path.read_bytes()
    found = []
    for share in np.linspace(0, 1, number(12, 100), endpoint=False):
        copy.write_bytes(intact[: int(share * len(intact))])
        found.append(what_is_left(copy, truth))
        copy.unlink()
    assert "all" not in found
    assert "a prefix" in found
    print(f"\n{len(found)} files cut off: {Counter(found)}")


def test_a_file_that_is_copied_while_it_is_written_is_the_run_so_far_or_an_error(whole, tmp_path):
    """As a machine that is switched off leaves it, and worse: file and journal are not of one moment."""
    _, truth = whole
    path = tmp_path / "run.walk"
    copy = tmp_path / "copy.walk"
    found = []
    journal = path.with_name(f"{path.name}-journal")
    while len(found) < number(20, 1000):
        path.unlink(missing_ok=True)
        writer = threading.Thread(target=wl.evolve, args=(SETTINGS, path), kwargs={"progress": False})
        writer.start()
        while writer.is_alive():
            if not path.exists():
                continue
            for one in (path, journal) if len(found) % 2 else (journal, path):
                if one.exists():
                    try:
                        shutil.copyfile(one, copy.with_name(one.name.replace("run", "copy")))
                    except FileNotFoundError:
                        continue
            found.append(what_is_left(copy, truth))
            copy.unlink(missing_ok=True)
            copy.with_name(f"{copy.name}-journal").unlink(missing_ok=True)
        writer.join()
    print(
        f"\n{len(found)} copies of a file that was being written: { ({one: found.count(one) for one in set(found)}) }"
    )
    assert "what was done" in found


@contextmanager
def disk(folder, kilobytes):
    """Make a folder a small disk; yields what changes its size."""
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", folder], check=True)
    try:
        yield lambda size: subprocess.run(["mount", "-o", f"remount,size={size}k", folder], check=True)
    finally:
        subprocess.run(["umount", folder], check=True)


def may_mount():
    try:
        return subprocess.run(["unshare", "-m", "true"], check=False, capture_output=True).returncode == 0
    except FileNotFoundError:
        return False


@as_root
@pytest.mark.skipif(not may_mount(), reason="no disk may be mounted here")
def test_a_full_disk_keeps_what_is_done_and_with_room_the_run_goes_on(whole, tmp_path, capsys):
    _, truth = whole
    path = tmp_path / "run.walk"
    with disk(tmp_path, kilobytes=150) as resize:
        with pytest.raises(wl.RunFileError, match="the disk is full") as caught:
            wl.evolve(SETTINGS, path, progress=False)
        kept = wl.load(path)
        assert 0 < kept.n_generations < SETTINGS.algorithm.generations
        assert f"The run is saved in {path}, with {kept.n_generations} gen" in "".join(caught.value.__notes__)
        assert truth.startswith(text(kept.records))
        assert main(["resume", str(path), "--quiet"]) == 1
        told = capsys.readouterr().err
        assert "the disk is full" in told
        assert f"Resume with: walkerlab resume {tmp_path}" in told
        with pytest.raises(wl.RunFileError, match="the disk is full"):
            wl.evolve(SETTINGS, tmp_path / "another.walk", progress=False)
        assert not (tmp_path / "another.walk").exists()
        resize(4000)
        assert text(wl.resume(path, progress=False).records) == truth


@pytest.mark.skipif(sys.platform == "win32", reason="no such limit there")
def test_a_file_that_may_not_grow_keeps_what_is_done(whole, tmp_path):
    """As under a quota: where no disk may be mounted, this is the full disk."""
    _, truth = whole
    program = (
        "import resource, signal, sys; sys.path.insert(0, sys.argv[1])\n"
        "import walkerlab as wl; from tests.faults import standins; standins.stand_in()\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, 150_000))\n"
        "wl.evolve(standins.SETTINGS, sys.argv[2], progress=False)\n"
    )
    root = os.path.dirname(os.path.dirname(os.path.dirname(__file__)))
    path = tmp_path / "run.walk"
    ended = subprocess.run([sys.executable, "-c", program, root, path], capture_output=True, text=True, check=False)
    assert "RunFileError" in ended.stderr
    assert "Its contents have not changed" in ended.stderr
    kept = text(wl.load(path).records)
    assert truth.startswith(kept)
    assert kept
    assert text(wl.resume(path, progress=False).records) == truth


@contextmanager
def nobody():
    """Be somebody who may write nowhere."""
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.fixture
def anywhere():
    """A folder that everybody may look into, on a way that everybody may go."""
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        yield Path(folder)


@as_root
def test_where_nothing_can_be_written_a_run_can_be_read_and_all_else_is_told(whole, anywhere, capsys):
    path, truth = whole
    path = Path(shutil.copy(path, anywhere / "run.walk"))
    asked = {
        "the file or its folder cannot be written to": lambda: wl.resume(path, 40, progress=False),
        "no run file can be created at": lambda: wl.evolve(SETTINGS, anywhere / "new.walk", progress=False),
        "Permission denied": lambda: wl.rescue(path, anywhere / "folder" / "new.walk"),
    }
    with nobody():
        assert text(wl.load(path).records) == truth
        assert main(["show", str(path)]) == 0
        for words, ask in asked.items():
            with pytest.raises(wl.RunFileError, match=words):
                ask()
        assert main(["resume", str(anywhere), "--generations", "40", "--quiet"]) == 2
        assert "cannot be written to" in capsys.readouterr().err
    assert [one.name for one in anywhere.iterdir()] == ["run.walk"]


@as_root
def test_what_was_being_written_when_its_process_died_is_not_read_where_it_cannot_be_undone(whole, anywhere, request):
    path, truth = whole
    path = Path(shutil.copy(path, anywhere / "run.walk"))
    killed = subprocess.run([sys.executable, "-c", KILLED_DURING_APPEND, path, request.config.rootpath], check=False)
    assert killed.returncode == -9
    with nobody(), pytest.raises(wl.RunFileError, match="Copy it"):
        wl.load(path)
    assert text(wl.load(path).records) == truth
