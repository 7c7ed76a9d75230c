"""Loads: their weight and the pull of the rope slow the robot down, and they are not part of its body."""

import mujoco
import numpy as np
import pytest

import walkerlab as wl
from tests.simulation.test_validity import WALKER
from walkerlab.simulation.fitness import distance, velocity
from walkerlab.simulation.rollout import simulate_walk
from walkerlab.simulation.starts import draw_nudge
from walkerlab.system.randomness import random_stream
from walkerlab.world.entities.walker import LEG_COLOURS, TRUNK_COLOUR
from walkerlab.world.scene import compile_scene

LOADS = [{"carry_weight": 3}, {"drag_weight": 2}, {"carry_weight": 3, "drag_weight": 2}]
OTHERS = [wl.Genome.random(wl.Robot(), rng=random_stream(4, "check", i)) for i in range(8)]


def scene_with(load, **changes):
    return compile_scene(WALKER, wl.Settings().with_(**load, **changes))


def simulate_steps(scene, seconds, *, rest=3):
    """Yield the data after each step of settling for ``rest`` seconds and walking for ``seconds``, without sleep."""
    model = scene.model
    timestep = scene.settings.simulation.timestep
    model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    data = mujoco.MjData(model)
    scene.place(data)
    hold = np.tile(scene.rest, (round(rest / timestep), 1))
    for control in [*hold, *scene.controls(1 + round(seconds / timestep))]:
        data.ctrl[:] = control
        mujoco.mj_step(model, data)
        yield data


# ------------------------------------------------------------------------------------------------ speed


@pytest.mark.parametrize(("lighter", "heavier"), [
    ({}, {"carry_weight": 3}), ({"carry_weight": 3}, {"carry_weight": 8}),
    ({}, {"drag_weight": 1}), ({"drag_weight": 1}, {"drag_weight": 2}), ({"drag_weight": 2}, {"drag_weight": 6}),
    ({"drag_weight": 2}, {"drag_weight": 2, "carry_weight": 3}),
], ids=str)  # fmt: skip
def test_the_heavier_the_load_the_slower_the_walk(lighter, heavier):
    quick, slow = (wl.simulate(WALKER, wl.Settings().with_(**load), poses=False) for load in (lighter, heavier))
    assert quick.counts
    assert slow.counts, slow.reason
    assert 0 < velocity(slow) < velocity(quick)
    assert distance(slow) < distance(quick)


@pytest.mark.parametrize("terrain", [
    wl.Terrain(), wl.Terrain(structure="incline", incline=-15), wl.Terrain(structure="rough"),
    wl.Terrain(structure="gaps", gap_width=0.3), wl.Terrain(texture="ice"),
], ids=lambda terrain: f"{terrain.structure.name} {terrain.texture.name}")  # fmt: skip
def test_the_sledge_is_never_ahead_in_a_walk_that_counts(terrain):
    settings = wl.Settings(terrain=terrain).with_(drag_weight=1, duration=4)
    rollouts = [wl.simulate(genome, settings, poses=False) for genome in [WALKER, *OTHERS]]
    counted = [rollout for rollout in rollouts if rollout.counts]
    assert counted
    assert all((rollout.load[:, 0] <= rollout.com[:, 0]).all() for rollout in counted)
    assert max(rollout.rope.max() for rollout in counted) < 1.05


# ------------------------------------------------------------------------------------------------ forces


@pytest.mark.parametrize("weight", [1, 6])
def test_the_rope_pulls_only_when_it_is_taut(weight):
    scene = scene_with({"drag_weight": weight})
    lengths, pulls = [], []
    for data in simulate_steps(scene, 4):
        is_rope = data.efc_type == mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON
        lengths.append(data.ten_length[0] / scene.rope_length)
        pulls.append(data.efc_force[is_rope].sum())
    length, pull = np.array(lengths), np.array(pulls)
    assert pull.min() >= 0
    assert not pull[length < 1].any()
    assert (length < 1).any()
    assert (pull > 0).mean() > 0.2
    assert length.max() < 1.05


