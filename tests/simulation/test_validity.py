"""Guards find every kind of invalid walk: some are simulated with a modified model, others are made-up traces."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.genome.features import FREQUENCY_RANGE
from walkerlab.genome.phenotype import Legs, Phenotype, Segment, Swing
from walkerlab.settings.choices import Guard, Obstacle, Structure, Texture
from walkerlab.simulation import validity
from walkerlab.simulation.fitness import distance, score
from walkerlab.simulation.rollout import simulate_walk
from walkerlab.simulation.validity import GUARD_FUNCTIONS, REJECTED, VERDICTS, Trace, judge
from walkerlab.system.randomness import random_stream
from walkerlab.world.compilation import assemble_model
from walkerlab.world.geometry import surface_points
from walkerlab.world.scene import ORIENTATION, POSITION, Scene, compile_scene

WALKER = (  # the champion of wl.evolve(wl.Settings().with_(generations=15, seed=1))
    "wl1 segments=4 | seg length=0.233 mass=2.368 legs length=0.277 force=13.136 "
    "| seg length=0.326 mass=1.105 legs length=0.345 force=4.177 "
    "| seg length=0.276 mass=1.965 nolegs length=0.297 force=11.404 "
    "| seg length=0.34 mass=3.33 legs length=0.295 force=18.937 | gait frequency=2.097 "
    "| step hip amplitude=0.752 phase=5.244 offset=0.51 knee amplitude=0.686 phase=3.279 offset=-0.993 stride=4.871 "
    "| step hip amplitude=0.806 phase=2.066 offset=-0.524 knee amplitude=0.893 phase=3.338 offset=0.029 stride=2.61 "
    "| step hip amplitude=0.103 phase=3.552 offset=0.458 knee amplitude=0.81 phase=2.375 offset=0.997 stride=2.792 "
    "| step hip amplitude=0.68 phase=2.08 offset=0.605 knee amplitude=0.489 phase=1.227 offset=-0.058 stride=5.596"
)


# ------------------------------------------------------------------------------------------------ simulated cheats


def scene_of(terrain=None, **changes):
    return compile_scene(WALKER, wl.Settings(terrain=terrain or wl.Terrain()).with_(**changes))


def grown(*segments, **changes):
    """Return a scene with a robot without a genome: (length, mass, leg length, force, hip, knee) of each segment."""
    still = [
        Segment(length, mass, Legs(leg, force, 0.0, 0.0, hip=Swing(0.0, 0.0, hip), knee=Swing(0.0, 0.0, knee)))
        for length, mass, leg, force, hip, knee in segments
    ]
    robot = Phenotype(tuple(still), frequency=1.0, duty=0.5)
    settings = wl.Settings().with_(**changes)
    return Scene(assemble_model(robot, settings), wl.Genome.parse(WALKER), robot, settings)


def driven(scene, law):
    """Return a copy of a scene with the servo targets ``law(time, target, rest)``; time has the shape (n_steps, 1)."""

    class Driven(Scene):
        def controls(self, n_steps):
            time = np.arange(n_steps)[:, np.newaxis] * self.settings.simulation.timestep
            return law(np.floor(50 * time + 1e-9) / 50, super().controls(n_steps), self.rest) + np.zeros(self.model.nu)

    return Driven(**vars(scene))


def placed(scene, change):
    """Return a copy of a scene in which ``change(model, data)`` changes the start."""

    class Placed(Scene):
        def place(self, data, nudge=None):
            super().place(data, nudge)
            change(self.model, data)

    return Placed(**vars(scene))


def held(scene):
    return driven(scene, lambda time, target, rest: rest + 0 * time)


def nudge(scene, *, y=0.0, yaw=0.0, x=0.0):
    return np.array([x, y, 0, 0, 0, yaw] + [0.0] * (scene.model.nv - 6))


def body(scene, name):
    """Return the index of a body's coordinates in ``qpos``, and which geoms belong to it, shape (ngeom,)."""
    number = scene.model.body(name).id
    return scene.model.jnt_qposadr[scene.model.body_jntadr[number]], scene.model.geom_bodyid == number


