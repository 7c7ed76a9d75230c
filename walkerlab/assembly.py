"""The compiled world: composer builds each plan once, and every individual's numbers are written into it.

    body plan, loads, terrain  --composer-->  MJCF  --once-->  MjSpec, its pieces strewn
    phenotype                  --numbers--->  the robot alone, compiled  --its rows-->  a copy of the compiled world

So nothing of the ground is compiled again for each robot, however much lies on it.
"""

import copy
import math
import threading
from functools import lru_cache

import mujoco
import numpy as np

from walkerlab.entities import Pack, Sledge, generate_robot, generate_terrain, tie
from walkerlab.entities.walker import SIDES, BodyPlan
from walkerlab.layout import dome, lay_out
from walkerlab.phenotype import Legs, Phenotype, Segment
from walkerlab.settings import Robot, Settings, Terrain
from walkerlab.textures import MATERIALS

BODY_DENSITY = 600.0  # kg/m³ of a trunk: mass and length together give its girth
SPLAY = math.radians(36)  # of the thighs outward: a stance wide enough not to topple
LEG_SHARE = 0.3  # of a segment's mass, that is its legs'
THIGH_SHARE = 0.6  # of a leg's mass
LEG_GIRTH = 0.07  # radius of a thigh over the length of the leg
SERVO_BAND = 0.3  # rad of error at which a servo gives its full torque
SPINE_STIFFNESS = 30.0  # N·m/rad for each kg·m of mass times length behind the joint
ROTOR = 0.001  # kg·m² of rotor inertia for each N·m of torque: with the band, a servo of 9 Hz whatever it turns
ROPE_LENGTH = 0.6  # m of rope besides the length of a leg, as high as which it may be tied

KEPT = 64  # plans that a worker remembers; with thousands of pieces each takes some megabytes

COM, GROUND, DEPTH, ANYTHING, ITSELF, LOAD, ROPE = slice(0, 3), 3, 4, 5, 6, slice(7, 10), 10
"""Where each sensor's numbers are, in the order of ``_world_xml``; the last two are there with a sledge only."""


def describe(phenotype: Phenotype, settings: Settings, *, scenery: bool) -> mujoco.MjSpec:
    """Describe one world, all numbers written; the description is good until this thread's next."""
    spec = _world_spec(*_plan(phenotype, settings.robot), settings.terrain, scenery, threading.get_ident())
    _write_measures(spec, phenotype, settings.robot)
    spec.option.timestep = settings.simulation.timestep
    return spec


def assemble(phenotype: Phenotype, settings: Settings) -> mujoco.MjModel:
    """Compile one world: what ``describe`` without scenery would compile to, but quicker."""
    plan, robot = _plan(phenotype, settings.robot), settings.robot
    alone = _world_spec(*plan, Terrain(), False, threading.get_ident())
    _write_measures(alone, phenotype, robot)
    model = copy.copy(_world_model(*plan, settings.terrain))
    model.opt.timestep = settings.simulation.timestep
    _transplant(alone.compile(), _world_model(*plan, Terrain()), model)
    return model


def _plan(phenotype: Phenotype, robot: Robot) -> tuple[BodyPlan, float, float]:
    return phenotype.plan, robot.carry_weight, robot.drag_weight


# ------------------------------------------------------------------------------------------------ body plans


@lru_cache(maxsize=KEPT)
def _world_xml(plan: BodyPlan, carry_weight: float, drag_weight: float, terrain: Terrain, scenery: bool) -> str:
    """Have composer build one body plan with its loads on one ground, in nominal measures."""
    walker, sledge = generate_robot(plan), Sledge(drag_weight) if drag_weight else None
    if carry_weight:
        walker.attach(Pack(carry_weight), walker.back)
    ground = generate_terrain(terrain, walker, *([sledge] if sledge else []), scenery=scenery)
    root = ground.mjcf_model
    root.option.integrator = "implicitfast"
    root.option.flag.autoreset = "disable"  # a world that blows up must not start anew unseen
    sense, body = root.sensor.add, walker.root_body
    sense("subtreecom", name="com", body=body)
    sense("contact", name="ground", subtree1=body, body2="world", data="found dist", num=1, reduce="mindist")
    sense("contact", name="anything", subtree1=body, data="found", num=1)
    sense("contact", name="itself", subtree1=body, subtree2=body, data="found", num=1)
    if sledge:
        tie(root, walker.hitch, sledge.ring)
        sense("framepos", name="load", objtype="xbody", objname=sledge.root_body)
        sense("tendonpos", name="rope", tendon="rope")
    return root.to_xml_string(zero_threshold=1e-15)  # of numbers that are next to nothing, MuJoCo's reader makes errors


