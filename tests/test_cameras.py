"""Every camera keeps every walker in its picture, whatever they do."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from walkerlab.cameras import FIELD_OF_VIEW, MIN_SIZE, SMOOTHING_TIME, aim_camera
from walkerlab.choices import Camera

TIME = np.arange(401) * 0.02
ASPECT = 4 / 3  # of a picture that is narrow


RIGHT = {
    Camera.side: "forward", Camera.front: "left", Camera.top: "forward", Camera.chase: "right", Camera.orbit: "forward",
}  # fmt: skip
ABOVE = {
    Camera.side: "up", Camera.front: "up", Camera.top: "left", Camera.chase: "up", Camera.orbit: "up",
}  # fmt: skip
NEARER = {
    Camera.side: "right", Camera.front: "forward", Camera.top: "up", Camera.chase: "back", Camera.orbit: "right",
}  # fmt: skip
"""What lies to the right in each camera's picture at the start, what above, and what towards the viewer."""

WAYS = {
    "forward": (1, 0, 0), "back": (-1, 0, 0), "left": (0, 1, 0), "right": (0, -1, 0), "up": (0, 0, 1),
}  # fmt: skip


def wander(rng, n, speed):
    steps = rng.normal(size=(n, len(TIME), 3)).cumsum(axis=1) * 0.01
    return steps + speed * TIME[:, np.newaxis] * [1, 0, 0]


@pytest.mark.parametrize("camera", list(Camera))
@given(seed=st.integers(0, 999), n=st.integers(1, 5), speed=st.floats(-1, 2), size=st.floats(0.2, 8))
def test_all_walkers_are_within_the_picture_all_the_time(camera, seed, n, speed, size):
    paths = wander(np.random.default_rng(seed), n, speed * np.arange(1, n + 1)[:, np.newaxis, np.newaxis] / n)
    shot = aim_camera(camera, TIME, paths, size)
    ahead = shot.target - shot.eye
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    right = np.cross(ahead, shot.up)
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    up = np.cross(right, ahead)
    for path in paths:
        seen = path - shot.eye
        depth = (seen * ahead).sum(axis=1)
        reach = math.tan(math.radians(FIELD_OF_VIEW / 2)) * depth
        assert (depth > 0).all()
        assert (np.abs((seen * up).sum(axis=1)) < reach).all()
        assert (np.abs((seen * right).sum(axis=1)) < ASPECT * reach).all()


@pytest.mark.parametrize("camera", list(Camera))
def test_one_walker_fills_a_good_part_of_the_picture(camera):
    size = 1.6
    shot = aim_camera(camera, TIME, wander(np.random.default_rng(0), 1, 0.5), size)
    share = size / (2 * shot.distance * math.tan(math.radians(FIELD_OF_VIEW / 2)) * ASPECT)
    assert (share > 0.4).all()
    assert (share < 0.8).all()


@pytest.mark.parametrize("camera", list(Camera))
@pytest.mark.parametrize("incline", [-30, -12, 12, 30])
def test_no_camera_is_below_the_slope(camera, incline):
    slope = math.radians(incline)
    along = np.stack([TIME, 0 * TIME, TIME * math.tan(slope) + 0.25], axis=1)
    eye = aim_camera(camera, TIME, along[np.newaxis], 1.5, slope).eye
    assert (eye[:, 2] > eye[:, 0] * math.tan(slope)).all()


def test_each_looks_where_its_name_says():
    path = np.zeros((1, len(TIME), 3))
    eye = {camera: aim_camera(camera, TIME, path, MIN_SIZE).eye[0] for camera in Camera}
    assert eye[Camera.side][1] < -1  # from the right, so that forward is to the right
    assert abs(eye[Camera.side][0]) < 1e-9
    assert eye[Camera.front][0] > 1
    assert abs(eye[Camera.front][1]) < 1e-9
    assert eye[Camera.top][2] > 1
    assert np.abs(eye[Camera.top][:2]).max() < 1e-9
    assert eye[Camera.chase][0] < -1
    around = aim_camera(Camera.orbit, TIME, path, MIN_SIZE)
    assert np.ptp(around.azimuth) > 180


def by_up(shot):
    """Return the ways right, above and towards the viewer in a picture, as one who is told which way is up sees it."""
    ahead = (shot.target - shot.eye)[0] / shot.distance[0]
    right = np.cross(ahead, shot.up)
    right /= np.linalg.norm(right)
    return right, np.cross(right, ahead), -ahead


def by_azimuth(shot):
    """Return the same as MuJoCo sees it: its camera turns to the azimuth, and then looks up or down."""
    turn, tilt = math.radians(shot.azimuth[0]), math.radians(shot.elevation[0])
    right, level = np.array([math.sin(turn), -math.cos(turn), 0]), np.array([math.cos(turn), math.sin(turn), 0])
    ahead = math.cos(tilt) * level + math.sin(tilt) * np.array([0, 0, 1])
    return right, np.cross(right, ahead), -ahead


@pytest.mark.parametrize("seen", [by_up, by_azimuth])
@pytest.mark.parametrize("camera", list(Camera))
def test_forward_left_and_up_are_where_they_belong_in_the_picture(camera, seen):
    """In a replay as in a film; but for the tilt and the turn of some cameras, which are 20 degrees at most."""
    shown = seen(aim_camera(camera, TIME, np.zeros((1, len(TIME), 3)), MIN_SIZE))
    for way, name in zip(shown, (RIGHT[camera], ABOVE[camera], NEARER[camera]), strict=True):
        assert way @ WAYS[name] > math.cos(math.radians(30))
    if camera == Camera.top:
        np.testing.assert_allclose(shown, [WAYS["forward"], WAYS["left"], WAYS["up"]], atol=1e-9)


@pytest.mark.parametrize("camera", list(Camera))
@given(seed=st.integers(0, 999))
def test_it_does_not_matter_how_the_moments_are_spaced(camera, seed):
    rng = np.random.default_rng(seed)
    uneven = np.unique(np.concatenate([[0, 8], rng.uniform(0, 8, 900)]))

    def shot(time):
        forward = np.stack([0.4 * time, 0.2 * np.sin(2 * time), 0.3 + 0.02 * np.sin(9 * time)], axis=1)
        return aim_camera(camera, time, np.stack([forward, forward * [0.5, -1, 1]]), 1.0)

    even, other = shot(TIME), shot(uneven)
    for of, near in (("target", 5e-3), ("distance", 5e-3), ("azimuth", 0.05), ("elevation", 0.05)):  # m, degrees
        wanted, got = (getattr(one, of).reshape(len(time), -1) for one, time in ((even, TIME), (other, uneven)))
        for one, two in zip(wanted.T, got.T, strict=True):
            np.testing.assert_allclose(np.interp(TIME, uneven, two), one, atol=near)


def test_bobbing_is_evened_out_over_the_same_time_however_often_it_is_recorded():
    for step in (0.005, 0.02, 0.025):
        time = np.arange(round(8 / step) + 1) * step
        bobbing = np.stack([0 * time, 0 * time, 0.1 * np.sin(2 * time)], axis=1)
        height = aim_camera(Camera.side, time, bobbing[np.newaxis], MIN_SIZE).target[:, 2]
        middle = (time > 2) & (time < 6)
        assert height[middle].max() == pytest.approx(0.1 * math.exp(-((2 * SMOOTHING_TIME) ** 2) / 2), rel=0.02)
