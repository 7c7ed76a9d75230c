"""The lie of the land: what is said of it is what rays, contacts and falling things find."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import walkerlab as wl
from tests.strategies import domains, robots
from walkerlab import ground, layout
from walkerlab.assembly import _add_pieces
from walkerlab.entities import generate_terrain
from walkerlab.ground import FIELD_START, LANDING, height, hill_heights, level_stretches, slope
from walkerlab.judge import OVERLAP
from walkerlab.layout import compute_layout
from walkerlab.quantity import SettingsError
from walkerlab.randomness import stream
from walkerlab.rollout import _start_overlap
from walkerlab.scene import compile_scene
from walkerlab.settings import FIELD, MAX_PIECES, PLANETS, Obstacle, Structure

AWAKE = mujoco.mjtSleepPolicy.mjSLEEP_NEVER
DOWN = np.array([0.0, 0.0, -1.0])


def described(terrain):
    """The ground with all that lies on it, and no robot."""
    spec = mujoco.MjSpec.from_string(generate_terrain(terrain).mjcf_model.to_xml_string(zero_threshold=1e-15))
    _add_pieces(spec, terrain)
    return spec


def started(spec):
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def hits(model, data, points, towards):
    """What a ray from each point hits, and how far away."""
    geom = np.zeros(1, np.int32)
    for point in points:
        distance = mujoco.mj_ray(model, data, point, towards, None, 1, -1, geom)
        yield int(geom[0]), distance


def accepted(**drawn):
    """A terrain, if these settings go together."""
    try:
        return wl.Terrain(**drawn)
    except SettingsError:
        assume(False)


@st.composite
def strewn_terrains(draw):
    """Any ground, with as much on it as one may ask for."""
    drawn = draw(domains(wl.Terrain))
    for name, value in drawn.items():  # MuJoCo reads no number as small as 1e-310
        if isinstance(value, tuple | float):
            drawn[name] = np.round(value, 9).tolist()
    width, kind = draw(st.floats(0.03, 0.6)), draw(st.sampled_from(Obstacle))
    crowd, share = math.pi * (layout.REACH[kind] * width + 0.01) ** 2, draw(st.sampled_from([0.1, 0.1, 0.1, 1.0]))
    lying = {"obstacle": kind, "obstacle_size": width, "obstacle_density": share * min(2.0, 0.25 / crowd)}
    size = draw(st.floats(0.02, 0.3))
    density = draw(st.just(0.0) | st.floats(0, 0.9)) * min(1.0, size**2 / 0.2)  # some hundreds of pieces at most
    return accepted(**drawn | lying | {"texture_size": size, "texture_density": density})


# ------------------------------------------------------------------------------------------- the shape of the ground


@pytest.mark.parametrize("terrain", [
    wl.Terrain(structure="rough"), wl.Terrain(structure="rough", hill_height=0.6, hill_length=0.8, seed=3),
    wl.Terrain(structure="rough", hill_height=0.0), wl.Terrain(structure="stairs", step_height=0.3, step_depth=0.25),
    wl.Terrain(structure="gaps", gap_width=0.3), wl.Terrain(structure="incline", incline=-20), wl.Terrain(),
], ids=str)  # fmt: skip
def test_a_ray_from_above_meets_the_ground_at_its_height(terrain):
    rng = np.random.default_rng(1)
    x, y = rng.uniform(-3, LANDING + ground.ARENA_LENGTH - 0.1, 1000), rng.uniform(-4.9, 4.9, 1000)
    found = hits(*started(described(terrain)), np.stack([x, y, np.full_like(x, 200.0)], axis=1), DOWN)
    np.testing.assert_allclose(200 - np.array([distance for _, distance in found]), height(terrain, x, y), atol=1e-4)


@pytest.mark.parametrize("structure", Structure)
def test_the_same_seed_lays_the_same_ground_and_another_seed_another(structure):
    def laid(seed):
        layout.compute_layout.cache_clear()
        hill_heights.cache_clear()
        terrain = wl.Terrain(structure=structure, texture_density=0.1, obstacle="rock", seed=seed)
        return vars(compute_layout(terrain)) | {"hills": hill_heights(terrain)}

    first, again, other = laid(1), laid(1), laid(2)
    for name, values in first.items():
        np.testing.assert_array_equal(values, again[name])
    assert not np.array_equal(first["pieces"], other["pieces"])
    assert not np.array_equal(first["obstacles"], other["obstacles"])
    assert structure != Structure.rough or not np.array_equal(first["hills"], other["hills"])


# -------------------------------------------------------------------------------------------------------- pieces


@pytest.mark.parametrize("structure", Structure)
@pytest.mark.parametrize(("size", "density"), [(0.08, 0.2), (0.15, 0.1), (0.2, 0.6)])
def test_pieces_cover_the_part_of_the_ground_that_was_asked_for(structure, size, density):
    terrain = wl.Terrain(structure=structure, incline=20, texture_size=size, texture_density=density)
    model, data = started(described(terrain))
    rng, pitch, sample = np.random.default_rng(1), slope(terrain), 6000
    # One point in each of as many stripes along the way, so that chance adds little to what is measured.
    along = FIELD_START + FIELD[0] * (rng.permutation(sample) + rng.random(sample)) / sample
    on_ground = [any(start < place < end for start, end in level_stretches(terrain)) for place in along]
    along, across = along[on_ground], rng.uniform(-FIELD[1] / 2, FIELD[1] / 2, sample)[on_ground]
    up = np.array([-math.sin(pitch), 0, math.cos(pitch)])
    points = np.stack([along * math.cos(pitch), across, along * math.sin(pitch)], axis=1) + 30 * up
    first_piece = model.ngeom - len(compute_layout(terrain).pieces)
    covered = np.mean([geom >= first_piece for geom, _ in hits(model, data, points, -up)])
    assert covered == pytest.approx(density, rel=0.1)


@pytest.mark.parametrize("structure", [Structure.stairs, Structure.gaps])
def test_pieces_lie_on_every_stretch_of_ground_whole_and_fixed(structure):
    terrain = wl.Terrain(structure=structure, texture_density=0.1)
    model, _ = started(described(terrain))
    x, half = compute_layout(terrain).pieces[:, 0], terrain.texture_size / 2
    on = [((start + half - 1e-9 <= x) & (x <= end - half + 1e-9)).sum() for start, end in level_stretches(terrain)]
    assert min(on) > 0
    assert sum(on) == len(x) == (model.geom_type == int(mujoco.mjtGeom.mjGEOM_SPHERE)).sum()
    assert model.nv == 0


# ----------------------------------------------------------------------------------------------------- obstacles


@pytest.mark.parametrize("structure", Structure)
@pytest.mark.parametrize("kind", [kind for kind in Obstacle if kind])
def test_as_many_obstacles_lie_on_each_square_metre_as_were_asked_for(structure, kind):
    terrain = wl.Terrain(structure=structure, obstacle=kind, obstacle_density=0.7)
    room = (np.maximum(level_stretches(terrain), LANDING) @ [-1, 1]).sum() * FIELD[1]
    spec = described(terrain)
    assert len(spec.bodies) - 1 == pytest.approx(0.7 * room, abs=0.5)


@given(strewn_terrains())
@settings(max_examples=15)
def test_no_obstacle_starts_inside_anything_or_just_ahead_of_the_robot(terrain):
    """But where pieces are wider than a tread, and stand out of the face of the stair."""
    assume(
        terrain.structure != Structure.stairs or terrain.step_depth > 2 * terrain.texture_size + terrain.obstacle_size
    )
    spec = described(terrain)
    for body in spec.bodies[1:]:
        body.sleep = AWAKE
    model, data = started(spec)
    assert min(data.contact.dist, default=0) > -1e-3
    pitch = slope(terrain)
    ahead = data.geom_xpos[model.geom_bodyid > 0] @ [math.cos(pitch), 0, math.sin(pitch)]
    assert min(ahead, default=9) > LANDING


def test_obstacles_sleep_until_they_are_touched_and_fall_asleep_again():
    spec = described(wl.Terrain(obstacle="box"))
    layout_ = compute_layout(wl.Terrain(obstacle="box"))
    spot, half = layout_.obstacles[0], layout_.obstacle_sizes[0] / 2
    hammer = spec.worldbody.add_body(pos=[*spot[:2], 2 * half + 0.3], sleep=mujoco.mjtSleepPolicy.mjSLEEP_INIT)
    hammer.add_freejoint()
    hammer.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[half / 2, 0, 0], mass=0.1)
    model, data = started(spec)
    assert (data.tree_asleep >= 0).all()
    mujoco.mj_step(model, data, 500)
    assert (data.tree_asleep >= 0).all()
    data.qvel[-4] = -2.0  # the hammer is let down
    woken = np.zeros(model.ntree, dtype=bool)
    for _ in range(500):
        mujoco.mj_step(model, data)
        woken |= data.tree_asleep < 0
    assert woken.nonzero()[0].tolist() == [0, model.ntree - 1], "the one that was hit, and the hammer"
    mujoco.mj_step(model, data, 2000)
    assert (data.tree_asleep >= 0).all()


# -------------------------------------------------------------------------------------------------- what stands on it


loads = st.just(0.0) | st.floats(0.01, 100)


@given(strewn_terrains(), robots(), loads, loads, st.integers(0, 99))
@settings(max_examples=60)
def test_nobody_starts_inside_anything(terrain, limits, carried, dragged, number):
    robot = wl.Robot(**limits.model_dump() | {"carry_weight": carried, "drag_weight": dragged})
    genome = wl.Genome.random(robot, rng=stream(1, "check", number))
    scene = compile_scene(genome, wl.Settings(terrain=terrain, robot=robot))
    model, data = scene.model, mujoco.MjData(scene.model)
    scene.place(data)
    mujoco.mj_forward(model, data)
    owner = model.body_rootid[model.geom_bodyid[data.contact.geom]].reshape(-1, 2)
    own = np.isin(owner, scene.roots).any(axis=1) & (owner[:, 0] != owner[:, 1])
    assert min(data.contact.dist[own], default=0) > -OVERLAP
    assert _start_overlap(scene, data) <= OVERLAP


@given(domains(wl.Terrain).map(lambda drawn: accepted(**drawn)))
@settings(max_examples=25)
def test_every_accepted_ground_is_laid_out_with_no_more_pieces_than_a_computer_bears(terrain):
    laid = compute_layout(terrain)
    assert len(laid.pieces) <= MAX_PIECES
    assert len(laid.pieces) == 0 or terrain.texture_density > 0
    assert np.isfinite(np.concatenate([laid.pieces, laid.obstacles])).all()


# ------------------------------------------------------------------------------------------------ the forces over it


def moved(seconds, **forces):
    """How far a ball moves that is let go high over the ground."""
    spec = described(wl.Terrain(**forces))
    ball = spec.worldbody.add_body(pos=[0, 0, 100])
    ball.sleep = AWAKE
    ball.add_freejoint()
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.15, 0, 0], mass=1)
    model, data = started(spec)
    mujoco.mj_step(model, data, round(seconds / model.opt.timestep))
    return data.qpos[:3] - [0, 0, 100]


pulls = st.tuples(*[st.floats(-30, 30)] * 3) | st.sampled_from(list(PLANETS.values()))


@given(pulls)
@settings(max_examples=20)
def test_what_falls_falls_as_gravity_says(gravity):
    np.testing.assert_allclose(moved(1.0, gravity=gravity), np.array(gravity) / 2, rtol=0.01, atol=1e-12)


@pytest.mark.parametrize("planet", PLANETS)
def test_a_planet_pulls_as_it_does_in_the_sky(planet):
    assert moved(1.0, gravity=planet)[2] == pytest.approx(PLANETS[planet][2] / 2, rel=0.01)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_wind_carries_along_what_is_free_the_faster_the_stronger_it_is(axis):
    way = np.eye(3)[axis]
    calm, breeze, gale, against = (moved(1.0, gravity=(0, 0, 0), wind=tuple(v * way)) for v in (0, 5, 20, -20))
    assert (calm == 0).all()
    assert 0 < 4 * breeze[axis] < gale[axis] < 20
    assert against == pytest.approx(-gale)
    assert abs(gale - gale[axis] * way).max() < 1e-9
