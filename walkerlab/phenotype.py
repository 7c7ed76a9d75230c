"""The robot that a genome expresses: its morphology and its gait."""

import math
from dataclasses import dataclass

from walkerlab.choices import Feature
from walkerlab.genome import Genome
from walkerlab.limits import PART, WHOLE


@dataclass(frozen=True)
class Swing:
    """The motion of one joint: offset + amplitude · sin(2π · frequency · t + phase), all in rad."""

    amplitude: float
    phase: float
    offset: float


@dataclass(frozen=True)
class Legs:
    """A pair of legs: length [m] and torque [N·m] of each, how they swing, and how far right lags left [rad]."""

    length: float
    force: float
    hip: Swing
    knee: Swing
    stride: float


@dataclass(frozen=True)
class Segment:
    """One grown segment: length [m], mass [kg] with its legs, and its legs if it has any."""

    length: float
    mass: float
    legs: Legs | None


@dataclass(frozen=True)
class Phenotype:
    """The robot that a genome expresses: morphology and gait.

    Attributes:
        segments: the grown ones, from the front.
        frequency: strides per second.
    """

    segments: tuple[Segment, ...]
    frequency: float

    @property
    def plan(self) -> tuple[bool, ...]:
        """The body plan: which segments have legs."""
        return tuple(segment.legs is not None for segment in self.segments)

    @property
    def n_legs(self) -> int:
        """How many legs it walks on."""
        return 2 * sum(self.plan)

    @property
    def weight(self) -> float:
        """Its whole mass, in kg."""
        return math.fsum(segment.mass for segment in self.segments)

    @property
    def body_length(self) -> float:
        """From the front of the first to the end of the last segment, in m."""
        return math.fsum(segment.length for segment in self.segments)


def express(genome: Genome) -> Phenotype:
    """Read the robot out of its genome; unexpressed genes are passed over."""
    genome = Genome.of(genome)
    count, frequency = genome.values[: len(WHOLE)].tolist()
    parts = genome.values[len(WHOLE) :].reshape(genome.n_parts, -1)[: int(count)]

    def segment(values: list[float]) -> Segment:
        gene = dict(zip(PART, values, strict=True))
        hip = Swing(gene[Feature.hip_amplitude], gene[Feature.hip_phase], gene[Feature.hip_offset])
        ahead = hip.phase + gene[Feature.knee_phase]
        knee = Swing(gene[Feature.knee_amplitude], ahead, gene[Feature.knee_offset])
        legs = Legs(gene[Feature.leg_length], gene[Feature.leg_force], hip, knee, gene[Feature.stride])
        return Segment(gene[Feature.length], gene[Feature.mass], legs if gene[Feature.legs] else None)

    return Phenotype(tuple(map(segment, parts.tolist())), frequency)
