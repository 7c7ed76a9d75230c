"""Which panels a notebook's cell made when it ran before, so that they can give way when it runs again."""

from typing import Any
from weakref import WeakSet

from IPython.core.getipython import get_ipython

_MADE = dict[str, tuple[str, WeakSet[Any]]]()
"""By cell, the run of it and what it made then."""


def made_before(made_now: object) -> list[Any]:
    """Return what the running cell made when it ran before, and remember what it makes now.

    Returns:
        Nothing outside a notebook, or in one whose front end does not say which cell is running.
    """
    cell, run = _running()
    if not cell:
        return []
    before, things = _MADE.get(cell, ("", WeakSet[Any]()))
    gone = [] if before == run else list(things)
    _MADE[cell] = run, WeakSet([made_now] if before != run else [*things, made_now])
    return gone


def _running() -> tuple[str, str]:
    """Name the cell that is running, and this run of it."""
    kernel: Any = getattr(get_ipython(), "kernel", None)
    message: dict[str, Any] = kernel.get_parent() if kernel else {}
    return message.get("metadata", {}).get("cellId", ""), message.get("header", {}).get("msg_id", "")
