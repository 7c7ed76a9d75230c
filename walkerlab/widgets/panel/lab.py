"""The panel: run controls, the world and its settings, a walking robot, the runs, and the robots of a generation.

The form changes the drawing of the world and the settings of new runs. Live runs, each on its own thread, update the
curves, the list of runs and the population. All pictures are drawn on one other thread.
"""

import time
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path
from threading import Lock
from typing import Any, cast

import ipywidgets
import traitlets

from walkerlab.evolution.live import LiveRun, State
from walkerlab.evolution.run import Run
from walkerlab.genome.genome import Genome
from walkerlab.settings.model import SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.simulation.workers import check_executor
from walkerlab.system.files import absolute_path
from walkerlab.text.templates import Markup, render
from walkerlab.view.snapshots import HasSnapshot, nested_widgets
from walkerlab.widgets.controls import use_labels
from walkerlab.widgets.panel.cells import register_in_cell
from walkerlab.widgets.panel.class_lock import make_lock
from walkerlab.widgets.panel.drawing_thread import DrawingThread
from walkerlab.widgets.panel.generation_slider import LATEST
from walkerlab.widgets.panel.robot import RobotArea
from walkerlab.widgets.panel.run_folders import ListedRun, new_live_run, prepare_further_generations
from walkerlab.widgets.panel.run_status import describe_forecast, error_text, show_state
from walkerlab.widgets.panel.run_views import ShowsRun, arrange_areas
from walkerlab.widgets.panel.runs import RunsArea
from walkerlab.widgets.panel.transport import Transport
from walkerlab.widgets.panel.walker_view import WalkerView
from walkerlab.widgets.population import Population
from walkerlab.widgets.world import World

STATUS_INTERVAL = 0.2  # s between two updates of the progress of a run


