"""Ctrl-C at any moment, once or several times: the command ends in good order, and its run can be gone on with."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from tests.faults import number
from walkerlab.__main__ import main
from walkerlab.evolution import outputs

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no process groups to send Ctrl-C to")

FLAGS = {"population_size": 8, "generations": 6, "duration": 1}
COMMAND = "from walkerlab.__main__ import main; print('up', flush=True); import sys; sys.exit(main())"
ON_A_TERMINAL = "import fcntl, sys, termios; fcntl.ioctl(0, termios.TIOCSCTTY, 0); "
PATIENCE = 15  # s for a command that was told to stop
NONE_LEFT = 5  # s for its workers to leave after it


class Command:
    """``walkerlab evolve`` in a process group of its own, as a shell starts it, or on a terminal of its own."""

    def __init__(self, folder, *, on_terminal=False, quiet=False):
        self.folder, self.said = folder, folder.with_suffix(".txt")
        words = [word for name, value in FLAGS.items() for word in (f"--{name.replace('_', '-')}", str(value))]
        words = ["evolve", "--out", str(folder), *words, *(["--quiet"] if quiet else [])]
        self.terminal = None
        with self.said.open("wb") as file:
            streams = {"stdin": subprocess.DEVNULL, "stdout": file, "stderr": file}
            if on_terminal:
                self.terminal, its_end = os.openpty()
                streams = dict.fromkeys(streams, its_end)
            code = (ON_A_TERMINAL if on_terminal else "") + COMMAND
            self.process = subprocess.Popen([sys.executable, "-c", code, *words], **streams, start_new_session=True)
        if on_terminal:
            os.close(its_end)
            threading.Thread(target=self._listen, daemon=True).start()
        while not self.text and self.process.poll() is None:
            time.sleep(0.005)

    def _listen(self):
        with self.said.open("wb", buffering=0) as file:
            try:
                while heard := os.read(self.terminal, 4096):
                    file.write(heard)
            except OSError:  # the last process has left the terminal
                pass

    @property
    def text(self):
        return self.said.read_text(encoding="utf-8").replace("\r\n", "\n")

    def send(self, sent=signal.SIGINT, *, alone=False):
        """Press Ctrl-C, which reaches all of the group, or send a signal to the command alone."""
        if self.process.poll() is not None:
            return
        if self.terminal and sent == signal.SIGINT and not alone:
            os.write(self.terminal, b"\x03")
        else:
            (os.kill if alone else os.killpg)(self.process.pid, sent)

    def end(self):
        """Return its exit code when it and all its processes have ended."""
        try:
            code = self.process.wait(PATIENCE)
            deadline = time.monotonic() + NONE_LEFT
            while self._is_there():
                assert time.monotonic() < deadline, "its workers have stayed behind"
                time.sleep(0.02)
        except subprocess.TimeoutExpired:
            raise AssertionError("it hangs") from None
        finally:
            if self._is_there():
                os.killpg(self.process.pid, signal.SIGKILL)
                self.process.wait()
        return code

    def _is_there(self):
        try:
            os.killpg(self.process.pid, 0)
        except ProcessLookupError:
            return False
        return True


@pytest.fixture(scope="module")
def whole():
    return wl.evolve(wl.Settings().with_(**FLAGS), progress=False).records


def goes_on(folder, whole):
    """Make sure that a file holds whole generations, if any, and that a resume brings the run to its end."""
    if not (folder / "run.walk").exists():
        return
    done = wl.load(folder).records
    pd.testing.assert_frame_equal(done, whole[whole.generation <= done.generation.max()])
    assert main(["resume", str(folder), "--quiet"]) == 0
    pd.testing.assert_frame_equal(wl.load(folder).records, whole)
    assert {there.name for there in folder.iterdir()} == {*outputs.FILES}


@pytest.mark.parametrize("n", range(number(2, 60)))
def test_pressed_at_any_moment_it_ends_in_good_order_and_the_run_goes_on(n, tmp_path, whole):
    rng = np.random.default_rng([2026, n])
    where = rng.choice(["group", "alone", "terminal"], p=[0.5, 0.2, 0.3])
    command = Command(tmp_path / "walk", on_terminal=where == "terminal", quiet=bool(rng.integers(2)))
    time.sleep(rng.uniform(0, 6))
    command.send(alone=where == "alone")
    for _ in range(rng.integers(3)):
        time.sleep(rng.uniform(0.05, 1))
        command.send(alone=where == "alone")
    code, text = command.end(), command.text
    assert "Traceback" not in text
    assert "leaked" not in text
    assert code in (0, 130)
    if code and (command.folder / "run.walk").exists():
        assert f"walkerlab resume {command.folder}" in text
    elif code:
        assert "there is no run file" in text or text.endswith("Stopped.\n"), "before anything was begun"
    goes_on(command.folder, whole)


@pytest.mark.parametrize("n", range(number(1, 20)))
def test_ended_by_the_system_its_workers_go_and_the_file_is_whole(n, tmp_path, whole):
    rng = np.random.default_rng([2027, n])
    sent = (signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)[n % 3]
    command = Command(tmp_path / "walk")
    time.sleep(rng.uniform(1, 6))
    command.send(sent, alone=bool(rng.integers(2)))
    assert command.end() in (0, -sent)
    goes_on(command.folder, whole)
