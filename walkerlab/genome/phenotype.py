"""The robot that a genome expresses: its morphology and its gait."""

import math
from dataclasses import dataclass, replace

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.genome.features import BODY_FEATURES, SEGMENT_FEATURES
from walkerlab.genome.genome import Genome
from walkerlab.settings.choices import Feature


@dataclass(frozen=True)
class Swing:
    """Motion of one joint: offset + amplitude · sin(angle + phase), in rad; see ``stride_angle`` for the angle.

    Attributes:
        amplitude: Greatest deviation from the offset, rad.
        phase: How far the joint is ahead of the stride of its leg, rad.
        offset: Angle about which the joint swings, rad.
    """

    amplitude: float
    phase: float
    offset: float


@dataclass(frozen=True)
class Legs:
    """A pair of legs of one segment.

    Attributes:
        length: Length of each leg, m.
        force: Maximum torque of each joint, N·m.
        phase: Phase of the left leg in its stride when the gait begins, rad.
        stride: Phase by which the right leg lags the left one, rad.
        hip: Motion of the hips.
        knee: Motion of the knees.
    """

    length: float
    force: float
    phase: float
    stride: float
    hip: Swing
    knee: Swing


@dataclass(frozen=True)
class Segment:
    """One segment of the body.

    Attributes:
        length: Length, m.
        mass: Mass including its legs, kg.
        legs: Its pair of legs, or None.
    """

    length: float
    mass: float
    legs: Legs | None


@dataclass(frozen=True)
class Phenotype:
    """The robot that a genome expresses: morphology and gait.

    Attributes:
        segments: Segments, from the front.
        frequency: Stride frequency, Hz.
        duty: Share of the stride in which the thighs swing backward; 0.5 makes the motion of each joint a sine.
    """

    segments: tuple[Segment, ...]
    frequency: float
    duty: float

    @property
    def plan(self) -> tuple[bool, ...]:
        """Body plan: for each segment from the front, whether it has legs."""
        return tuple(segment.legs is not None for segment in self.segments)

    @property
    def n_legs(self) -> int:
        """Number of legs."""
        return 2 * sum(self.plan)

    @property
    def weight(self) -> float:
        """Total mass, in kg; excludes loads."""
        return math.fsum(segment.mass for segment in self.segments)

    @property
    def body_length(self) -> float:
        """Length from the front of the first to the end of the last segment, in m."""
        return math.fsum(segment.length for segment in self.segments)


def express(genome: Genome) -> Phenotype:
    """Return the robot that a genome expresses; unexpressed genes are ignored.

    A segment whose ``repeat`` is 1 has the legs and the step of the nearest legs in front of it. With each segment
    towards the rear, the legs lag by another ``lag``, so that a wave of steps travels along the body.
    """
    genome = Genome.of(genome)
    body = dict(zip(BODY_FEATURES, genome.values[: len(BODY_FEATURES)].tolist(), strict=True))
    rows = genome.values[len(BODY_FEATURES) :].reshape(genome.n_parts, -1)[: max(0, round(body[Feature.segments]))]
    segments: list[Segment] = []
    legs: Legs | None = None
    for number, row in enumerate(rows.tolist()):
        gene: dict[Feature, float] = dict(zip(SEGMENT_FEATURES, row, strict=True))
        has_legs = gene[Feature.legs] > 0
        if has_legs and not (legs and gene[Feature.repeat] > 0):
            legs = _express_legs(gene)
        shifted = legs and replace(legs, phase=legs.phase - number * body[Feature.lag])
        segments.append(Segment(gene[Feature.length], gene[Feature.mass], shifted if has_legs else None))
    return Phenotype(tuple(segments), body[Feature.frequency], body[Feature.duty])


def _express_legs(gene: dict[Feature, float]) -> Legs:
    """Return the legs that the genes of a segment express, before the lag is applied."""
    return Legs(
        length=gene[Feature.leg_length],
        force=gene[Feature.leg_force],
        phase=gene[Feature.hip_phase],
        stride=gene[Feature.stride],
        hip=Swing(gene[Feature.hip_amplitude], 0.0, gene[Feature.hip_offset]),
        knee=Swing(gene[Feature.knee_amplitude], gene[Feature.knee_phase], gene[Feature.knee_offset]),
    )


def stride_angle(strides: Floats, duty: float) -> Floats:
    """Return the angle that drives the joints of a leg: the thigh is foremost at π/2 and rearmost at 3π/2.

    The angle increases by a full turn in each stride: by half a turn while the thigh swings forward, and by half a turn
    while it swings backward, which takes the share ``duty`` of the stride. With a duty of 0.5 it increases steadily.

    Args:
        strides: Phase in strides, any shape; whole numbers are full strides.
        duty: Share of the stride in which the thigh swings backward.

    Returns:
        Angles [rad], same shape, from -π/2 to 3π/2.
    """
    position = np.mod(strides + 0.25, 1.0)  # strides since the thigh was last rearmost, if the duty is 0.5
    is_forward = position < 1 - duty
    half_turns = np.where(is_forward, position / (1 - duty), 1 + (position - (1 - duty)) / duty)
    return math.pi * half_turns - math.pi / 2
