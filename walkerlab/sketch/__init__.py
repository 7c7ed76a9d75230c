"""Drawings as SVG text: quick enough to follow a slider, and drawn on any thread; they need no GL and no matplotlib."""

from walkerlab.sketch.bodies import body as body
from walkerlab.sketch.worlds import world as world

__all__ = ["body", "world"]
