r"""The visible part of a world: a strip of ground along the walking direction, seen from the side and slightly above.

       far edge
+---------------------+        distant points are drawn higher and further left,
 \  o  robot    []     \       which shows the risers of stairs
  +---------------------+
  |  section of ground  |
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from xml.etree.ElementTree import Element

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.settings.terrain import Terrain
from walkerlab.view.sketch.projection import DEPTH_SHIFT, RAISED_VIEW, Projection
from walkerlab.world.heights import ground_height

DrawnItem = tuple[float, Element]
"""Smallest y [m] of something drawn, and its SVG element; distant items are drawn first."""


@dataclass(frozen=True)
class Window:
    """The section of a world that a drawing shows.

    Attributes:
        size: Width and height [pixels].
        left: x at the left edge of the drawing, for y = 0 [m].
        width_m: Width [m].
        bottom: z at the lower edge of the drawing, for y = 0 [m].
        y_range: y at the near and at the far edge of the ground [m].
    """

    size: tuple[float, float]
    left: float
    width_m: float
    bottom: float
    y_range: tuple[float, float]

    @cached_property
    def projection(self) -> Projection:
        """Projection from metres to pixels."""
        scale = self.size[0] / self.width_m
        return Projection(RAISED_VIEW, scale, np.array([-self.left * scale, self.size[1] + self.bottom * scale]))

    @property
    def x_range(self) -> tuple[float, float]:
        """Smallest and largest x [m] of the ground that is visible at any depth."""
        near, far = (-DEPTH_SHIFT * y for y in self.y_range)
        return self.left + near, self.left + self.width_m + far


def ground_points(terrain: Terrain, x: Floats, y: Floats | float) -> Floats:
    """Return the points of the ground at x, shape (n,), and y [m]; shape (n, 3)."""
    return np.stack([x, np.broadcast_to(y, x.shape), ground_height(terrain, x, y)], axis=1)


def back_to_front(items: Iterable[DrawnItem]) -> list[Element]:
    """Return the SVG elements in drawing order, the most distant first."""
    return [drawn for _, drawn in sorted(items, key=lambda item: -item[0])]
