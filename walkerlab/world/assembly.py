"""The MuJoCo specification of a world: composer builds each body plan once, and each individual's sizes are written in.

Building a world with composer takes about 20 ms, writing an individual's sizes and compiling it 1 ms.
"""

import math
import threading
from collections.abc import Callable
from functools import lru_cache, wraps
from typing import ParamSpec, TypeVar

import mujoco
import numpy as np

from walkerlab.genome.phenotype import Legs, Phenotype, Segment
from walkerlab.settings.choices import Recording
from walkerlab.settings.proportions import (
    SHANK_RADIUS_RATIO,
    compute_legs_mass,
    compute_thigh_radius,
    compute_thigh_share,
    compute_trunk_radius,
)
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import Terrain
from walkerlab.world.entities import Ground, Pack, Sledge, add_rope, generate_robot, generate_terrain
from walkerlab.world.entities.walker import SIDES, BodyPlan, list_legs
from walkerlab.world.materials import MATERIALS
from walkerlab.world.placement import compute_layout, dome_sphere

SPLAY_ANGLE = math.radians(36)  # outward tilt of the thighs, so that the stance is wide enough not to topple
SERVO_BAND = 0.3  # rad; error at which a servo reaches its full torque
SPINE_STIFFNESS = 30.0  # N·m/rad per kg·m of mass behind the joint times segment length
SPINE_DAMPING = 0.05  # s, damping over stiffness
ROTOR_INERTIA = 0.001  # kg·m² per N·m of torque; with SERVO_BAND this gives a servo of 9 Hz, whatever its load
ROPE_LENGTH = 0.6  # m, in addition to the length of a leg, the greatest height of the hitch

MAX_CACHED_WORLDS = 64  # per thread; with thousands of texture pieces each takes some megabytes

NET_FORCE = 3  # reduction of a contact sensor: the sum of all contacts, in the frame of the world
ROBOT_BODY = 1  # MuJoCo's index of the robot's root body; 0 is the world


class Sensor:
    """Columns of ``mjData.sensordata``, in the order in which ``_world_xml`` adds the sensors."""

    COM = slice(0, 3)  # centre of mass of the robot [m]
    GROUND_CONTACT = 3  # number of contacts between the robot and the ground
    GROUND_DISTANCE = 4  # least distance of these contacts [m]; negative is penetration
    ANY_CONTACT = 5  # number of contacts of the robot
    SELF_CONTACT = 6  # number of contacts of the robot with itself
    UP = slice(7, 10)  # unit vector that points up from the back of the middle segment
    SLEDGE = slice(10, 13)  # position of the sledge [m]; only if there is one
    ROPE = 13  # distance between the ends of the rope [m]; only if there is one
    # If contact forces are recorded, the force of each leg on the ground [N] follows, three numbers for each leg.


def describe_world(phenotype: Phenotype, settings: Settings, *, scenery: bool) -> mujoco.MjSpec:
    """Return the specification of an individual's world; it is valid until the next call in the same thread."""
    arguments = composer_arguments(phenotype, settings.robot)
    spec = _cached_spec(*arguments, settings.terrain, scenery, measures_forces(settings))
    write_individual(spec, phenotype, settings.robot)
    spec.option.timestep = settings.simulation.timestep
    return spec


def measures_forces(settings: Settings) -> bool:
    """Return whether worlds have sensors of the contact forces."""
    record = settings.simulation.record
    return Recording.contact_forces in (record if isinstance(record, tuple) else (record,))


def composer_arguments(phenotype: Phenotype, robot: Robot) -> tuple[BodyPlan, float, float]:
    """Return what composer builds a robot from: its body plan, carried weight [kg] and dragged weight [kg]."""
    return phenotype.plan, robot.carry_weight, robot.drag_weight


