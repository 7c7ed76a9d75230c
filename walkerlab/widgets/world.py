"""The world as it will be: drawn anew at once when a setting changes, with a robot at its start."""

import threading
from typing import Any

import traitlets

from walkerlab.genome.genome import Genome
from walkerlab.randomness import stream
from walkerlab.settings.settings import Settings
from walkerlab.text.html import Html
from walkerlab.view import sketch
from walkerlab.view.snapshots import image
from walkerlab.widgets.component import Part, script, style


class World(Part):
    """A drawing of the ground, what lies on it, what pulls and pushes over it, and a robot to scale.

    Attributes:
        settings: of terrain and robot; while they are None, as a form says when they cannot be, the drawing stays.
        genome: whose robot stands at the start; one drawn by chance within the limits if None.
        number: which of those that chance could draw; they are the robots with which a run of these settings begins.
        picture: the drawing, as SVG.
        by_chance: whether its robot is one of chance, of which there are others.
    """

    title = "world"
    _esm = script("world")
    _css = style("world")
    settings: Any = traitlets.Instance(Settings, allow_none=True)
    genome: Any = traitlets.Instance(Genome, allow_none=True)
    number = traitlets.Int(0)
    picture = traitlets.Unicode("").tag(sync=True)
    by_chance = traitlets.Bool(True).tag(sync=True)

    def __init__(self, settings: Settings | None = None, genome: Genome | str | None = None) -> None:
        """Draw it.

        Args:
            settings: of terrain and robot; the defaults if None.
            genome: as the attribute; its text will do.
        """
        self._lock, self._drawn = threading.RLock(), None
        own = None if genome is None else Genome.of(genome)
        super().__init__(settings=settings or Settings(), genome=own)
        self.observe(self._redraw, ["settings", "genome", "number"])
        self.on_msg(self._hear)
        self._redraw()

    def draw(self, settings: Settings, genome: Genome | None = None) -> None:
        """Draw other settings and another robot in one go; from any thread."""
        with self._lock, self.hold_trait_notifications():
            self.settings, self.genome = settings, genome

    def snapshot(self) -> Html:
        """Write the drawing as static HTML."""
        return image(self.picture)

    def _redraw(self, _: object = None) -> None:
        with self._lock:
            wanted = (self.settings, self.genome, self.number)
            if self.settings and wanted != self._drawn:  # when two of them change in one go, this is called twice
                settings, genome, number = self._drawn = wanted
                self.by_chance = genome is None
                chance = stream(settings.algorithm.seed, "population", 0, number)
                self.picture = sketch.draw_world(settings, genome or Genome.random(settings.robot, rng=chance))

    def _hear(self, _widget: object, message: Any, _buffers: object) -> None:
        """Put another robot of chance there, if the browser asks for one."""
        if message == "another" and self.genome is None:
            with self._lock:
                self.number += 1