CROUCH = [(0.3, 4.0, 0.6, 60.0, 0.8, -1.6)] * 2
CHEATS = {}


def expect(verdict, reason):
    """Add a function that simulates a cheat to ``CHEATS``, with its verdict and a pattern of the reason."""

    def add(simulate_cheat):
        CHEATS[simulate_cheat.__name__.replace("_", " ")] = simulate_cheat, verdict, reason
        return simulate_cheat

    return add


@expect("fell", "its centre of mass was below 40% of its height at rest for")
def robot_on_stilts_that_falls_forward():
    stilts = grown(*[(0.3, 4.0, 0.8, 40.0, 0.0, 0.0)] * 2)
    return simulate_walk(
        driven(stilts, lambda time, target, rest: rest - np.minimum(time, 0.5) * np.tile([2.0, 0.0], 4))
    )


@expect("too fast", "body lengths/s; 10 body lengths/s is allowed")
def robot_on_one_pair_of_stilts_that_tips_over():
    return simulate_walk(grown((0.3, 4.0, 1.2, 40.0, 0.0, 0.0)))


@expect("too fast", "body lengths/s; 10 body lengths/s is allowed")
def robot_that_throws_itself_with_excessive_torque():
    scene = grown(*CROUCH)
    for strength in (scene.model.actuator_gainprm, scene.model.actuator_biasprm, scene.model.actuator_forcerange):
        strength *= 20
    return simulate_walk(driven(scene, lambda time, target, rest: np.where(time > 0.5, 0.0, target)))


@expect("restless", r"after 3 s without drive it still moved at \d+\.\d\d m/s; 0.05 m/s is allowed")
def robot_that_starts_with_upward_speed():
    return simulate_walk(placed(scene_of(), lambda model, data: data.qvel.__setitem__(2, 20.0)))


@expect("airborne", r"off the ground for \d\.\d\d s; 0.5 s is allowed")
def robot_without_gravity():
    return simulate_walk(scene_of(wl.Terrain(gravity=(0, 0, 0)), duration=2))


@expect("airborne", "off the ground for")
def robot_that_hops_on_the_moon():
    return simulate_walk(scene_of(wl.Terrain(gravity="moon"), forgive="too_high"))


@expect("too high", "body lengths higher than at rest; 0.5 body lengths is allowed")
def robot_that_vaults():
    return simulate_walk(driven(grown(*CROUCH), lambda time, target, rest: np.where(time > 0.5, 0.0, target)))


@expect("sunk", "m deep in the ground; 0.05 m is allowed")
def robot_on_soft_ground():
    scene = scene_of()
    scene.model.geom_solref[:] = 0.1, 1
    return simulate_walk(scene)


@expect("sunk", "m deep in the ground; 0.05 m is allowed")
def robot_that_presses_a_foot_into_the_ground():
    scene = grown(*CROUCH)
    scene.model.geom_solref[:] = 0.08, 1
    assert simulate_walk(held(scene), poses=False).verdict == "ok"
    return simulate_walk(driven(scene, lambda time, target, rest: rest * np.where(time > 0.5, 0.7, 1.0)))


@expect("bad start", r"at the start it was 0\.04\d m deep in another body; 0.001 m is allowed")
def start_in_the_ground():
    def lower(model, data):
        data.qpos[POSITION][2] -= 0.05

    return simulate_walk(placed(scene_of(), lower))


@expect("bad start", "m deep in another body")
def start_inside_an_obstacle():
    scene = scene_of(wl.Terrain(obstacle="box", obstacle_size=0.3))
    start, _ = body(scene, "obstacle1")

    def overlap(model, data):
        data.qpos[start:][POSITION][:2] = -0.2, 0.0

    return simulate_walk(placed(scene, overlap))


