"""The robot area of a panel: the description of one robot, its genome in an editor, and the replay of its walk."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import ipywidgets

from walkerlab.evolution.run import Run
from walkerlab.genome.genome import Genome
from walkerlab.runfile.records import birth_rows
from walkerlab.settings.settings import Settings
from walkerlab.text.html import data_url
from walkerlab.text.templates import Markup, render
from walkerlab.view import sketch
from walkerlab.view.replay import Replay, replay
from walkerlab.view.replay.page import Frame
from walkerlab.view.snapshots import HasSnapshot
from walkerlab.widgets.component import answer_on_requested_thread
from walkerlab.widgets.editor import Editor
from walkerlab.widgets.outcomes import Outcome, recorded_outcome
from walkerlab.widgets.panel.card import Card, robot_card
from walkerlab.widgets.panel.live_robot import open_live_robot

POSTER_SIZE = (640, 360)  # pixels


@dataclass(frozen=True)
class ShownRobot:
    """The robot whose genome is edited.

    Attributes:
        name: Name in text for users, such as "robot 12".
        genome: Genome before it was edited.
        rivals: Genomes of the robots that are played beside the edited one (the unedited one, the champion), keyed by
            name.
        settings: Settings of its run; None before the first run.
        outcome: Result of its walk; None if it has not walked.
        number: Number of the robot; -1 if it is not of a run.
        describe: Function that describes the robot as HTML; its argument is whether the genome has been edited.
    """

    name: str
    genome: Genome
    rivals: dict[str, Genome]
    settings: Settings | None
    outcome: Outcome | None
    number: int
    describe: Callable[[bool], Markup]


class RobotArea(HasSnapshot, ipywidgets.Box):
    """A robot of a run: its description, its genome in an editor, and its replay.

    Attributes:
        card: Description of the robot.
        editor: Editor of its genome.
        frame: Replay of its walk; a picture until it is played.
        live: Playground of the robot in the editor; empty until the user opens it.
    """

    title = "robot"

    def __init__(
        self,
        settings: Settings,
        on_insert: Callable[[Genome], str],
        on_continue: Callable[[Genome], str] | None = None,
    ) -> None:
        """Create the area with a random robot.

        Args:
            settings: Settings of the world in which edited genomes are simulated before there is a run.
            on_insert: Function that inserts a genome into the next generation and returns a message about the result.
            on_continue: Function that continues a run that has ended, with the genome in its next generation, and
                returns a message about the result; if None, the button is hidden.
        """
        self.card = Card()
        self.frame = Frame()
        self.live = ipywidgets.Box()
        self.editor = Editor(settings=settings)
        self._lock = threading.RLock()  # robots are shown by the drawing thread, and buttons are pressed at any time
        self._settings = settings
        self._on_insert = on_insert
        self._shown: tuple[Settings | None, int] = None, -1  # settings and number of the robot; -1 for an edited genome
        name, genome = "the random robot", self.editor.genome
        message = render("widgets/panel/robot_message.html")
        self._original = ShownRobot(name, genome, {name: genome}, None, None, -1, lambda _: message)
        self._replaced: tuple[ShownRobot, str, Any] | None = None  # edited robot, its text, and the result of its walk
        self._selected = -1
        super().__init__([self.card, self.frame, self.live, self.editor])
        self.add_class("wl-robot")
        self.frame.add_class("wl-frame")
        self.live.add_class("wl-live")
        answer_on_requested_thread(self.frame)
        self._describe(message)
        self._offer_replay({"a random robot": self.editor.genome})
        self.editor.on_try(self._replace_replay)
        self.editor.on_walk(self._play)
        self.editor.on_live(self._walk_live)
        self.editor.on_insert(self._insert)
        self.editor.on_restore(self._restore)
        if on_continue:
            self.editor.on_continue(lambda genome: self._report(on_continue(genome)))

    def snapshot(self) -> Markup:
        """Return the description, the picture and the genome of the robot as static HTML."""
        return render(
            "widgets/panel/robot.html",
            description=self.card.snapshot(),
            frame=self.frame.snapshot(),
            editor=self.editor.snapshot(),
        )

    def set_settings(self, settings: Settings) -> None:
        """Change the world in which edited genomes are simulated, and the limits of the editor."""
        self._settings = settings
        self.editor.settings = settings

    def show(self, run: Run, number: int) -> None:
        """Show a robot of a run.

        A robot whose replay is open or whose genome is being edited stays until the user selects another robot or run,
        even if a better one is found. An edited robot that is replaced can be shown again. The replay stays open if the
        robot is already shown.

        Args:
            run: Run of the robot.
            number: Number of the selected robot; the champion is shown if the run has no robot with this number.
        """
        with self._lock:
            exists = number >= 0 and bool((run.records.individual == number).any())
            robot = number if exists else run.champion.individual
            is_new_selection = exists and number != self._selected
            self._selected = number
            is_edited = self.editor.is_edited
            is_playing = self.frame.is_watched or any(live.is_open for live in self.live.children)
            is_of_run = self._shown[0] is not None and _is_continuation(run.settings, self._shown[0])
            is_kept = (is_edited and not self._shown[0]) or (is_of_run and (is_edited or is_playing))
            wanted = (run.settings, robot)
            is_shown = wanted == self._shown and not (is_edited and is_new_selection)
            if is_shown or (is_kept and not is_new_selection):
                if is_of_run:
                    self._follow_champion(run)
                return
            if is_edited:
                self._replaced = self._original, str(self.editor.text), self.editor.result
                self.editor.replaced = self._original.name
            self._shown = wanted
            row: Any = birth_rows(run.records).loc[robot]
            genome = Genome.parse(row.genome)
            rivals = _choose_rivals(run, robot, genome)
            outcome = recorded_outcome(row, run.settings)
            describe = partial(_describe_robot, run, robot)
            original = ShownRobot(f"robot {robot}", genome, rivals, run.settings, outcome, robot, describe)
            fragile = " (fragile)" if row.verdict == "fragile" else ""  # the walk in its replay counts
            self._present(original, {f"robot {robot} of generation {row.born}{fragile}": genome})

    def _follow_champion(self, run: Run) -> None:
        """Update the rivals and the description of the robot that is shown, if its run has another champion."""
        number = self._original.number
        rivals = _choose_rivals(run, number, self._original.genome)
        if rivals.keys() != self._original.rivals.keys() and (run.records.individual == number).any():
            self._original = replace(self._original, rivals=rivals, describe=partial(_describe_robot, run, number))
            self._describe(self._original.describe(self.editor.is_edited))

    def _restore(self) -> None:
        """Show the edited robot that was replaced."""
        with self._lock:
            if not self._replaced:
                return
            (original, text, result), self._replaced = self._replaced, None
            self.editor.replaced = ""
            self._shown = original.settings, -1
            self._present(original, {})
            self.editor.text = text
            self.editor.result = result
            if genome := self.editor.genome:
                self._offer_race(genome)

    def _present(self, robot: ShownRobot, walkers: dict[str, Genome]) -> None:
        """Show a robot, its genome in the editor, and a picture of the replay of several walkers.

        The description is last, because the user may play the robot as soon as it is described, and another replay
        would cancel that.
        """
        self._close_live_robot()
        self._original = robot
        self.set_settings(robot.settings or self._settings)
        self.editor.genome = robot.genome
        self.editor.accept(robot.outcome)
        self._offer_replay(walkers or robot.rivals)
        self._describe(robot.describe(False))

    def _describe(self, description: Markup) -> None:
        self.card.value = description

    def _offer_replay(self, walkers: dict[str, Genome]) -> None:
        """Show a picture of the first robot; the walks of all robots are simulated when the user plays them."""
        name, genome = next(iter(walkers.items()))
        svg = sketch.draw_robot(genome, self._settings.robot, size=POSTER_SIZE, caption=name)
        picture = data_url("image/svg+xml", svg.encode())
        others = f", beside {' and '.join(list(walkers)[1:])}" if len(walkers) > 1 else ""

        def walk() -> Replay:  # reads the settings when the replay is played
            return replay(walkers, self._settings)

        self.frame.set_replay(walk, picture, f"Replay of {name}{others}. Press to play.")

    def _offer_race(self, genome: Genome) -> None:
        """Show a picture of the edited robot; its replay also shows the unedited robot and the champion."""
        self._shown = self._shown[0], -1
        is_edited = self.editor.is_edited
        edited = {f"edited {self._original.name}": genome} if is_edited else {}
        self._offer_replay(edited | self._original.rivals)
        self._describe(self._original.describe(is_edited))

    def _replace_replay(self, genome: Genome) -> None:
        """Prepare the replay of an edited robot; if a replay is open, play the new one instead."""
        with self._lock:
            is_watched = self.frame.is_watched
            self._offer_race(genome)
            if is_watched:
                self.frame.play()

    def _play(self, genome: Genome) -> None:
        """Play the walk of the genome in the editor."""
        with self._lock:
            self._offer_race(genome)
            self.frame.play(reveal=True)

    def _walk_live(self, genome: Genome) -> None:  # noqa: ARG002
        """Open a playground of the robot in the editor; the sliders of the editor change it while it walks."""
        with self._lock:
            self._close_live_robot()
            self.frame.stop()  # an edit would play an open replay again, which pauses the live robot
            live = open_live_robot(self.editor, self._original.name, self._settings)
            live.observe(self._live_robot_changed, "is_open")
            self.live.children = [live]

    def _live_robot_changed(self, change: Any) -> None:
        """Remove the playground when its page is closed."""
        with self._lock:
            if not change.new and change.owner in self.live.children:
                self._close_live_robot()

    def _close_live_robot(self) -> None:
        for playground in self.live.children:
            playground.close()
        self.live.children = []

    def _insert(self, genome: Genome) -> None:
        self._report(self._on_insert(genome))

    def _report(self, message: str) -> None:
        self.editor.report = message


def _describe_robot(run: Run, number: int, is_edited: bool) -> Markup:
    return robot_card(run.records, number, is_edited=is_edited)


def _is_continuation(settings: Settings, earlier: Settings) -> bool:
    """Return whether settings differ from earlier ones in the number of generations only, or not at all."""
    return settings == earlier.with_(generations=settings.algorithm.generations)


def _choose_rivals(run: Run, number: int, genome: Genome) -> dict[str, Genome]:
    """Return the genomes of a robot before it was edited and, if it is another one, of the champion, keyed by name."""
    champion = run.champion
    rivals = {f"robot {number}": genome}
    if champion.individual != number:
        rivals[f"robot {champion.individual}, the champion"] = champion.genome
    return rivals
