"""Ctrl-C, kept from those whom it does not concern, and put off where it would do harm."""

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any

CAN_MASK = hasattr(signal, "pthread_sigmask")  # not on Windows


@contextmanager
def interrupts_held() -> Generator[None]:
    """Put Ctrl-C off until the block is done.

    A terminal sends it to every process of a program. Processes started within the block never hear of it, so that
    one of them, the caller, can stop in good order; and what is imported within the block is imported whole.

    Raises:
        KeyboardInterrupt: at the end of the block, if Ctrl-C was pressed within.
    """
    heard: list[Any] = []
    listening = threading.current_thread() is threading.main_thread()
    handler = signal.signal(signal.SIGINT, lambda *call: heard.append(call)) if listening else None
    if CAN_MASK:
        resource_tracker.ensure_running()  # were it started later, Python 3.11 and 3.12 would drop the mask
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT}) if CAN_MASK else None
    try:
        yield
    finally:
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        if listening:
            signal.signal(signal.SIGINT, handler)
    if heard and callable(handler):
        handler(*heard[0])
