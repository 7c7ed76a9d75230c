"""Oblique projection from metres to pixels: a side view in which distant points are shifted to the left."""

from dataclasses import dataclass

import numpy as np

from walkerlab.ga.genes import Floats

DEPTH_SHIFT = -0.24  # horizontal shift for each metre of depth; shows the far legs and the risers of stairs
SIDE_VIEW = np.array([(1.0, 0.0), (DEPTH_SHIFT, 0.0), (0.0, 1.0)])
"""View at ground level, shape (3, 2): images of the unit vectors along x, y and z. The ground is a line."""
RAISED_VIEW = np.array([(1.0, 0.0), (DEPTH_SHIFT, 0.21), (0.0, 1.0)])
"""View from slightly above the ground, (3, 2); distant points are also drawn higher."""

TO_SUN = np.array([0.36, -0.64, 0.68])  # direction to the sun, close to that of ``entities.scenery``
AMBIENT_LIGHT = 0.6  # brightness of a face parallel to the sunlight
BRIGHTNESS_RANGE = (0.45, 1.12)


@dataclass(frozen=True, eq=False)
class Projection:
    """Parallel projection of points in metres to pixels.

    Attributes:
        view: Images of the unit vectors along x, y and z, to the right and up, shape (3, 2).
        scale: Pixels per metre.
        origin: Image of the origin [pixels], shape (2,).
    """

    view: Floats
    scale: float
    origin: Floats

    def project(self, points: Floats) -> Floats:
        """Return the images (…, 2) [pixels] of points (…, 3) [m]."""
        return points @ self.view * (self.scale, -self.scale) + self.origin

    @property
    def to_viewer(self) -> Floats:
        """Direction towards the viewer, shape (3,); not of unit length."""
        return np.cross(self.view[:, 0], self.view[:, 1])


def face_brightness(normals: Floats) -> Floats:
    """Return the brightness of faces in sunlight, shape (n, 1); a level face has 1.

    Args:
        normals: Unit normals of the faces, shape (n, 3).
    """
    diffuse = (1 - AMBIENT_LIGHT) * (normals @ TO_SUN) / TO_SUN[2]
    return np.clip(AMBIENT_LIGHT + diffuse, *BRIGHTNESS_RANGE)[:, np.newaxis]
