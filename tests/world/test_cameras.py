"""Every camera keeps all walkers in the picture and looks in the direction that its name says."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from walkerlab.settings.choices import Camera
from walkerlab.world.cameras import FIELD_OF_VIEW, MIN_SIZE, SMOOTHING_TIME, aim_camera

TIME = np.arange(401) * 0.02
ASPECT = 4 / 3  # width over height of a narrow picture


RIGHT = {
    Camera.side: "forward", Camera.front: "left", Camera.top: "forward", Camera.chase: "right", Camera.orbit: "forward",
}  # fmt: skip
ABOVE = {
    Camera.side: "up", Camera.front: "up", Camera.top: "left", Camera.chase: "up", Camera.orbit: "up",
}  # fmt: skip
NEARER = {
    Camera.side: "right", Camera.front: "forward", Camera.top: "up", Camera.chase: "back", Camera.orbit: "right",
}  # fmt: skip
"""Directions that point to the right, up and towards the viewer in each camera's picture at the start."""

DIRECTIONS = {
    "forward": (1, 0, 0), "back": (-1, 0, 0), "left": (0, 1, 0), "right": (0, -1, 0), "up": (0, 0, 1),
}  # fmt: skip


def wander(rng, n, speed):
    steps = rng.normal(size=(n, len(TIME), 3)).cumsum(axis=1) * 0.01
    return steps + speed * TIME[:, np.newaxis] * [1, 0, 0]


@pytest.mark.parametrize("camera", list(Camera))
@given(seed=st.integers(0, 999), n=st.integers(1, 5), speed=st.floats(-1, 2), size=st.floats(0.2, 8))
def test_all_walkers_are_in_the_picture_all_the_time(camera, seed, n, speed, size):
    paths = wander(np.random.default_rng(seed), n, speed * np.arange(1, n + 1)[:, np.newaxis, np.newaxis] / n)
    track = aim_camera(camera, TIME, paths, size)
    ahead = track.target - track.eye
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    right = np.cross(ahead, track.up)
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    up = np.cross(right, ahead)
    for path in paths:
        offset = path - track.eye
        depth = (offset * ahead).sum(axis=1)
        reach = math.tan(math.radians(FIELD_OF_VIEW / 2)) * depth
        assert (depth > 0).all()
        assert (np.abs((offset * up).sum(axis=1)) < reach).all()
        assert (np.abs((offset * right).sum(axis=1)) < ASPECT * reach).all()


@pytest.mark.parametrize("camera", list(Camera))
def test_one_walker_fills_a_large_part_of_the_picture(camera):
    size = 1.6
    track = aim_camera(camera, TIME, wander(np.random.default_rng(0), 1, 0.5), size)
    share = size / (2 * track.distance * math.tan(math.radians(FIELD_OF_VIEW / 2)) * ASPECT)
    assert (share > 0.4).all()
    assert (share < 0.8).all()


@pytest.mark.parametrize("camera", list(Camera))
@pytest.mark.parametrize("incline", [-30, -12, 12, 30])
def test_no_camera_is_below_the_slope(camera, incline):
    slope = math.radians(incline)
    along = np.stack([TIME, 0 * TIME, TIME * math.tan(slope) + 0.25], axis=1)
    eye = aim_camera(camera, TIME, along[np.newaxis], 1.5, slope).eye
    assert (eye[:, 2] > eye[:, 0] * math.tan(slope)).all()


def test_each_camera_is_where_its_name_says():
    path = np.zeros((1, len(TIME), 3))
    eye = {camera: aim_camera(camera, TIME, path, MIN_SIZE).eye[0] for camera in Camera}
    assert eye[Camera.side][1] < -1  # on the right side of the robot, so that forward is to the right in the picture
    assert abs(eye[Camera.side][0]) < 1e-9
    assert eye[Camera.front][0] > 1
    assert abs(eye[Camera.front][1]) < 1e-9
    assert eye[Camera.top][2] > 1
    assert np.abs(eye[Camera.top][:2]).max() < 1e-9
    assert eye[Camera.chase][0] < -1
    around = aim_camera(Camera.orbit, TIME, path, MIN_SIZE)
    assert np.ptp(around.azimuth) > 180


def axes_from_up(track):
    """Return the directions right, up and towards the viewer in a picture, from eye, target and up as in a replay."""
    ahead = (track.target - track.eye)[0] / track.distance[0]
    right = np.cross(ahead, track.up)
    right /= np.linalg.norm(right)
    return right, np.cross(right, ahead), -ahead


def axes_from_angles(track):
    """Return the same directions from azimuth and elevation, as MuJoCo's camera in a film uses them."""
    turn, tilt = math.radians(track.azimuth[0]), math.radians(track.elevation[0])
    right, level = np.array([math.sin(turn), -math.cos(turn), 0]), np.array([math.cos(turn), math.sin(turn), 0])
    ahead = math.cos(tilt) * level + math.sin(tilt) * np.array([0, 0, 1])
    return right, np.cross(right, ahead), -ahead


@pytest.mark.parametrize("picture_axes", [axes_from_up, axes_from_angles])
@pytest.mark.parametrize("camera", list(Camera))
def test_forward_left_and_up_have_the_expected_direction_in_the_picture(camera, picture_axes):
    """Within 30 degrees, as some cameras are tilted or rotated by up to 20 degrees."""
    axes = picture_axes(aim_camera(camera, TIME, np.zeros((1, len(TIME), 3)), MIN_SIZE))
    for axis, name in zip(axes, (RIGHT[camera], ABOVE[camera], NEARER[camera]), strict=True):
        assert axis @ DIRECTIONS[name] > math.cos(math.radians(30))
    if camera == Camera.top:
        np.testing.assert_allclose(axes, [DIRECTIONS["forward"], DIRECTIONS["left"], DIRECTIONS["up"]], atol=1e-9)


@pytest.mark.parametrize("camera", list(Camera))
@given(seed=st.integers(0, 999))
def test_the_track_does_not_depend_on_the_spacing_of_the_moments(camera, seed):
    rng = np.random.default_rng(seed)
    uneven = np.unique(np.concatenate([[0, 8], rng.uniform(0, 8, 900)]))

    def track(time):
        forward = np.stack([0.4 * time, 0.2 * np.sin(2 * time), 0.3 + 0.02 * np.sin(9 * time)], axis=1)
        return aim_camera(camera, time, np.stack([forward, forward * [0.5, -1, 1]]), 1.0)

    even, other = track(TIME), track(uneven)
    tolerances = {"target": 5e-3, "distance": 5e-3, "azimuth": 0.05, "elevation": 0.05}  # m, degrees
    for field, tolerance in tolerances.items():
        expected = getattr(even, field).reshape(len(TIME), -1)
        actual = getattr(other, field).reshape(len(uneven), -1)
        for expected_column, actual_column in zip(expected.T, actual.T, strict=True):
            np.testing.assert_allclose(np.interp(TIME, uneven, actual_column), expected_column, atol=tolerance)


def test_smoothing_does_not_depend_on_the_time_step():
    for step in (0.005, 0.02, 0.025):
        time = np.arange(round(8 / step) + 1) * step
        bobbing = np.stack([0 * time, 0 * time, 0.1 * np.sin(2 * time)], axis=1)
        height = aim_camera(Camera.side, time, bobbing[np.newaxis], MIN_SIZE).target[:, 2]
        middle = (time > 2) & (time < 6)
        assert height[middle].max() == pytest.approx(0.1 * math.exp(-((2 * SMOOTHING_TIME) ** 2) / 2), rel=0.02)