@expect("bad start", "m deep in another body")
def start_inside_the_sledge():
    scene = scene_of(drag_weight=20)
    start, _ = body(scene, "sledge/")

    def overlap(model, data):
        data.qpos[start] = -0.3

    return simulate_walk(placed(scene, overlap))


@expect("jittering", "a joint was driven at 15.0 Hz; 3.4 Hz is allowed")
def robot_that_jitters():
    return simulate_walk(driven(scene_of(), lambda time, target, rest: rest + 0.2 * np.sin(math.tau * 15 * time)))


@expect("unstable", r"MuJoCo gave \d warnings?")
def robot_with_unstable_servos():
    scene = scene_of()
    scene.model.dof_armature[:] = 0
    scene.model.actuator_gainprm[:, 0] *= 1e9
    scene.model.actuator_biasprm[:, 1] *= 1e9
    scene.model.actuator_forcelimited[:] = 0
    return simulate_walk(scene)


@expect("unstable", "MuJoCo gave 1 warning")
def controls_that_become_nan():
    return simulate_walk(driven(scene_of(), lambda time, target, rest: np.where(time > 1, np.nan, target)))


@expect("unstable", "MuJoCo gave 3 warnings")
def start_with_nan():
    scene = scene_of(drag_weight=2)
    return simulate_walk(scene, nudge=nudge(scene, x=math.nan))


@expect("out of arena", "m outside the arena; 0 m is allowed")
def robot_that_leaves_the_stairs_sideways():
    scene = scene_of(wl.Terrain(structure="stairs"))
    return simulate_walk(scene, nudge=nudge(scene, y=3.5, yaw=math.pi / 2))


@expect("out of arena", "m outside the arena; 0 m is allowed")
def robot_that_walks_around_the_obstacles():
    scene = scene_of(wl.Terrain(obstacle="rock"))
    return simulate_walk(scene, nudge=nudge(scene, y=2.5, yaw=math.pi / 2))


@expect("restless", "after 3 s without drive it still moved at")
def robot_that_slides_on_an_icy_slope():
    return simulate_walk(held(scene_of(wl.Terrain(structure="incline", incline=-10, texture="ice"))))


@expect("restless", r"it still moved at 0\.0\d m/s; 0.05 m/s is allowed")
def robot_that_creeps_because_of_soft_contacts():
    return simulate_walk(held(scene_of(wl.Terrain(structure="incline", incline=-5, texture="ice"))))


@expect("restless", "after 3 s without drive it still moved at")
def robot_that_is_moved_by_wind():
    return simulate_walk(held(scene_of(wl.Terrain(wind=(0, 40, 0)))))


@expect("restless", "after 3 s without drive it still moved at")
def robot_that_rides_on_an_obstacle():
    board = {"obstacle": "box", "obstacle_size": 1, "obstacle_density": 0.05}
    scene = scene_of(wl.Terrain(structure="incline", incline=-20, texture="ice", **board))
    start, board = body(scene, "obstacle1")
    scene.model.geom_priority[scene.is_robot_geom] = 2
    scene.model.geom_friction[scene.is_robot_geom] = (1, 0.01, 0.001)

    def mount(model, data):
        down = math.radians(20)
        along, up = np.array([math.cos(down), 0, -math.sin(down)]), np.array([math.sin(down), 0, math.cos(down)])
        half = model.geom_size[board][0, 0]
        data.qpos[start:][POSITION] = -0.5 * along + (half + 0.001) * up
        data.qpos[start:][ORIENTATION] = data.qpos[ORIENTATION]
        data.qpos[POSITION] += (2 * half + 0.005) * up

    return simulate_walk(placed(scene, mount))


@expect("load lost", r"the rope was stretched to \d\.\d\d times its length; 1.1 times is allowed")
def robot_whose_rope_is_cut():
    scene = scene_of(drag_weight=2)
    scene.model.tendon_limited[:] = 0
    return simulate_walk(scene)


