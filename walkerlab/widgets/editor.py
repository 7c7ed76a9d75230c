"""A text editor for one genome, with a picture of its robot and messages on what is wrong."""

import threading
from collections.abc import Callable
from typing import Any

import traitlets

from walkerlab.genome.genome import Genome
from walkerlab.genome.text import GenomeError
from walkerlab.randomness import random_stream
from walkerlab.settings.settings import Settings
from walkerlab.text.templates import Markup, render
from walkerlab.view import sketch
from walkerlab.view.snapshots import svg_image_html
from walkerlab.widgets.component import Component, load_script, load_style
from walkerlab.widgets.repairs import describe_repairs, find_fault, format_genome

PICTURE_SIZE = (300, 190)  # pixels of the picture
MAX_NOTES = 5  # maximum number of changes to the genome that are listed

OnGenome = Callable[[Genome], object]


class Editor(Component):
    """A genome as editable text, and the robot that it describes.

    Attributes:
        text: Text in the editor.
        genome: Genome of the text, brought within the limits; None while the text is not a valid genome. Setting it
            changes the text.
        settings: Settings with the limits of the robot.
        fault: Why the text is not a valid genome; empty if it is.
        fault_range: Start and exclusive end of the wrong characters of the text; empty if they are unknown.
        notes: Sentences on the genes that were beyond the limits and the values that are used instead.
        picture: Picture of the robot, as SVG; while the text is not valid, the picture of the last valid genome.
        can_insert: Whether the genome can be inserted into a later generation.
        buttons: Names of the visible buttons: those with a callback.
    """

    title = "genome editor"
    _esm = load_script("editor")
    _css = load_style("editor")
    text = traitlets.Unicode("").tag(sync=True)
    genome: Any = traitlets.Instance(Genome, allow_none=True)
    settings: Any = traitlets.Instance(Settings)
    fault = traitlets.Unicode("").tag(sync=True)
    fault_range = traitlets.List(traitlets.Int()).tag(sync=True)
    notes = traitlets.List(traitlets.Unicode()).tag(sync=True)
    picture = traitlets.Unicode("").tag(sync=True)
    can_insert = traitlets.Bool(False).tag(sync=True)
    buttons = traitlets.List(traitlets.Unicode()).tag(sync=True)

    def __init__(self, genome: Genome | str | None = None, settings: Settings | None = None) -> None:
        """Create the editor.

        Args:
            genome: Initial genome, or a text, which may be invalid; a random genome if None.
            settings: Settings with the limits of the robot; the defaults if None.
        """
        super().__init__(settings=settings or Settings())
        self._lock = threading.RLock()
        self._callbacks: dict[str, list[OnGenome]] = {"walk": [], "insert": []}
        self.observe(self._parse, ["text", "settings"])
        self.observe(self._update_text, "genome")
        self.on_msg(self._handle_message)
        if genome is None:
            rng = random_stream(self.settings.algorithm.seed, "population", 0, 0)
            genome = Genome.random(self.settings.robot, rng=rng)
        self.text = genome if isinstance(genome, str) else format_genome(genome)

    def on_walk(self, callback: OnGenome) -> None:
        """Register a function that is called with the genome when its walk is to be played."""
        self._add_callback("walk", callback)

    def on_insert(self, callback: OnGenome) -> None:
        """Register a function that is called with the genome when it is to be inserted into the next generation."""
        self._add_callback("insert", callback)

    def snapshot(self) -> Markup:
        """Return the robot, its genome and the messages as static HTML."""
        notes = [self.fault] if self.fault else self.notes
        picture = svg_image_html(self.picture) if self.picture else ""
        return render("widgets/editor.html", picture=picture, text=self.text, notes=notes)

    def _add_callback(self, button: str, callback: OnGenome) -> None:
        self._callbacks[button].append(callback)
        self.buttons = [name for name, callbacks in self._callbacks.items() if callbacks]

    def _parse(self, _: object = None) -> None:
        """Update the genome and the picture from the text, or report why the text is not valid."""
        with self._lock, self.hold_sync():
            robot = self.settings.robot
            try:
                parsed = Genome.parse(self.text)
            except GenomeError as error:
                self.fault = str(error).partition("\n")[0]
                self.fault_range = find_fault(self.fault, self.text) or []
                self.genome = None
                self.notes = []
                return
            self.fault = ""
            self.fault_range = []
            self.notes = _shorten(describe_repairs(parsed, robot))
            self.genome = parsed.within(robot)
            self.picture = sketch.draw_robot(self.genome, robot, size=PICTURE_SIZE)

    def _update_text(self, change: Any) -> None:
        """Replace the text with the text of a genome that was set from outside."""
        with self._lock:
            if change.new is not None and change.new != _parse_within(self.text, self.settings):
                self.text = format_genome(change.new)

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        """Call the callbacks of the pressed button, if the text is a valid genome."""
        match message:
            case {"press": "walk" | "insert" as button} if self.genome is not None:
                for callback in self._callbacks[button]:
                    callback(self.genome)
            case _:
                pass


def _parse_within(text: str, settings: Settings) -> Genome | None:
    """Return the genome of a text, brought within the limits; None if the text is not valid."""
    try:
        return Genome.parse(text).within(settings.robot)
    except GenomeError:
        return None


def _shorten(notes: list[str]) -> list[str]:
    n_more = len(notes) - MAX_NOTES
    return notes if n_more <= 0 else [*notes[:MAX_NOTES], f"And {n_more} more."]
