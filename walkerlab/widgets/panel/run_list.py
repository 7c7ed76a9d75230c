"""The list of a panel's runs, in which runs are named, selected, removed, and shown on the curve or hidden."""

import threading
from collections import Counter
from collections.abc import Mapping
from typing import Any

import traitlets

from walkerlab.text.templates import Markup, render
from walkerlab.view.plots.style import RUN_COLOURS, RUN_MARKERS
from walkerlab.widgets.component import Component, load_script, load_style

MAX_NAME_LENGTH = 60  # maximum length of a name, which is also shown in legends, in characters


class RunList(Component):
    """A list of runs, identified by keys; observe ``runs`` and ``selected`` to react to the user's actions.

    Attributes:
        runs: A dict for each run, oldest first: ``key``, ``name``, ``colour`` and ``mark`` of its line, the strings
            ``differs``, ``best`` and ``state``, and whether it is ``shown`` on the curve.
        selected: Key of the selected run; empty if there is none.
    """

    title = "list of runs"
    _esm = load_script("panel/run_list")
    _css = load_style("panel/run_list")
    runs = traitlets.List().tag(sync=True)
    selected = traitlets.Unicode().tag(sync=True)

    def __init__(self) -> None:
        """Create an empty list."""
        super().__init__()
        self._lock = threading.RLock()
        self.on_msg(self._handle_message)

    def set_state(self, sync_data: dict[str, Any]) -> None:
        """Ignore traits that the browser sets; it sends messages instead."""

    def add(self, key: str, **changes: Any) -> None:
        """Add a run with an unused colour and marker, or with the least used ones; update it if it is in the list.

        Args:
            key: Key of the run.
            **changes: As for ``update``.
        """
        with self._lock:
            if self._has_run(key):
                self.update(key, **changes)
                return
            new = {"key": key, **self._next_look(), "differs": "", "best": "", "state": "", "shown": True}
            self.runs = [*self.runs, new | self._clean_changes(key, {"name": key} | changes)]

    def update(self, key: str, **changes: Any) -> None:
        """Change the entry of a run; do nothing if the run is not in the list.

        Args:
            key: Key of the run.
            **changes: Any of ``name``, ``differs``, ``best``, ``state``, ``shown``.
        """
        with self._lock:
            changes = self._clean_changes(key, changes)
            self.runs = [run | changes if run["key"] == key else run for run in self.runs]

    def name_of(self, key: str) -> str:
        """Return the name of a run; "" if the run is not in the list."""
        return next((str(run["name"]) for run in self.runs if run["key"] == key), "")

    def remove(self, key: str) -> None:
        """Remove a run; if it was selected, select its neighbour."""
        with self._lock:
            keys = [run["key"] for run in self.runs]
            if key not in keys:
                return
            index = keys.index(key)
            self.runs = [run for run in self.runs if run["key"] != key]
            if self.selected == key:
                self.selected = self.runs[min(index, len(self.runs) - 1)]["key"] if self.runs else ""

    def snapshot(self) -> Markup:
        """Return the list as static HTML."""
        rows = [[run[key] for key in ("name", "differs", "best", "state")] for run in self.runs]
        classes = ["strong" if run["key"] == self.selected else "" for run in self.runs]
        return render("widgets/panel/run_list.html", rows=rows, classes=classes)

    def _next_look(self) -> dict[str, str]:
        """Return the first of the least used colours, with its marker."""
        used = Counter(run["colour"] for run in self.runs)
        index = min(range(len(RUN_COLOURS)), key=lambda i: used[RUN_COLOURS[i]])
        return {"colour": RUN_COLOURS[index], "mark": RUN_MARKERS[index]}

    def _clean_changes(self, key: str, changes: Mapping[str, Any]) -> dict[str, Any]:
        """Return changes with a name that is unique, on one line and not too long; without the name if it is blank."""
        cleaned = {field: value for field, value in changes.items() if field != "name"}
        if name := " ".join(str(changes.get("name", "")).split())[:MAX_NAME_LENGTH]:
            others = {run["name"] for run in self.runs if run["key"] != key}
            candidates = (name, *(f"{name} ({n})" for n in range(2, len(others) + 2)))
            cleaned["name"] = next(candidate for candidate in candidates if candidate not in others)
        return cleaned

    def _handle_message(self, _: object, message: object, __: object) -> None:
        """Carry out an action that the browser requests; ignore invalid messages and unknown runs."""
        with self._lock:
            match message:
                case {"remove": str(key)}:
                    self.remove(key)
                case {"name": str(name), "of": str(key)}:
                    self.update(key, name=name)
                case {"shown": bool(shown), "of": str(key)}:
                    self.update(key, shown=shown)
                case {"select": str(key)} if self._has_run(key):
                    self.selected = key
                case _:
                    pass

    def _has_run(self, key: str) -> bool:
        return any(run["key"] == key for run in self.runs)