@expect("load lost", r"the rope was stretched to \d\.\d\d times its length; 1.1 times is allowed")
def robot_with_an_elastic_rope():
    scene = scene_of(drag_weight=2)
    scene.model.tendon_solref_lim[:] = 0.2, 1
    return simulate_walk(scene)


@expect("load lost", "m ahead of the robot; 0 m is allowed")
def sledge_that_slides_ahead_downhill():
    scene = scene_of(wl.Terrain(structure="incline", incline=-10), drag_weight=2)
    _, sledge = body(scene, "sledge/")
    scene.model.geom_priority[sledge] = 2
    scene.model.geom_friction[sledge] = (0.05, 0.0005, 0.0005)
    return simulate_walk(held(scene))


@expect("load lost", "m ahead of the robot; 0 m is allowed")
def robot_that_pushes_its_sledge():
    scene = scene_of(drag_weight=2)
    return simulate_walk(scene, nudge=nudge(scene, yaw=math.pi))


@expect("load lost", "the sledge was .* m")
def sledge_that_falls_through_the_ground():
    scene = scene_of(drag_weight=2)
    _, sledge = body(scene, "sledge/")
    scene.model.geom_contype[sledge] = scene.model.geom_conaffinity[sledge] = 0
    return simulate_walk(scene)


ON_ITS_BACK = (  # walks on its back down a slope
    "wl1 segments=1 | seg length=0.4 mass=10.589 legs length=0.6 force=18.393 | gait frequency=1.532 "
    "| step hip amplitude=0.659 phase=3.987 offset=-0.264 knee amplitude=0.999 phase=6.02 offset=-1.163 stride=2.939"
)
FLAILING = (  # lies on its belly or rolls, and trembles
    "wl1 segments=2 | seg length=0.3 mass=2.5 legs length=0.1 force=15 | seg length=0.3 mass=2.5 legs length=0.1 "
    "force=15 | gait frequency=2.2 "
    "| step hip amplitude=1 phase=0 offset=0 knee amplitude=1 phase=0 offset=0 stride=3.14 "
    "| step hip amplitude=1 phase=0 offset=0 knee amplitude=1 phase=0 offset=0 stride=3.14"
)


def slope_of(incline, **changes):
    return wl.Settings().with_(structure="incline", incline=incline, **changes)


@expect("overturned", r"for \d\.\d\d s in total it was on its back; 0.5 s is allowed")
def robot_that_walks_on_its_back_down_a_slope():
    return wl.simulate(ON_ITS_BACK, slope_of(-20))


@expect("overturned", "s in total it was on its back")
def robot_that_rolls():
    return wl.simulate(FLAILING, wl.Settings())


@expect("carried", r"it moved at \d\.\d\d m/s, and on level ground in still air it moved at -?0\.0\d m/s")
def robot_that_trembles_down_an_icy_slope():
    return wl.simulate(FLAILING, slope_of(-5, texture="ice", forgive="overturned"))


@expect("carried", "on level ground in still air it moved at")
def walker_that_mostly_slides_down_an_icy_slope():
    return wl.simulate(WALKER, slope_of(-3, texture="ice"))


@expect("carried", "on level ground in still air it moved at")
def robot_that_trembles_where_gravity_is_tilted():
    return wl.simulate(FLAILING, wl.Settings().with_(gravity=(5, 0, -9.81), forgive="overturned"))


@expect("carried", "on level ground in still air it moved at")
def robot_that_the_wind_blows_over_ice():
    return wl.simulate(FLAILING, wl.Settings().with_(texture="ice", wind=(15, 0, 0), forgive="overturned"))


@pytest.mark.parametrize("cheat", CHEATS)
def test_each_cheat_gets_its_verdict_with_a_reason(cheat, capfd):
    simulate_cheat, verdict, reason = CHEATS[cheat]
    rollout = simulate_cheat()
    assert rollout.verdict == verdict, rollout.reason
    assert re.search(reason, rollout.reason), rollout.reason
    assert score(rollout, wl.Fitness.distance) == -math.inf
    assert "".join(capfd.readouterr()) == ""


