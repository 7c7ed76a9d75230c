"""Ground, layout and forces: rays, contacts and falling bodies in MuJoCo agree with the computed values."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import walkerlab as wl
from tests.strategies import domains, robots
from walkerlab.settings.choices import Obstacle, Structure
from walkerlab.settings.model import SettingsError
from walkerlab.settings.terrain import MAX_PIECES, PLACEMENT_AREA, PLANET_GRAVITY
from walkerlab.simulation.starts import start_overlap
from walkerlab.simulation.validity import MAX_START_OVERLAP
from walkerlab.system.randomness import random_stream
from walkerlab.world import heights, placement
from walkerlab.world.assembly import _add_pieces
from walkerlab.world.entities import generate_terrain
from walkerlab.world.heights import FIELD_START, LANDING_LENGTH, ground_height, hill_heights, level_stretches, slope
from walkerlab.world.placement import compute_layout
from walkerlab.world.scene import POSITION, compile_scene

AWAKE = mujoco.mjtSleepPolicy.mjSLEEP_NEVER
DOWN = np.array([0.0, 0.0, -1.0])


def world_spec(terrain):
    """Return the specification of a ground with its pieces and obstacles, without a robot."""
    spec = mujoco.MjSpec.from_string(generate_terrain(terrain).mjcf_model.to_xml_string(zero_threshold=1e-15))
    _add_pieces(spec, terrain)
    return spec


def compiled(spec):
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def cast_rays(model, data, points, direction):
    """Yield the geom that a ray from each point hits, and its distance [m]."""
    geom = np.zeros(1, np.int32)
    for point in points:
        distance = mujoco.mj_ray(model, data, point, direction, None, 1, -1, geom)
        yield int(geom[0]), distance


def valid_terrain(**values):
    """Return a terrain; reject the example if the settings contradict each other."""
    try:
        return wl.Terrain(**values)
    except SettingsError:
        assume(False)


@st.composite
def crowded_terrains(draw):
    """Draw terrains with up to as many pieces and obstacles as the settings accept."""
    values = draw(domains(wl.Terrain))
    for name, value in values.items():  # MuJoCo fails to parse subnormal numbers such as 1e-310
        if isinstance(value, tuple | float):
            values[name] = np.round(value, 9).tolist()
    width = draw(st.floats(0.03, 0.6))
    kind = draw(st.sampled_from(Obstacle))
    area = math.pi * (placement.OBSTACLE_REACH[kind] * width + 0.01) ** 2
    share = draw(st.sampled_from([0.1, 0.1, 0.1, 1.0]))
    obstacles = {"obstacle": kind, "obstacle_size": width, "obstacle_density": share * min(2.0, 0.25 / area)}
    size = draw(st.floats(0.02, 0.3))
    density = draw(st.just(0.0) | st.floats(0, 0.9)) * min(1.0, size**2 / 0.2)  # a few hundred pieces at most
    return valid_terrain(**values | obstacles | {"texture_size": size, "texture_density": density})


# ------------------------------------------------------------------------------------------- the shape of the ground


@pytest.mark.parametrize("terrain", [
    wl.Terrain(structure="rough"), wl.Terrain(structure="rough", hill_height=0.6, hill_length=0.8, seed=3),
    wl.Terrain(structure="rough", hill_height=0.0), wl.Terrain(structure="stairs", step_height=0.3, step_depth=0.25),
    wl.Terrain(structure="gaps", gap_width=0.3), wl.Terrain(structure="incline", incline=-20), wl.Terrain(),
], ids=str)  # fmt: skip
def test_rays_from_above_hit_the_ground_at_the_computed_height(terrain):
    rng = np.random.default_rng(1)
    x, y = rng.uniform(-3, LANDING_LENGTH + heights.ARENA_LENGTH - 0.1, 1000), rng.uniform(-4.9, 4.9, 1000)
    found = cast_rays(*compiled(world_spec(terrain)), np.stack([x, y, np.full_like(x, 200.0)], axis=1), DOWN)
    np.testing.assert_allclose(
        200 - np.array([distance for _, distance in found]), ground_height(terrain, x, y), atol=1e-4
    )


@pytest.mark.parametrize("structure", Structure)
def test_ground_and_layout_are_determined_by_the_seed(structure):
    def generate(seed):
        placement.compute_layout.cache_clear()
        hill_heights.cache_clear()
        terrain = wl.Terrain(structure=structure, texture_density=0.1, obstacle="rock", seed=seed)
        return vars(compute_layout(terrain)) | {"hills": hill_heights(terrain)}

    first, again, other = generate(1), generate(1), generate(2)
    for name, values in first.items():
        np.testing.assert_array_equal(values, again[name])
    assert not np.array_equal(first["pieces"], other["pieces"])
    assert not np.array_equal(first["obstacles"], other["obstacles"])
    assert structure != Structure.rough or not np.array_equal(first["hills"], other["hills"])


# -------------------------------------------------------------------------------------------------------- pieces


@pytest.mark.parametrize("structure", Structure)
@pytest.mark.parametrize(("size", "density"), [(0.08, 0.2), (0.15, 0.1), (0.2, 0.6)])
def test_pieces_cover_the_requested_share_of_the_ground(structure, size, density):
    terrain = wl.Terrain(structure=structure, incline=20, texture_size=size, texture_density=density)
    model, data = compiled(world_spec(terrain))
    rng = np.random.default_rng(1)
    pitch = slope(terrain)
    sample = 6000
    # One random point in each of many stripes, to reduce the variance of the measured share.
    along = FIELD_START + PLACEMENT_AREA[0] * (rng.permutation(sample) + rng.random(sample)) / sample
    on_ground = [any(start < place < end for start, end in level_stretches(terrain)) for place in along]
    along, across = along[on_ground], rng.uniform(-PLACEMENT_AREA[1] / 2, PLACEMENT_AREA[1] / 2, sample)[on_ground]
    up = np.array([-math.sin(pitch), 0, math.cos(pitch)])
    points = np.stack([along * math.cos(pitch), across, along * math.sin(pitch)], axis=1) + 30 * up
    first_piece = model.ngeom - len(compute_layout(terrain).pieces)
    covered = np.mean([geom >= first_piece for geom, _ in cast_rays(model, data, points, -up)])
    assert covered == pytest.approx(density, rel=0.1)


@pytest.mark.parametrize("structure", [Structure.stairs, Structure.gaps])
def test_pieces_are_fixed_and_lie_completely_on_one_stretch(structure):
    terrain = wl.Terrain(structure=structure, texture_density=0.1)
    model, _ = compiled(world_spec(terrain))
    x = compute_layout(terrain).pieces[:, 0]
    half = terrain.texture_size / 2
    n_on = [((start + half - 1e-9 <= x) & (x <= end - half + 1e-9)).sum() for start, end in level_stretches(terrain)]
    assert min(n_on) > 0
    assert sum(n_on) == len(x) == (model.geom_type == int(mujoco.mjtGeom.mjGEOM_SPHERE)).sum()
    assert model.nv == 0


# ----------------------------------------------------------------------------------------------------- obstacles


@pytest.mark.parametrize("structure", Structure)
@pytest.mark.parametrize("kind", [kind for kind in Obstacle if kind])
def test_the_obstacle_density_is_as_requested(structure, kind):
    terrain = wl.Terrain(structure=structure, obstacle=kind, obstacle_density=0.7)
    area = (np.maximum(level_stretches(terrain), LANDING_LENGTH) @ [-1, 1]).sum() * PLACEMENT_AREA[1]
    spec = world_spec(terrain)
    assert len(spec.bodies) - 1 == pytest.approx(0.7 * area, abs=0.5)


@given(crowded_terrains())
@settings(max_examples=15)
def test_no_obstacle_overlaps_anything_or_is_on_the_landing(terrain):
    assume(  # pieces wider than a tread protrude from the riser of the stair
        terrain.structure != Structure.stairs or terrain.step_depth > 2 * terrain.texture_size + terrain.obstacle_size
    )
    spec = world_spec(terrain)
    for body in spec.bodies[1:]:
        body.sleep = AWAKE
    model, data = compiled(spec)
    assert min(data.contact.dist, default=0) > -1e-3
    pitch = slope(terrain)
    ahead = data.geom_xpos[model.geom_bodyid > 0] @ [math.cos(pitch), 0, math.sin(pitch)]
    assert min(ahead, default=9) > LANDING_LENGTH


def test_obstacles_sleep_until_touched_and_fall_asleep_again():
    spec = world_spec(wl.Terrain(obstacle="box"))
    placed = compute_layout(wl.Terrain(obstacle="box"))
    spot = placed.obstacles[0]
    half = placed.obstacle_sizes[0] / 2
    hammer = spec.worldbody.add_body(pos=[*spot[:2], 2 * half + 0.3], sleep=mujoco.mjtSleepPolicy.mjSLEEP_INIT)
    hammer.add_freejoint()
    hammer.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[half / 2, 0, 0], mass=0.1)
    model, data = compiled(spec)
    assert (data.tree_asleep >= 0).all()
    mujoco.mj_step(model, data, 500)
    assert (data.tree_asleep >= 0).all()
    data.qvel[-4] = -2.0  # drop the hammer
    is_woken = np.zeros(model.ntree, dtype=bool)
    for _ in range(500):
        mujoco.mj_step(model, data)
        is_woken |= data.tree_asleep < 0
    assert is_woken.nonzero()[0].tolist() == [0, model.ntree - 1], "only the obstacle that was hit, and the hammer"
    mujoco.mj_step(model, data, 2000)
    assert (data.tree_asleep >= 0).all()


# --------------------------------------------------------------------------------------------------- robots and loads


loads = st.just(0.0) | st.floats(0.01, 100)


@given(crowded_terrains(), robots(), loads, loads, st.integers(0, 99))
@settings(max_examples=60)
def test_no_robot_or_sledge_starts_inside_anything(terrain, limits, carried, dragged, number):
    robot = wl.Robot(**limits.model_dump() | {"carry_weight": carried, "drag_weight": dragged})
    genome = wl.Genome.random(robot, rng=random_stream(1, "check", number))
    scene = compile_scene(genome, wl.Settings(terrain=terrain, robot=robot))
    model = scene.model
    data = mujoco.MjData(scene.model)
    scene.place(data)
    mujoco.mj_forward(model, data)
    roots = model.body_rootid[model.geom_bodyid[data.contact.geom]].reshape(-1, 2)
    is_relevant = np.isin(roots, scene.roots).any(axis=1) & (roots[:, 0] != roots[:, 1])
    assert min(data.contact.dist[is_relevant], default=0) > -MAX_START_OVERLAP
    assert start_overlap(scene, data) <= MAX_START_OVERLAP


@given(domains(wl.Terrain).map(lambda values: valid_terrain(**values)))
@settings(max_examples=25)
def test_every_valid_terrain_has_a_finite_layout_within_the_limit_of_pieces(terrain):
    placed = compute_layout(terrain)
    assert len(placed.pieces) <= MAX_PIECES
    assert len(placed.pieces) == 0 or terrain.texture_density > 0
    assert np.isfinite(np.concatenate([placed.pieces, placed.obstacles])).all()


# ------------------------------------------------------------------------------------------------- gravity and wind


def displacement(seconds, **forces):
    """Return the displacement [m] of a ball that is released high above the ground."""
    spec = world_spec(wl.Terrain(**forces))
    ball = spec.worldbody.add_body(pos=[0, 0, 100])
    ball.sleep = AWAKE
    ball.add_freejoint()
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.15, 0, 0], mass=1)
    model, data = compiled(spec)
    mujoco.mj_step(model, data, round(seconds / model.opt.timestep))
    return data.qpos[POSITION] - [0, 0, 100]


gravities = st.tuples(*[st.floats(-30, 30)] * 3) | st.sampled_from(list(PLANET_GRAVITY.values()))


@given(gravities)
@settings(max_examples=20)
def test_a_falling_ball_accelerates_by_gravity(gravity):
    np.testing.assert_allclose(displacement(1.0, gravity=gravity), np.array(gravity) / 2, rtol=0.01, atol=1e-12)


@pytest.mark.parametrize("planet", PLANET_GRAVITY)
def test_a_planet_preset_sets_its_gravity(planet):
    assert displacement(1.0, gravity=planet)[2] == pytest.approx(PLANET_GRAVITY[planet][2] / 2, rel=0.01)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_stronger_wind_moves_a_free_ball_farther(axis):
    direction = np.eye(3)[axis]
    calm, breeze, gale, against = (
        displacement(1.0, gravity=(0, 0, 0), wind=tuple(v * direction)) for v in (0, 5, 20, -20)
    )
    assert (calm == 0).all()
    assert 0 < 4 * breeze[axis] < gale[axis] < 20
    assert against == pytest.approx(-gale)
    assert abs(gale - gale[axis] * direction).max() < 1e-9
