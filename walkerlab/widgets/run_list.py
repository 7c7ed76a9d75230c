"""The list of the runs that are kept: shown on the curve or not, named, looked at, dropped."""

import threading
from collections import Counter
from collections.abc import Mapping
from typing import Any

import traitlets

from walkerlab.text.html import Html, table, tag
from walkerlab.view.plots.style import RUN_COLOURS, RUN_MARKERS
from walkerlab.widgets.component import Part, script, style

LONGEST = 60  # characters of a name, which stands in legends


class Shelf(Part):
    """The list of kept runs; it knows them by a key only, so observe ``runs`` and ``selected`` to act on what is done.

    Attributes:
        runs: an entry each, in the order in which they came: ``key``, ``name``, ``colour`` and ``mark`` of its line,
            ``differs``, ``best`` and ``state`` in words, and whether it is ``shown`` on the curve.
        selected: the key of the run that is looked at, "" if there is none.
    """

    title = "list of runs"
    _esm = script("run_list")
    _css = style("run_list")
    runs = traitlets.List().tag(sync=True)
    selected = traitlets.Unicode().tag(sync=True)

    def __init__(self) -> None:
        """Make an empty one."""
        super().__init__()
        self._lock = threading.RLock()
        self.on_msg(self._heard)

    def set_state(self, sync_data: dict[str, Any]) -> None:
        """Hear nothing from a browser but messages."""

    def put(self, key: str, **told: Any) -> None:
        """Add a run, in a colour and with a mark that no other has, as long as there are such.

        Args:
            key: by which it is known; one that is there already is only told of.
            **told: as for ``tell``.
        """
        with self._lock:
            if self._knows(key):
                self.tell(key, **told)
                return
            new = {"key": key, **self._next_look(), "differs": "", "best": "", "state": "", "shown": True}
            self.runs = [*self.runs, new | self._checked(key, {"name": key} | told)]

    def tell(self, key: str, **told: Any) -> None:
        """Tell what is new of a run; nothing comes of it if the run was dropped meanwhile.

        Args:
            key: by which it is known.
            **told: any of ``name``, ``differs``, ``best``, ``state``, ``shown``.
        """
        with self._lock:
            told = self._checked(key, told)
            self.runs = [run | told if run["key"] == key else run for run in self.runs]

    def drop(self, key: str) -> None:
        """Forget a run; if it was looked at, its neighbour is."""
        with self._lock:
            keys = [run["key"] for run in self.runs]
            if key not in keys:
                return
            place = keys.index(key)
            self.runs = [run for run in self.runs if run["key"] != key]
            if self.selected == key:
                self.selected = self.runs[min(place, len(self.runs) - 1)]["key"] if self.runs else ""

    def snapshot(self) -> Html:
        """Write the list as static HTML."""
        if not self.runs:
            return tag("p", "No run was started or loaded.")
        rows = [[run[key] for key in ("name", "differs", "best", "state")] for run in self.runs]
        strong = ["strong" if run["key"] == self.selected else "" for run in self.runs]
        return table("Runs", ("run", "differs", "best", "state"), rows, classes=strong)

    def _next_look(self) -> dict[str, str]:
        """Return the colour and mark that fewest runs have, the earlier ones first."""
        used = Counter(run["colour"] for run in self.runs)
        place = min(range(len(RUN_COLOURS)), key=lambda i: used[RUN_COLOURS[i]])
        return {"colour": RUN_COLOURS[place], "mark": RUN_MARKERS[place]}

    def _checked(self, key: str, told: Mapping[str, Any]) -> dict[str, Any]:
        """Make a name one of its own, on one line and not too long; none is no news."""
        name = " ".join(str(told.get("name", "")).split())[:LONGEST]
        others = {run["name"] for run in self.runs if run["key"] != key}
        again = (f"{name} ({n})" for n in range(2, len(others) + 2))
        own = {"name": next(one for one in (name, *again) if one not in others)} if name else {}
        return {what: news for what, news in told.items() if what != "name"} | own

    def _heard(self, _: object, message: object, __: object) -> None:
        """Do what the browser asks for, if there is such a run."""
        with self._lock:
            match message:
                case {"drop": str(key)}:
                    self.drop(key)
                case {"name": str(name), "of": str(key)}:
                    self.tell(key, name=name)
                case {"shown": bool(shown), "of": str(key)}:
                    self.tell(key, shown=shown)
                case {"select": str(key)} if self._knows(key):
                    self.selected = key
                case _:
                    pass

    def _knows(self, key: str) -> bool:
        return any(run["key"] == key for run in self.runs)