class Lab(ShowsRun, HasSnapshot, ipywidgets.Box):
    """The panel, in a notebook.

        lab = wl.Lab()
        lab

    Attributes:
        run: Completed generations of the run that is selected in the list; None without runs.
        settings: Settings of the form; None while they are invalid. Setting it changes the form.
    """

    title = "panel"

    def __init__(
        self,
        settings: Settings | None = None,
        folder: str | Path = "lab",
        executor: Executor | None = None,
        *,
        only: Sequence[str] = (),
        budget: int | None = None,
        locked: Mapping[str, Any] | None = None,
        student: str = "",
    ) -> None:
        """Create the panel; no walk is simulated and no file is created until a button is pressed.

        The limits of the class that ``walkerlab lab --class`` named apply, too.

        Args:
            settings: Initial settings of the form; the defaults if None.
            folder: Folder of the runs, each in a subfolder; if it is not writable, runs are not saved.
            executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
            only: Names of the domains (``"terrain"``) and settings (``"step_height"``) to show; all if empty.
            budget: Maximum number of walks of a run; None for any.
            locked: Fixed settings with their values: ``{"population_size": 24}``.
            student: Name of the student, for the seed and for ``hand_in``.

        Raises:
            SettingsError: If a limit, or the file of the class, is wrong.
            ValueError: If each student has a seed, and the name is unknown.
        """
        self.lock = make_lock(settings, only, budget, locked, student)
        settings = self.lock.settings
        self._folder = absolute_path(folder, "folder")
        self._executor = executor
        self._reported: dict[LiveRun, tuple[tuple[State, int] | None, float]] = {}  # last state and time shown
        self._active: LiveRun | None = None
        self._n_started = 0
        self._button_lock = Lock()
        self._drawing = DrawingThread(self._is_running, self._report_drawing_error)
        self.form = self.lock.make_form()
        self.world = World(settings)
        self.transport = Transport(self._press)
        self.walker = WalkerView()
        hand_in = self._hand_in_champion if self.lock.classroom.shared_folder else None
        self.runs = RunsArea(
            self._folder, self._drawing, self._run_selected, self._copy_settings, self._evolve_further, hand_in
        )
        self.population = Population()
        self.population.hint = "click a robot: its description is below"
        self.robot = RobotArea(settings, self._insert, self._continue_with)
        columns = ([self.transport], [self.world, self.form], [self.walker, self.runs], [self.population, self.robot])
        super().__init__([arrange_areas(*columns)])
        check_executor(executor)  # last, so that the panel can be closed if this raises
        self.add_class("wl-lab")
        traitlets.dlink((self.runs.drawer, "n_further"), (self.robot.editor, "can_continue"), bool)
        self.form.observe(self._form_changed, ["settings", "fault"])
        self.population.observe(self._robot_selected, "selected")
        self.runs.generation.observe(self._generation_selected, "selected")
        for panel in register_in_cell(self):  # or its run would continue without a panel
            self._take_over(panel)
        self._form_changed()
        self._run_selected()

    def __repr__(self) -> str:
        """Return a short description without the widgets, which are many."""
        return f"<Lab: a panel with {len(self.runs.entries)} runs, displayed in a notebook>"

    def snapshot(self) -> Markup:
        """Return the content of the panel as static HTML."""
        components = (self.transport, self.walker, self.runs, self.population, self.robot, self.world)
        snapshots = [component.snapshot() for component in components]
        return render("widgets/panel/lab.html", components=snapshots, form=self.form.snapshot())

    @property
    def settings(self) -> Settings | None:
        """Settings of the form; None while they are invalid."""
        return cast(Settings | None, self.form.settings)

    @settings.setter
    def settings(self, settings: Settings) -> None:
        self.form.settings = settings

    @property
    def run(self) -> Run | None:
        """Completed generations of the run that is selected in the list; None without runs."""
        return self.runs.selected

    def close(self) -> None:
        """Stop all runs, release their workers and remove the panel; run files remain."""
        if hasattr(self, "robot"):  # not if an argument was invalid
            self._drawing.close()
            live_runs = [entry.live for entry in self.runs.entries.values() if entry.live]
            for end in (LiveRun.stop, LiveRun.close):  # all are stopped before the first wait
                for live in live_runs:
                    end(live)
        for component in nested_widgets(self):
            component.close()
        super().close()

    def _form_changed(self, _change: object = None) -> None:
        """Draw the new world, and show the forecast of a run or why none can start."""
        settings = self.settings
        faults = "\n".join(map(use_labels, self.form.fault.splitlines()))
        faults = self.lock.describe_excess(settings) if settings else faults
        self.transport.fault = f"Cannot start. {faults}" if faults else ""
        if settings:
            self._compare_with_form()
            self._drawing.request("world", self.world.prepare(settings), is_urgent=True)
            self._drawing.request("forecast", self._show_forecast)
            if not self.run:  # edited genomes are simulated in the world of the selected run, if there is one
                self.robot.set_settings(settings)

    def _show_forecast(self) -> None:
        """Show how long a run with the form's settings will take; not during a run, which would distort the timing."""
        if (settings := self.settings) and not self._is_running():
            words = describe_forecast(settings, self._active) + self.lock.describe_budget(settings)
            self.transport.forecast = words + self.runs.describe_equal_run(settings)

    def _press(self, button: str) -> None:
        """Carry out the action of a button; presses from several threads are processed one after the other."""
        with self._button_lock:
            live = self._active if self._is_in_progress else None
            match button:
                case "start" | "step" if not live and self.settings:
                    self._start(self.settings, 1 if button == "step" else None)
                case "step" if live:
                    live.resume(1)
                case "continue" if live:
                    live.resume()
                case "pause" if live:
                    live.pause()
                case "stop" if live:
                    live.stop()
                case _:
                    pass

    def _start(self, settings: Settings, generations: int | None) -> None:
        """Start a run, which pauses after a number of generations unless this is None."""
        if excess := self.lock.describe_excess(settings):
            self.transport.words = excess
            return
        try:
            live, note = new_live_run(settings, self._folder, self._executor, self._run_progressed, self.transport.stop)
        except ValueError as error:  # a user function that cannot be used as this operator
            self.transport.words = str(error)
            return
        self.runs.drawer.words = note
        self._n_started += 1
        name = f"run {self._n_started}"
        self._activate(ListedRun(name, settings, live), live, name)
        live.resume(generations)

    def _activate(self, entry: ListedRun, live: LiveRun, name: str) -> None:
        """Add a live run to the list, or replace the entry with the same key, and show its progress."""
        self._active = live
        self._reported[live] = None, 0.0
        self._compare_with_form()
        self.runs.generation.selected = LATEST
        self.runs.add(entry, name)

    def _evolve_further(self, n_generations: int, *, with_form: bool) -> None:
        """Continue the selected run, with the settings of the form or with its own."""
        with self._button_lock:
            entry = self.runs.selected_entry
            if not entry or self._is_in_progress:
                return
            try:
                prepared, note = prepare_further_generations(entry, n_generations, self.settings if with_form else None)
                self.lock.require_within_limits(prepared.settings)
            except ValueError as error:
                self.runs.drawer.report_fault(error)
                return
            live = LiveRun(prepared, None, self._executor, stop=self.transport.stop, on_change=self._run_progressed)
            for genome in entry.live.inserted_genomes if entry.live else []:  # before the run was stopped
                live.insert(genome)
            self.runs.drawer.words = note
            self._activate(ListedRun(entry.key, prepared.settings, live), live, "")
            live.resume()

    def _run_progressed(self, live: LiveRun) -> None:
        """Show the progress of a run, at limited frequency unless its state has changed."""
        state = (live.state, live.n_generations)
        now = time.monotonic()
        last_state, last_time = self._reported[live]
        is_first = live.n_generations == 1 and state != last_state  # only now are the random robots tested
        if state != last_state:
            self.runs.redraw(is_urgent=is_first)
        if state != last_state or not live.n_generations:
            self._request_views(is_urgent=is_first)
        if state == last_state and now - last_time < STATUS_INTERVAL:
            return
        self._reported[live] = state, now
        if live is self._active:
            self._show_status(live)
        if live.state != State.running:
            self._drawing.request("forecast", self._show_forecast)
            self._drawing.end_pause()

    def _show_status(self, live: LiveRun) -> None:
        """Show the state and the progress of a run."""
        if live.state == State.failed:
            self.runs.drawer.words = "\n".join(getattr(live.error, "__notes__", []))
        show_state(self.transport, live)
        self.walker.frame.is_busy = live.state == State.running
        self.robot.editor.can_insert = not live.is_over and live.n_generations > 0
        if live.is_over:
            self.robot.editor.report = ""
        if live.loss_note:
            self.runs.drawer.words = live.loss_note

    def _copy_settings(self) -> None:
        """Change the form to the settings of the selected run."""
        if run := self.run:
            try:
                self.settings = run.settings
                self.runs.drawer.words = "The form now has the settings of the selected run."
            except SettingsError as error:
                self.runs.drawer.report_fault(error)

    def _insert(self, genome: Genome) -> str:
        """Insert a genome into the next generation of the active run; return a message about the result."""
        if not self._active:
            return "No run is in progress."
        try:
            generation = self._active.insert(genome)
        except ValueError as error:
            return str(error)
        return f"The genome will be in generation {generation}, in place of a child. It is marked with ✎."

    def _continue_with(self, genome: Genome) -> str:
        """Continue the selected run with a genome in its next generation; return a message about the result."""
        if not self.runs.drawer.n_further:
            return "No run that can be continued is selected. Select a saved run that is not in progress."
        self._evolve_further(self.runs.drawer.n_further, with_form=False)
        return self._insert(genome)

    @property
    def _is_in_progress(self) -> bool:
        return self._active is not None and not self._active.is_over

    def _is_running(self) -> bool:
        return self._active is not None and self._active.state == State.running

    def _report_drawing_error(self, error: Exception) -> None:
        self.runs.drawer.report_fault(f"A picture could not be drawn. {error_text(error)}")