# ------------------------------------------------------------------------------------------------ body plans

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def cache_per_thread(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Cache the results of a function separately for each thread, because callers write into them."""
    caches = threading.local()

    @wraps(function)
    def cached(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        if not hasattr(caches, "function"):
            caches.function = lru_cache(maxsize=MAX_CACHED_WORLDS)(function)
        return caches.function(*args, **kwargs)

    return cached


@lru_cache(maxsize=MAX_CACHED_WORLDS)
def _world_xml(plan: BodyPlan, carry_weight: float, drag_weight: float, terrain: Terrain, scenery: bool) -> str:
    """Build a body plan with its loads on a terrain with composer, with nominal sizes, and return it as MJCF."""
    ground = build_ground(plan, carry_weight, drag_weight, terrain, scenery)
    return ground.mjcf_model.to_xml_string(zero_threshold=1e-15)  # MuJoCo fails to parse subnormal numbers


def build_ground(plan: BodyPlan, carry_weight: float, drag_weight: float, terrain: Terrain, scenery: bool) -> Ground:
    """Build a body plan with its loads on a terrain with composer, with nominal sizes and without texture pieces."""
    walker = generate_robot(plan)
    sledge = Sledge(drag_weight) if drag_weight else None
    if carry_weight:
        walker.attach(Pack(carry_weight), walker.back)
    ground = generate_terrain(terrain, walker, *([sledge] if sledge else []), scenery=scenery)
    root = ground.mjcf_model
    root.option.integrator = "implicitfast"
    root.option.flag.autoreset = "disable"  # otherwise MuJoCo silently resets a simulation that diverges
    if not (sledge or len(compute_layout(terrain).obstacles)):
        root.option.flag.island = "disable"  # a robot alone is one island; searching for others takes time
        root.option.flag.sleep = "disable"  # only obstacles sleep
    body = walker.root_body
    add_sensor = root.sensor.add
    add_sensor("subtreecom", name="com", body=body)
    add_sensor("contact", name="ground", subtree1=body, body2="world", data="found dist", num=1, reduce="mindist")
    add_sensor("contact", name="anything", subtree1=body, data="found", num=1)
    add_sensor("contact", name="itself", subtree1=body, subtree2=body, data="found", num=1)
    add_sensor("framezaxis", name="up", objtype="site", objname=walker.back)
    if sledge:
        add_rope(root, walker.hitch, sledge.ring)
        add_sensor("framepos", name="load", objtype="xbody", objname=sledge.root_body)
        add_sensor("tendonpos", name="rope", tendon="rope")
    return ground


def nominal_spec(
    plan: BodyPlan,
    carry_weight: float,
    drag_weight: float,
    terrain: Terrain,
    scenery: bool = False,
    forces: bool = False,
) -> mujoco.MjSpec:
    """Return a new specification of a world, with nominal sizes and, on request, sensors of the contact forces."""
    spec = mujoco.MjSpec.from_string(_world_xml(plan, carry_weight, drag_weight, terrain, scenery))
    _add_pieces(spec, terrain)
    if forces:
        _add_force_sensors(spec, plan)
    return spec


_cached_spec = cache_per_thread(nominal_spec)
"""Like ``nominal_spec``, but returns the same object for equal arguments; each individual overwrites the sizes."""


def _add_force_sensors(spec: mujoco.MjSpec, plan: BodyPlan) -> None:
    """Add a sensor of the net force of each leg on the ground, after all other sensors."""
    data = 1 << mujoco.mjtConDataField.mjCONDATA_FORCE.value
    for number, side in list_legs(plan):
        spec.add_sensor(
            name=f"force of {side} leg {number}",
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=mujoco.mjtObj.mjOBJ_XBODY,  # the thigh with its shank
            objname=f"walker/{side}_thigh{number}",
            reftype=mujoco.mjtObj.mjOBJ_BODY,
            refname="world",
            intprm=[data, NET_FORCE, 1],
        )


def _add_pieces(spec: mujoco.MjSpec, terrain: Terrain) -> None:
    """Add the texture pieces: domes, each the cap of a sphere that is mostly below the ground."""
    layout = compute_layout(terrain)
    material = MATERIALS[terrain.texture]
    radius, depth = dome_sphere(terrain)
    colours = np.outer(1 + 0.15 * np.sin(2.4 * np.arange(len(layout.pieces))), material.piece).clip(0, 1)
    for centre, colour in zip(layout.pieces - depth * layout.piece_normals, colours, strict=True):
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0, 0], pos=centre, rgba=[*colour, 1],
            friction=material.friction(), priority=1, condim=3,
        )  # fmt: skip


def write_individual(spec: mujoco.MjSpec, phenotype: Phenotype, robot: Robot) -> None:
    """Write all sizes, masses and strengths of an individual into the specification of its body plan."""
    mass_behind = 0.0
    for number, segment in reversed(list(enumerate(phenotype.segments, start=1))):
        mass_behind += segment.mass
        _write_segment(spec, number, segment, phenotype, mass_behind)
        if segment.legs:
            _write_legs(spec, number, segment, segment.legs)
    last = phenotype.segments[-1]
    middle = phenotype.segments[(1 + len(phenotype.segments)) // 2 - 1]
    spec.site("walker/hitch").pos = [-last.length, 0, 0]
    spec.site("walker/back").pos = [-middle.length / 2, 0, _trunk_radius(middle)]
    if robot.carry_weight:
        spec.body("walker/pack/").pos = spec.site("walker/back").pos
    if robot.drag_weight:
        longest_leg = max(segment.legs.length for segment in phenotype.segments if segment.legs)
        spec.tendon("rope").range = [0, ROPE_LENGTH + longest_leg]


def _legs_mass(segment: Segment) -> float:
    """Return the mass of a segment's legs [kg]."""
    return compute_legs_mass(segment.mass, segment.length, segment.legs.length) if segment.legs else 0.0


def _trunk_mass(segment: Segment) -> float:
    """Return the mass of a segment without its legs [kg]."""
    return segment.mass - _legs_mass(segment)


def _trunk_radius(segment: Segment) -> float:
    """Return the radius of a segment's trunk [m]."""
    return compute_trunk_radius(_trunk_mass(segment), segment.length)


def _write_segment(
    spec: mujoco.MjSpec, number: int, segment: Segment, phenotype: Phenotype, mass_behind: float
) -> None:
    radius = _trunk_radius(segment)
    trunk = spec.geom(f"walker/trunk{number}")
    trunk.size[0] = radius
    trunk.fromto = [-radius, 0, 0, -(segment.length - radius), 0, 0]
    trunk.mass = _trunk_mass(segment)
    if number > 1:
        spec.body(f"walker/seg{number}").pos = [-phenotype.segments[number - 2].length, 0, 0]
        stiffness = SPINE_STIFFNESS * mass_behind * segment.length
        for axis in ("pitch", "yaw"):
            joint = spec.joint(f"walker/{axis}{number}")
            joint.stiffness[0] = stiffness
            joint.damping[0] = SPINE_DAMPING * stiffness


def _write_legs(spec: mujoco.MjSpec, number: int, segment: Segment, legs: Legs) -> None:
    leg_mass = _legs_mass(segment) / 2
    thigh_radius = compute_thigh_radius(leg_mass, legs.length)
    thigh_mass = leg_mass * compute_thigh_share(thigh_radius, legs.length)
    bone_length = legs.length / 2
    for side, sign in zip(SIDES, (1, -1), strict=True):
        hip = [-segment.length / 2, sign * (_trunk_radius(segment) + thigh_radius), 0]
        knee = [0, sign * bone_length * math.sin(SPLAY_ANGLE), -bone_length * math.cos(SPLAY_ANGLE)]
        foot = [0, 0, -bone_length]
        for bone, joint, start, end, radius, mass in (
            ("thigh", "hip", hip, knee, thigh_radius, thigh_mass),
            ("shank", "knee", knee, foot, SHANK_RADIUS_RATIO * thigh_radius, leg_mass - thigh_mass),
        ):
            spec.body(f"walker/{side}_{bone}{number}").pos = start
            geom = spec.geom(f"walker/{side}_{bone}{number}")
            geom.size[0] = radius
            geom.fromto = [0, 0, 0, *end]
            geom.mass = mass
            spec.joint(f"walker/{side}_{joint}{number}").armature = ROTOR_INERTIA * legs.force
            servo = spec.actuator(f"walker/{side}_{joint}{number}")
            servo.gainprm[0] = legs.force / SERVO_BAND
            servo.biasprm[1] = -legs.force / SERVO_BAND
            servo.forcerange = [-legs.force, legs.force]
