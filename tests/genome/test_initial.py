"""Random robots of the first generation: most stand on their feet, and many walk."""

import mujoco
import numpy as np

import walkerlab as wl
from walkerlab.genome.breeding import generate_robot_population
from walkerlab.genome.genome import Genome
from walkerlab.simulation.starts import settle
from walkerlab.simulation.stepping import STATE_PARTS


def touching_geoms(scene):
    """Return the names of the geoms of a robot that touch the ground once the robot has settled in its rest pose."""
    data = mujoco.MjData(scene.model)
    scene.place(data)
    state, _, _ = settle(scene, data)
    mujoco.mj_setState(scene.model, data, state[0], STATE_PARTS)
    mujoco.mj_fwdPosition(scene.model, data)
    pairs = data.contact.geom
    is_outer = scene.is_robot_geom[pairs].sum(axis=1) == 1
    touching = pairs[is_outer][scene.is_robot_geom[pairs[is_outer]]]
    return {scene.model.geom(geom).name for geom in touching.tolist()}


def first_generation(n):
    return [Genome(values) for values in generate_robot_population(wl.Robot(), n, seed=0)]


def test_most_random_robots_stand_on_their_shanks():
    names = [touching_geoms(wl.compile_scene(genome, wl.Settings())) for genome in first_generation(60)]
    assert np.mean([bool(touching) and all("_shank" in name for name in touching) for touching in names]) >= 0.75


def test_many_random_robots_move_forward():
    settings = wl.Settings()
    distances = [wl.simulate(genome, settings, poses=False).distance for genome in first_generation(30)]
    assert np.mean(np.array(distances) > 0.2) >= 0.35
