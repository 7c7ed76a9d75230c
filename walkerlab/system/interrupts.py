"""Deferral of Ctrl-C: for child processes for as long as they live, for this process until a block ends."""

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any

CAN_MASK_SIGNALS = hasattr(signal, "pthread_sigmask")  # not on Windows


@contextmanager
def interrupts_held() -> Generator[None]:
    """Defer Ctrl-C until the end of the block.

    A terminal sends Ctrl-C to every process of a program. Processes that are started in the block ignore it, so that
    only the calling process reacts and can stop in an orderly way. Imports in the block are always completed.

    Raises:
        KeyboardInterrupt: At the end of the block, if Ctrl-C was pressed during the block.
    """
    received: list[Any] = []
    is_main_thread = threading.current_thread() is threading.main_thread()
    handler = signal.signal(signal.SIGINT, lambda *call: received.append(call)) if is_main_thread else None
    if CAN_MASK_SIGNALS:
        resource_tracker.ensure_running()  # if it started inside the block, Python 3.11 and 3.12 would drop the mask
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT}) if CAN_MASK_SIGNALS else None
    try:
        yield
    finally:
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        if is_main_thread:
            signal.signal(signal.SIGINT, handler)
    if received and callable(handler):
        handler(*received[0])
