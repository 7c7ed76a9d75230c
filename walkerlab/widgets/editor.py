"""A gene to be written by hand: its robot beside it as one types, and what is wrong with it."""

import threading
from collections.abc import Callable
from typing import Any

import traitlets

from walkerlab.genome.genome import Genome
from walkerlab.genome.text import GenomeError
from walkerlab.randomness import stream
from walkerlab.settings.settings import Settings
from walkerlab.text.html import Html, code, join, tag
from walkerlab.view import sketch
from walkerlab.view.snapshots import image
from walkerlab.widgets.component import Part, script, style
from walkerlab.widgets.repairs import laid_out, mended, place_of

SIZE = (300, 190)  # pixels of the drawing
SAID = 5  # genes at most, of which it is said that they were brought within the limits

OnGenome = Callable[[Genome], object]


class Editor(Part):
    """A gene as text, and the robot that grows from it.

    Attributes:
        text: what is written.
        genome: the genome that it is, within the limits; None while it is none. Setting it writes its text.
        settings: of which the limits hold.
        fault: why the text is no genome, or "".
        place: the first character of the text that is at fault, and the one after the last; empty if there is none.
        notes: which genes were beyond the limits, and what is used in their place: a sentence each.
        picture: the robot, as SVG; that of the last genome, while there is none.
        can_insert: whether there is a generation into which it can be put.
        heard: the buttons that somebody listens to; the others are not there.
    """

    title = "gene editor"
    _esm = script("editor")
    _css = style("editor")
    text = traitlets.Unicode("").tag(sync=True)
    genome: Any = traitlets.Instance(Genome, allow_none=True)
    settings: Any = traitlets.Instance(Settings)
    fault = traitlets.Unicode("").tag(sync=True)
    place = traitlets.List(traitlets.Int()).tag(sync=True)
    notes = traitlets.List(traitlets.Unicode()).tag(sync=True)
    picture = traitlets.Unicode("").tag(sync=True)
    can_insert = traitlets.Bool(False).tag(sync=True)
    heard = traitlets.List(traitlets.Unicode()).tag(sync=True)

    def __init__(self, genome: Genome | str | None = None, settings: Settings | None = None) -> None:
        """Open it.

        Args:
            genome: to begin with, or its text, which need not be one yet; one drawn by chance if None.
            settings: of which the limits hold; the defaults if None.
        """
        super().__init__(settings=settings or Settings())
        self._lock, self._listeners = threading.RLock(), dict[str, list[OnGenome]](walk=[], insert=[])
        self.observe(self._read, ["text", "settings"])
        self.observe(self._write, "genome")
        self.on_msg(self._hear)
        robot, seed = self.settings.robot, self.settings.algorithm.seed
        begin = Genome.random(robot, rng=stream(seed, "population", 0, 0)) if genome is None else genome
        self.text = begin if isinstance(begin, str) else laid_out(begin)

    def on_walk(self, callback: OnGenome) -> None:
        """Have something called with the genome, when its robot is to walk."""
        self._listen("walk", callback)

    def on_insert(self, callback: OnGenome) -> None:
        """Have something called with the genome, when it is to be put into the next generation."""
        self._listen("insert", callback)

    def snapshot(self) -> Html:
        """Write the robot, its gene and what is wrong with it as static HTML."""
        notes = [tag("p", note) for note in ([self.fault] if self.fault else self.notes)]
        return join(image(self.picture) if self.picture else "", code(self.text), *notes)

    def _listen(self, button: str, callback: OnGenome) -> None:
        self._listeners[button].append(callback)
        self.heard = [name for name, callbacks in self._listeners.items() if callbacks]

    def _read(self, _: object = None) -> None:
        """Make a genome of the text, or say why that cannot be."""
        with self._lock, self.hold_sync():
            robot = self.settings.robot
            try:
                read = Genome.parse(self.text)
            except GenomeError as error:
                self.fault = str(error).partition("\n")[0]
                self.place = place_of(self.fault, self.text) or []
                self.genome, self.notes = None, []
                return
            self.fault, self.place, self.notes = "", [], _brief(mended(read, robot))
            self.genome = read.within(robot)
            self.picture = sketch.draw_robot(self.genome, robot, size=SIZE)

    def _write(self, change: Any) -> None:
        """Write the text of a genome that was not read from it."""
        with self._lock:
            if change.new is not None and change.new != _within(self.text, self.settings):
                self.text = laid_out(change.new)

    def _hear(self, _widget: object, message: Any, _buffers: object) -> None:
        """Hand the genome on, when a button is pressed."""
        match message:
            case {"press": "walk" | "insert" as button} if self.genome is not None:
                for callback in self._listeners[button]:
                    callback(self.genome)
            case _:
                pass


def _within(text: str, settings: Settings) -> Genome | None:
    try:
        return Genome.parse(text).within(settings.robot)
    except GenomeError:
        return None


def _brief(notes: list[str]) -> list[str]:
    more = len(notes) - SAID
    return notes if more <= 0 else [*notes[:SAID], f"And {more} more."]