@pytest.mark.parametrize("planet", ["earth", "moon"])
@pytest.mark.parametrize("load", [{}, *LOADS], ids=str)
def test_the_ground_supports_the_robot_with_its_pack_and_the_sledge_separately(planet, load):
    """Measured at rest, over the last half second."""
    scene = scene_with(load, gravity=planet)
    model = scene.model
    force = np.empty(6)
    forces = {root: [] for root in scene.roots}
    for data in simulate_steps(scene, 0, rest=6):
        if data.time < 5.5:
            continue
        upward_force = dict.fromkeys(forces, 0.0)
        for number, contact in enumerate(data.contact):
            first, second = model.body_rootid[model.geom_bodyid[contact.geom]]
            assert 0 in (first, second), "the sledge does not touch the robot"
            mujoco.mj_contactForce(model, data, number, force)
            upward = contact.frame.reshape(3, 3)[:, 2] @ force[:3]
            upward_force[first or second] += upward if first == 0 else -upward
        for root, values in forces.items():
            values.append(upward_force[root])
    robot = scene.settings.robot
    g = -model.opt.gravity[2]
    weights = [scene.phenotype.weight + robot.carry_weight, robot.drag_weight]
    for values, weight in zip(forces.values(), weights, strict=False):
        assert np.mean(values) == pytest.approx(weight * g, rel=0.02)


# ------------------------------------------------------------------------------------------------ not part of the body


@pytest.mark.parametrize("load", LOADS, ids=str)
def test_loads_do_not_count_towards_the_robot_limits(load):
    scene, without_load = scene_with(load), scene_with({})
    assert scene.genome == without_load.genome
    assert scene.phenotype == without_load.phenotype
    limits = scene.settings.robot
    assert wl.gene_table(limits).equals(wl.gene_table(wl.Robot()))
    assert scene.model.body_mass.sum() == pytest.approx(
        without_load.phenotype.weight + limits.carry_weight + limits.drag_weight, rel=1e-9
    )


def test_the_pack_is_fixed_on_the_back():
    rollout = wl.simulate(WALKER, wl.Settings().with_(carry_weight=3))
    scene = scene_with({"carry_weight": 3})
    model = scene.model
    data = mujoco.MjData(scene.model)
    pack = model.body("walker/pack/").id
    segment = model.body_parentid[pack]
    relative_poses = []
    for pose in rollout.poses:
        data.qpos[:] = pose
        mujoco.mj_kinematics(model, data)
        rotation = data.xmat[segment].reshape(3, 3)
        offset = rotation.T @ (data.xpos[pack] - data.xpos[segment])
        relative_poses.append(np.concatenate([offset, (rotation.T @ data.xmat[pack].reshape(3, 3)).ravel()]))
    assert np.ptp(rollout.poses[:, :3], axis=0).max() > 1, "it walked"
    np.testing.assert_allclose(relative_poses, np.broadcast_to(relative_poses[0], (len(relative_poses), 12)), atol=1e-9)
    assert relative_poses[0][2] > 0, "above the middle of its segment"


def test_loads_are_visible_and_differ_in_colour_from_the_robot():
    model = scene_with({"carry_weight": 3, "drag_weight": 2}).model
    robot = np.array([TRUNK_COLOUR, *LEG_COLOURS.values()])
    for name in ("walker/pack/", "sledge/"):
        geoms = model.geom_bodyid == model.body(name).id
        assert geoms.any()
        assert (model.geom_rgba[geoms, 3] == 1).all()
        assert (model.geom_group[geoms] <= 2).all(), "groups that MuJoCo draws"
        assert np.abs(model.geom_rgba[geoms][:, np.newaxis] - robot).max(axis=-1).min() > 0.1
    assert model.tendon_rgba[0, 3] == 1


@pytest.mark.parametrize("weight", [0.1, 2, 100])
def test_no_robot_starts_inside_its_load_or_with_a_taut_rope(weight):
    for genome in OTHERS:
        scene = compile_scene(genome, wl.Settings().with_(carry_weight=weight, drag_weight=weight))
        data = mujoco.MjData(scene.model)
        scene.place(data)
        mujoco.mj_forward(scene.model, data)
        roots = scene.model.body_rootid[scene.model.geom_bodyid[data.contact.geom]]
        assert not (data.contact.dist[roots[:, 0] != roots[:, 1]] < 0).any()
        assert 0.95 < data.ten_length[0] / scene.rope_length < 1


def test_a_robot_whose_tail_is_higher_than_the_rope_is_long_can_start():
    robot = wl.Robot(body_length=(7.9, 8.0), segments=(4, 8), segment_length=(0.5, 2.0), weight=(20, 80), drag_weight=1)
    settings = wl.Settings(robot=robot).with_(duration=1.0)
    scene = wl.compile_scene(wl.Genome.random(robot, rng=np.random.default_rng(2)), settings)
    for start in range(20):
        assert np.isfinite(simulate_walk(scene, nudge=draw_nudge(scene, start), poses=False).com).all()
