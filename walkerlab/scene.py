"""One world, compiled: a genome and the settings become an ``MjModel`` and the controls that drive it."""

import math
import threading
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np

from walkerlab.entities import generate_robot, generate_terrain
from walkerlab.entities.terrain import bounds, slope
from walkerlab.entities.walker import SIDES
from walkerlab.genes import Floats, Indices
from walkerlab.genome import Genome
from walkerlab.phenotype import Legs, Phenotype, Segment, express
from walkerlab.settings import Settings, Simulation, Terrain

CONTROL_RATE = 50.0  # Hz, at which servos take a new target
RAMP = 0.5  # s, over which a gait swells from rest to its full swing
CLEARANCE = 0.005  # m, between the ground and the lowest point of a robot at the start

BODY_DENSITY = 600.0  # kg/m³ of a trunk: mass and length together give its girth
SPLAY = math.radians(36)  # of the thighs outward: a stance wide enough not to topple
LEG_SHARE = 0.3  # of a segment's mass, that is its legs'
THIGH_SHARE = 0.6  # of a leg's mass
LEG_GIRTH = 0.07  # radius of a thigh over the length of the leg
SERVO_BAND = 0.3  # rad of error at which a servo gives its full torque
SPINE_STIFFNESS = 30.0  # N·m/rad for each kg·m of mass times length behind the joint
ROTOR = 0.001  # kg·m² of rotor inertia for each N·m of torque: with the band, a servo of 9 Hz whatever it turns


@dataclass(frozen=True)
class Scene:
    """One compiled world.

    Attributes:
        model: ready for ``mj_step``; actuators in the order of ``controls``.
        pitch: of the ground at the start, in rad; positive is uphill.
        bounds: (2, 2) least and greatest x and y [m] of the ground that was built; infinite on a plane.
        genome: the genome it was built from, within the limits.
        phenotype: the robot in it.
        simulation: the settings it will be stepped by.
    """

    model: mujoco.MjModel
    pitch: float
    bounds: Floats
    genome: Genome
    phenotype: Phenotype
    simulation: Simulation

    def controls(self, n_steps: int) -> Floats:
        """Compute the servo targets of the whole walk; the gait needs no feedback.

        Returns:
            (n_steps, nu) in rad, a new value ``CONTROL_RATE`` times a second.
        """
        amplitude, phase, offset = _motion(self.phenotype)
        first, tick = ticks(n_steps, self.simulation.timestep)
        time = np.arange(len(first))[:, np.newaxis] / CONTROL_RATE
        swell = np.minimum(time / RAMP, 1.0)
        wave = offset + swell * amplitude * np.sin(math.tau * self.phenotype.frequency * time + phase)
        return wave[tick]

    def place(self, data: mujoco.MjData) -> None:
        """Stand the robot on the ground at the origin: its belly along the slope, its lowest point just clear."""
        model = self.model
        data.qpos[3:7] = [math.cos(self.pitch / 2), 0, -math.sin(self.pitch / 2), 0]
        mujoco.mj_kinematics(model, data)
        own = model.geom_bodyid > 0
        up = np.array([-math.sin(self.pitch), 0, math.cos(self.pitch)])
        axis = data.geom_xmat[own].reshape(-1, 3, 3)[:, :, 2]
        reach = np.abs(axis @ up) * model.geom_size[own, 1] + model.geom_size[own, 0]
        lowest = float(np.min(data.geom_xpos[own] @ up - reach))
        data.qpos[:3] += (CLEARANCE - lowest) * up

    def outline(self, pose: Floats) -> tuple[Floats, Floats, Floats]:
        """Lay out the capsules of the body in a pose, for a drawing that needs no GL.

        Args:
            pose: (nq,) as in ``Rollout.poses``.

        Returns:
            (n, 2, 3) both ends of each capsule's axis, in m; (n,) their radii; (n, 4) their colours, RGBA.
        """
        model, data = self.model, mujoco.MjData(self.model)
        data.qpos[:] = pose
        mujoco.mj_kinematics(model, data)
        own = model.geom_bodyid > 0
        half = data.geom_xmat[own].reshape(-1, 3, 3)[:, :, 2] * model.geom_size[own, 1, np.newaxis]
        ends = np.stack([data.geom_xpos[own] - half, data.geom_xpos[own] + half], axis=1)
        return ends, model.geom_size[own, 0].copy(), model.geom_rgba[own].astype(np.float64)

    @property
    def rest(self) -> Floats:
        """(nu,) servo targets of the body at rest."""
        return _motion(self.phenotype)[2]


