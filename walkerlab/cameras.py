"""Where the camera stands, moment by moment: the same in a replay and in a film."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from walkerlab.choices import Camera
from walkerlab.genes import Floats

FIELD_OF_VIEW = 45.0  # degrees from the lower to the upper edge of the picture
CALM = 0.4  # s over which a camera evens out the bobbing of what it follows
STEP = 0.02  # s between the moments from which that is reckoned
NEAREST = 1.2  # m, as if what it looks at were at least as large
MARGIN = 1.3  # m farther away for each m between those in the picture
RISE = 14.0  # degrees by which level cameras look from higher up for each m between lanes, which would hide each other
DOWN = -90  # degrees, at which a camera looks straight down
TURN = 30.0  # degrees a second, at which an orbit goes round

VIEWS: dict[Camera, tuple[float, float, float]] = {
    Camera.side: (90, -10, 1.9),
    Camera.front: (180, -14, 1.9),
    Camera.top: (90, DOWN, 2.2),
    Camera.chase: (20, -20, 1.9),
    Camera.orbit: (90, -18, 2.0),
}
"""Which way each looks: degrees to the left of forward, degrees upward; and from how far, in sizes of what it sees."""


@dataclass(frozen=True, eq=False)
class Shot:
    """What a camera does during a walk, at each of n moments.

    Attributes:
        target: (n, 3) what it looks at [m].
        distance: (n,) from how far [m].
        azimuth: (n,) which way it looks: degrees to the left of forward.
        elevation: (n,) how far upward it looks, degrees.
    """

    target: Floats
    distance: Floats
    azimuth: Floats
    elevation: Floats

    @property
    def eye(self) -> Floats:
        """(n, 3) where it stands [m]."""
        azimuth, elevation = np.radians(self.azimuth), np.radians(self.elevation)
        flat = np.cos(elevation)
        way = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=1)
        return self.target - self.distance[:, np.newaxis] * way

    @property
    def up(self) -> tuple[float, float, float]:
        """Which way is up in the picture: to the left of the way, if it looks straight down."""
        return (0.0, 1.0, 0.0) if self.elevation[0] <= DOWN else (0.0, 0.0, 1.0)


def aim(camera: Camera, time: Floats, paths: Floats, size: float, slope: float = 0.0) -> Shot:
    """Follow one walker or several, so that all are in the picture at any moment.

    Args:
        camera: which view.
        time: (n,) s, in order; the steps may differ.
        paths: (k, n, 3) the centre of mass of each walker, and where loads are that it drags [m].
        size: of the largest of them [m].
        slope: pitch of the ground [rad], so as not to look from below it; positive is uphill.
    """
    azimuth, elevation, far = VIEWS[camera]
    low, high = paths.min(axis=0), paths.max(axis=0)
    target = _calmed(time, (low + high) / 2)
    spread = _calmed(time, (high - low).max(axis=1))
    around = TURN * (time - time[0]) * (camera == Camera.orbit)
    looks = azimuth + around
    lanes = np.minimum(_calmed(time, np.ptp(paths[:, :, 1], axis=0)), 1.5)
    above = RISE * lanes * (camera in (Camera.side, Camera.front))
    tilt = math.degrees(slope) * np.cos(np.radians(looks)) * (elevation > DOWN)
    return Shot(target, far * max(size, NEAREST) + MARGIN * spread, looks, elevation + tilt - above)


def _calmed(time: Floats, track: Floats) -> Floats:
    """Even out a track, (n,) or (n, k), over ``CALM`` seconds, however its moments, (n,), are spaced."""
    columns = track.reshape(len(time), -1).T
    even = np.linspace(time[0], time[-1], max(2, round((time[-1] - time[0]) / STEP) + 1))
    calm = (gaussian_filter1d(np.interp(even, time, column), CALM / STEP, mode="nearest") for column in columns)
    return np.stack([np.interp(time, even, column) for column in calm], axis=1).reshape(track.shape)