def test_every_verdict_has_a_cheat():
    assert {verdict for _, verdict, _ in CHEATS.values()} == set(VERDICTS) - {"ok", "fragile", REJECTED}


# ------------------------------------------------------------------------------- walks that count but score little


def test_walking_in_circles_gives_no_distance():
    scene = scene_of(duration=60)  # about one lap
    left = np.array([scene.model.actuator(i).name.startswith("walker/left") for i in range(scene.model.nu)])
    rollout = simulate_walk(driven(scene, lambda time, target, rest: np.where(left, target, rest)), poses=False)
    path = np.linalg.norm(np.diff(rollout.com[:, :2], axis=0), axis=1).sum()
    assert rollout.verdict == "ok"
    assert path > 8
    assert abs(distance(rollout)) < 0.1 * path


def test_walking_backward_gives_a_negative_distance():
    scene = scene_of()
    forward, backward = simulate_walk(scene), simulate_walk(scene, nudge=nudge(scene, yaw=math.pi))
    assert backward.verdict == "ok"
    assert distance(backward) == pytest.approx(-distance(forward), rel=0.05)


def test_stretching_a_leg_forward_gives_no_distance():
    scene = grown((0.2, 0.2, 0.8, 5.0, -1.4, 0.0), (0.4, 6.0, 0.3, 20.0, 0.3, 0.0), (0.4, 6.0, 0.3, 20.0, 0.0, 0.0))
    arms = np.array([1, 0, 1, 0] + [0] * 8)
    rollout = simulate_walk(
        driven(scene, lambda time, target, rest: rest - arms * np.minimum(time, 3.4))
    )  # raises the front legs
    first, last = (max(skin[:, 0].max() for skin, _ in surface_points(scene, pose)) for pose in rollout.poses[[0, -1]])
    assert rollout.verdict == "ok", rollout.reason
    assert last - first > 0.3
    assert abs(distance(rollout)) < 0.1


def test_standing_still_gives_no_distance_on_any_slope():
    for incline in (-30, -15, 0, 15, 30):
        rollout = simulate_walk(held(scene_of(wl.Terrain(structure="incline", incline=incline))), poses=False)
        assert rollout.verdict == "ok", rollout.reason
        assert distance(rollout) < validity.MAX_REST_SPEED * rollout.time[-1]


TOPPLING = (  # balances on one pair of legs for a second
    "wl1 segments=1 | seg length=0.456 mass=10.486 legs length=0.553 force=11.654 | gait frequency=0.878 "
    "| step hip amplitude=0 phase=0 offset=-0.52 knee amplitude=0 phase=0 offset=0.524 stride=0"
)


def test_a_robot_that_balances_topples_before_its_walk():
    rollout = wl.simulate(TOPPLING, wl.Settings(), poses=False)
    assert rollout.settled > 1
    assert abs(distance(rollout)) < 0.05


def test_standing_on_four_legs_settles_soon():
    scene = grown(*CROUCH)
    assert simulate_walk(held(scene), poses=False).settled <= 1


@pytest.mark.parametrize("duration", [1, 2, 3.3])
def test_the_greatest_gait_frequency_is_not_jittering_for_any_duration(duration):
    for number in range(10):
        values = wl.Genome.random(wl.Robot(), rng=random_stream(9, "check", number)).values.copy()
        values[1] = FREQUENCY_RANGE[1]
        settings = wl.Settings().with_(duration=duration)
        assert wl.simulate(wl.Genome(values), settings, poses=False).verdict != "jittering"


WORLDS = {
    **{f"{structure.name} ground": {"structure": structure, "step_height": 0.05} for structure in Structure},
    **{texture.name: {"texture": texture} for texture in Texture},
    **{f"{kind.name} obstacles": {"obstacle": kind, "obstacle_density": 1} for kind in Obstacle if kind},
    "texture pieces": {"texture": "gravel", "texture_density": 0.2, "texture_size": 0.1},
    "mars": {"gravity": "mars", "duration": 3},  # it falls later
    "wind": {"wind": (-5, 3, 0)},
    "a steep descent": {"structure": "incline", "incline": -20},
    "a tail wind": {"wind": (10, 0, 0)},
    "tilted gravity": {"gravity": (1, 0, -9.81)},
    "with a pack": {"carry_weight": 3},
    "with a sledge": {"drag_weight": 2},
    "with both": {"carry_weight": 2, "drag_weight": 2},
}


