"""A drawing of the world that settings describe, updated when a setting changes."""

import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import traitlets

from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.system.randomness import random_stream
from walkerlab.text.templates import Markup
from walkerlab.view import sketch
from walkerlab.view.snapshots import svg_image_html
from walkerlab.widgets.component import Component, load_script, load_style

LEGEND = "the world, with a random robot"
FALLEN_LEGEND = f"{LEGEND}, which falls over before its walk begins"
PICTURE_SIZE = (720, 240)  # pixels


class World(Component):
    """A drawing of the ground, the obstacles, gravity and wind, and a robot to scale.

    Attributes:
        settings: Settings of terrain and robot; while they are None, for example because a form has an invalid value,
            the drawing does not change.
        genome: Genome of the robot at the start; None for a random one within the limits.
        number: Index of the random robot; index i gives robot i of generation 0 in a run with these settings.
        picture: Drawing, as SVG.
        is_outdated: Whether another drawing was requested and is not finished.
        legend: Text below the drawing of a random robot, which may have fallen over at the start.
        by_chance: Whether the robot is random, so that another one can be drawn.
    """

    title = "world"
    _esm = load_script("world")
    _css = load_style("world")
    settings: Any = traitlets.Instance(Settings, allow_none=True)
    genome: Any = traitlets.Instance(Genome, allow_none=True)
    number = traitlets.Int(0)
    picture = traitlets.Unicode("").tag(sync=True)
    is_outdated = traitlets.Bool(False).tag(sync=True)
    legend = traitlets.Unicode("").tag(sync=True)
    by_chance = traitlets.Bool(True).tag(sync=True)

    def __init__(self, settings: Settings | None = None, genome: Genome | str | None = None) -> None:
        """Create the drawing.

        Args:
            settings: Settings of terrain and robot; the defaults if None.
            genome: Genome of the robot, or its text; a random one if None.
        """
        self._lock = threading.RLock()
        self._drawn: tuple[Settings, Genome | None, int] | None = None
        given = None if genome is None else Genome.of(genome)
        super().__init__(settings=settings or Settings(), genome=given)
        self.observe(self._redraw, ["settings", "genome", "number"])
        self.on_msg(self._handle_message)
        self._redraw()

    def prepare(self, settings: Settings) -> Callable[[], None]:
        """Mark the drawing as outdated and return a function that draws it.

        Args:
            settings: Settings of terrain and robot.
        """
        self.is_outdated = True
        return partial(self.draw, settings)

    def draw(self, settings: Settings, genome: Genome | None = None) -> None:
        """Change settings and robot together and draw once; can be called from any thread.

        Args:
            settings: Settings of terrain and robot.
            genome: Genome of the robot; a random one if None.
        """
        try:
            with self._lock, self.hold_trait_notifications():
                self.settings = settings
                self.genome = genome
        finally:
            self.is_outdated = False

    def snapshot(self) -> Markup:
        """Return the drawing as static HTML."""
        return svg_image_html(self.picture)

    def _redraw(self, _: object = None) -> None:
        with self._lock:
            wanted = (self.settings, self.genome, self.number)
            if self.settings and wanted != self._drawn:  # called once for each trait that changes
                settings, genome, number = self._drawn = wanted
                self.by_chance = genome is None
                rng = random_stream(settings.algorithm.seed, "population", 0, number)
                robot = genome or Genome.random(settings.robot, rng=rng)
                self.picture = sketch.draw_world(settings, robot, size=PICTURE_SIZE)
                lies = sketch.lies_at_start(robot.within(settings.robot), settings)
                self.legend = FALLEN_LEGEND if lies else LEGEND

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        """Show the next random robot if the browser requests it."""
        if message == "another" and self.genome is None:
            with self._lock:
                self.number += 1
