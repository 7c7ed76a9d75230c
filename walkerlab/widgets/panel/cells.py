"""The widgets that each notebook cell has created, so that they can be closed when the cell runs again."""

from typing import Any
from weakref import WeakSet

from IPython.core.getipython import get_ipython

_created_widgets: dict[str, tuple[str, WeakSet[Any]]] = {}
"""ID of the last execution of each cell, and the widgets that it created, keyed by cell ID."""


def register_in_cell(widget: object) -> list[Any]:
    """Register a widget as created by the running cell.

    Returns:
        Widgets that an earlier execution of the same cell created; empty outside a notebook and in front ends that do
        not report which cell is running.
    """
    cell, execution = _running_cell()
    if not cell:
        return []
    last_execution, created = _created_widgets.setdefault(cell, (execution, WeakSet()))
    if last_execution == execution:
        created.add(widget)
        return []
    _created_widgets[cell] = execution, WeakSet([widget])
    return list(created)


def _running_cell() -> tuple[str, str]:
    """Return the IDs of the running cell and of its execution; empty if they are unknown."""
    kernel: Any = getattr(get_ipython(), "kernel", None)
    message: dict[str, Any] = kernel.get_parent() if kernel else {}
    return message.get("metadata", {}).get("cellId", ""), message.get("header", {}).get("msg_id", "")
