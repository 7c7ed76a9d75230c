"""After Ctrl-C at any moment, the command ends without a traceback and its run can be resumed."""

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
STOP_TIME_LIMIT = 15  # s from the signal to the end of the command
WORKER_TIME_LIMIT = 5  # s from then to the end of its workers


class Command:
    """``walkerlab evolve`` in a new process group, as a shell starts it, or on a new terminal."""

    def __init__(self, folder, *, on_terminal=False, quiet=False):
        self.folder = folder
        self.said = folder.with_suffix(".txt")
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
            except OSError:  # the last process has closed the terminal
                pass

    @property
    def text(self):
        return self.said.read_text(encoding="utf-8").replace("\r\n", "\n")

    def send(self, sent=signal.SIGINT, *, alone=False):
        """Send a signal to the process group, as Ctrl-C does, or only to the command."""
        if self.process.poll() is not None:
            return
        if self.terminal and sent == signal.SIGINT and not alone:
            os.write(self.terminal, b"\x03")
        else:
            (os.kill if alone else os.killpg)(self.process.pid, sent)

    def end(self):
        """Wait until the command and all its processes have ended, and return its exit code."""
        try:
            code = self.process.wait(STOP_TIME_LIMIT)
            deadline = time.monotonic() + WORKER_TIME_LIMIT
            while self._exists():
                assert time.monotonic() < deadline, "its workers have not ended"
                time.sleep(0.02)
        except subprocess.TimeoutExpired:
            raise AssertionError("it hangs") from None
        finally:
            if self._exists():
                os.killpg(self.process.pid, signal.SIGKILL)
                self.process.wait()
        return code

    def _exists(self):
        try:
            os.killpg(self.process.pid, 0)
        except ProcessLookupError:
            return False
        return True


@pytest.fixture(scope="module")
def whole():
    return wl.evolve(wl.Settings().with_(**FLAGS), progress=False).records


def check_resume(folder, whole):
    """Check that a run file, if there is one, holds complete generations and that the run can be resumed."""
    if not (folder / "run.walk").exists():
        return
    done = wl.load(folder).records
    pd.testing.assert_frame_equal(done, whole[whole.generation <= done.generation.max()])
    assert main(["resume", str(folder), "--quiet"]) == 0
    pd.testing.assert_frame_equal(wl.load(folder).records, whole)
    assert {there.name for there in folder.iterdir()} == {*outputs.OUTPUT_FILES}


@pytest.mark.parametrize("n", range(number(2, 60)))
def test_ctrl_c_at_any_moment_stops_the_run_and_it_can_be_resumed(n, tmp_path, whole):
    rng = np.random.default_rng([2026, n])
    where = rng.choice(["group", "alone", "terminal"], p=[0.5, 0.2, 0.3])
    command = Command(tmp_path / "walk", on_terminal=where == "terminal", quiet=bool(rng.integers(2)))
    time.sleep(rng.uniform(0, 6))
    command.send(alone=where == "alone")
    for _ in range(rng.integers(3)):
        time.sleep(rng.uniform(0.05, 1))
        command.send(alone=where == "alone")
    code = command.end()
    text = command.text
    assert "Traceback" not in text
    assert "leaked" not in text
    assert code in (0, 130)
    if code and (command.folder / "run.walk").exists():
        assert f"walkerlab resume {command.folder}" in text
    elif code:
        assert "there is no run file" in text or text.endswith("Stopped.\n"), "before the run started"
    check_resume(command.folder, whole)


@pytest.mark.parametrize("n", range(number(1, 20)))
def test_after_a_signal_the_workers_end_and_the_run_file_is_intact(n, tmp_path, whole):
    rng = np.random.default_rng([2027, n])
    sent = (signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)[n % 3]
    command = Command(tmp_path / "walk")
    time.sleep(rng.uniform(1, 6))
    command.send(sent, alone=bool(rng.integers(2)))
    assert command.end() in (0, -sent)
    check_resume(command.folder, whole)