@lru_cache(maxsize=KEPT)
def _world_spec(
    plan: BodyPlan, carry_weight: float, drag_weight: float, terrain: Terrain, scenery: bool, thread: int
) -> mujoco.MjSpec:
    """Return a thread's own spec of a world, into which every individual's measures are written anew."""
    assert thread == threading.get_ident()
    return _nominal_spec(plan, carry_weight, drag_weight, terrain, scenery)


def _nominal_spec(
    plan: BodyPlan, carry_weight: float, drag_weight: float, terrain: Terrain, scenery: bool
) -> mujoco.MjSpec:
    spec = mujoco.MjSpec.from_string(_world_xml(plan, carry_weight, drag_weight, terrain, scenery))
    _strew_pieces(spec, terrain)
    return spec


def _strew_pieces(spec: mujoco.MjSpec, terrain: Terrain) -> None:
    """Set the pieces of a texture into the ground: domes, each the tip of a ball whose rest is below."""
    layout, material = lay_out(terrain), MATERIALS[terrain.texture]
    radius, depth = dome(terrain)
    shades = np.outer(1 + 0.15 * np.sin(2.4 * np.arange(len(layout.pieces))), material.piece).clip(0, 1)
    for middle, shade in zip(layout.pieces - depth * layout.normals, shades, strict=True):
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0, 0], pos=middle, rgba=[*shade, 1],
            friction=material.friction(), priority=1, condim=4,
        )  # fmt: skip


