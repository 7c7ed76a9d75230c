"""The robot that a genome expresses: its morphology and its gait."""

import math
from dataclasses import dataclass

from walkerlab.genome.genome import Genome
from walkerlab.genome.repair import BODY_FEATURES, SEGMENT_FEATURES
from walkerlab.settings.choices import Feature


@dataclass(frozen=True)
class Swing:
    """Motion of one joint: offset + amplitude · sin(2π · frequency · t + phase), in rad."""

    amplitude: float
    phase: float
    offset: float


@dataclass(frozen=True)
class Legs:
    """A pair of legs of one segment.

    Attributes:
        length: Length of each leg, m.
        force: Maximum torque of each joint, N·m.
        hip: Motion of the left hip.
        knee: Motion of the left knee.
        stride: Phase by which the right leg lags the left one, rad.
    """

    length: float
    force: float
    hip: Swing
    knee: Swing
    stride: float


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
    """

    segments: tuple[Segment, ...]
    frequency: float

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
    """Return the robot that a genome expresses; unexpressed genes are ignored."""
    genome = Genome.of(genome)
    n_segments, frequency = genome.values[: len(BODY_FEATURES)].tolist()
    rows = genome.values[len(BODY_FEATURES) :].reshape(genome.n_parts, -1)[: int(n_segments)]
    return Phenotype(tuple(map(_express_segment, rows.tolist())), frequency)


def _express_segment(values: list[float]) -> Segment:
    gene = dict(zip(SEGMENT_FEATURES, values, strict=True))
    hip = Swing(gene[Feature.hip_amplitude], gene[Feature.hip_phase], gene[Feature.hip_offset])
    knee_phase = hip.phase + gene[Feature.knee_phase]
    knee = Swing(gene[Feature.knee_amplitude], knee_phase, gene[Feature.knee_offset])
    legs = Legs(gene[Feature.leg_length], gene[Feature.leg_force], hip, knee, gene[Feature.stride])
    return Segment(gene[Feature.length], gene[Feature.mass], legs if gene[Feature.legs] else None)
