"""The features of a genome, the gene table for given limits, and which genes have an effect."""

from functools import lru_cache

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats, GeneKind, Genes, Indices
from walkerlab.settings.choices import Feature
from walkerlab.settings.proportions import MAX_TRUNK_MASS
from walkerlab.settings.robot import MASS_MARGIN, Robot

MAX_SEGMENTS = Robot.declared()["segments"].high  # type: ignore[union-attr]

BODY_FEATURES = (Feature.segments, Feature.frequency, Feature.lag, Feature.duty)
"""Features of the whole body."""

TRUNK_FEATURES = (Feature.length, Feature.mass, Feature.legs, Feature.repeat)
LEG_FEATURES = (
    Feature.leg_length,
    Feature.leg_force,
    Feature.hip_amplitude,
    Feature.hip_phase,
    Feature.hip_offset,
    Feature.knee_amplitude,
    Feature.knee_phase,
    Feature.knee_offset,
    Feature.stride,
)
SEGMENT_FEATURES = TRUNK_FEATURES + LEG_FEATURES
"""Features of each segment: those of its trunk, and those of its legs and their step, which can be repeated."""

FREQUENCY_RANGE = (0.4, 3.0)
"""Frequency of strides [Hz]. Animals of 3 to 12 kg change from trot to gallop at 3.8 to 3.2 Hz (Heglund, Taylor &
McMahon 1974, Science 186)."""

DUTY_RANGE = (0.3, 0.75)

LENGTH, MASS, LEGS, REPEAT, LEG_LENGTH = (
    SEGMENT_FEATURES.index(feature) for feature in (*TRUNK_FEATURES, LEG_FEATURES[0])
)
"""Columns of the genes of a segment."""

WHOLE_ROBOT = "whole robot"
GENE_WORDS = {Feature.legs: "has legs", Feature.repeat: "copies legs in front"}
"""Words for genes that differ from the name of the feature."""

FULL_TURN = 6.283  # rad, rounded to the grid


def feature_ranges(robot: Robot) -> dict[Feature, tuple[float, float, str, GeneKind]]:
    """Return low, high, unit and kind of every feature."""
    shortest, longest = robot.segment_length
    min_mass = min(robot.weight[0] / (2 * robot.segments[1]), MASS_MARGIN * MAX_TRUNK_MASS * shortest**3)
    angle = "rad"
    return {
        Feature.segments: (*robot.segment_range, "", "count"),
        Feature.frequency: (*FREQUENCY_RANGE, "Hz", "real"),
        Feature.lag: (0.0, FULL_TURN, angle, "cyclic"),
        Feature.duty: (*DUTY_RANGE, "", "real"),
        Feature.length: (shortest, longest, "m", "real"),
        Feature.mass: (min_mass, robot.weight[1], "kg", "real"),
        Feature.legs: (0, 1, "pair", "count"),
        Feature.repeat: (0, 1, "", "count"),
        Feature.leg_length: (*robot.leg_length_range, "m", "real"),
        Feature.leg_force: (*robot.leg_force, "N·m", "real"),
        Feature.hip_amplitude: (0.0, 1.0, angle, "real"),
        Feature.hip_phase: (0.0, FULL_TURN, angle, "cyclic"),
        Feature.hip_offset: (-0.8, 0.8, angle, "real"),
        Feature.knee_amplitude: (0.0, 1.0, angle, "real"),
        Feature.knee_phase: (0.0, FULL_TURN, angle, "cyclic"),
        Feature.knee_offset: (-1.2, 1.2, angle, "real"),
        Feature.stride: (0.0, FULL_TURN, angle, "cyclic"),
    }


@lru_cache(maxsize=64)
def build_genes(robot: Robot) -> Genes:
    """Return the gene table of robots within these limits: four genes of the whole body and 13 for each segment.

    Raises:
        ValueError: If ``robot`` is not a ``Robot``.
    """
    if not isinstance(robot, Robot):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(f"the limits must be a Robot such as settings.robot; got a {type(robot).__name__}")
    ranges = feature_ranges(robot)
    n_parts = robot.segments[1]
    columns = [(feature.name, feature) for feature in BODY_FEATURES]
    columns += [
        (f"seg{part}.{feature.name}", feature) for part in range(1, n_parts + 1) for feature in SEGMENT_FEATURES
    ]
    low, high, units, kinds = zip(*(ranges[feature] for _, feature in columns), strict=True)
    return Genes(
        names=tuple(name for name, _ in columns),
        units=units,
        kinds=kinds,
        meanings=tuple(feature.about for _, feature in columns),
        low=np.array(low, dtype=np.float64),
        high=np.array(high, dtype=np.float64),
        n_parts=n_parts,
        n_whole=len(BODY_FEATURES),
        count=BODY_FEATURES.index(Feature.segments),
    )


