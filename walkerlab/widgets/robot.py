"""One robot: who it is, its gene to be edited, and its walk to be watched."""

import base64
from collections.abc import Callable
from typing import Any

import ipywidgets

from walkerlab.evolution.run import Run
from walkerlab.genome.genome import Genome
from walkerlab.runfile.records import births
from walkerlab.settings.settings import Settings
from walkerlab.text.html import Html, details, join, shown, tag
from walkerlab.view import sketch
from walkerlab.view.replay import Replay, replay
from walkerlab.view.replay.page import Frame
from walkerlab.view.snapshots import HasSnapshot
from walkerlab.widgets.card import card
from walkerlab.widgets.component import answer_at_once
from walkerlab.widgets.editor import Editor

POSTER = (640, 360)  # pixels
FIRST = "No robot has walked yet. This one is drawn by chance: play its walk, or edit its gene."


class RobotRoom(HasSnapshot, ipywidgets.Box):
    """A robot of a run: its card, its gene in an editor, and its replay.

    Attributes:
        editor: of its gene.
        frame: its replay, a picture until it is played.
    """

    title = "robot"

    def __init__(self, settings: Settings, on_insert: Callable[[Genome], str]) -> None:
        """Make it, with nobody in it.

        Args:
            settings: of the world in which an edited gene walks before there is a run.
            on_insert: puts a genome into the next generation, and says what became of that.
        """
        self.card, self.frame = ipywidgets.HTML(), Frame()
        self.editor = Editor(settings=settings)
        self._settings, self._on_insert = settings, on_insert
        self._shown: tuple[Settings | None, int] = None, -1
        self._text, self._picked = self.editor.text, -1
        super().__init__([self.card, self.frame, self.editor])
        self.add_class("wl-robot")
        self.frame.add_class("wl-frame")
        answer_at_once(self.frame)
        self.card.value = shown(tag("p", FIRST))
        self._offer(self.editor.genome, "a robot drawn by chance")
        self.editor.on_walk(self._walk)
        self.editor.on_insert(self._insert)

    def snapshot(self) -> Html:
        """Write the card, the picture and the gene of the robot as static HTML."""
        return join(Html(self.card.value), self.frame.snapshot(), details("Its gene", self.editor.snapshot()))

    def use(self, settings: Settings) -> None:
        """Let edited genes walk in another world."""
        self._settings = self.editor.settings = settings

    def show(self, run: Run, number: int) -> None:
        """Show a robot of a run, or its champion if there is none of the number.

        A robot that is being watched, or whose gene is being edited, stays until somebody picks another: whatever
        better ones come.
        """
        known = number >= 0 and bool((run.records.individual == number).any())
        robot = number if known else run.champion.individual
        is_picked = known and number != self._picked
        is_edited = self.editor.text != self._text
        is_watched = bool(self.frame.is_open) and run.settings == self._shown[0]
        wanted, self._picked = (run.settings, robot), number
        if not is_picked and (wanted == self._shown or is_edited or is_watched):
            return
        self._shown = wanted
        row: Any = births(run.records).loc[robot]
        genome = Genome.parse(row.genome)
        self.card.value = card(run.records, robot)
        self.use(run.settings)
        self.editor.genome = genome
        self._text = self.editor.text
        self._offer(genome, f"robot {robot} of generation {row.born}")

    def _offer(self, genome: Genome, name: str) -> None:
        """Offer its walk: a picture now, the walk when somebody wants to see it."""
        svg = sketch.draw_robot(genome, self._settings.robot, size=POSTER)
        picture = f"data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}"

        def walk() -> Replay:  # in the world that is set when it is played
            return replay({name: genome}, self._settings)

        self.frame.offer(walk, picture, f"Replay of {name}. Press to play.")

    def _walk(self, genome: Genome) -> None:
        self._shown = self._shown[0], -1  # the card is of somebody else
        self.card.value = shown(tag("p", tag("strong", "The gene in the editor"), ", as it walks in this world."))
        self._offer(genome, "the gene in the editor")
        self.frame.play()

    def _insert(self, genome: Genome) -> None:
        self.editor.notes = [self._on_insert(genome)]