@pytest.mark.parametrize("world", WORLDS)
def test_an_ordinary_walk_counts_in_every_world_and_with_every_load(world):
    rollout = wl.simulate(WALKER, wl.Settings().with_(**WORLDS[world]), poses=False)
    assert (rollout.verdict, rollout.reason) == ("ok", "")


# ------------------------------------------------------------------------------------------------ made-up traces

TIME = np.arange(8 * 64 + 1) / 64  # s; most values here are exact in binary
SETTINGS = wl.Settings(terrain=wl.Terrain(obstacle="ball"), robot=wl.Robot(drag_weight=1))
ROBOT = Phenotype((Segment(0.5, 4.0, legs=None),), frequency=1.0, duty=0.5)
PLAIN = Trace(  # at 0.5 m/s, with a sledge 1 m behind
    time=TIME,
    com=np.stack([TIME / 2, 0 * TIME, 0 * TIME + 0.25], axis=1),
    up=np.tile([0.0, 0.0, 1.0], (len(TIME), 1)),
    on_ground=TIME >= 0,
    sink=0 * TIME,
    work=TIME,
    load=np.stack([TIME / 2 - 1, 0 * TIME, 0 * TIME], axis=1),
    rope=0 * TIME + 0.99,
    phenotype=ROBOT,
    settled=3.0,
    creep=0.0,
    overlap=0.0,
    drive=1.0,
    warnings=0,
    level_speed=math.nan,
)


def peak(name, value, axis=None, when=2.0):
    """Return changes in which one quantity of the plain trace rises to a value within 1 s and returns."""
    record = getattr(PLAIN, name).copy()
    share = np.maximum(0.0, 1 - np.abs(TIME - when))
    column = record if axis is None else record[:, axis]
    column[:] = column * (1 - share) + value * share
    return {name: record}


def lowered(height, seconds):
    """Return changes that lower the centre of mass to just above the limit, and to a height from 5 s on for a time."""
    sinking = np.maximum(0.25 - 0.15 * np.maximum(0.0, TIME - 4), 0.25 * validity.MIN_HEIGHT + 1e-9)
    down = (TIME >= 5) & (seconds + 5 > TIME)
    return {"com": np.stack([TIME / 2, 0 * TIME, np.where(down, height, sinking)], axis=1)}


def turned(seconds):
    """Return changes that turn the robot on its back twice, for a time in total."""
    first = (TIME > 1) & (TIME <= 1.25)
    again = (TIME > 5) & (5 + seconds - 0.25 >= TIME)
    return {"up": np.where((first | again)[:, np.newaxis], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0])}


