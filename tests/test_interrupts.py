import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable

import pytest

from walkerlab.interrupts import interrupts_held

not_on_windows = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals to hold")


def interrupt_within(rest: Callable[[], object]) -> None:
    with interrupts_held():
        signal.raise_signal(signal.SIGINT)
        rest()


def test_ctrl_c_comes_when_the_block_is_done():
    done: list[str] = []
    with pytest.raises(KeyboardInterrupt):
        interrupt_within(lambda: done.append("all of it"))
    assert done


def test_afterwards_all_is_as_before():
    before = signal.getsignal(signal.SIGINT)
    with interrupts_held():
        pass
    assert signal.getsignal(signal.SIGINT) is before
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


def test_an_error_in_the_block_is_told_first():
    with pytest.raises(ZeroDivisionError):
        interrupt_within(lambda: 1 / 0)


def test_another_thread_may_use_it():
    faults: list[BaseException] = []

    def hold() -> None:
        try:
            with interrupts_held():
                pass
        except BaseException as fault:
            faults.append(fault)

    thread = threading.Thread(target=hold)
    thread.start()
    thread.join()
    assert not faults


@not_on_windows
def test_a_process_started_within_never_hears_of_it():
    code = "print('ready', flush=True); input(); print('still here')"
    pipe = subprocess.PIPE
    with interrupts_held():
        child = subprocess.Popen([sys.executable, "-c", code], stdin=pipe, stdout=pipe, text=True)
    assert child.stdout
    assert child.stdout.readline() == "ready\n"
    os.kill(child.pid, signal.SIGINT)
    out, _ = child.communicate("\n", timeout=30)
    assert out == "still here\n"
    assert child.returncode == 0
