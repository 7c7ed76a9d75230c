"""The whole panel: buttons on top, settings on the left, what comes of them on the right, the robots below.

    form → world                            what will be
    transport → LiveRun → runs, population  what comes of it
    population → robot                      one of them: its card, its gene, its walk

Every run goes on on a thread of its own, and tells that it has come farther; then what shows it is drawn, at one desk.
"""

import time
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from threading import Lock
from typing import cast

import ipywidgets

from walkerlab.errors import Fault
from walkerlab.evolution.forecast import describe_duration, estimate_seconds, n_walks
from walkerlab.evolution.live import LiveRun, State
from walkerlab.evolution.run import Run
from walkerlab.genome.genome import Genome
from walkerlab.runfile.records import join
from walkerlab.runfile.store import RunFileError
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.simulation.workers import check_executor
from walkerlab.system.files import absolute_path
from walkerlab.text.html import Html, details, tag
from walkerlab.view.snapshots import HasSnapshot, pieces_of
from walkerlab.widgets.cells import made_before
from walkerlab.widgets.controls import in_words as in_labels
from walkerlab.widgets.drawing_thread import Desk
from walkerlab.widgets.form import Form
from walkerlab.widgets.population import Population
from walkerlab.widgets.robot import RobotRoom
from walkerlab.widgets.run_folders import Kept, new_file
from walkerlab.widgets.runs import RunsRoom
from walkerlab.widgets.transport import Transport
from walkerlab.widgets.world import World

OFTEN = 0.2  # s between two words on how far a run has come


