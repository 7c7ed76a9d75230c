import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable

import pytest

from walkerlab.system.interrupts import interrupts_held

not_on_windows = pytest.mark.skipif(sys.platform == "win32", reason="Windows cannot mask signals")


def interrupt_within(rest: Callable[[], object]) -> None:
    with interrupts_held():
        signal.raise_signal(signal.SIGINT)
        rest()


def test_ctrl_c_is_raised_at_the_end_of_the_block():
    done: list[str] = []
    with pytest.raises(KeyboardInterrupt):
        interrupt_within(lambda: done.append("all of it"))
    assert done


def test_the_signal_handler_is_restored_after_the_block():
    before = signal.getsignal(signal.SIGINT)
    with interrupts_held():
        pass
    assert signal.getsignal(signal.SIGINT) is before
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


def test_an_error_in_the_block_takes_precedence_over_ctrl_c():
    with pytest.raises(ZeroDivisionError):
        interrupt_within(lambda: 1 / 0)


def test_it_has_no_effect_in_another_thread():
    errors: list[BaseException] = []

    def hold() -> None:
        try:
            with interrupts_held():
                pass
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=hold)
    thread.start()
    thread.join()
    assert not errors


@not_on_windows
def test_a_process_started_in_the_block_ignores_ctrl_c():
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
