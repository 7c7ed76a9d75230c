"""Every camera keeps every walker in its picture, whatever they do."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from walkerlab.cameras import FIELD_OF_VIEW, NEAREST, aim
from walkerlab.choices import Camera

TIME = np.arange(401) * 0.02
ASPECT = 4 / 3  # of a picture that is narrow


def wander(rng, n, speed):
    steps = rng.normal(size=(n, len(TIME), 3)).cumsum(axis=1) * 0.01
    return steps + speed * TIME[:, np.newaxis] * [1, 0, 0]


@pytest.mark.parametrize("camera", list(Camera))
@given(seed=st.integers(0, 999), n=st.integers(1, 5), speed=st.floats(-1, 2), size=st.floats(0.2, 8))
def test_all_walkers_are_within_the_picture_all_the_time(camera, seed, n, speed, size):
    paths = wander(np.random.default_rng(seed), n, speed * np.arange(1, n + 1)[:, np.newaxis, np.newaxis] / n)
    shot = aim(camera, TIME, paths, size)
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
    shot = aim(camera, TIME, wander(np.random.default_rng(0), 1, 0.5), size)
    share = size / (2 * shot.distance * math.tan(math.radians(FIELD_OF_VIEW / 2)) * ASPECT)
    assert (share > 0.4).all()
    assert (share < 0.8).all()


@pytest.mark.parametrize("camera", list(Camera))
@pytest.mark.parametrize("incline", [-30, -12, 12, 30])
def test_no_camera_is_below_the_slope(camera, incline):
    slope = math.radians(incline)
    along = np.stack([TIME, 0 * TIME, TIME * math.tan(slope) + 0.25], axis=1)
    eye = aim(camera, TIME, along[np.newaxis], 1.5, slope).eye
    assert (eye[:, 2] > eye[:, 0] * math.tan(slope)).all()


def test_each_looks_where_its_name_says():
    path = np.zeros((1, len(TIME), 3))
    eye = {camera: aim(camera, TIME, path, NEAREST).eye[0] for camera in Camera}
    assert eye[Camera.side][1] < -1  # from the right, so that forward is to the right
    assert abs(eye[Camera.side][0]) < 1e-9
    assert eye[Camera.front][0] > 1
    assert abs(eye[Camera.front][1]) < 1e-9
    assert eye[Camera.top][2] > 1
    assert np.abs(eye[Camera.top][:2]).max() < 1e-9
    assert eye[Camera.chase][0] < -1
    around = aim(Camera.orbit, TIME, path, NEAREST)
    assert np.ptp(around.azimuth) > 180
