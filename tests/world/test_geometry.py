"""Drawn surfaces have the size and position of the simulated bodies."""

import math

import mujoco
import numpy as np
import pytest

import walkerlab as wl
from walkerlab.commands.worlds import WALKER_GENOME as GENOME
from walkerlab.settings.choices import Obstacle, Structure
from walkerlab.world.geometry import body_placements, material_image, rope_ends, rotate, visible_surfaces
from walkerlab.world.heights import ground_height

GEOM = mujoco.mjtGeom


def volume(surface):
    """Return the volume by the divergence theorem, which requires a closed surface with outward triangles."""
    a, b, c = surface.points[surface.triangles].transpose(1, 0, 2)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


@pytest.mark.parametrize("obstacle", [kind for kind in Obstacle if kind])
def test_every_moving_surface_is_closed_and_encloses_its_volume(obstacle):
    settings = wl.Settings().with_(obstacle=obstacle, carry_weight=2, drag_weight=2)
    model = wl.compile_scene(GENOME, settings).model
    drawn = list(visible_surfaces(model, bodies=True))
    kinds = [(i, GEOM(model.geom_type[i])) for i in range(model.ngeom) if model.geom_bodyid[i]]
    for surface, (i, kind) in zip(drawn, kinds, strict=True):
        a, b, c = model.geom_size[i]
        expected = {
            GEOM.mjGEOM_SPHERE: 4 / 3 * math.pi * a**3,
            GEOM.mjGEOM_CAPSULE: 4 / 3 * math.pi * a**3 + 2 * math.pi * a**2 * b,
            GEOM.mjGEOM_CYLINDER: 2 * math.pi * a**2 * b,
            GEOM.mjGEOM_BOX: 8 * a * b * c,
            GEOM.mjGEOM_MESH: volume(surface),
        }[kind]
        assert 0.95 * expected < volume(surface) <= 1.0001 * expected
        assert volume(surface) > 0


def test_drawn_hills_have_the_computed_height():
    settings = wl.Settings().with_(structure=Structure.rough, hill_height=0.5)
    (hills,) = [
        one
        for one in visible_surfaces(wl.compile_scene(GENOME, settings).model, bodies=False)
        if len(one.points) > 1000
    ]
    x, y, z = hills.points.T
    assert np.allclose(z, ground_height(settings.terrain, x, y), atol=1e-3)


def test_placements_and_rope_ends_agree_with_mujoco():
    settings = wl.Settings().with_(drag_weight=2, obstacle="ball", duration=2)
    scene = wl.compile_scene(GENOME, settings)
    poses = wl.simulate(GENOME, settings).poses[::20]
    placed = body_placements(scene, poses)
    data = mujoco.MjData(scene.model)
    for pose, place, ends in zip(poses, placed, rope_ends(scene, placed), strict=True):
        data.qpos[:] = pose
        mujoco.mj_forward(scene.model, data)
        assert np.allclose(place, np.concatenate([data.xpos, data.xquat], axis=1))
        assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(float(data.ten_length[0]), abs=1e-9)


def test_rotate_agrees_with_mujoco():
    rng = np.random.default_rng(0)
    expected = np.empty(3)
    quaternions = rng.normal(size=(20, 4))
    vector = rng.normal(size=3)
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    for quaternion, rotated in zip(quaternions, rotate(quaternions, vector), strict=True):
        mujoco.mju_rotVecQuat(expected, vector, quaternion)
        assert np.allclose(rotated, expected)


def test_the_image_of_the_ground_has_the_colours_of_its_material():
    from walkerlab.world.materials import MATERIALS

    settings = wl.Settings().with_(texture="grass")
    model = wl.compile_scene(GENOME, settings, scenery=True).model
    image, repeat = material_image(model, int(model.geom("plane").matid[0]))
    colours = {tuple(pixel) for pixel in image.reshape(-1, 3).tolist()}
    material = MATERIALS[settings.terrain.texture]
    for colour in (material.light, material.dark):
        assert any(np.allclose(np.array(found) / 255, colour, atol=0.01) for found in colours)
    assert repeat.tolist() == [0.5, 0.5]
