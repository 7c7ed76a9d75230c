"""From metres to pixels: a view from the side in which what is farther away is drawn aside, and maybe higher."""

from dataclasses import dataclass

import numpy as np

from walkerlab.genes import Floats

LEAN = -0.24  # by which what is farther away is drawn farther left, so that far legs and the risers of stairs are seen
LEVEL = np.array([(1.0, 0.0), (LEAN, 0.0), (0.0, 1.0)])
"""Level with the ground, which is a line: what x, y and z are to the right and up."""
RAISED = np.array([(1.0, 0.0), (LEAN, 0.21), (0.0, 1.0)])
"""A little above it."""

SUN = np.array([0.36, -0.64, 0.68])  # where it stands, about as in ``entities.scenery``
GRAZED = 0.6  # of its colour, that is seen of what the sun only grazes


@dataclass(frozen=True, eq=False)
class Lens:
    """How points are seen.

    Attributes:
        view: (3, 2) what x, y and z are to the right and up.
        scale: pixels for each m.
        place: (2,) pixels, where the origin is.
    """

    view: Floats
    scale: float
    place: Floats

    def at(self, points: Floats) -> Floats:
        """Return where (…, 3) points [m] are seen, (…, 2) pixels."""
        return points @ self.view * (self.scale, -self.scale) + self.place

    @property
    def eye(self) -> Floats:
        """(3,) which way it is to who looks."""
        return np.cross(self.view[:, 0], self.view[:, 1])


def lit(normals: Floats) -> Floats:
    """Return how much of its colour is seen of what faces (n, 3) ways: (n, 1), 1 where it lies level."""
    return np.clip(GRAZED + (1 - GRAZED) * (normals @ SUN) / SUN[2], 0.45, 1.12)[:, np.newaxis]
