"""Footfalls agree with the height of the lowest point of each foot."""

import math

import mujoco
import numpy as np
import pytest

import walkerlab as wl
from walkerlab.simulation.footfalls import find_footfalls, foot_names, foot_share
from walkerlab.world.geometry import surface_points

ROBOTS = [wl.Genome.random(wl.Robot(), rng=np.random.default_rng(seed)) for seed in range(4)]


def lowest_height(scene, pose, foot):
    """Return the height of the lowest point of a shank [m]."""
    side, number = foot.split()
    data = mujoco.MjData(scene.model)
    data.qpos[:] = pose
    mujoco.mj_kinematics(scene.model, data)
    shank = scene.model.geom(f"walker/{side}_shank{number}").id
    radius, half, _ = scene.model.geom_size[shank]
    return data.geom_xpos[shank][2] - half * abs(data.geom_xmat[shank][8]) - radius


@pytest.mark.parametrize("genome", ROBOTS)
def test_on_level_ground_a_foot_is_down_if_its_lowest_point_is_below_0(genome):
    settings = wl.Settings().with_(duration=2)
    scene = wl.compile_scene(genome, settings)
    poses = wl.simulate(genome, settings).poses[::5]
    heights = np.array([[lowest_height(scene, pose, foot) for foot in foot_names(scene)] for pose in poses])
    is_clear = np.abs(heights) > 1e-9
    assert (find_footfalls(scene, poses) == (heights < 0))[is_clear].all()
    assert is_clear.mean() > 0.99


@pytest.mark.parametrize("ground", ["flat", "stairs", "rough", "gaps", "incline"])
@pytest.mark.parametrize("objects", [{}, {"obstacle": "ball", "obstacle_density": 1.0}, {"texture_density": 0.1}])
def test_the_robot_is_on_the_ground_whenever_a_foot_is_down(ground, objects):
    settings = wl.Settings().with_(structure=ground, duration=2, carry_weight=2, drag_weight=1, **objects)
    for genome in ROBOTS[:2]:
        rollout = wl.simulate(genome, settings)
        down = find_footfalls(wl.compile_scene(genome, settings), rollout.poses)
        assert down.any(), "otherwise the next assertion is trivial"
        assert not (down.any(axis=1) & ~rollout.on_ground).any()


def test_feet_are_named_from_the_front_left_before_right():
    genome = wl.Genome.random(wl.Robot(segments=(3, 3), legs=(4, 4)), rng=np.random.default_rng(0))
    legged = [number for number, legs in enumerate(wl.express(genome).plan, start=1) if legs]
    scene = wl.compile_scene(genome, wl.Settings(robot=wl.Robot(segments=(3, 3), legs=(4, 4))))
    assert foot_names(scene) == tuple(f"{side} {number}" for number in legged for side in ("left", "right"))
    assert find_footfalls(scene, scene.start[np.newaxis]).shape == (1, 4)


def test_a_foot_is_down_once_the_robot_is_lowered_to_the_ground():
    scene = wl.compile_scene(ROBOTS[0], wl.Settings())
    start = scene.start
    lowest = min(lowest_height(scene, start, foot) for foot in foot_names(scene))
    poses = np.array([start, start, start])
    poses[:, 2] += [1.0, 1e-4 - lowest, -1e-4 - lowest]
    in_air, just_above, just_below = find_footfalls(scene, poses)
    assert not in_air.any()
    assert not just_above.any()
    assert just_below.any()


def test_a_pose_that_is_not_finite_has_no_footfalls():
    scene = wl.compile_scene(ROBOTS[0], wl.Settings())
    poses = np.array([np.full(scene.model.nq, np.nan), scene.start])
    assert not find_footfalls(scene, poses)[0].any()
    assert find_footfalls(scene, poses[:0]).shape == (0, scene.phenotype.n_legs)


def test_poses_of_another_scene_raise_an_error():
    scene = wl.compile_scene(ROBOTS[0], wl.Settings())
    with pytest.raises(ValueError, match=r"poses must come from a walk in this scene, shape \(n, \d+\); got \(2, 3\)"):
        find_footfalls(scene, np.zeros((2, 3)))


STANDING = (
    "wl1 segments=2 | seg length=0.3 mass=3 legs length=0.3 force=15 | seg length=0.3 mass=3 legs length=0.3 force=15 "
    "| gait frequency=1 | step hip amplitude=0 phase=0 offset=0 knee amplitude=0 phase=0 offset=0 stride=0 "
    "| step hip amplitude=0 phase=0 offset=0 knee amplitude=0 phase=0 offset=0 stride=0"
)


@pytest.mark.parametrize(
    ("hip", "knee", "share"),
    [(0.0, 0.0, 1.0), (0.4, -0.8, 1.0), (0.0, -math.pi / 2, 0.0), (0.5, -2.5, 0.0), (math.pi / 2, 0.0, 0.0)],
    ids=["straight legs", "bent legs", "flat shanks", "knees", "belly"],
)
def test_only_the_ends_of_the_shanks_are_feet(hip, knee, share):
    scene = wl.compile_scene(STANDING, wl.Settings())
    pose = scene.start
    pose[scene.model.jnt_qposadr[scene.model.actuator_trnid[:, 0]]] = np.tile([hip, knee], 4)
    pose[2] -= min(skin[:, 2].min() for skin, _ in surface_points(scene, pose)) + 0.001
    assert foot_share(scene, pose[np.newaxis]) == share


def test_a_robot_in_the_air_has_no_share_of_contacts():
    scene = wl.compile_scene(ROBOTS[0], wl.Settings())
    assert math.isnan(foot_share(scene, scene.start[np.newaxis]))
