"""Choices of the settings: the members of each kind, with their integer codes and a sentence about each."""

from enum import IntEnum
from typing import Self


class Choice(IntEnum):
    """One of several named options; each member has an integer code and a sentence ``about`` it."""

    about: str

    def __init_subclass__(cls) -> None:
        """Write the docstring for ``help``: each member with its code and its meaning."""
        members = [f"    {choice.name} ({choice.value}): {choice.about}" for choice in cls]
        cls.__doc__ = "\n".join([cls.__doc__ or "", "", "Members:", *members])

    def __new__(cls, code: int, about: str) -> Self:
        """Return the member with an integer code."""
        member = int.__new__(cls, code)
        member._value_ = code
        member.about = about
        return member


class Structure(Choice):
    """Shape of the ground, seen from the side; robots walk to the right."""

    flat = 0, "______________ a level plane"
    incline = 1, "___---‾‾‾ a plane that rises, or falls, in the walking direction"
    stairs = 2, "____┌──┌──┌── steps that go up in the walking direction"
    rough = 3, "___/‾\\_/‾\\_ hills and hollows, in both directions"
    gaps = 4, "_____  ___  ___ a level plane with trenches across the walking direction"


class Texture(Choice):
    """Material of the ground, which determines its friction and appearance."""

    rubber = 0, "a sports floor: the best grip"
    marble = 1, "polished stone: hard and smooth"
    ice = 2, "feet slide at the slightest push"
    wood = 3, "parquet: firm and even"
    concrete = 4, "rough and hard, like a pavement"
    grass = 5, "a mown lawn: some of the grip is lost"
    sand = 6, "a beach: grains give way, and rolling objects soon stop"
    gravel = 7, "small stones that shift under the foot"
    mud = 8, "wet earth: slippery, and rolling objects soon stop"
    snow = 9, "trodden snow: twice the grip of ice"


class Obstacle(Choice):
    """Kind of loose obstacles on the ground, for robots to push or to climb over."""

    none = 0, "no obstacles"
    box = 1, "wooden boxes"
    ball = 2, "light balls, which roll away"
    cylinder = 3, "upright tins"
    rock = 4, "stones with edges: the heaviest"
    log = 5, "round logs on their sides"


class Fitness(Choice):
    """Quantity that evolution increases."""

    distance = 0, "net forward travel of the centre of mass after settling, in m"
    velocity = 1, "mean forward speed over the last two thirds of the walk, in m/s"
    efficiency = 2, "net forward travel for each joule of work that the legs do, in m/J"
    straightness = 3, "net forward travel minus the sideways drift, in m"


class Selection(Choice):
    """Method by which parents are chosen."""

    gradient = 0, "probability grows in proportion to the lead over the least fit robot"
    top_half = 1, "the better half, each equally often"
    tournament = 2, "the best of a few drawn at random"
    rank = 3, "probability grows with rank, not with fitness itself"
    uniform = 4, "every robot has the same probability: no selection pressure"


class Crossover(Choice):
    """Method by which two or more parents make children."""

    paired = 0, "front half of one parent, rear half of the other; the remaining halves make the second child"
    randomized = 1, "each gene comes from a parent drawn at random from all selected ones"
    weighted = 2, "the less fit parent is moved towards the fitter one, by a larger step if the gap is larger"
    one_point = 3, "the gene string is cut at one random place and its ends are swapped"
    uniform = 4, "a coin toss for each gene decides from which of two parents it comes"
    none = 5, "children are copies; only mutation changes them"


class Mutation(Choice):
    """Method by which children are varied."""

    randomized = 0, "each gene is equally likely to change, by a random step relative to its value"
    favored = 1, "one chosen kind of gene changes far more often than the others"
    micro = 2, "small steps; the body plan does not change"
    macro = 3, "large jumps; whole segments are added or removed"
    gaussian = 4, "each gene is equally likely to change, by a random step relative to its range"


