"""An editor for one genome: sliders and text, a picture of its robot, messages, and the result of its walk."""

import math
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import traitlets

from walkerlab.genome.features import is_expressed
from walkerlab.genome.genome import Genome
from walkerlab.genome.repair_notes import describe_repairs
from walkerlab.genome.text import GenomeError
from walkerlab.settings.settings import Settings
from walkerlab.system.errors import WalkerlabError
from walkerlab.system.randomness import random_stream
from walkerlab.text.templates import Markup, render
from walkerlab.view import sketch
from walkerlab.view.snapshots import svg_image_html
from walkerlab.widgets.component import Component, load_script, load_style
from walkerlab.widgets.gene_controls import describe_genes
from walkerlab.widgets.outcomes import Outcome, compare_outcomes, simulate_outcome
from walkerlab.widgets.repairs import describe_fault, find_fault, format_genome, parse_within

PICTURE_SIZE = (296, 148)  # pixels of the picture
MAX_NOTES = 5  # maximum number of changes to the genome that are listed

NO_RUN = "No run is in progress. Start a run, or continue one, to insert this robot into its next generation."

OnGenome = Callable[[Genome], object]


class Editor(Component):
    """A genome as sliders and as editable text, which are synchronised, and the robot that it describes.

    Attributes:
        text: Text in the editor.
        genome: Genome of the text, brought within the limits; None while the text is not a valid genome. Setting it
            changes the text.
        settings: Settings with the limits of the robot.
        fault: Why the text is not a valid genome; empty if it is.
        fault_range: Start and exclusive end of the wrong characters of the text; empty if they are unknown.
        notes: Sentences about the genes that were beyond the limits and the values that are used instead.
        reasons: The sentence about each of these genes, keyed by the name of the gene.
        picture: Picture of the robot, as SVG; while the text is not valid, the picture of the last valid genome.
        genes: Description of each gene, as ``describe_genes`` returns it.
        values: Value of each gene in the text, even beyond the limits; the last valid values if the text is not valid.
        repaired: The same values within the limits, which are those of the robot.
        used: Whether each gene has an effect on the robot.
        original: Values of the genome before it was edited.
        result: Result of the last walk, as plain data for the browser: ``distance``, ``change``, ``before``,
            ``verdict``, ``counts``, ``is_better`` and ``others``, a list of additional lines; or ``fault``.
        can_insert: Whether the genome can be inserted into a later generation.
        can_continue: Whether a run can be continued with the genome in its next generation.
        replaced: Name of an edited robot that was replaced by another one and can be shown again; otherwise empty.
        report: Result of the last button that inserted the genome; empty before the first one and after a change.
        insert_hint: Why the genome cannot be inserted, and what to do.
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
    reasons = traitlets.Dict().tag(sync=True)
    picture = traitlets.Unicode("").tag(sync=True)
    genes = traitlets.List().tag(sync=True)
    values = traitlets.List(traitlets.Float()).tag(sync=True)
    repaired = traitlets.List(traitlets.Float()).tag(sync=True)
    used = traitlets.List(traitlets.Bool()).tag(sync=True)
    original = traitlets.List(traitlets.Float()).tag(sync=True)
    result = traitlets.Dict().tag(sync=True)
    can_insert = traitlets.Bool(False).tag(sync=True)
    can_continue = traitlets.Bool(False).tag(sync=True)
    replaced = traitlets.Unicode("").tag(sync=True)
    report = traitlets.Unicode("").tag(sync=True)
    insert_hint = traitlets.Unicode(NO_RUN).tag(sync=True)
    buttons = traitlets.List(traitlets.Unicode()).tag(sync=True)

    def __init__(self, genome: Genome | str | None = None, settings: Settings | None = None) -> None:
        """Create the editor.

        Args:
            genome: Initial genome, or its text, which may be invalid; a random genome if None.
            settings: Settings with the limits of the robot; the defaults if None.
        """
        super().__init__(settings=settings or Settings())
        self._lock = threading.RLock()
        self._callbacks: dict[str, list[OnGenome]] = {
            name: [] for name in ("try", "walk", "live", "insert", "continue")
        }
        self._on_restore: Callable[[], None] = lambda: None
        self._unrepaired: Genome | None = None
        self._unedited_text = ""
        self._original_outcome: Outcome | None = None
        self.observe(self._parse, ["text", "settings"])
        self.observe(self._update_text, "genome")
        self.observe(self._discard_result, "settings")
        self.on_msg(self._handle_message)
        if genome is None:
            rng = random_stream(self.settings.algorithm.seed, "population", 0, 0)
            genome = Genome.random(self.settings.robot, rng=rng)
        self.text = genome if isinstance(genome, str) else format_genome(genome)
        self.accept()

    @property
    def is_edited(self) -> bool:
        """Whether the text has been edited since the genome was set or accepted."""
        return self.text != self._unedited_text

    def accept(self, before: Outcome | None = None) -> None:
        """Use the current genome as the original, with which edits are compared and which *undo* restores.

        Args:
            before: Result of the walk of this genome; if None, the walk is simulated when needed.
        """
        with self._lock, self.hold_sync():
            self._unedited_text = self.text
            self.original = self.values
            self._original_outcome = before
            self.result = {}

    def on_try(self, callback: OnGenome) -> None:
        """Register a function that is called with an edited genome when the ``result`` of its walk is set."""
        self._add_callback("try", callback)

    def on_continue(self, callback: OnGenome) -> None:
        """Register a function that continues a run that has ended, with the genome in its next generation."""
        self._add_callback("continue", callback)

    def on_restore(self, callback: Callable[[], None]) -> None:
        """Set the function that shows the replaced robot again."""
        self._on_restore = callback

    def on_walk(self, callback: OnGenome) -> None:
        """Register a function that is called with the genome when its walk is to be played."""
        self._add_callback("walk", callback)

    def on_live(self, callback: OnGenome) -> None:
        """Register a function that is called with the genome to simulate its walk live in the browser."""
        self._add_callback("live", callback)

    def on_insert(self, callback: OnGenome) -> None:
        """Register a function that is called with the genome when it is to be inserted into the next generation."""
        self._add_callback("insert", callback)

    def snapshot(self) -> Markup:
        """Return the robot, its genome and the messages as static HTML."""
        notes = [self.fault] if self.fault else self.notes
        picture = svg_image_html(self.picture) if self.picture else ""
        result = [str(self.result[key]) for key in ("distance", "change", "before", "verdict") if self.result.get(key)]
        return render("widgets/editor.html", picture=picture, text=self.text, notes=notes, result=result)

    def _add_callback(self, button: str, callback: OnGenome) -> None:
        self._callbacks[button].append(callback)
        self.buttons = [name for name, callbacks in self._callbacks.items() if callbacks]

    def _parse(self, _: object = None) -> None:
        """Update the genome, the sliders and the picture from the text, or report why the text is not valid."""
        with self._lock, self.hold_sync():
            self.report = ""
            robot = self.settings.robot
            self.genes = describe_genes(robot)
            try:
                parsed = Genome.parse(self.text)
            except GenomeError as error:
                self.fault = describe_fault(str(error), self.text)
                self.fault_range = find_fault(str(error), self.text) or []
                self.genome = None
                self.notes = []
                self.reasons = {}
                return
            self.fault = ""
            self.fault_range = []
            repairs = describe_repairs(parsed, robot)
            self.notes = _shorten([str(repair) for repair in repairs])
            self.reasons = {repair.gene: str(repair) for repair in repairs if repair.gene}
            self.genome = repaired = parsed.within(robot)
            self._unrepaired = unrepaired = parsed if parsed.n_parts == repaired.n_parts else repaired
            self.values = unrepaired.values.tolist()
            self.repaired = repaired.values.tolist()
            self.used = is_expressed(repaired.values[np.newaxis])[0].tolist()
            self.picture = sketch.draw_robot(repaired, robot, size=PICTURE_SIZE)

    def _set_gene(self, index: int, value: float) -> None:
        """Change one gene of a valid genome; all other genes keep the values in the text, even beyond the limits."""
        with self._lock:
            if self._unrepaired is None or self.genome is None or not 0 <= index < self._unrepaired.values.size:
                return
            values = self._unrepaired.values.copy()
            values[index] = value
            self.text = format_genome(Genome(values))

    def _discard_result(self, _: object) -> None:
        """Discard the results of walks with the previous settings."""
        self._original_outcome = None
        self.result = {}

    def _walk(self, genome: Genome) -> None:
        """Simulate the walk of a genome, and set ``result`` to a comparison with the walk before the edit."""
        try:
            if self._original_outcome is None and self.original:
                self._original_outcome = simulate_outcome(Genome(np.array(self.original)), self.settings)
            after = simulate_outcome(genome, self.settings)
            self.result = compare_outcomes(after, self._original_outcome or after)
        except WalkerlabError as error:
            self.result = {"fault": str(error)}
        self.send({"walked": True})  # notifies the browser even if the result is unchanged

    def _undo(self) -> None:
        self.text = self._unedited_text
        self.result = {}

    def _update_text(self, change: Any) -> None:
        """Replace the text with the text of a genome that was set from outside."""
        with self._lock:
            if change.new is not None and change.new != parse_within(self.text, self.settings.robot):
                self.text = format_genome(change.new)
                self.accept()

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        """Change a gene, or call the callbacks of the pressed button if the text is a valid genome."""
        match message:
            case {"gene": int(index), "value": int() | float() as value} if math.isfinite(value):
                self._set_gene(index, float(value))
            case {"press": "undo"}:
                self._undo()
            case {"press": "restore"} if self.replaced:
                self._on_restore()
            case {"press": "try" | "walk" | "live" | "insert" | "continue" as button} if self.genome is not None:
                genome = self.genome
                if button == "try":
                    self._walk(genome)
                for callback in self._callbacks[button]:
                    callback(genome)
            case _:
                pass


def _shorten(notes: list[str]) -> list[str]:
    n_more = len(notes) - MAX_NOTES
    return notes if n_more <= 0 else [*notes[:MAX_NOTES], f"And {n_more} more."]
