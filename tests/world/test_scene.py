"""A compiled scene contains exactly the robot that the genome expresses."""

import math
from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
import pytest

import walkerlab as wl
from walkerlab.genome.phenotype import express
from walkerlab.settings.choices import Obstacle, Structure
from walkerlab.system.randomness import random_stream
from walkerlab.world import assembly
from walkerlab.world import scene as scenes


def random_genomes(n, robot=None):
    return [wl.Genome.random(robot or wl.Robot(), rng=random_stream(1, "check", i)) for i in range(n)]


@pytest.mark.parametrize("genome", random_genomes(12), ids=range(12))
def test_weight_and_length_of_the_model_are_those_of_the_genome(genome):
    scene = wl.compile_scene(genome, wl.Settings())
    robot = express(genome)
    model = scene.model
    data = mujoco.MjData(model)
    scene.place(data)
    mujoco.mj_kinematics(model, data)
    trunks = [i for i in range(model.ngeom) if model.geom(i).name.startswith("walker/trunk")]
    reach = model.geom_size[trunks, 0] + model.geom_size[trunks, 1]
    front, rear = (data.geom_xpos[trunks, 0] + reach).max(), (data.geom_xpos[trunks, 0] - reach).min()

    assert model.body_mass.sum() == pytest.approx(robot.weight, rel=1e-12)
    assert front - rear == pytest.approx(robot.body_length, abs=1e-6)
    assert front <= 1e-6, "the whole robot is behind the start line"
    assert model.nu == 2 * robot.n_legs
    assert sorted(model.actuator_forcerange[:, 1]) == pytest.approx(
        sorted(segment.legs.force for segment in robot.segments if segment.legs for _ in range(4))
    )


def test_models_do_not_depend_on_previous_robots_of_the_same_body_plan():
    genomes = random_genomes(40)
    models = [wl.compile_scene(genome, wl.Settings()).model for genome in genomes]
    for genome, model in zip(genomes, models, strict=True):
        with ThreadPoolExecutor(1) as thread:  # each thread has a cache of its own
            fresh = thread.submit(wl.compile_scene, genome, wl.Settings()).result().model
        for field in ("body_mass", "body_pos", "geom_size", "geom_pos", "dof_armature", "dof_damping",
                      "jnt_stiffness", "actuator_gainprm", "actuator_biasprm", "actuator_forcerange"):  # fmt: skip
            np.testing.assert_array_equal(getattr(model, field), getattr(fresh, field), err_msg=field)


def test_composer_builds_each_body_plan_once():
    assembly._world_xml.cache_clear()
    with ThreadPoolExecutor(1) as thread:  # with an empty cache
        for genome in random_genomes(60):
            thread.submit(wl.compile_scene, genome, wl.Settings()).result()
    info = assembly._world_xml.cache_info()
    assert info.misses == len({express(genome).plan for genome in random_genomes(60)})


@pytest.mark.parametrize("terrain", [
    wl.Terrain(), wl.Terrain(structure="incline", incline=30), wl.Terrain(structure="incline", incline=-25),
    wl.Terrain(structure="stairs", step_height=0.4, step_depth=0.1),
], ids=lambda terrain: f"{terrain.structure.name} {terrain.incline:g}")  # fmt: skip
def test_no_robot_starts_inside_the_ground_or_itself(terrain):
    for genome in random_genomes(30):
        scene = wl.compile_scene(genome, wl.Settings(terrain=terrain))
        data = mujoco.MjData(scene.model)
        scene.place(data)
        mujoco.mj_forward(scene.model, data)
        assert not [c for c in data.contact if c.dist < -1e-6], str(genome)
        scene.model.geom_margin[:] = 4 * scenes.START_CLEARANCE
        mujoco.mj_forward(scene.model, data)
        ground = [c.dist for c in data.contact if min(scene.model.geom_bodyid[c.geom]) == 0]
        assert min(ground) == pytest.approx(scenes.START_CLEARANCE, abs=1e-6), "START_CLEARANCE above the ground"


def test_the_right_leg_lags_the_left_one_by_the_stride_gene():
    robot = wl.Robot(segments=(1, 1), body_length=(0.4, 0.5), segment_length=(0.4, 0.5), legs=(2, 2))
    genome = random_genomes(1, robot)[0]
    values = genome.values.copy()
    names = list(wl.gene_table(robot).gene)
    values[names.index("frequency")] = 1.0
    values[names.index("seg1.stride")] = math.pi
    scene = wl.compile_scene(wl.Genome(values), wl.Settings(robot=robot))
    controls = scene.controls(800)  # 4 s
    left, right = controls[:, :2], controls[:, 2:]
    assert np.abs(right[300:] - left[200:700]).max() < 0.01  # half a second later, to within a milliradian of phase
    assert (controls[0] == scene.rest).all(), "the amplitude grows from the rest pose"


@pytest.mark.parametrize("timestep", [0.0005, 0.00125, 0.003, 0.005, 0.0097])
def test_controls_depend_on_time_not_on_the_timestep(timestep):
    genome = random_genomes(1)[0]
    fine = wl.compile_scene(genome, wl.Settings().with_(timestep=0.0005)).controls(4000)
    coarse = wl.compile_scene(genome, wl.Settings().with_(timestep=timestep)).controls(int(2 / timestep))
    time = np.arange(len(coarse)) * timestep
    is_between_control_steps = np.abs(time * 50 - np.rint(time * 50)) > 1e-6
    expected = fine[np.floor(time / 0.0005 + 1e-9).astype(int)]
    np.testing.assert_allclose(coarse[is_between_control_steps], expected[is_between_control_steps])


WORLDS = [{"structure": structure} for structure in Structure]
WORLDS += [{"obstacle": kind, "obstacle_density": 0.5, "wind": (2.0, 1.0, 0.0)} for kind in Obstacle if kind]
WORLDS += [{"carry_weight": 2.0, "drag_weight": 2.0, "gravity": "moon", "texture": "gravel", "texture_density": 0.01}]


@pytest.mark.parametrize("world", WORLDS, ids=str)
def test_scenery_does_not_affect_the_physics(world):
    settings = wl.Settings().with_(**world)
    genome = random_genomes(1)[0]
    plain, with_scenery = (wl.compile_scene(genome, settings, scenery=scenery) for scenery in (False, True))
    ends = []
    for scene in (plain, with_scenery):
        data = mujoco.MjData(scene.model)
        scene.place(data)
        for control in scene.controls(400):
            data.ctrl[:] = control
            mujoco.mj_step(scene.model, data)
        ends.append(data.qpos.copy())
    # The two are compiled in different ways, so that sums of masses can differ in the last bit.
    np.testing.assert_allclose(*ends, rtol=0, atol=1e-9)
    assert plain.model.ntex == 0
    assert with_scenery.model.ntex > 0


def test_gravity_is_a_vector():
    model = wl.compile_scene(random_genomes(1)[0], wl.Settings(terrain=wl.Terrain(gravity=(0.5, 0, -3.7)))).model
    assert model.opt.gravity.tolist() == [0.5, 0, -3.7]
