"""The runs that a panel keeps: their list, their curves on one picture, and what goes out of them and comes in."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ipywidgets

from walkerlab.errors import Fault
from walkerlab.evolution import outputs
from walkerlab.evolution.loading import load
from walkerlab.evolution.run import Run
from walkerlab.system.files import absolute_path, shown
from walkerlab.text.html import Html, join
from walkerlab.view.plots.style import RUNS
from walkerlab.view.report.code import as_python, own_functions
from walkerlab.view.snapshots import HasSnapshot
from walkerlab.widgets.curve import Curve
from walkerlab.widgets.drawer import Drawer
from walkerlab.widgets.drawing_thread import Desk
from walkerlab.widgets.run_folders import Kept, best_of, name_of, new_file, run_files, told_apart
from walkerlab.widgets.run_list import Shelf


class RunsRoom(HasSnapshot, ipywidgets.Box):
    """The runs of a panel, of which one is chosen to be looked at.

    Attributes:
        kept: the runs, by their keys; every change is a new dict.
        curve: their fitness.
        shelf: their list.
        drawer: where the chosen one is exported and its code copied, and others are loaded.
    """

    title = "runs"

    def __init__(
        self, folder: Path, desk: Desk, on_chosen: Callable[[], None], on_settings: Callable[[], None]
    ) -> None:
        """Make it, with no runs.

        Args:
            folder: where the runs are kept, in a folder each.
            desk: at which the curve is drawn.
            on_chosen: told that another run is chosen.
            on_settings: told that the settings of the chosen run are wanted for the next one.
        """
        self._folder, self._desk, self._on_chosen = folder, desk, on_chosen
        self._on_curve = list[tuple[str, str, bool]]()
        self.kept = dict[str, Kept]()
        self.curve, self.shelf, self.drawer = Curve(), Shelf(), Drawer(self._load, self._export, on_settings)
        self._list_files()
        super().__init__([self.curve, self.shelf, self.drawer])
        self.add_class("wl-runs")
        self.shelf.observe(self._run_chosen, "selected")
        self.shelf.observe(self._runs_changed, "runs")

    def snapshot(self) -> Html:
        """Write the curves, the list and the code of the chosen run as static HTML."""
        return join(*(piece.snapshot() for piece in (self.curve, self.shelf, self.drawer)))

    @property
    def chosen(self) -> Run | None:
        """The run that is chosen, as far as it has come; None before there is one."""
        kept = self.kept.get(str(self.shelf.selected))
        return kept.run if kept else None

    def keep(self, kept: Kept, name: str) -> None:
        """Put a run into the list, and choose it."""
        self.kept = {**self.kept, kept.key: kept}
        self.shelf.put(kept.key, name=name)
        self.shelf.selected = kept.key
        self.redraw()
        self._on_chosen()  # also if it was chosen before, and has grown since

    def redraw(self) -> None:
        """Have the curve drawn anew, and the list told what the runs have reached."""
        self._desk.order("curve", self._draw_curve)
        self._desk.order("shelf", self._tell_runs)

    def _draw_curve(self) -> None:
        """Draw the curves of the runs that are to be shown, each in the look that the list gives it."""
        entries: list[dict[str, Any]] = self.shelf.runs
        shown = {entry["key"]: entry for entry in entries if entry["shown"] and entry["key"] in self.kept}
        kept = [self.kept[key] for key in shown]
        tables = {shown[one.key]["name"]: one.run.records for one in kept}
        going = [one.settings.algorithm.generations for one in kept if one.live and not one.live.is_over]
        self.curve.draw(tables, max(going, default=1), [RUNS.index(shown[one.key]["colour"]) for one in kept])

    def _tell_runs(self) -> None:
        """Say in the list what tells the runs apart and what each has reached, and offer the code of the chosen one."""
        kept = list(self.kept.values())
        for one, differs in zip(kept, told_apart([one.settings for one in kept]), strict=True):
            self.shelf.tell(one.key, differs=differs, best=best_of(one.run), state=one.state)
        run = self.chosen
        has_walked = run is not None and bool(run.n_generations)
        self.drawer.can_export = has_walked
        self.drawer.code = _code(run) if run and has_walked else ""

    def _run_chosen(self, _change: object) -> None:
        self._desk.order("shelf", self._tell_runs)
        self._on_chosen()

    def _runs_changed(self, _change: object) -> None:
        """Forget runs that were dropped from the list, and draw those that are to be shown."""
        on_curve = [(entry["key"], entry["name"], entry["shown"]) for entry in self.shelf.runs]
        if on_curve == self._on_curve:
            return
        self._on_curve, keys = on_curve, {entry["key"] for entry in self.shelf.runs}
        for key in self.kept.keys() - keys:
            if live := self.kept[key].live:
                live.stop()
        self.kept = {key: kept for key, kept in self.kept.items() if key in keys}
        self._desk.order("curve", self._draw_curve)

    # ---------------------------------------------------------------------------------------------- out and in

    def _list_files(self) -> None:
        """List the run files that can be loaded."""
        self._files = {shown(Path(path)): path for path in run_files(self._folder)}
        self.drawer.files = list(self._files)

    def _load(self, name: str) -> None:
        try:
            run = load(path := self._files.get(name, name))
            best_of(run)  # whose genome may be no genome
        except (ValueError, OSError) as error:
            self.drawer.words = str(error)
            return
        file = run.path or absolute_path(path)
        self.keep(Kept(str(file.resolve()), run.settings, run), name_of(file))
        none = "" if run.n_generations else f" No generation is done yet; resume it with wl.resume({shown(file)!r})."
        self.drawer.words = f"Loaded {shown(file)}.{none}"

    def _export(self) -> None:
        """Write all that there is to see of the chosen run into its folder, on a thread, for it takes seconds."""
        if (run := self.chosen) and run.n_generations:
            folder = run.path.parent if run.path else new_file(self._folder).parent
            self.drawer.words = f"Writing into {shown(folder)} …"
            threading.Thread(target=self._write, args=(run, folder), name="walkerlab export", daemon=True).start()

    def _write(self, run: Run, folder: Path) -> None:
        try:
            outputs.write(run, folder)
        except Fault as error:
            self.drawer.words = str(error)
        except Exception as error:  # it is on a thread of its own: nobody else would say so
            self.drawer.words = f"Nothing could be written into {shown(folder)}. {type(error).__name__}: {error}"
        else:
            self._list_files()
            self.drawer.words = f"Exported into the folder {shown(folder)}: {', '.join(outputs.FILES)}."


def _code(run: Run) -> str:
    """Write the code that makes a run again, and say which functions it takes for granted."""
    own = own_functions(run.settings)
    needed = f"# Define these of your own first: {', '.join(own)}\n" if own else ""
    return needed + as_python(run.settings, run.records)
