"""The panel: run controls at the top, settings on the left, runs on the right, and the robots below.

The form changes the drawing of the world and the settings of new runs. Live runs, each on its own thread, update the
curves, the list of runs and the population. All pictures are drawn on one other thread.
"""

import time
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from threading import Lock
from typing import cast

import ipywidgets

from walkerlab.errors import WalkerlabError
from walkerlab.evolution.forecast import describe_duration, estimate_seconds, n_walks
from walkerlab.evolution.live import LiveRun, State
from walkerlab.evolution.run import Run
from walkerlab.genome.genome import Genome
from walkerlab.runfile.opening import RunFileError
from walkerlab.runfile.records import concatenate_tables
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.simulation.workers import check_executor
from walkerlab.system.files import absolute_path
from walkerlab.text.templates import Markup, render
from walkerlab.view.snapshots import HasSnapshot, nested_widgets
from walkerlab.widgets.cells import register_in_cell
from walkerlab.widgets.controls import use_labels
from walkerlab.widgets.drawing_thread import DrawingThread
from walkerlab.widgets.form import Form
from walkerlab.widgets.population import Population
from walkerlab.widgets.robot import RobotArea
from walkerlab.widgets.run_folders import ListedRun, new_run_path
from walkerlab.widgets.runs import RunsArea
from walkerlab.widgets.transport import Transport
from walkerlab.widgets.world import World

STATUS_INTERVAL = 0.2  # s between two updates of the progress of a run