def gene_words(gene: str) -> tuple[str, str]:
    """Return the part of the robot that a gene describes, and the gene itself, in words.

    Args:
        gene: Name of the gene: ``seg2.hip_phase`` is the "hip phase" of "segment 2".
    """
    part, _, name = gene.rpartition(".")
    group = f"segment {part.removeprefix('seg')}" if part else WHOLE_ROBOT
    return group, GENE_WORDS.get(Feature[name], name.replace("_", " "))


def find_leg_sources(segments: Floats) -> Indices:
    """Return the segment whose genes describe the legs of each segment, shape (n, n_segments); -1 without legs.

    That is the segment itself, or the nearest segment in front of it that does not repeat others.

    Args:
        segments: Genes of the segments, shape (n, n_segments, genes of one segment).
    """
    has_legs = segments[:, :, LEGS] > 0
    is_first = has_legs & (np.cumsum(has_legs, axis=1) == 1)
    is_source = has_legs & (is_first | ~(segments[:, :, REPEAT] > 0))
    sources = np.maximum.accumulate(np.where(is_source, np.arange(segments.shape[1]), -1), axis=1)
    return np.where(has_legs, sources, -1)


def is_expressed(genomes: Floats) -> NDArray[np.bool_]:
    """Return which genes have an effect on the robot, shape (n, n_genes), for (n, n_genes) genomes.

    Genes of unexpressed segments have no effect, and neither do the genes of legs that do not exist or repeat others.
    The lag has no effect if only the first segment has legs.
    """
    segments = genomes[:, len(BODY_FEATURES) :].reshape(len(genomes), -1, len(SEGMENT_FEATURES))
    numbers = np.arange(segments.shape[1])
    is_segment_expressed = numbers < np.rint(genomes[:, BODY_FEATURES.index(Feature.segments), np.newaxis])
    sources = find_leg_sources(segments)
    has_front_legs = np.cumsum(sources >= 0, axis=1) > 1  # legs on the segment itself and on one in front of it
    can_repeat = is_segment_expressed & (sources >= 0) & has_front_legs
    has_own_legs = is_segment_expressed & (sources == numbers)
    masks: dict[Feature, NDArray[np.bool_]] = {Feature.repeat: can_repeat, **dict.fromkeys(LEG_FEATURES, has_own_legs)}
    of_segments = np.stack([masks.get(feature, is_segment_expressed) for feature in SEGMENT_FEATURES], axis=2)
    of_body = np.ones((len(genomes), len(BODY_FEATURES)), dtype=np.bool_)
    of_body[:, BODY_FEATURES.index(Feature.lag)] = (is_segment_expressed & (sources >= 0))[:, 1:].any(axis=1)
    return np.concatenate([of_body, of_segments.reshape(len(genomes), -1)], axis=1)


def gene_table(robot: Robot) -> pd.DataFrame:
    """Return the gene table as a DataFrame: a row for each gene, with its unit, range, kind and meaning.

    Args:
        robot: Limits of the robots.

    Raises:
        ValueError: If ``robot`` is not a ``Robot``.
    """
    genes = build_genes(robot)
    columns = ("names", "units", "low", "high", "kinds", "meanings")
    titles = ("gene", "unit", "low", "high", "kind", "meaning")
    return GeneTable({title: list(getattr(genes, column)) for title, column in zip(titles, columns, strict=True)})


class GeneTable(pd.DataFrame):
    """Table that notebooks display with whole sentences, which pandas would cut off after 50 characters."""

    @property
    def _constructor(self) -> "type[GeneTable]":
        return GeneTable

    def _repr_html_(self) -> str | None:
        with pd.option_context("display.max_colwidth", None):
            return super()._repr_html_()  # type: ignore[operator]