def _write_measures(spec: mujoco.MjSpec, phenotype: Phenotype, robot: Robot) -> None:
    """Write one individual's numbers into the spec of its body plan: all of them, every time."""
    behind = 0.0
    for number, segment in reversed(list(enumerate(phenotype.segments, start=1))):
        behind += segment.mass
        _write_segment(spec, number, segment, phenotype, behind)
        if segment.legs:
            _write_legs(spec, number, segment, segment.legs)
    last, middle = phenotype.segments[-1], phenotype.segments[(1 + len(phenotype.segments)) // 2 - 1]
    spec.site("walker/hitch").pos = [-last.length, 0, 0]
    spec.site("walker/back").pos = [-middle.length / 2, 0, _girth(middle)]
    if robot.carry_weight:
        spec.body("walker/pack/").pos = spec.site("walker/back").pos
    if robot.drag_weight:
        longest = max(segment.legs.length for segment in phenotype.segments if segment.legs)
        spec.tendon("rope").range = [0, ROPE_LENGTH + longest]


def _girth(segment: Segment) -> float:
    """The radius [m] that gives the trunk its density, within what its length can bear."""
    mass = segment.mass * (1 - LEG_SHARE if segment.legs else 1)
    return float(np.clip(math.sqrt(mass / (math.pi * BODY_DENSITY * segment.length)), 0.02, 0.35 * segment.length))


def _write_segment(spec: mujoco.MjSpec, number: int, segment: Segment, phenotype: Phenotype, behind: float) -> None:
    girth = _girth(segment)
    trunk = spec.geom(f"walker/trunk{number}")
    trunk.size[0] = girth
    trunk.fromto = [-girth, 0, 0, -(segment.length - girth), 0, 0]
    trunk.mass = segment.mass * (1 - LEG_SHARE if segment.legs else 1)
    if number > 1:
        spec.body(f"walker/seg{number}").pos = [-phenotype.segments[number - 2].length, 0, 0]
        stiffness = SPINE_STIFFNESS * behind * segment.length
        for axis in ("pitch", "yaw"):
            joint = spec.joint(f"walker/{axis}{number}")
            joint.stiffness[0] = stiffness
            joint.damping[0] = 0.05 * stiffness


def _write_legs(spec: mujoco.MjSpec, number: int, segment: Segment, legs: Legs) -> None:
    thick, half = LEG_GIRTH * legs.length, legs.length / 2
    mass = segment.mass * LEG_SHARE / 2
    for side, left in zip(SIDES, (1, -1), strict=True):
        hip = [-segment.length / 2, left * (_girth(segment) + thick), 0]
        knee = [0, left * half * math.sin(SPLAY), -half * math.cos(SPLAY)]
        foot = [0, 0, -half]
        for bone, joint, start, end, radius, share in (
            ("thigh", "hip", hip, knee, thick, THIGH_SHARE),
            ("shank", "knee", knee, foot, 0.8 * thick, 1 - THIGH_SHARE),
        ):
            spec.body(f"walker/{side}_{bone}{number}").pos = start
            geom = spec.geom(f"walker/{side}_{bone}{number}")
            geom.size[0] = radius
            geom.fromto = [0, 0, 0, *end]
            geom.mass = mass * share
            spec.joint(f"walker/{side}_{joint}{number}").armature = ROTOR * legs.force
            servo = spec.actuator(f"walker/{side}_{joint}{number}")
            servo.gainprm[0] = legs.force / SERVO_BAND
            servo.biasprm[1] = -legs.force / SERVO_BAND
            servo.forcerange = [-legs.force, legs.force]


# ------------------------------------------------------------------------------------------------------ transplanting


@lru_cache(maxsize=KEPT)
def _world_model(plan: BodyPlan, carry_weight: float, drag_weight: float, terrain: Terrain) -> mujoco.MjModel:
    """Compile one world in nominal measures, into copies of which those of individuals are written."""
    return _nominal_spec(plan, carry_weight, drag_weight, terrain, False).compile()


KINDS = ("body", "jnt", "dof", "geom", "site", "actuator", "tendon")
"""Of what a model has rows, as its arrays are called: ``body_mass``, ``dof_armature``."""

FLAGS = ("sameframe", "simple", "simplenum")
"""Whole numbers that follow from measures: which frames coincide, and which inertias are diagonal."""


@lru_cache(maxsize=1)
def _measured() -> tuple[tuple[str, str], ...]:
    """Name every array of a model that holds measures of something, or follows from them, and of what kind."""
    model = mujoco.MjSpec().compile()
    arrays = ((name, *name.partition("_")[::2], getattr(model, name)) for name in dir(model))
    return tuple((name, kind) for name, kind, of, it in arrays if kind in KINDS and (of in FLAGS or _is_real(it)))


def _is_real(array: object) -> bool:
    return isinstance(array, np.ndarray) and array.dtype.kind == "f"


def _transplant(robot: mujoco.MjModel, nominal: mujoco.MjModel, world: mujoco.MjModel) -> None:
    """Write the rows of a robot that was compiled alone, on a bare plane, into a world that holds one of its kind.

    A robot comes first in both: after what is of the world itself, and before what lies about in it.

    Args:
        robot: alone, in the measures of an individual.
        nominal: alone, in nominal measures.
        world: in nominal measures; changed.
    """
    here = {"body": 1, "geom": int(robot.body_geomnum[0])}
    there = {"body": 1, "geom": int(world.body_geomnum[0])}
    for name, kind in _measured():
        rows = getattr(robot, name)[here.get(kind, 0) :]
        start = there.get(kind, 0)
        getattr(world, name)[start : start + len(rows)] = rows
    boxes = robot.bvh_aabb[robot.body_bvhadr[1] :]  # by which contacts are looked for
    start = world.body_bvhadr[1]
    world.bvh_aabb[start : start + len(boxes)] = boxes
    others = world.body_subtreemass[0] - nominal.body_subtreemass[0]
    world.body_subtreemass[0] = robot.body_subtreemass[0] + others
    share = robot.nv / world.nv
    others = world.stat.meaninertia - nominal.stat.meaninertia * share
    world.stat.meaninertia = robot.stat.meaninertia * share + others
