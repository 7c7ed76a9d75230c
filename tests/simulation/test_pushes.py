"""Pushes are what gravity and wind do along the ground, and without them a walk shows whether a robot walks."""

import math

import pytest

import walkerlab as wl
from walkerlab.simulation.pushes import LEVEL_WALK_DURATION, is_pushed_forward, remove_pushes
from walkerlab.world.heights import slope

PUSHED = {
    "downhill": {"structure": "incline", "incline": -5},
    "tilted gravity": {"gravity": (1, 0, -9.81)},
    "gravity that is steeper than the ascent": {"structure": "incline", "incline": 5, "gravity": (2, 0, -9.81)},
    "tail wind": {"wind": (3, 1, 0)},
    "tail wind up the stairs": {"structure": "stairs", "wind": (3, 0, 0)},
    "downhill in a head wind": {"structure": "incline", "incline": -5, "wind": (-3, 0, 0)},
}
NOT_PUSHED = {
    "level ground": {},
    "uphill": {"structure": "incline", "incline": 5},
    "an incline that is not used": {"structure": "flat", "incline": -5},
    "head wind": {"wind": (-3, 2, 1)},
    "gravity backward": {"gravity": (-1, 2, -9)},
    "gravity that is less steep than the ascent": {"structure": "incline", "incline": 10, "gravity": (1, 0, -9.81)},
    "no gravity": {"gravity": (0, 0, 0)},
}
SEGMENT = "| seg length=0.3 mass=3 legs length=0.3 force=15 "
STEP = "| step hip amplitude=0.5 phase={} offset=0 knee amplitude=0.5 phase=4 offset=-0.3 stride=3.14 "
WALKER = f"wl1 segments=2 {2 * SEGMENT}| gait frequency=1.5 {STEP.format(0)}{STEP.format(3.14)}"


def settings_with(changes):
    return wl.Settings().with_(duration=1, **changes)


@pytest.mark.parametrize("world", PUSHED)
def test_without_its_pushes_no_world_pushes_forward(world):
    settings = settings_with(PUSHED[world])
    calm = remove_pushes(settings)
    assert is_pushed_forward(settings.terrain)
    assert not is_pushed_forward(calm.terrain)
    assert math.hypot(*calm.terrain.gravity) == pytest.approx(math.hypot(*settings.terrain.gravity))
    assert calm.terrain.wind[1:] == settings.terrain.wind[1:]
    assert slope(calm.terrain) >= 0


@pytest.mark.parametrize("world", NOT_PUSHED)
def test_a_world_that_does_not_push_keeps_its_terrain(world):
    settings = settings_with(NOT_PUSHED[world])
    assert not is_pushed_forward(settings.terrain)
    assert remove_pushes(settings).terrain == settings.terrain


def test_the_walk_without_push_is_short():
    long = wl.Settings().with_(duration=100, wind=(1, 0, 0))
    assert remove_pushes(long).simulation.duration == LEVEL_WALK_DURATION
    assert remove_pushes(long.with_(duration=2)).simulation.duration == 2


def test_the_speed_without_push_is_that_of_the_walk_in_the_calm_world():
    level_settings = wl.Settings().with_(duration=2, forgive=["fell", "overturned"])
    downhill = level_settings.with_(**PUSHED["downhill"])
    level = wl.simulate(WALKER, level_settings, poses=False)
    assert wl.simulate(WALKER, downhill, poses=False).level_speed == level.mean_speed
    assert math.isnan(level.level_speed)
    forgiving = downhill.with_(forgive=["fell", "overturned", "carried"])
    assert math.isnan(wl.simulate(WALKER, forgiving, poses=False).level_speed)