class Feature(Choice):
    """Meaning of a gene: of the whole body (``segments``, ``frequency``, ``lag``, ``duty``), or of each segment."""

    segments = 0, "number of segments"
    frequency = 1, "strides per second, the same for all legs"
    length = 2, "length of the segment"
    mass = 3, "mass of the segment and its legs"
    legs = 4, "whether the segment has a pair of legs (1) or no legs (0)"
    leg_length = 5, "length of each leg, thigh and shank together"
    leg_force = 6, "greatest torque at the hip and at the knee"
    hip_amplitude = 7, "how far the thigh swings to either side"
    hip_phase = 8, "when in the stride the thigh swings forward"
    hip_offset = 9, "angle about which the thigh swings: positive is forward"
    knee_amplitude = 10, "how far the shank swings to either side"
    knee_phase = 11, "how far the shank is ahead of its thigh in the stride"
    knee_offset = 12, "angle about which the shank swings: positive is forward"
    stride = 13, "how far the right leg is behind the left in the stride; half a turn is a trot"
    lag = 14, "how far in the stride each pair of legs is behind that of the segment in front; 0: all move together"
    duty = 15, "share of each stride in which a leg swings backward and pushes; in the rest, it swings forward"
    repeat = 16, "whether the legs copy the nearest legs in front, shape and motion (1), or have genes of their own (0)"


class Frozen(Choice):
    """Genes that evolution does not change: all of the body, all of the gait, or single features."""

    none = 0, "all genes evolve"
    body = 1, "segments, lengths, masses and legs: only the gait evolves"
    gait = 2, "rhythm and joints: only the body evolves"
    segments = 3, Feature.segments.about
    frequency = 4, Feature.frequency.about
    length = 5, Feature.length.about
    mass = 6, Feature.mass.about
    legs = 7, Feature.legs.about
    leg_length = 8, Feature.leg_length.about
    leg_force = 9, Feature.leg_force.about
    hip_amplitude = 10, Feature.hip_amplitude.about
    hip_phase = 11, Feature.hip_phase.about
    hip_offset = 12, Feature.hip_offset.about
    knee_amplitude = 13, Feature.knee_amplitude.about
    knee_phase = 14, Feature.knee_phase.about
    knee_offset = 15, Feature.knee_offset.about
    stride = 16, Feature.stride.about
    lag = 17, Feature.lag.about
    duty = 18, Feature.duty.about
    repeat = 19, Feature.repeat.about


class Guard(Choice):
    """Rule that a walk must follow to count."""

    none = 0, "all the guards below are on"
    bad_start = 1, "it started inside something: the ground, an obstacle or its own load"
    restless = 2, "it slid, rolled or was blown along before it made a step"
    jittering = 3, "its legs were driven faster than any gene allows: trembling, not walking"
    too_fast = 4, "it moved faster than Simulation.max_speed allows: thrown, not walking"
    too_high = 5, "its centre of mass rose far above its standing height: vaulting, not walking"
    sunk = 6, "a part of it was pushed deep into the ground, which is impossible on real ground"
    airborne = 7, "it was off the ground for longer than Simulation.max_airborne: flying, not walking"
    fell = 8, "it stood, went down and did not get up; a robot that lay from the start has not fallen"
    out_of_arena = 9, "it left the ground that was built"
    load_lost = 10, "its sledge broke the rope, overtook it, or sank into the ground"
    overturned = 11, "it was on its back for too long in total: rolling or sliding, not walking"
    carried = 12, "a slope, gravity or the wind moved it; on level ground in still air it does not walk"
    fragile = 13, "it was among the best, but from a slightly different start its fitness was much lower"


class Recording(Choice):
    """Quantity that is recorded during a walk on request, for a user function or for analysis."""

    none = 0, "only what every walk records"
    joint_angles = 1, "angle of each joint, in rad, shape (n, n_joints)"
    joint_velocities = 2, "angular velocity of each joint, in rad/s, shape (n, n_joints)"
    orientation = 3, "rotation matrix of the first segment, shape (n, 3, 3)"
    contact_forces = 4, "force of the ground on each leg, in N, shape (n, n_legs, 3)"


class Camera(Choice):
    """Viewpoint from which a walk is shown."""

    side = 0, "beside the robot, level"
    front = 1, "ahead of the robot, looking back"
    top = 2, "straight above the robot"
    chase = 3, "behind and above the robot, following it"
    orbit = 4, "circling the robot slowly"
