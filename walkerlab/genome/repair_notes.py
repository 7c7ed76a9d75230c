"""Descriptions of the changes that bring a genome within the limits."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from walkerlab.genome.features import BODY_FEATURES, SEGMENT_FEATURES, build_genes, is_expressed
from walkerlab.genome.genome import Genome
from walkerlab.genome.repair import GRID_DECIMALS
from walkerlab.settings.choices import Feature
from walkerlab.settings.proportions import DENSITY_RANGE
from walkerlab.settings.robot import Robot

ROUNDING_TOLERANCE = 0.51 * 10.0**-GRID_DECIMALS  # smaller changes come from rounding and are not reported

_DEFAULT_GENES = build_genes(Robot())
_FEATURE_KINDS = [
    (Feature[name.rpartition(".")[2]], unit, kind)
    for name, unit, kind in zip(_DEFAULT_GENES.names, _DEFAULT_GENES.units, _DEFAULT_GENES.kinds, strict=True)
]
FEATURE_UNITS = {feature: unit for feature, unit, kind in _FEATURE_KINDS if kind != "count"}
CYCLIC_FEATURES = {feature for feature, _, kind in _FEATURE_KINDS if kind == "cyclic"}


class Repair(NamedTuple):
    """A change that brings a genome within the limits; as text, one sentence.

    Attributes:
        fault: What is not allowed, and why; without a full stop.
        remedy: What is used instead; without a full stop.
        gene: Name of the gene, such as ``seg2.mass``; empty if the change is not of one gene.
    """

    fault: str
    remedy: str
    gene: str = ""

    def __str__(self) -> str:
        return f"{self.fault}; {self.remedy}."


def describe_repairs(genome: Genome, robot: Robot) -> list[Repair]:
    """Describe the changes that bring a genome within the limits.

    Genes without effect are ignored; see ``is_expressed``.

    Args:
        genome: Genome before the repair.
        robot: Limits of the robot.
    """
    genes = build_genes(robot)
    values = genome.within(robot).values
    used = genes.parts(values[np.newaxis])[0]
    given = genome.values[len(BODY_FEATURES) :].reshape(genome.n_parts, -1)
    lows, highs = (genes.parts(limits[np.newaxis])[0] for limits in (genes.low, genes.high))
    weight = float(used[: int(values[genes.count or 0]), SEGMENT_FEATURES.index(Feature.mass)].sum())
    repairs = list(_describe_segments(genome, robot))
    for i, feature in enumerate(BODY_FEATURES):
        changes = _describe_gene(feature, genome.values[i], values[i], (genes.low[i], genes.high[i]), robot, weight)
        repairs += [change._replace(gene=genes.names[i]) for change in changes]
    expressed = is_expressed(values[np.newaxis])[0, len(BODY_FEATURES) :].reshape(used.shape)
    for segment, index in np.argwhere(expressed[: genome.n_parts]).tolist():
        at = segment, index
        changes = _describe_gene(SEGMENT_FEATURES[index], given[at], used[at], (lows[at], highs[at]), robot, weight)
        name = f"seg{segment + 1}.{SEGMENT_FEATURES[index].name}"
        repairs += [Repair(f"Segment {segment + 1}: {fault}", remedy, name) for fault, remedy, _ in changes]
    return repairs


def _describe_segments(genome: Genome, robot: Robot) -> Iterator[Repair]:
    """Yield a repair if the genome does not describe as many segments as the robot has."""
    most = robot.segments[1]
    wanted = min(genome.values[0], most)
    if genome.n_parts > most:
        fault = f"The genome describes {genome.n_parts} segments, and the limits allow {most}"
        yield Repair(fault, "the others are ignored")
    if genome.n_parts < wanted:
        fault = f"The robot has {wanted:g} segments, and the genome describes {genome.n_parts}"
        yield Repair(fault, "the last one is repeated")


def _describe_gene(
    feature: Feature, given: float, used: float, limits: tuple[float, float], robot: Robot, weight: float
) -> Iterator[Repair]:
    """Yield a repair if the value of a gene is not allowed.

    Args:
        feature: Feature that the gene describes.
        given: Value before the repair.
        used: Value after the repair.
        limits: Range of the gene.
        robot: Limits of the robot.
        weight: Weight of the robot after the repair [kg].
    """
    if abs(given - used) <= ROUNDING_TOLERANCE:
        return
    low, high = limits
    given_text, low_text, high_text, used_text = (_with_unit(value, feature) for value in (given, low, high, used))
    beyond = high_text if given > high else low_text if given < low else ""
    shared_limit = _describe_shared_limit(feature, robot, weight)
    if feature in CYCLIC_FEATURES:
        why = "is not within one turn"
    elif beyond:
        why = f"is {'above' if given > high else 'below'} the limit of {beyond}"
        if shared_limit and used_text != beyond:
            why += f", and {shared_limit}"
    elif shared_limit and (feature != Feature.legs or given in (0, 1)):
        why = f"does not fit, because {shared_limit}"
    else:
        why = "is not a whole number"
    yield Repair(f"{feature.name.replace('_', ' ')} {given_text} {why}", f"{used_text} is used")


def _describe_shared_limit(feature: Feature, robot: Robot, weight: float) -> str:
    """Describe the limit that a gene must obey together with other genes; empty if there is none.

    Args:
        feature: Feature that the gene describes.
        robot: Limits of the robot.
        weight: Weight of the robot after the repair [kg].
    """
    match feature:
        case Feature.length:
            return f"the body must be {_format_range(robot.body_length)} m long"
        case Feature.mass:
            if min(abs(weight - limit) for limit in robot.weight) < 10 * ROUNDING_TOLERANCE:
                return f"the robot must weigh {_format_range(robot.weight)} kg"
            return f"the density of a segment of this size must be {_format_range(DENSITY_RANGE)} kg/m³"
        case Feature.legs:
            return f"the robot must have {_format_range(robot.legs)} legs"
        case _:
            return ""


def _with_unit(value: float, feature: Feature) -> str:
    return f"{value:.4g} {FEATURE_UNITS.get(feature, '')}".rstrip()


def _format_range(limits: tuple[float, float]) -> str:
    return f"between {limits[0]:g} and {limits[1]:g}"
