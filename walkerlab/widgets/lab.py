"""The whole panel: buttons on top, settings on the left, what comes of them on the right, the robots below.

    form → world                                       what will be
    transport → LiveRun → curve, shelf, population     what comes of it
    population → robot                                 one of them: its card, its gene, its walk
    drawer                                             what goes out and what comes in

Every run goes on on a thread of its own, and tells that it has come farther; then what shows it is drawn, at one desk.
"""

import threading
import time
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import Any, cast

import ipywidgets

from walkerlab import outputs
from walkerlab.forecast import in_words, seconds_of
from walkerlab.genome import Genome
from walkerlab.live import LiveRun, State
from walkerlab.plots.style import RUNS
from walkerlab.report.code import as_python
from walkerlab.run import Run, load
from walkerlab.settings import Settings
from walkerlab.store import RunFileError
from walkerlab.widgets.controls import in_words as in_labels
from walkerlab.widgets.curve import Curve
from walkerlab.widgets.desk import Desk
from walkerlab.widgets.drawer import Drawer
from walkerlab.widgets.form import Form
from walkerlab.widgets.kept import Kept, best_of, new_file, run_files, told_apart
from walkerlab.widgets.population import Population
from walkerlab.widgets.robot import RobotRoom
from walkerlab.widgets.shelf import Shelf
from walkerlab.widgets.transport import Transport
from walkerlab.widgets.world import World

OFTEN = 0.2  # s between two words on how far a run has come


