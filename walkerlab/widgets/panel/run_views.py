"""What a panel shows of its selected run: the population, the robot and the walk of a generation."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import ipywidgets

from walkerlab.evolution.live import LiveRun, State
from walkerlab.evolution.run import Run
from walkerlab.evolution.running import evolve
from walkerlab.evolution.stages import find_changes
from walkerlab.genome.genome import Genome
from walkerlab.runfile.records import concatenate_tables
from walkerlab.settings.model import SettingsError
from walkerlab.system.files import display_path
from walkerlab.widgets.form import Form
from walkerlab.widgets.panel.class_lock import ClassLock
from walkerlab.widgets.panel.drawing_thread import DrawingThread
from walkerlab.widgets.panel.generation_slider import LATEST
from walkerlab.widgets.panel.robot import RobotArea
from walkerlab.widgets.panel.run_folders import ListedRun
from walkerlab.widgets.panel.run_status import best_walker, describe_state
from walkerlab.widgets.panel.runs import RunsArea
from walkerlab.widgets.panel.transport import Transport
from walkerlab.widgets.panel.walker_view import WalkerView
from walkerlab.widgets.population import Population

SETTINGS_CHANGED = "This run keeps its settings. The changed settings are for a new run."


class ShowsRun:
    """Mix-in of the panel that updates the views of the selected run; its attributes are those of the panel."""

    runs: RunsArea
    population: Population
    form: Form
    robot: RobotArea
    walker: WalkerView
    lock: ClassLock
    transport: Transport
    _active: LiveRun | None
    _n_started: int
    _reported: dict[LiveRun, tuple[tuple[State, int] | None, float]]
    _run_progressed: Callable[[LiveRun], None]
    _show_status: Callable[[LiveRun], None]
    _drawing: DrawingThread

    def finish(self) -> Run:
        """Return the selected run when it is complete; without runs, evolve one with the settings of the form.

        A paused run continues. Until the run is complete, a progress bar is shown, and no button responds. If there are
        several runs, the name of the selected one is printed.

        Raises:
            SettingsError: If there is no run, and the settings of the form are not valid.
        """
        entry = self.runs.selected_entry
        if len(self.runs.entries) > 1:
            print(f"Run selected in the panel: {self._selected_name()}")
        if entry and entry.live and not entry.live.is_over:
            return entry.live.finish()
        if (run := self.runs.selected) and run.n_generations:
            return run
        settings: Any = self.form.settings
        if not settings:
            raise SettingsError(str(self.form.fault))
        return evolve(settings)

    def hand_in(self, genome: Genome | str | None = None) -> Path:
        """Write a robot into the shared folder of the class, under the name of the student.

        Args:
            genome: Genome or its text; the champion of the selected run if None.

        Returns:
            The path of the file; an earlier robot of the same student is replaced.

        Raises:
            ValueError: If there is no run, no shared folder or no name.
        """
        return self.lock.hand_in(self.runs.selected if genome is None else Genome.of(genome))

    def _hand_in_champion(self) -> None:
        """Hand in the champion of the selected run, and show where it is or why it could not be handed in."""
        try:
            path = self.hand_in()
        except (ValueError, OSError) as error:
            self.runs.drawer.report_fault(f"The robot was not handed in: {error}")
        else:
            self.runs.drawer.words = f"Handed in as {display_path(path)}, in place of any earlier robot of yours."

    def _take_over(self, earlier: Any) -> None:
        """Take over the runs of an earlier panel, which is closed; a run in progress continues."""
        rows: dict[str, dict[str, Any]] = {row["key"]: row for row in earlier.runs.run_list.runs}
        entries: dict[str, ListedRun] = earlier.runs.entries
        selected = str(earlier.runs.run_list.selected)
        earlier.runs.entries = {}
        self._active, self._n_started = earlier._active, earlier._n_started
        for key, entry in entries.items():
            if entry.live:
                self._reported[entry.live] = None, 0.0
                entry.live.on_change = self._run_progressed
            self.runs.add(entry, rows[key]["name"])
        earlier.close()
        self.runs.run_list.selected = selected
        if self._active:
            self._show_status(self._active)

    def _compare_with_form(self) -> None:
        """Say during a run that changed settings of the form are for a new run."""
        settings: Any = self.form.settings
        is_changed = self._active is not None and settings and find_changes(self._active.settings, settings)
        self.transport.note = SETTINGS_CHANGED if is_changed else ""

    def _run_selected(self) -> None:
        if self._active and self._active.is_over:  # the controls describe the last run only while it is selected
            entry = self.runs.selected_entry
            self.transport.words = describe_state(self._active) if entry and entry.live is self._active else ""
        self.population.selected = -1
        self.runs.generation.selected = LATEST
        self._generation_selected()

    def _generation_selected(self, _change: object = None) -> None:
        self._request_views(is_urgent=True)

    def _request_views(self, *, is_urgent: bool) -> None:
        """Request the population, and then the walk of its best robot."""
        self._drawing.request("population", self._show_population, is_urgent=is_urgent)
        self._drawing.request("walker", self._show_walker, is_urgent=is_urgent)

    def _robot_selected(self, _change: object) -> None:
        self._drawing.request("robot", self._show_robot, is_urgent=True)

    def _show_population(self) -> None:
        """Show the selected generation, or the robots that have walked if generation 0 is not complete."""
        run = self.runs.visible
        table = run.records if run else concatenate_tables([])
        generation = self.runs.generation.generation
        if generation is not None:
            table = table.loc[table.generation == generation]
        self.population.show(table, run.settings if run else None)
        self._show_robot()

    def _show_robot(self) -> None:
        """Show the selected robot, or the champion so far."""
        if (run := self.runs.visible) and run.n_generations:
            self.robot.show(run, self.population.selected)

    def _show_walker(self) -> None:
        """Show the walk of the best robot so far, or of the best robot of the selected generation."""
        runs = self.runs
        name = self._selected_name() if len(runs.entries) > 1 else ""
        self.walker.show(best_walker(runs.selected_entry, runs.generation.generation, name))

    def _selected_name(self) -> str:
        run_list = self.runs.run_list
        return run_list.name_of(str(run_list.selected))


def arrange_areas(*columns: list[Any]) -> ipywidgets.Box:
    """Return the layout of the panel.

    Args:
        columns: Components at the top, on the left, on the right and at the bottom.
    """
    names = ("wide", "left", "right", "wide")
    areas = [
        ipywidgets.Box(parts).add_class("wl-area").add_class(f"wl-{name}")
        for name, parts in zip(names, columns, strict=True)
    ]
    return ipywidgets.Box(areas).add_class("wl-areas")