class Lab(HasSnapshot, ipywidgets.Box):
    """The panel, in a notebook.

        lab = wl.Lab()
        lab

    Attributes:
        run: Completed generations of the run that is selected in the list; None without runs.
        settings: Settings of the form; None while they are invalid. Setting it changes the form.
    """

    title = "panel"

    def __init__(
        self, settings: Settings | None = None, folder: str | Path = "lab", executor: Executor | None = None
    ) -> None:
        """Create the panel; no walk is simulated and no file is created before a button is pressed.

        Args:
            settings: Initial settings of the form; the defaults if None.
            folder: Folder of the runs, each in a subfolder; if it is not writable, runs are not saved.
            executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        """
        settings = Settings() if settings is None else require_settings(settings)
        self._folder = absolute_path(folder, "folder")
        self._executor = executor
        self._reported: dict[LiveRun, tuple[tuple[State, int] | None, float]] = {}  # last state and time shown
        self._active: LiveRun | None = None
        self._button_lock = Lock()
        self._drawing = DrawingThread(self._is_running, self._report_drawing_error)
        self.form = Form(settings)
        self.world = World(settings)
        self.transport = Transport(self._press)
        self.runs = RunsArea(self._folder, self._drawing, self._run_selected, self._copy_settings)
        self.population = Population()
        self.robot = RobotArea(settings, self._insert)
        areas = [
            _make_area("wide", self.transport),
            _make_area("left", self.form, self.world),
            _make_area("right", self.runs),
            _make_area("wide", self.population, self.robot),
        ]
        super().__init__([ipywidgets.Box(areas).add_class("wl-areas")])
        check_executor(executor)  # last, so that the panel can be closed if this raises
        self.add_class("wl-lab")
        self.form.observe(self._form_changed, ["settings", "fault"])
        self.population.observe(self._robot_selected, "selected")
        for panel in register_in_cell(self):  # or its run would continue without a panel
            panel.close()
            self.transport.words = "The earlier panel of this cell was closed. Its runs are saved: open them with Load."
        self._form_changed()

    def __repr__(self) -> str:
        """Return a short description without the widgets, which are many."""
        return f"<Lab: a panel with {len(self.runs.entries)} runs, displayed in a notebook>"

    def snapshot(self) -> Markup:
        """Return the content of the panel as static HTML."""
        components = (self.transport, self.runs, self.population, self.robot, self.world)
        snapshots = [component.snapshot() for component in components]
        return render("widgets/lab.html", components=snapshots, form=self.form.snapshot())

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

    # ----------------------------------------------------------------------------------------- settings and forecast

    def _form_changed(self, _change: object = None) -> None:
        """Draw the new world, and show the forecast of a run or why none can start."""
        settings = self.settings
        faults = "\n".join(map(use_labels, self.form.fault.splitlines()))
        self.transport.fault = f"Cannot start. {faults}" if faults else ""
        if settings:
            self._drawing.request("world", partial(self.world.draw, settings))
            self._drawing.request("forecast", self._show_forecast)
            if not self.run:  # edited genomes are simulated in the world of the selected run, if there is one
                self.robot.set_settings(settings)

    def _show_forecast(self) -> None:
        """Show how long a run with the form's settings takes; not during a run, which would distort the timing."""
        if (settings := self.settings) and not self._is_running():
            algorithm = settings.algorithm
            run = f"{algorithm.generations} generations of {algorithm.population_size} robots"
            duration = describe_duration(self._seconds_of(settings))
            self.transport.forecast = f"A new run: {run}, {duration} on this computer."

    def _seconds_of(self, settings: Settings) -> float:
        """Estimate the duration of a run, s: at the pace of the last run if that was in the same world."""
        last = self._active
        if last and last.seconds_per_walk and _world_of(last.settings) == _world_of(settings):
            return last.seconds_per_walk * n_walks(settings)
        return estimate_seconds(settings)

    # ------------------------------------------------------------------------------------------------------ live runs

    def _press(self, button: str) -> None:
        """Carry out the action of a button; presses from several threads are processed one after the other."""
        with self._button_lock:
            self._carry_out(button)

    def _carry_out(self, button: str) -> None:
        live = self._active if self._active and not self._active.is_over else None
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
        try:
            live = self._create_live_run(settings)
        except ValueError as error:  # a user function that cannot be used as this operator
            self.transport.words = str(error)
            return
        self._active = live
        self._reported[live] = None, 0.0
        name = f"run {len(self._reported)}"
        self.runs.add(ListedRun(name, settings, live), name)
        live.resume(generations)

    def _create_live_run(self, settings: Settings) -> LiveRun:
        """Create a run with a run file, or without one if the folder is not writable."""
        try:
            return LiveRun(settings, new_run_path(self._folder), self._executor, on_change=self._run_progressed)
        except (RunFileError, OSError) as error:
            live = LiveRun(settings, None, self._executor, on_change=self._run_progressed)
            self.runs.drawer.words = f"This run will not be saved. {error}"
            return live

    def _run_progressed(self, live: LiveRun) -> None:
        """Show the progress of a run, at limited frequency unless its state has changed."""
        state = (live.state, live.n_generations)
        now = time.monotonic()
        last_state, last_time = self._reported[live]
        if state != last_state:
            self.runs.redraw()
            self._drawing.request("population", self._show_population)
        elif now - last_time < STATUS_INTERVAL:
            return
        self._reported[live] = state, now
        if live is self._active:
            self._show_status(live)
        if live.state != State.running:
            self._drawing.request("forecast", self._show_forecast)
            self._drawing.end_pause()

    def _show_status(self, live: LiveRun) -> None:
        """Show the state and the progress of a run."""
        n_done = live.n_generations
        last = live.settings.algorithm.generations - 1
        seconds_left = live.seconds_left
        where = f"after generation {n_done - 1} of 0 to {last}" if n_done else f"during generation 0 of 0 to {last}"
        match live.state:
            case State.running:
                left = " …" if seconds_left is None else f": {describe_duration(seconds_left)} left."
                words = f"Generation {n_done} of 0 to {last} is running{left}"
            case State.failed:
                words = f"Failed {where}. {_error_text(live.error)}"
                self.runs.drawer.words = "\n".join(getattr(live.error, "__notes__", []))
            case State.finished:
                words = f"Finished: generations 0 to {last} in {live.seconds:.0f} s."
            case state:
                words = f"{state.capitalize()} {where} ({live.seconds:.0f} s)."
        with self.transport.hold_sync():
            self.transport.state = live.state
            self.transport.words = words
            self.transport.share = live.n_done / live.n_walks
        self.robot.editor.can_insert = not live.is_over and n_done > 0
        if live.loss_note:
            self.runs.drawer.words = live.loss_note

    # ------------------------------------------------------------------------------------------- the selected run

    def _run_selected(self) -> None:
        self.population.selected = -1
        self._drawing.request("population", self._show_population)

    def _copy_settings(self) -> None:
        """Change the form to the settings of the selected run."""
        if run := self.run:
            self.settings = run.settings

    def _robot_selected(self, _change: object) -> None:
        self._drawing.request("robot", self._show_robot)

    def _show_population(self) -> None:
        """Show the last generation of the selected run."""
        run = self.run
        self.population.show(run.records if run else concatenate_tables([]), run.settings if run else None)
        self._show_robot()

    def _show_robot(self) -> None:
        """Show the selected robot, or the champion so far."""
        if (run := self.run) and run.n_generations:
            self.robot.show(run, self.population.selected)

    def _insert(self, genome: Genome) -> str:
        """Insert a genome into the next generation of the active run; return a message on the result."""
        if not self._active:
            return "No run is in progress."
        try:
            generation = self._active.insert(genome)
        except ValueError as error:
            return str(error)
        return f"The genome will be in generation {generation}, in place of a child. It is marked with ✎."

    def _is_running(self) -> bool:
        return self._active is not None and self._active.state == State.running

    def _report_drawing_error(self, error: Exception) -> None:
        self.runs.drawer.words = f"A picture could not be drawn. {_error_text(error)}"


def _error_text(error: BaseException | None) -> str:
    """Return the message of an error, with its type unless the message is written for users."""
    return str(error) if isinstance(error, WalkerlabError) else f"{type(error).__name__}: {error}"


def _world_of(settings: Settings) -> tuple[object, ...]:
    """Return the domains of settings that a walk depends on."""
    return settings.terrain, settings.robot, settings.simulation


def _make_area(name: str, *components: ipywidgets.Widget) -> ipywidgets.Box:
    """Stack components in an area of the panel."""
    return ipywidgets.Box(components).add_class("wl-area").add_class(f"wl-{name}")
