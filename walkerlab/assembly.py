"""The described world: composer builds each body plan once, and every individual's numbers are written into it."""

import math
import threading
from collections.abc import Callable
from functools import lru_cache, wraps
from typing import ParamSpec, TypeVar

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
    spec = _world_spec(*plan_of(phenotype, settings.robot), settings.terrain, scenery)
    write_measures(spec, phenotype, settings.robot)
    spec.option.timestep = settings.simulation.timestep
    return spec


def plan_of(phenotype: Phenotype, robot: Robot) -> tuple[BodyPlan, float, float]:
    """What composer builds anew: the body plan, and the two loads [kg]."""
    return phenotype.plan, robot.carry_weight, robot.drag_weight


# ------------------------------------------------------------------------------------------------ body plans

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def each_thread_its_own(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Remember what a function has made, for every thread apart: others must not write into it."""
    own = threading.local()

    @wraps(function)
    def remembered(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        if not hasattr(own, "made"):
            own.made = lru_cache(maxsize=KEPT)(function)
        return own.made(*args, **kwargs)

    return remembered


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
    if not (sledge or len(lay_out(terrain).obstacles)):
        root.option.flag.island = "disable"  # a robot alone is one, and need not be searched for others
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


def nominal(
    plan: BodyPlan, carry_weight: float, drag_weight: float, terrain: Terrain, scenery: bool = False
) -> mujoco.MjSpec:
    """Describe one world in nominal measures."""
    spec = mujoco.MjSpec.from_string(_world_xml(plan, carry_weight, drag_weight, terrain, scenery))
    _strew_pieces(spec, terrain)
    return spec


_world_spec = each_thread_its_own(nominal)
"""One world, into whose description every individual's measures are written in its turn."""


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


def write_measures(spec: mujoco.MjSpec, phenotype: Phenotype, robot: Robot) -> None:
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