class Lab(ipywidgets.Box):
    """The panel, in a notebook.

        lab = wl.Lab()
        lab

    Attributes:
        run: the run that is chosen in the list, as far as it has come; None before there is one.
        settings: what the form says; None while that cannot be. Setting it moves the form.
    """

    def __init__(
        self, settings: Settings | None = None, folder: str | Path = "lab", executor: Executor | None = None
    ) -> None:
        """Set it up; nothing walks, and no file is made, before a button is pressed.

        Args:
            settings: with which the form begins; the defaults if None.
            folder: where every run is kept, in a folder of its own, made with the first run; if nothing can be written
                there, runs are in memory only.
            executor: any ``concurrent.futures.Executor``; loky on all cores if None.
        """
        settings = settings or Settings()
        self._folder, self._executor = Path(folder), executor
        self._kept, self._told = dict[str, Kept](), dict[str, tuple[object, float]]()
        self._active: LiveRun | None = None
        self._on_curve = list[tuple[str, str, bool]]()
        self._desk = Desk(self._is_busy, self._tell_fault)
        self.form, self.world = Form(settings), World(settings)
        self.transport, self.curve, self.shelf = Transport(self._press), Curve(), Shelf()
        self.population, self.robot = Population(), RobotRoom(settings, self._insert)
        self.drawer = Drawer(self._load, self._export)
        rooms = ipywidgets.Box(
            [
                _room("wide", self.transport),
                _room("left", self.form, self.world),
                _room("right", self.curve, self.shelf, self.drawer),
                _room("wide", self.population, self.robot),
            ]
        )
        rooms.add_class("wl-rooms")
        super().__init__([rooms])
        self.add_class("wl-lab")
        self.form.observe(self._form_changed, ["settings", "fault"])
        self.shelf.observe(self._run_chosen, "selected")
        self.shelf.observe(self._runs_changed, "runs")
        self.population.observe(self._robot_chosen, "selected")
        self.drawer.files = run_files(self._folder)
        self._form_changed()

    def __repr__(self) -> str:
        """Name it; its widgets are many."""
        return f"<Lab: a panel, to be seen in a notebook; it keeps {len(self._kept)} runs>"

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
        kept = self._kept.get(str(self.shelf.selected))
        return kept.run if kept else None

    def close(self) -> None:
        """Stop what runs, send the workers home, and take the panel off the page; the runs stay in their files."""
        self._desk.close()
        for kept in self._kept.values():
            if kept.live:
                kept.live.close()
        for piece in _within(self):
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

    def _forecast(self) -> None:
        """Say how long a run of what the form says would take; while one is going on, its walks are in the way."""
        if (settings := self.settings) and not self._is_busy():
            algorithm = settings.algorithm
            run = f"{algorithm.generations} generations of {algorithm.population_size} robots"
            self.transport.forecast = f"{run}: {in_words(seconds_of(settings))} on this computer."

    # ------------------------------------------------------------------------------------------------------ a run

    def _press(self, button: str) -> None:
        """Do what a button of the transport says."""
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
        key = f"run {len(self._told) + 1}"
        options: dict[str, Any] = {"executor": self._executor, "on_news": partial(self._news, key)}
        try:
            live = self._live(settings, options)
        except ValueError as error:  # an operator of the user's own that does not do what its slot needs
            self.transport.words = str(error)
            return
        self._active, self._told[key] = live, (None, 0.0)
        self._keep(Kept(key, settings, live))
        live.go_on(generations)

    def _live(self, settings: Settings, options: dict[str, Any]) -> LiveRun:
        try:
            return LiveRun(settings, new_file(self._folder), **options)
        except RunFileError as error:
            live = LiveRun(settings, **options)
            self.drawer.words = f"This run is in memory only. {error}"
            return live

    def _keep(self, kept: Kept) -> None:
        self._kept = {**self._kept, kept.key: kept}
        self.shelf.put(kept.key)
        self.shelf.selected = kept.key
        self._desk.order("shelf", self._tell_runs)

    def _news(self, key: str) -> None:
        """Hear that a run has come farther: say so, and have drawn what shows it."""
        live, now = self._kept[key].live, time.monotonic()
        if live is None:
            return
        stage, (before, spoken) = (live.state, live.n_generations), self._told[key]
        if stage != before:
            self._desk.order("curve", self._draw_curve)
            self._desk.order("shelf", self._tell_runs)
            self._desk.order("run", self._show_run)
        elif now - spoken < OFTEN:
            return
        self._told[key] = stage, now
        if live is self._active:
            self._say(live)
        if live.state != State.running:
            self._desk.order("forecast", self._forecast)
            self._desk.hurry()

    def _say(self, live: LiveRun) -> None:
        """Say how far a run has come."""
        done, left = live.n_generations, live.seconds_left
        far = f"{done} of {live.settings.algorithm.generations} generations"
        match live.state:
            case State.running:
                words = f"{far}, {in_words(left)} left" if left is not None else "The robots are getting ready …"
            case State.failed:
                words = f"Failed after {far}, which are kept. {in_full(live.error)}"
            case state:
                words = f"{state.capitalize()} after {far} and {live.seconds:.0f} s."
        with self.transport.hold_sync():
            self.transport.state, self.transport.words = live.state, words
            self.transport.share = live.n_done / live.n_walks
        self.robot.editor.can_insert = not live.is_over and done > 0

    # ------------------------------------------------------------------------------------------- what comes of it

    def _draw_curve(self) -> None:
        """Draw the curves of the runs that are to be shown, each in the look that the list gives it."""
        entries: list[dict[str, Any]] = self.shelf.runs
        shown = {entry["key"]: entry for entry in entries if entry["shown"] and entry["key"] in self._kept}
        kept = [self._kept[key] for key in shown]
        tables = {shown[one.key]["name"]: one.run.records for one in kept}
        going = [one.settings.algorithm.generations for one in kept if one.live and not one.live.is_over]
        self.curve.draw(tables, max(going, default=1), [RUNS.index(shown[one.key]["colour"]) for one in kept])

    def _tell_runs(self) -> None:
        """Say in the list what tells the runs apart, and what each has reached."""
        kept = list(self._kept.values())
        for one, differs in zip(kept, told_apart([one.settings for one in kept]), strict=True):
            self.shelf.tell(one.key, differs=differs, best=best_of(one.run), state=one.state)

    def _show_run(self) -> None:
        """Show the last generation of the run that is chosen, and the robot that is."""
        run = self.run
        self.drawer.can_export = bool(run and run.n_generations)
        if run and run.n_generations:
            self.drawer.code = as_python(run.settings, run.records)
            self.population.show(run)
            self._show_robot()

    def _show_robot(self) -> None:
        """Show the robot that is selected, or the champion so far."""
        if (run := self.run) and run.n_generations:
            self.robot.show(run, self.population.selected)

    def _run_chosen(self, _change: object) -> None:
        self.population.selected = -1
        self._desk.order("run", self._show_run)

    def _robot_chosen(self, _change: object) -> None:
        self._desk.order("robot", self._show_robot)

    def _runs_changed(self, _change: object) -> None:
        """Forget runs that were dropped from the list, and draw those that are to be shown."""
        on_curve = [(entry["key"], entry["name"], entry["shown"]) for entry in self.shelf.runs]
        if on_curve == self._on_curve:
            return
        self._on_curve, keys = on_curve, {entry["key"] for entry in self.shelf.runs}
        for key in self._kept.keys() - keys:
            if live := self._kept[key].live:
                live.stop()
        self._kept = {key: kept for key, kept in self._kept.items() if key in keys}
        self._desk.order("curve", self._draw_curve)

    def _insert(self, genome: Genome) -> str:
        """Put a genome into the next generation of the run that is going on; say what became of that."""
        if not self._active:
            return "No run is going on."
        try:
            self._active.insert(genome)
        except ValueError as error:
            return str(error)
        return f"It will be in generation {self._active.n_generations}, in the place of a child."

    # ---------------------------------------------------------------------------------------------- out and in

    def _load(self, path: str) -> None:
        try:
            run = load(path)
        except (RunFileError, OSError) as error:
            self.drawer.words = str(error)
            return
        self._keep(Kept(str(run.path), run.settings, run))
        self._desk.order("curve", self._draw_curve)
        self.drawer.words = f"Loaded {run.path}."

    def _export(self) -> None:
        """Write all that there is to see of the chosen run into its folder, on a thread, for it takes seconds."""
        if (run := self.run) and run.n_generations:
            folder = run.path.parent if run.path else new_file(self._folder).parent
            self.drawer.words = f"Writing into {folder} …"
            threading.Thread(target=self._write, args=(run, folder), name="walkerlab export", daemon=True).start()

    def _write(self, run: Run, folder: Path) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            outputs.write(run, folder)
        except OSError as error:
            self.drawer.words = f"Nothing can be written into {folder}: {error.strerror}."
        else:
            self.drawer.words = f"Exported into the folder {folder}: {', '.join(outputs.FILES)}."
            self.drawer.files = run_files(self._folder)

    def _is_busy(self) -> bool:
        return self._active is not None and self._active.state == State.running

    def _tell_fault(self, error: Exception) -> None:
        self.drawer.words = f"A picture could not be drawn. {in_full(error)}"


def in_full(error: Exception | None) -> str:
    """Say what went wrong, with what is known of where."""
    return "; ".join([f"{type(error).__name__}: {error}", *getattr(error, "__notes__", [])])


def _room(name: str, *pieces: ipywidgets.Widget) -> ipywidgets.Box:
    """Put pieces below each other."""
    box = ipywidgets.Box(pieces)
    box.add_class("wl-room")
    box.add_class(f"wl-{name}")
    return box


def _within(box: ipywidgets.Widget) -> list[ipywidgets.Widget]:
    """Return every widget in a box, in boxes in it and so on, the inner ones first."""
    children: tuple[ipywidgets.Widget, ...] = getattr(box, "children", ())
    return [one for child in children for one in (*_within(child), child)]
