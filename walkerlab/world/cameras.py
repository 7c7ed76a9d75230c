"""Camera position and direction over time, shared by replays and films."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from walkerlab.ga.genes import Floats
from walkerlab.settings.choices import Camera

FIELD_OF_VIEW = 45.0  # degrees, vertical
SMOOTHING_TIME = 0.4  # s, standard deviation of the filter that removes the bobbing of the walker
SMOOTHING_STEP = 0.02  # s, time step of that filter
MIN_SIZE = 1.2  # m; the camera is never closer than for a walker of this size
DISTANCE_PER_SPREAD = 1.3  # m of additional distance for each m between walkers
ELEVATION_PER_WIDTH = 14.0  # degrees by which level cameras look from higher up for each m between lanes
MAX_WIDTH = 1.5  # m between lanes beyond which level cameras do not rise further
STRAIGHT_DOWN = -90  # degrees of elevation
ORBIT_SPEED = 30.0  # degrees/s

CAMERA_VIEWS: dict[Camera, tuple[float, float, float]] = {
    Camera.side: (90, -10, 1.9),
    Camera.front: (180, -14, 1.9),
    Camera.top: (90, STRAIGHT_DOWN, 2.2),
    Camera.chase: (20, -20, 1.9),
    Camera.orbit: (90, -18, 2.0),
}
"""Azimuth [degrees, left of forward], elevation [degrees, upward] and distance [walker sizes] of each camera."""


@dataclass(frozen=True, eq=False)
class CameraTrack:
    """Camera position and direction at each of n moments.

    Attributes:
        target: Point at the centre of the picture [m], shape (n, 3).
        distance: Distance from the target [m], shape (n,).
        azimuth: Horizontal direction of view [degrees, left of forward], shape (n,).
        elevation: Vertical direction of view [degrees, upward], shape (n,).
    """

    target: Floats
    distance: Floats
    azimuth: Floats
    elevation: Floats

    @property
    def eye(self) -> Floats:
        """Position of the camera [m], shape (n, 3)."""
        azimuth, elevation = np.radians(self.azimuth), np.radians(self.elevation)
        horizontal = np.cos(elevation)
        direction = np.stack([horizontal * np.cos(azimuth), horizontal * np.sin(azimuth), np.sin(elevation)], axis=1)
        return self.target - self.distance[:, np.newaxis] * direction

    @property
    def up(self) -> tuple[float, float, float]:
        """Direction that is up in the picture: left (+y) for a camera that looks straight down, +z otherwise."""
        return (0.0, 1.0, 0.0) if self.elevation[0] <= STRAIGHT_DOWN else (0.0, 0.0, 1.0)


def aim_camera(camera: Camera, time: Floats, paths: Floats, size: float, slope: float = 0.0) -> CameraTrack:
    """Follow one walker or several so that all of them stay in the picture.

    Args:
        camera: Camera to compute.
        time: Moments [s], increasing but not necessarily evenly spaced, shape (n,).
        paths: Centres of mass of the walkers, and positions of their sledges [m], shape (k, n, 3).
        size: Length of the largest walker [m].
        slope: Pitch of the ground [rad], by which the camera is tilted to stay above it; positive is uphill.
    """
    azimuth, elevation, relative_distance = CAMERA_VIEWS[camera]
    low, high = paths.min(axis=0), paths.max(axis=0)
    target = _smooth_track(time, (low + high) / 2)
    spread = _smooth_track(time, (high - low).max(axis=1))
    distance = relative_distance * max(size, MIN_SIZE) + DISTANCE_PER_SPREAD * spread
    rotation = ORBIT_SPEED * (time - time[0]) if camera == Camera.orbit else np.zeros(len(time))
    azimuths = azimuth + rotation
    elevations = np.full(len(time), float(elevation))
    if elevation > STRAIGHT_DOWN:
        elevations += math.degrees(slope) * np.cos(np.radians(azimuths))
    if camera in (Camera.side, Camera.front):  # from where walkers in neighbouring lanes would hide each other
        width = np.minimum(_smooth_track(time, np.ptp(paths[:, :, 1], axis=0)), MAX_WIDTH)
        elevations -= ELEVATION_PER_WIDTH * width
    return CameraTrack(target, distance, azimuths, elevations)


def _smooth_track(time: Floats, track: Floats) -> Floats:
    """Apply a Gaussian filter of ``SMOOTHING_TIME`` to a track, (n,) or (n, k), at unevenly spaced times, (n,)."""
    columns = track.reshape(len(time), -1).T
    even = np.linspace(time[0], time[-1], max(2, round((time[-1] - time[0]) / SMOOTHING_STEP) + 1))
    width = SMOOTHING_TIME / SMOOTHING_STEP
    smooth = (gaussian_filter1d(np.interp(even, time, column), width, mode="nearest") for column in columns)
    return np.stack([np.interp(time, even, column) for column in smooth], axis=1).reshape(track.shape)