@lru_cache(maxsize=16)
def ticks(n_steps: int, timestep: float) -> tuple[Indices, Indices]:
    """Lay the gait's clock over the steps of the physics.

    Returns:
        The first step of each tick, (n_ticks,), and the tick of each step, (n_steps,).
    """
    tick = np.floor(np.arange(n_steps) * timestep * CONTROL_RATE + 1e-9).astype(np.intp)
    return np.unique(tick, return_index=True)[1], tick


def compile_scene(genome: Genome | str | Floats, settings: Settings, *, scenery: bool = False) -> Scene:
    """Build the world in which one individual walks.

    Args:
        genome: a genome, its text or its (n_genes,) values; brought within the robot limits first.
        settings: of terrain, robot and simulation.
        scenery: whether to add sky, chequered ground and a sun, which cost more to compile than the rest.

    Raises:
        GenomeError: if a text is no genome.
        ValueError: if values are no genome.
    """
    return describe_scene(genome, settings, scenery=scenery)[1]


def describe_scene(genome: Genome | str | Floats, settings: Settings, *, scenery: bool) -> tuple[mujoco.MjSpec, Scene]:
    """Build the same world, and hand out its description too; it is good until this thread's next scene."""
    return _build(Genome.of(genome).within(settings.robot), settings, scenery=scenery)


def scene_of(genome: Genome, settings: Settings) -> Scene:
    """Build the world of a genome that is known to be within the limits."""
    return _build(genome, settings, scenery=False)[1]


def _build(genome: Genome, settings: Settings, *, scenery: bool) -> tuple[mujoco.MjSpec, Scene]:
    phenotype, terrain = express(genome), settings.terrain
    spec = _plan_spec(phenotype.plan, terrain, scenery, threading.get_ident())
    _write_measures(spec, phenotype)
    spec.option.timestep = settings.simulation.timestep
    ends = np.array(bounds(terrain))
    return spec, Scene(spec.compile(), slope(terrain), ends, genome, phenotype, settings.simulation)


# ------------------------------------------------------------------------------------------------ body plans


@lru_cache(maxsize=512)
def _plan_xml(plan: tuple[bool, ...], terrain: Terrain, scenery: bool) -> str:
    """Have composer build one body plan on one ground, in nominal measures."""
    ground, walker = generate_terrain(terrain, scenery=scenery), generate_robot(plan)
    root, body = ground.mjcf_model, ground.attach(walker)
    body.add("freejoint", name="free")
    root.option.integrator = "implicitfast"
    root.option.flag.autoreset = "disable"  # a world that blows up must not start anew unseen
    root.sensor.add("subtreecom", name="com", body=body)
    root.sensor.add("contact", name="touch", subtree1=body, body2="world", data="found", num=1)
    return root.to_xml_string()


@lru_cache(maxsize=512)
def _plan_spec(plan: tuple[bool, ...], terrain: Terrain, scenery: bool, thread: int) -> mujoco.MjSpec:
    """Return a thread's own spec of a plan, into which every individual's measures are written anew."""
    assert thread == threading.get_ident()
    return mujoco.MjSpec.from_string(_plan_xml(plan, terrain, scenery))


def _write_measures(spec: mujoco.MjSpec, phenotype: Phenotype) -> None:
    """Write one individual's numbers into the spec of its body plan: all of them, every time."""
    behind = 0.0
    for number, segment in reversed(list(enumerate(phenotype.segments, start=1))):
        behind += segment.mass
        _write_segment(spec, number, segment, phenotype, behind)
        if segment.legs:
            _write_legs(spec, number, segment, segment.legs)


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


# --------------------------------------------------------------------------------------------------- the gait


def _motion(phenotype: Phenotype) -> tuple[Floats, Floats, Floats]:
    """Amplitude, phase and offset of each actuator, (nu,) each [rad], in the order in which legs were grown."""
    rows = [
        (swing.amplitude, swing.phase - lag, swing.offset)
        for segment in phenotype.segments
        if (legs := segment.legs)
        for lag in (0.0, legs.stride)
        for swing in (legs.hip, legs.knee)
    ]
    amplitude, phase, offset = np.array(rows, dtype=np.float64).reshape(-1, 3).T
    return amplitude, phase, offset