class Lab(HasSnapshot, ipywidgets.Box):
    """The panel, in a notebook.

        lab = wl.Lab()
        lab

    Attributes:
        run: the run that is chosen in the list, as far as it has come; None before there is one.
        settings: what the form says; None while that cannot be. Setting it moves the form.
    """

    title = "panel"

    def __init__(
        self, settings: Settings | None = None, folder: str | Path = "lab", executor: Executor | None = None
    ) -> None:
        """Set it up; nothing walks, and no file is made, before a button is pressed.

        Args:
            settings: with which the form begins; the defaults if None.
            folder: where every run is kept, in a folder of its own, made with the first run; if nothing can be written
                there, runs go with the panel.
            executor: any ``concurrent.futures.Executor``; loky on all cores if None.
        """
        settings = Settings() if settings is None else require_settings(settings)
        self._folder, self._executor = absolute_path(folder, "folder"), executor
        self._told = dict[LiveRun, tuple[object, float]]()
        self._active: LiveRun | None = None
        self._pressing = Lock()
        self._desk = Desk(self._is_busy, self._tell_fault)
        self.form, self.world = Form(settings), World(settings)
        self.transport, self.runs = (
            Transport(self._press),
            RunsRoom(self._folder, self._desk, self._run_chosen, self._take_settings),
        )
        self.population, self.robot = Population(), RobotRoom(settings, self._insert)
        rooms = ipywidgets.Box(
            [
                _room("wide", self.transport),
                _room("left", self.form, self.world),
                _room("right", self.runs),
                _room("wide", self.population, self.robot),
            ]
        )
        rooms.add_class("wl-rooms")
        super().__init__([rooms])
        check_executor(executor)  # now that there is a whole panel, which can be thrown away
        self.add_class("wl-lab")
        self.form.observe(self._form_changed, ["settings", "fault"])
        self.population.observe(self._robot_chosen, "selected")
        for panel in made_before(self):  # or its run would go on, with nobody to see it
            panel.close()
            self.transport.words = "The panel that stood here is closed. What it has run is in its files: see Load."
        self._form_changed()

    def __repr__(self) -> str:
        """Name it; its widgets are many."""
        return f"<Lab: a panel, to be seen in a notebook; it keeps {len(self.runs.kept)} runs>"

    def snapshot(self) -> Html:
        """Write what the panel shows as static HTML."""
        pieces = (self.transport, self.runs, self.population, self.robot, self.world)
        return tag("div", *(piece.snapshot() for piece in pieces), details("Settings", self.form.snapshot()))

    @property
    def settings(self) -> Settings | None:
        """What the form says; None while that cannot be."""
        return cast(Settings | None, self.form.settings)

    @settings.setter
    def settings(self, settings: Settings) -> None:
        self.form.settings = settings

    @property
    def run(self) -> Run | None:
        """The run that is chosen in the list, as far as it has come; None before there is one."""
        return self.runs.chosen

    def close(self) -> None:
        """Stop what runs, send the workers home, and take the panel off the page; the runs stay in their files."""
        if hasattr(self, "robot"):  # unless an argument was refused
            self._desk.close()
            lives = [kept.live for kept in self.runs.kept.values() if kept.live]
            for end in (LiveRun.stop, LiveRun.close):  # all are stopped before any is waited for
                for live in lives:
                    end(live)
        for piece in pieces_of(self):
            piece.close()
        super().close()

    # ---------------------------------------------------------------------------------------------- before a run

    def _form_changed(self, _change: object = None) -> None:
        """Draw the new world, and say what a run in it would cost, or why there can be none."""
        settings = self.settings
        faults = "\n".join(map(in_labels, self.form.fault.splitlines()))
        self.transport.fault = f"Cannot start. {faults}" if faults else ""
        if settings:
            self._desk.order("world", partial(self.world.draw, settings))
            self._desk.order("forecast", self._forecast)
            if not self.run:  # or edited genes walk in the world of the run that is looked at
                self.robot.use(settings)

    def _forecast(self) -> None:
        """Say how long a run of what the form says would take; while one is going on, its walks are in the way."""
        if (settings := self.settings) and not self._is_busy():
            algorithm = settings.algorithm
            run = f"{algorithm.generations} generations of {algorithm.population_size} robots"
            duration = describe_duration(self._seconds_of(settings))
            self.transport.forecast = f"A new run: {run}, {duration} on this computer."

    def _seconds_of(self, settings: Settings) -> float:
        """Estimate how long a run will take: at the pace of the last one if that was in the same world."""
        last = self._active
        if last and last.pace and _world_of(last.settings) == _world_of(settings):
            return last.pace * n_walks(settings)
        return estimate_seconds(settings)

    # ------------------------------------------------------------------------------------------------------ a run

    def _press(self, button: str) -> None:
        """Do what a button of the transport says, one press after the other."""
        with self._pressing:
            self._do(button)

    def _do(self, button: str) -> None:
        live = self._active if self._active and not self._active.is_over else None
        match button:
            case "start" | "step" if not live and self.settings:
                self._begin(self.settings, 1 if button == "step" else None)
            case "step" if live:
                live.go_on(1)
            case "go_on" if live:
                live.go_on()
            case "pause" if live:
                live.pause()
            case "stop" if live:
                live.stop()
            case _:
                pass

    def _begin(self, settings: Settings, generations: int | None) -> None:
        """Start a run of these settings, to its end or for so many generations."""
        try:
            live = self._live(settings)
        except ValueError as error:  # an operator of the user's own that does not do what its slot needs
            self.transport.words = str(error)
            return
        self._active, self._told[live] = live, (None, 0.0)
        name = f"run {len(self._told)}"
        self.runs.keep(Kept(name, settings, live), name)
        live.go_on(generations)

    def _live(self, settings: Settings) -> LiveRun:
        try:
            return LiveRun(settings, new_file(self._folder), self._executor, on_change=self._news)
        except (RunFileError, OSError) as error:
            live = LiveRun(settings, None, self._executor, on_change=self._news)
            self.runs.drawer.words = f"This run will not be kept. {error}"
            return live

    def _news(self, live: LiveRun) -> None:
        """Hear that a run has come farther: say so, and have drawn what shows it."""
        stage, now, (before, spoken) = (live.state, live.n_generations), time.monotonic(), self._told[live]
        if stage != before:
            self.runs.redraw()
            self._desk.order("population", self._show_population)
        elif now - spoken < OFTEN:
            return
        self._told[live] = stage, now
        if live is self._active:
            self._say(live)
        if live.state != State.running:
            self._desk.order("forecast", self._forecast)
            self._desk.hurry()

    def _say(self, live: LiveRun) -> None:
        """Say how far a run has come."""
        done, last, left = live.n_generations, live.settings.algorithm.generations - 1, live.seconds_left
        come = f"generation {done - 1} of 0 to {last}" if done else "the first robots had begun"
        match live.state:
            case State.running:
                words = (
                    "The first robots walk, and bodies are built …"
                    if left is None
                    else (f"Generation {done} of 0 to {last} walks: {describe_duration(left)} left.")
                )
            case State.failed:
                words = f"Failed after {come}. {in_full(live.error)}"
                self.runs.drawer.words = "\n".join(getattr(live.error, "__notes__", []))
            case State.finished:
                words = f"Finished: generations 0 to {last} in {live.seconds:.0f} s."
            case state:
                words = f"{state.capitalize()} after {come}, and {live.seconds:.0f} s."
        with self.transport.hold_sync():
            self.transport.state, self.transport.words = live.state, words
            self.transport.share = live.n_done / live.n_walks
        self.robot.editor.can_insert = not live.is_over and done > 0
        if live.note:
            self.runs.drawer.words = live.note

    # ------------------------------------------------------------------------------------------- what comes of it

    def _run_chosen(self) -> None:
        self.population.selected = -1
        self._desk.order("population", self._show_population)

    def _take_settings(self) -> None:
        """Move the form to the settings of the run that is chosen."""
        if run := self.run:
            self.settings = run.settings

    def _robot_chosen(self, _change: object) -> None:
        self._desk.order("robot", self._show_robot)

    def _show_population(self) -> None:
        """Show the last generation of the run that is chosen."""
        run = self.run
        self.population.show(run.records if run else join([]), run.settings if run else None)
        self._show_robot()

    def _show_robot(self) -> None:
        """Show the robot that is selected, or the champion so far."""
        if (run := self.run) and run.n_generations:
            self.robot.show(run, self.population.selected)

    def _insert(self, genome: Genome) -> str:
        """Put a genome into the next generation of the run that is going on; say what became of that."""
        if not self._active:
            return "No run is going on."
        try:
            number = self._active.insert(genome)
        except ValueError as error:
            return str(error)
        return f"It will be in generation {number}, in the place of a child: look for ✎."

    def _is_busy(self) -> bool:
        return self._active is not None and self._active.state == State.running

    def _tell_fault(self, error: Exception) -> None:
        self.runs.drawer.words = f"A picture could not be drawn. {in_full(error)}"


def in_full(error: BaseException | None) -> str:
    """Say what went wrong; of what is not in words for people, also what kind of error it is."""
    return str(error) if isinstance(error, Fault) else f"{type(error).__name__}: {error}"


def _world_of(settings: Settings) -> tuple[object, ...]:
    """Return all of settings that a walk depends on."""
    return settings.terrain, settings.robot, settings.simulation


def _room(name: str, *pieces: ipywidgets.Widget) -> ipywidgets.Box:
    """Put pieces below each other."""
    return ipywidgets.Box(pieces).add_class("wl-room").add_class(f"wl-{name}")
