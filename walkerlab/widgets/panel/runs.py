"""The runs area of a panel: fitness curves, the list of runs, and controls to load and export them."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ipywidgets

from walkerlab.evolution import outputs
from walkerlab.evolution.loading import load
from walkerlab.evolution.run import Run
from walkerlab.runfile.records import RANDOM
from walkerlab.settings.settings import Settings
from walkerlab.system.errors import WalkerlabError
from walkerlab.system.files import absolute_path, display_path
from walkerlab.text.templates import Markup, render
from walkerlab.view.plots.style import RUN_COLOURS
from walkerlab.view.report.code import as_python, user_functions
from walkerlab.view.snapshots import HasSnapshot
from walkerlab.widgets.curve import Curve
from walkerlab.widgets.panel.drawer import Drawer, EvolveFurther
from walkerlab.widgets.panel.drawing_thread import DrawingThread
from walkerlab.widgets.panel.generation_slider import GenerationSlider
from walkerlab.widgets.panel.run_folders import (
    ListedRun,
    best_result,
    describe_differences,
    find_run_files,
    n_further,
    new_run_path,
    run_name,
    save_name,
)
from walkerlab.widgets.panel.run_list import RunList

SAME_TABLE = "In a notebook cell, the code repeats the run and gives the same table."
LAST_SETTINGS = (
    "The settings of this run were changed: the code has the last ones, so that its first generations differ."
)


class RunsArea(HasSnapshot, ipywidgets.Box):
    """The runs of a panel, one of which is selected.

    Attributes:
        entries: Dict from keys to runs; replaced by a new dict at every change.
        curve: Fitness curves.
        generation: Slider that selects the generation of the selected run that is shown.
        run_list: List of the runs.
        drawer: Controls that export the selected run, show its code, and load other runs.
    """

    title = "runs"

    def __init__(
        self,
        folder: Path,
        drawing: DrawingThread,
        on_selected: Callable[[], None],
        on_settings: Callable[[], None],
        on_further: EvolveFurther,
        on_hand_in: Callable[[], None] | None = None,
    ) -> None:
        """Create the area without runs.

        Args:
            folder: Folder of the runs, each in a subfolder.
            drawing: Thread that draws the curve.
            on_selected: Called when another run is selected.
            on_settings: Called to copy the settings of the selected run to the form.
            on_further: Called to continue the selected run.
            on_hand_in: Called to hand in the champion of the selected run; if None, there is no button for it.
        """
        self._folder = folder
        self._drawing = drawing
        self._on_selected = on_selected
        self._exported: dict[str, list[str]] = {}  # paths of the exported files of each run, by its key
        self._on_curve: list[tuple[str, str, bool]] = []
        self.entries: dict[str, ListedRun] = {}
        self.curve = Curve()
        self.run_list = RunList()
        self.generation = GenerationSlider()
        self.drawer = Drawer(self._load, self._export, on_settings, on_further, on_hand_in)
        self._list_files()
        super().__init__([self.curve, self.generation, self.run_list, self.drawer])
        self.add_class("wl-runs")
        self.run_list.observe(self._selection_changed, "selected")
        self.run_list.observe(self._list_changed, "runs")

    def snapshot(self) -> Markup:
        """Return the curves, the list and the code of the selected run as static HTML."""
        return render(
            "widgets/panel/runs.html",
            curve=self.curve.snapshot(),
            run_list=self.run_list.snapshot(),
            drawer=self.drawer.snapshot(),
        )

    @property
    def selected(self) -> Run | None:
        """The completed generations of the selected run; None without runs."""
        entry = self.selected_entry
        return entry.run if entry else None

    @property
    def visible(self) -> Run | None:
        """The selected run; until generation 0 is complete, the robots that have walked so far; None without runs."""
        entry = self.selected_entry
        return entry.visible if entry else None

    @property
    def selected_entry(self) -> ListedRun | None:
        """The selected run in the list; None without runs."""
        return self.entries.get(str(self.run_list.selected))

    def add(self, entry: ListedRun, name: str) -> None:
        """Add a run to the list, or replace the one with the same key, and select it.

        Args:
            entry: Run to add.
            name: Name of the run; if empty, the name in the list is unchanged.
        """
        self.entries = {**self.entries, entry.key: entry}
        self._exported.pop(entry.key, None)  # files of a run that continues are out of date
        self.run_list.add(entry.key, name=name)
        self.run_list.selected = entry.key
        self.drawer.exported = []
        self._list_files()
        self.redraw()
        self._on_selected()  # even if it was selected already: its file may have grown

    def describe_equal_run(self, settings: Settings) -> str:
        """Return a sentence that a new run will have the robots of a run in the list; "" if it will not."""
        for key, entry in self.entries.items():
            if entry.settings == settings and _is_repeatable(entry.run):
                name = self.run_list.name_of(key)
                return f" It would repeat {name}."
        return ""

    def redraw(self, *, is_urgent: bool = False) -> None:
        """Request an update of the curve and of the list."""
        self._drawing.request("curve", self._draw_curve, is_urgent=is_urgent)
        self._drawing.request("run list", self._update_list, is_urgent=is_urgent)

    def _draw_curve(self) -> None:
        """Draw the curves of the runs that are shown, with the colours and markers of the list."""
        rows: list[dict[str, Any]] = self.run_list.runs
        shown = {row["key"]: row for row in rows if row["shown"] and row["key"] in self.entries}
        entries = [self.entries[key] for key in shown]
        tables = {shown[entry.key]["name"]: entry.run.records for entry in entries}
        running = [entry.settings.algorithm.generations for entry in entries if entry.live and not entry.live.is_over]
        looks = [RUN_COLOURS.index(shown[entry.key]["colour"]) for entry in entries]
        self.curve.draw(tables, max(running, default=1), looks)

    def _update_list(self) -> None:
        """Update the texts of the list, and the code of the selected run."""
        entries = list(self.entries.values())
        differences = describe_differences([entry.settings for entry in entries])
        for entry, differs in zip(entries, differences, strict=True):
            self.run_list.update(entry.key, differs=differs, best=best_result(entry.run), state=entry.state)
        entry = self.selected_entry
        run = entry.run if entry else None
        has_generations = run is not None and bool(run.n_generations)
        self.generation.n_generations = run.n_generations if run else 0
        self.drawer.can_export = has_generations
        self.drawer.n_further = n_further(entry) if entry else 0
        self.drawer.code = _code(run) if run and has_generations else ""
        self.drawer.about_code = LAST_SETTINGS if run and len(run.stages) > 1 else SAME_TABLE

    def _selection_changed(self, _change: object) -> None:
        exported = self._exported.get(str(self.run_list.selected), [])
        if exported != self.drawer.exported:
            self.drawer.words = ""
            self.drawer.exported = exported
        self._drawing.request("run list", self._update_list)
        self._on_selected()

    def _list_changed(self, _change: object) -> None:
        """Stop runs that were removed from the list, and redraw the curve if it shows other runs or names."""
        rows: list[dict[str, Any]] = self.run_list.runs
        on_curve = [(str(row["key"]), str(row["name"]), bool(row["shown"])) for row in rows]
        if on_curve == self._on_curve:
            return
        names = {key: name for key, name, _ in self._on_curve}
        for key, name, _ in on_curve:
            if names.get(key, name) != name and key in self.entries and (path := self.entries[key].run.path):
                save_name(path, name)
        self._on_curve = on_curve
        if self.drawer.words.startswith("⚠"):
            self.drawer.words = ""
        keys = {key for key, _, _ in on_curve}
        for key in self.entries.keys() - keys:
            if live := self.entries[key].live:
                live.stop()
        self.entries = {key: entry for key, entry in self.entries.items() if key in keys}
        self._list_files()
        self._drawing.request("curve", self._draw_curve)

    # ---------------------------------------------------------------------------------------- load and export

    def _list_files(self) -> None:
        """Update the list of run files that can be loaded: those whose runs are not in the list of runs."""
        listed = {str(path.resolve()) for entry in self.entries.values() if (path := entry.run.path)}
        files = (Path(path) for path in find_run_files(self._folder))
        self._files = {display_path(path): str(path) for path in files if str(path.resolve()) not in listed}
        self.drawer.files = [
            {"path": path, "name": f"{run_name(Path(file))} ({path})"} for path, file in self._files.items()
        ]

    def _load(self, name: str) -> None:
        try:
            run = load(path := self._files.get(name, name))
            best_result(run)  # raises if the champion's genome is damaged
        except (ValueError, OSError) as error:
            self.drawer.report_fault(error)
            return
        file = run.path or absolute_path(path)
        self.add(ListedRun(str(file.resolve()), run.settings, run), run_name(file))
        hint = "" if run.n_generations else " No generation is complete yet. Press Continue this run to evolve it."
        self.drawer.exported = []
        self.drawer.words = f"Loaded {display_path(file)}.{hint}"

    def _export(self) -> None:
        """Write all outputs of the selected run into its folder, on a thread because it takes seconds."""
        if (run := self.selected) and run.n_generations:
            folder = run.path.parent if run.path else new_run_path(self._folder).parent
            self.drawer.exported = []
            key = str(self.run_list.selected)
            self.drawer.words = f"Writing into {display_path(folder)} …"
            threading.Thread(target=self._write, args=(run, folder, key), name="walkerlab export", daemon=True).start()

    def _write(self, run: Run, folder: Path, key: str) -> None:
        try:
            outputs.write_outputs(run, folder)
        except WalkerlabError as error:
            self.drawer.report_fault(error)
        except Exception as error:  # on this thread, nothing else reports it
            self.drawer.report_fault(
                f"The run could not be exported into {display_path(folder)}. {type(error).__name__}: {error}"
            )
        else:
            self._list_files()
            self._exported[key] = [f"{display_path(folder)}/{name}" for name in outputs.OUTPUT_FILES]
            if key == self.run_list.selected:
                self.drawer.words = f"Exported into the folder {display_path(folder)}:"
                self.drawer.exported = self._exported[key]


def _is_repeatable(run: Run) -> bool:
    """Return whether a run depends on its settings only: one stage, and all robots without parents are random."""
    first = run.records[run.records.parents == ""]
    return len(run.stages) <= 1 and bool((first.operators == RANDOM).all())


def _code(run: Run) -> str:
    """Return the code that repeats a run, with a comment on the user functions that it requires."""
    functions = user_functions(run.settings)
    comment = f"# Define these functions first: {', '.join(functions)}\n" if functions else ""
    return comment + as_python(run.settings, run.records)
