r"""The part of a world that is drawn: a strip of ground along the way, seen from beside it and a little above.

       far edge
+---------------------+        what is farther away is drawn higher, and to the left:
 \  o  robot    []     \       so the risers of stairs are seen
  +---------------------+
  |  the ground, cut    |
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from walkerlab.genes import Floats
from walkerlab.ground import height
from walkerlab.markup import Html
from walkerlab.settings import Terrain
from walkerlab.sketch.lens import LEAN, RAISED, Lens

Item = tuple[float, Html]
"""Something drawn, and how near it comes: its least y [m]. The far ones are drawn first."""


@dataclass(frozen=True)
class Stage:
    """The window through which a world is seen.

    Attributes:
        size: pixels, wide and high.
        start: what x is at its left edge, where y is 0 [m].
        width: how many m it is wide.
        bottom: what z is at its lower edge, where y is 0 [m].
        sides: what y is at the near and at the far edge of the ground [m].
    """

    size: tuple[float, float]
    start: float
    width: float
    bottom: float
    sides: tuple[float, float]

    @cached_property
    def lens(self) -> Lens:
        """How points are seen."""
        scale = self.size[0] / self.width
        return Lens(RAISED, scale, np.array([-self.start * scale, self.size[1] + self.bottom * scale]))

    @property
    def reach(self) -> tuple[float, float]:
        """From where to where along the way the ground is seen somewhere, in m."""
        near, far = (-LEAN * y for y in self.sides)
        return self.start + near, self.start + self.width + far


def surface(terrain: Terrain, x: Floats, y: Floats | float) -> Floats:
    """Return the (n, 3) points of the ground at places along and across the way."""
    return np.stack([x, np.broadcast_to(y, x.shape), height(terrain, x, y)], axis=1)


def in_order(items: Iterable[Item]) -> list[Html]:
    """Return what is drawn, the far first."""
    return [drawn for _, drawn in sorted(items, key=lambda item: -item[0])]
