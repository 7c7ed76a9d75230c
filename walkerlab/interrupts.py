"""Ctrl-C, kept from those whom it does not concern."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Hold Ctrl-C back until the block is done.

    A terminal sends Ctrl-C to every process of a program. Processes started within the block inherit the hold and
    never hear of it, so that one of them, the caller, can stop in good order. Where signals cannot be held (Windows)
    nothing happens.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