LIMIT_CASES = {
    "bad start": (Guard.bad_start, lambda value: {"overlap": value}, validity.MAX_START_OVERLAP),
    "restless": (Guard.restless, lambda value: {"creep": value}, validity.MAX_REST_SPEED),
    "jittering": (Guard.jittering, lambda value: {"drive": value}, validity.MAX_DRIVE_FREQUENCY + 1 / 8),
    "too fast": (Guard.too_fast, lambda value: {"com": PLAIN.com * [value, 1, 1]}, 10.0),  # 1 body length/s or more
    "too high": (Guard.too_high, lambda value: peak("com", 0.25 + 0.5 * value, 2), validity.MAX_RISE),
    "sunk": (Guard.sunk, lambda value: peak("sink", value), validity.MAX_SINK),
    "airborne": (Guard.airborne, lambda value: {"on_ground": (TIME < 2) | (value + 2 <= TIME)}, 0.5),
    "fell": (Guard.fell, lambda value: lowered(0.25 * validity.MIN_HEIGHT - 1e-9, value), validity.MAX_TIME_DOWN),
    "out of arena to the left": (Guard.out_of_arena, lambda value: peak("com", value, 1), 3.0),
    "out of arena to the right": (Guard.out_of_arena, lambda value: peak("com", -value, 1), 3.0),
    "load lost by the rope": (Guard.load_lost, lambda value: peak("rope", value), validity.MAX_ROPE_STRETCH),
    "load lost ahead": (Guard.load_lost, lambda value: peak("load", 1.0 + value, 0), validity.MAX_LOAD_LEAD),
    "load lost below": (Guard.load_lost, lambda value: peak("load", -value, 2), validity.MAX_SLEDGE_SINK),
    "overturned": (Guard.overturned, turned, validity.MAX_OVERTURNED_TIME),
    "carried": (Guard.carried, lambda value: {"level_speed": -value}, -validity.MIN_LEVEL_SHARE * 0.5),
}
SMALL_EXCESS = 1 / 64
DURATION_GUARDS = (Guard.airborne, Guard.fell, Guard.overturned)


def violation(guard):
    """Return changes of the plain trace that violate a guard."""
    changes, allowed = next((changes, allowed) for one, changes, allowed in LIMIT_CASES.values() if one == guard)
    return changes(allowed + SMALL_EXCESS)


def with_forgiven(*forgiven):
    """Return the settings with some guards turned off."""
    return SETTINGS.with_(forgive=list(forgiven) or "none")


def test_the_plain_trace_counts():
    assert judge(PLAIN, SETTINGS) == ("ok", "")


@pytest.mark.parametrize("case", LIMIT_CASES)
def test_a_verdict_changes_exactly_at_the_limit(case):
    guard, changes, allowed = LIMIT_CASES[case]
    beyond = judge(replace(PLAIN, **changes(allowed + (SMALL_EXCESS if guard in DURATION_GUARDS else 1e-9))), SETTINGS)
    assert judge(replace(PLAIN, **changes(allowed)), SETTINGS) == ("ok", "")
    assert beyond[0] == guard.name.replace("_", " ")


def test_a_robot_has_fallen_only_if_it_is_too_low_for_too_long():
    assert judge(replace(PLAIN, **lowered(0.25 * validity.MIN_HEIGHT + 1e-9, 9.0)), SETTINGS) == ("ok", "")
    assert judge(replace(PLAIN, **lowered(0.05, validity.MAX_TIME_DOWN)), SETTINGS) == ("ok", ""), "it gets up"
    assert judge(replace(PLAIN, **lowered(0.05, 9.0)), SETTINGS)[0] == "fell", "it stays down"


@pytest.mark.parametrize("incline", [-30, -10, 10, 30])
def test_a_fall_on_a_slope_is_judged_as_on_the_level(incline):
    slope = math.radians(incline)
    sloping = wl.Settings(terrain=wl.Terrain(structure="incline", incline=incline))
    turn = np.array([[math.cos(slope), 0, math.sin(slope)], [0, 1, 0], [-math.sin(slope), 0, math.cos(slope)]])
    for seconds in (validity.MAX_TIME_DOWN, validity.MAX_TIME_DOWN + SMALL_EXCESS, 9.0):
        for height in (0.25 * validity.MIN_HEIGHT - 1e-9, 0.25 * validity.MIN_HEIGHT + 1e-9):
            changes = lowered(height, seconds)
            level = replace(PLAIN, **changes, load=np.empty((0, 3)))
            tilted = replace(level, com=level.com @ turn, up=level.up @ turn)
            assert judge(tilted, sloping)[0] == judge(level, wl.Settings())[0]


