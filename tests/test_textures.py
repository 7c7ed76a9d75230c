"""What the ground is made of is felt: blocks stick and slide, things roll and spin, as the table says."""

import math

import mujoco
import numpy as np
import pytest

import walkerlab as wl
from walkerlab.entities import generate_terrain
from walkerlab.settings import Texture
from walkerlab.textures import MATERIALS

G = 9.81
AWAKE = mujoco.mjtSleepPolicy.mjSLEEP_NEVER
STEEPEST = wl.Terrain.declared()["incline"].high  # deg


def ground(**settings):
    return mujoco.MjSpec.from_string(generate_terrain(wl.Terrain(**settings)).mjcf_model.to_xml_string())


def tilted(texture, angle):
    """A ground of this slope [rad]: built so, or, where none so steep is built, level under a gravity so tilted."""
    if math.degrees(angle) <= STEEPEST:
        return ground(texture=texture, structure="incline", incline=math.degrees(angle)), angle
    return ground(texture=texture, gravity=(-G * math.sin(angle), 0, -G * math.cos(angle))), 0.0


def slid(texture, angle):
    """How far [m] a block slides downhill within the second after it was laid on the ground."""
    spec, pitch = tilted(texture, angle)
    turn = [math.cos(pitch / 2), 0, -math.sin(pitch / 2), 0]
    block = spec.worldbody.add_body(pos=[-0.02 * math.sin(pitch), 0, 0.02 * math.cos(pitch)], quat=turn)
    block.sleep = AWAKE
    block.add_freejoint()
    block.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 0.1, 0.02], mass=1)
    model = spec.compile()
    data = mujoco.MjData(model)
    start = data.qpos[:3].copy()
    mujoco.mj_step(model, data, round(1 / model.opt.timestep))
    return float((start - data.qpos[:3]) @ [math.cos(pitch), 0, math.sin(pitch)])


def slowed(texture, spin):
    """How much speed a ball, 0.5 m wide, loses within a second on level ground, once it rolls or spins as it will.

    Args:
        texture: of the ground.
        spin: how fast it spins at first [rad/s]; 0 is a ball that rolls.

    Returns:
        What it loses of speed [m/s] if it rolls, of turning [rad/s] if it spins; and its radius [m].
    """
    spec = ground(texture=texture, obstacle="ball", obstacle_size=0.5, obstacle_density=0.02)
    while len(spec.bodies) > 2:
        spec.delete(spec.bodies[-1])
    spec.bodies[1].sleep = AWAKE
    model = spec.compile()
    data, radius = mujoco.MjData(model), float(model.geom_size[-1, 0])
    data.qpos[3:7] = [1, 0, 0, 0]  # as it turns about axes of its own
    data.qvel[:] = [0, 0, 0, 0, 0, spin] if spin else [4, 0, 0, 0, 4 / radius, 0]
    mujoco.mj_step(model, data, round(2 / model.opt.timestep))
    before = data.qvel.copy()
    mujoco.mj_step(model, data, round(1 / model.opt.timestep))
    return (before - data.qvel)[5 if spin else 0], radius


def test_every_texture_is_in_the_table_with_its_source_and_true_colours():
    assert set(MATERIALS) == set(Texture)
    for material in MATERIALS.values():
        assert material.source
        assert 0 < material.sliding < 1.5
        assert 0 < material.rolling < 1
        assert 0 <= material.speckle_share <= 1
        colours = np.array([material.light, material.dark, material.piece, material.speckle])
        assert colours.shape == (4, 3)
        assert ((colours >= 0) & (colours <= 1)).all()


@pytest.mark.parametrize("texture", Texture)
def test_a_block_stays_on_a_slope_a_tenth_under_the_angle_of_friction_and_slides_a_tenth_over_it(texture):
    friction = MATERIALS[texture].sliding
    under, over = 0.9 * math.atan(friction), 1.1 * math.atan(friction)
    assert abs(slid(texture, under)) < 0.01
    assert slid(texture, over) == pytest.approx(G * (math.sin(over) - friction * math.cos(over)) / 2, rel=0.05)


@pytest.mark.parametrize("texture", Texture)
def test_a_rolling_ball_is_slowed_by_the_rolling_resistance_of_the_ground(texture):
    """A solid ball, held back by a torque of c·r times its weight, loses 5/7·c·g of its speed each second."""
    loss, _ = slowed(texture, spin=0)
    assert loss == pytest.approx(5 / 7 * MATERIALS[texture].rolling * G, rel=0.3)


@pytest.mark.parametrize("texture", Texture)
def test_a_spinning_ball_is_slowed_by_the_torsional_friction_of_the_ground(texture):
    loss, radius = slowed(texture, spin=40)
    torsional = 2 / 3 * MATERIALS[texture].sliding * MATERIALS[texture].patch_radius
    assert loss == pytest.approx(torsional * G / (0.4 * radius**2), rel=0.05)
