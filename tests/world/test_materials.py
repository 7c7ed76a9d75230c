"""Friction of each texture: blocks stick and slide, balls roll and spin, as the table of materials implies."""

import math

import mujoco
import numpy as np
import pytest

import walkerlab as wl
from walkerlab.settings.choices import Texture
from walkerlab.world.entities import generate_terrain
from walkerlab.world.materials import MATERIALS
from walkerlab.world.scene import ORIENTATION, POSITION

G = 9.81
AWAKE = mujoco.mjtSleepPolicy.mjSLEEP_NEVER
STEEPEST = wl.Terrain.declared()["incline"].high  # deg


def ground_spec(**settings):
    return mujoco.MjSpec.from_string(generate_terrain(wl.Terrain(**settings)).mjcf_model.to_xml_string())


def tilted_ground(texture, angle):
    """Return a ground with a slope [rad] and its pitch; if too steep to build, a level one with tilted gravity."""
    if math.degrees(angle) <= STEEPEST:
        return ground_spec(texture=texture, structure="incline", incline=math.degrees(angle)), angle
    return ground_spec(texture=texture, gravity=(-G * math.sin(angle), 0, -G * math.cos(angle))), 0.0


def sliding_distance(texture, angle):
    """Return how far [m] a block slides downhill in the first second."""
    spec, pitch = tilted_ground(texture, angle)
    orientation = [math.cos(pitch / 2), 0, -math.sin(pitch / 2), 0]
    block = spec.worldbody.add_body(pos=[-0.02 * math.sin(pitch), 0, 0.02 * math.cos(pitch)], quat=orientation)
    block.sleep = AWAKE
    block.add_freejoint()
    block.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 0.1, 0.02], mass=1)
    model = spec.compile()
    data = mujoco.MjData(model)
    start = data.qpos[POSITION].copy()
    mujoco.mj_step(model, data, round(1 / model.opt.timestep))
    return float((start - data.qpos[POSITION]) @ [math.cos(pitch), 0, math.sin(pitch)])


def deceleration(texture, spin):
    """Measure how much a ball 0.5 m wide slows down in one second on level ground, after the first two seconds.

    Args:
        texture: Texture of the ground.
        spin: Initial spin about the vertical axis [rad/s]; 0 for a rolling ball.

    Returns:
        Loss of speed [m/s] of a rolling ball or of spin [rad/s] of a spinning one, and the radius of the ball [m].
    """
    spec = ground_spec(texture=texture, obstacle="ball", obstacle_size=0.5, obstacle_density=0.02)
    while len(spec.bodies) > 2:
        spec.delete(spec.bodies[-1])
    spec.bodies[1].sleep = AWAKE
    model = spec.compile()
    data = mujoco.MjData(model)
    radius = float(model.geom_size[-1, 0])
    data.qpos[ORIENTATION] = [1, 0, 0, 0]  # because angular velocity is given in the frame of the body
    data.qvel[:] = [0, 0, 0, 0, 0, spin] if spin else [4, 0, 0, 0, 4 / radius, 0]
    mujoco.mj_step(model, data, round(2 / model.opt.timestep))
    before = data.qvel.copy()
    mujoco.mj_step(model, data, round(1 / model.opt.timestep))
    return (before - data.qvel)[5 if spin else 0], radius


def test_every_texture_has_a_material_with_a_source_and_valid_colours():
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
def test_a_block_slides_on_slopes_steeper_than_the_friction_angle_only(texture):
    friction = MATERIALS[texture].sliding
    under, over = 0.9 * math.atan(friction), 1.1 * math.atan(friction)
    assert abs(sliding_distance(texture, under)) < 0.01
    assert sliding_distance(texture, over) == pytest.approx(
        G * (math.sin(over) - friction * math.cos(over)) / 2, rel=0.05
    )


@pytest.mark.parametrize("texture", Texture)
def test_a_rolling_ball_decelerates_by_the_rolling_resistance(texture):
    """A torque of c·r times its weight decelerates a solid ball by 5/7·c·g."""
    loss, _ = deceleration(texture, spin=0)
    assert loss == pytest.approx(5 / 7 * MATERIALS[texture].rolling * G, rel=0.3)


@pytest.mark.parametrize("texture", Texture)
def test_a_spinning_ball_decelerates_by_the_torsional_friction(texture):
    loss, radius = deceleration(texture, spin=40)
    torsional = 2 / 3 * MATERIALS[texture].sliding * MATERIALS[texture].patch_radius
    assert loss == pytest.approx(torsional * G / (0.4 * radius**2), rel=0.05)
