"""The animated drawing of a walk shows the recorded poses, in every world, and repeats without a script."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.simulation.rollout import simulate_walk
from walkerlab.view.sketch.walks import FRAMES_PER_SECOND, draw_walk
from walkerlab.world.geometry import surface_points
from walkerlab.world.limbs import limb_tracks

SVG = "{http://www.w3.org/2000/svg}"
WORLDS = [
    {},
    {"structure": "stairs", "carry_weight": 1, "drag_weight": 2},
    {"structure": "rough", "gravity": "mars", "obstacle": "rock"},
    {"structure": "gaps", "texture_density": 0.1},
]


@pytest.fixture(scope="module", params=WORLDS, ids=str)
def walk(request):
    settings = wl.Settings().with_(duration=2, **request.param)
    scene = wl.compile_scene(wl.Genome.random(settings.robot, rng=np.random.default_rng(2)), settings)
    return scene, simulate_walk(scene)


def test_a_limb_is_a_rod_around_its_axis(walk):
    scene, rollout = walk
    limbs = limb_tracks(scene, rollout.poses[:1])
    parts = surface_points(scene, rollout.poses[0])
    assert len(limbs) == len(parts)
    for limb, (points, colour) in zip(limbs, parts, strict=True):
        assert (limb.colour == colour).all()
        if limb.has_round_ends and len(points) > 2:
            start, end = limb.ends[0]
            share = np.clip((points - start) @ (end - start) / ((end - start) @ (end - start)), 0, 1)
            distances = np.linalg.norm(points - (start + share[:, np.newaxis] * (end - start)), axis=1)
            np.testing.assert_allclose(distances, limb.radius, atol=1e-6)


def test_the_drawing_moves_through_the_whole_walk(walk):
    scene, rollout = walk
    drawing = ElementTree.fromstring(draw_walk(scene, rollout))
    animations = [*drawing.iter(f"{SVG}animate"), *drawing.iter(f"{SVG}animateTransform")]
    limbs = limb_tracks(scene, rollout.poses[:1])
    assert len(animations) == len(limbs) + 1  # and the world behind them
    for animation in animations:
        n_frames = animation.get("values").count(";") + 1
        assert n_frames == pytest.approx(FRAMES_PER_SECOND * rollout.time[-1], rel=0.1)
        assert float(animation.get("dur").removesuffix("s")) == pytest.approx(rollout.time[-1])
        assert animation.get("repeatCount") == "indefinite"
    assert not list(drawing.iter(f"{SVG}script"))


def test_the_robot_stays_in_the_picture(walk):
    scene, rollout = walk
    drawing = ElementTree.fromstring(draw_walk(scene, rollout, size=(640, 288)))
    [world] = list(drawing.iter(f"{SVG}animateTransform"))
    camera = np.array([value.split() for value in world.get("values").split(";")], dtype=float)[:, 0]
    for animation in drawing.iter(f"{SVG}animate"):
        x = np.array([re.findall(r"[-\d]+", value)[0] for value in animation.get("values").split(";")], dtype=float)
        if not scene.rope_length:
            assert ((x / 10 + camera > 0) & (x / 10 + camera < 640)).all()


def test_a_still_drawing_has_no_animation_and_the_same_description(walk):
    moving, still = (draw_walk(*walk, moves=moves) for moves in (True, False))
    assert "<animate" not in still
    labels = [re.search('aria-label="([^"]*)"', drawing)[1] for drawing in (moving, still)]
    assert labels[0] == labels[1]
    assert "in 2.00 s" in labels[0]


def test_a_walk_that_breaks_down_at_once_is_drawn_without_motion():
    settings = wl.Settings().with_(duration=1)
    scene = wl.compile_scene(wl.Genome.random(settings.robot, rng=np.random.default_rng(2)), settings)
    rollout = simulate_walk(scene)
    broken = replace(rollout, poses=np.full_like(rollout.poses, np.nan), com=np.full_like(rollout.com, np.nan))
    assert "<animate" not in draw_walk(scene, broken)