@pytest.mark.parametrize("width", [0.02, 0.2, 1.0])
def test_a_fall_is_found_in_a_trench(width):
    gaps = wl.Settings(terrain=wl.Terrain(structure="gaps", gap_width=width, gap_distance=0.2))
    assert judge(replace(PLAIN, **lowered(0.05, 9.0)), gaps)[0] == "fell"
    assert judge(replace(PLAIN, **lowered(-0.3, 9.0)), gaps.with_(forgive="too_fast"))[0] == "fell", "in the trench"


@pytest.mark.parametrize("case", LIMIT_CASES)
def test_a_reason_names_the_time_the_value_and_the_limit(case):
    guard, changes, allowed = LIMIT_CASES[case]
    _, reason = judge(replace(PLAIN, **changes(allowed + SMALL_EXCESS)), SETTINGS)
    moment = {
        Guard.bad_start: "at the start ",
        Guard.restless: "after 3 s ",
        Guard.jittering: "a joint was driven at ",
        Guard.airborne: "from 2.00 s on ",
        Guard.fell: "from 5.00 s on ",
        Guard.overturned: "for ",
        Guard.carried: "it moved at ",
    }.get(guard, r"at \d\.\d\d s ")
    limit = r"\d+(\.\d+)? (m|m/s|s|Hz|times|body lengths|body lengths/s) (is allowed|or more is required)"
    assert re.fullmatch(rf"{moment}.*\d.*; {limit}", reason), reason


@pytest.mark.parametrize("guard", GUARD_FUNCTIONS)
def test_forgive_turns_off_one_guard_by_name_code_or_member(guard):
    trace = replace(PLAIN, **violation(guard))
    others = [other for other in GUARD_FUNCTIONS if other != guard]
    for forgiven in (guard, guard.name, int(guard)):
        assert judge(trace, SETTINGS.with_(forgive=forgiven)) == ("ok", "")
        assert judge(trace, with_forgiven(others[0], forgiven)) == ("ok", "")
    assert judge(trace, with_forgiven(*others)) == judge(trace, SETTINGS)


@pytest.mark.parametrize("forgiven", [(), tuple(GUARD_FUNCTIONS)], ids=["strict", "all forgiven"])
def test_a_diverged_simulation_is_never_forgiven(forgiven):
    settings = with_forgiven(*forgiven)
    assert judge(replace(PLAIN, warnings=1), settings) == ("unstable", "MuJoCo gave 1 warning")
    assert judge(replace(PLAIN, warnings=2), settings) == ("unstable", "MuJoCo gave 2 warnings")
    for name, number in (("com", math.nan), ("com", math.inf), ("load", math.nan)):
        record = getattr(PLAIN, name).copy()
        record[128:, 1] = number
        verdict = judge(replace(PLAIN, **{name: record}), settings)
        assert verdict == ("unstable", "at 2.00 s a value was not finite")


def test_the_first_violated_guard_gives_the_verdict():
    """The guards are turned off one by one for a walk that violates all of them."""
    all_violations = PLAIN
    for guard in GUARD_FUNCTIONS:
        for name, change in violation(guard).items():
            plain = getattr(PLAIN, name)
            so_far = getattr(all_violations, name)
            all_violations = replace(all_violations, **{name: np.where(change == plain, so_far, change)[()]})
    verdicts = [
        judge(all_violations, with_forgiven(*list(GUARD_FUNCTIONS)[:count]))[0]
        for count in range(len(GUARD_FUNCTIONS) + 1)
    ]
    assert verdicts == [*(guard.name.replace("_", " ") for guard in GUARD_FUNCTIONS), "ok"]
    assert judge(replace(all_violations, warnings=1), SETTINGS)[0] == "unstable"


def test_guards_and_verdicts_are_in_the_order_of_the_codes():
    of_one_walk = [guard for guard in Guard if guard not in (Guard.none, Guard.fragile)]
    assert list(GUARD_FUNCTIONS) == of_one_walk
    names = [guard.name.replace("_", " ") for guard in of_one_walk]
    assert list(VERDICTS) == ["ok", "unstable", *names, "fragile", REJECTED]
    assert all(sentence[0].isupper() and sentence.endswith(".") for sentence in VERDICTS.values())
