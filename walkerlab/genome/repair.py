"""The gene table for given limits, and the repair that brings any genome within them."""

from functools import lru_cache

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from walkerlab.ga.genes import Floats, GeneKind, Genes
from walkerlab.settings.choices import Feature
from walkerlab.settings.robot import Robot

GRID_DECIMALS = 3
"""Decimals to which repair rounds genes (millimetres, grams, milliradians), so that the text form is short."""

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
FULL_TURN = 6.283  # rad, rounded to the grid
SUM_TOLERANCE = 1e-10  # relative to the maximum of the sum
GRID_TOLERANCE = 1e-6  # steps of the grid


def _feature_ranges(robot: Robot) -> dict[Feature, tuple[float, float, str, GeneKind]]:
    """Return low, high, unit and kind of every feature."""
    shortest, longest = robot.segment_length
    angle = "rad"
    return {
        Feature.segments: (*robot.segment_range, "", "count"),
        Feature.frequency: (*FREQUENCY_RANGE, "Hz", "real"),
        Feature.lag: (0.0, FULL_TURN, angle, "cyclic"),
        Feature.duty: (*DUTY_RANGE, "", "real"),
        Feature.length: (shortest, longest, "m", "real"),
        Feature.mass: (robot.weight[0] / (2 * robot.segments[1]), robot.weight[1], "kg", "real"),
        Feature.legs: (0, 1, "pair", "count"),
        Feature.repeat: (0, 1, "", "count"),
        Feature.leg_length: (0.5 * shortest, 1.2 * longest, "m", "real"),
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
    ranges = _feature_ranges(robot)
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


def is_expressed(genomes: Floats) -> NDArray[np.bool_]:
    """Return which genes have an effect on the robot, shape (n, n_genes), for (n, n_genes) genomes.

    Genes of segments that are not grown have none, nor have those of legs that do not exist or that repeat others.
    """
    segments = genomes[:, len(BODY_FEATURES) :].reshape(len(genomes), -1, len(SEGMENT_FEATURES))
    n_grown = genomes[:, BODY_FEATURES.index(Feature.segments), np.newaxis]
    is_grown = np.arange(segments.shape[1]) < n_grown
    has_legs = is_grown & (segments[:, :, SEGMENT_FEATURES.index(Feature.legs)] > 0)
    can_repeat = has_legs & (np.cumsum(has_legs, axis=1) > 1)
    has_own_legs = has_legs & ~(can_repeat & (segments[:, :, SEGMENT_FEATURES.index(Feature.repeat)] > 0))
    masks = {Feature.repeat: can_repeat, **dict.fromkeys(LEG_FEATURES, has_own_legs)}
    of_segments = np.stack([masks.get(feature, is_grown) for feature in SEGMENT_FEATURES], axis=2)
    of_body = np.ones((len(genomes), len(BODY_FEATURES)), dtype=np.bool_)
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
    return pd.DataFrame({title: list(getattr(genes, column)) for title, column in zip(titles, columns, strict=True)})


def repair(genomes: ArrayLike, robot: Robot) -> Floats:
    """Return for each genome a nearby one whose robot obeys every limit; one that obeys them already is unchanged.

    Genes are brought into their ranges, including the number of segments, and rounded to a grid. Lengths and masses of
    the grown segments are moved towards an end of their range until their sum is within the limits. Pairs of legs are
    added from the front, or removed from the rear, until their number is. Limits have priority over the grid: where no
    value on the grid obeys them, a gene is not rounded.

    Args:
        genomes: Genomes in physical units, shape (n, n_genes); not modified.
        robot: Limits of the robots.

    Returns:
        Repaired genomes, shape (n, n_genes), such that ``repair(repair(g)) == repair(g)``.

    Raises:
        ValueError: If a value is not finite, or the shape is wrong.
    """
    genes = build_genes(robot)
    given = np.asarray(genomes, dtype=np.float64)
    if given.ndim != 2 or given.shape[1] != len(genes):
        raise ValueError(f"genomes must have the shape (n, {len(genes)}) for these limits; got {given.shape}")
    if not np.isfinite(given).all():
        row, column = np.argwhere(~np.isfinite(given))[0]
        raise ValueError(f"genome {row}: {genes.names[column]} is {given[row, column]}; it must be a finite number")

    clipped = np.clip(given, genes.low, genes.high)
    wrapped = np.mod(np.round(np.mod(given, genes.high), GRID_DECIMALS), genes.high)
    values = np.where(genes.is_cyclic, wrapped, _on_grid(clipped, genes.low, genes.high))
    values = np.where(genes.is_count, np.rint(clipped), values)

    parts = genes.parts(values)
    is_grown = np.arange(genes.n_parts) < genes.n_grown(values)[:, np.newaxis]
    for feature, (min_sum, max_sum) in ((Feature.length, robot.body_length), (Feature.mass, robot.weight)):
        low, high, *_ = _feature_ranges(robot)[feature]
        column = SEGMENT_FEATURES.index(feature)
        parts[:, :, column] = _fit_sum(genes.parts(clipped)[:, :, column], is_grown, low, high, min_sum, max_sum)
    column = SEGMENT_FEATURES.index(Feature.legs)
    parts[:, :, column] = _fit_leg_pairs(parts[:, :, column], is_grown, *robot.leg_pairs)
    return values


def _on_grid(x: Floats, low: float | Floats, high: float | Floats) -> Floats:
    """Round values to the grid; values equal to ``low`` or ``high``, which may be off the grid, are unchanged."""
    return np.where((x == low) | (x == high), x, np.clip(np.round(x, GRID_DECIMALS), low, high))


def _fit_sum(x: Floats, is_grown: NDArray[np.bool_], low: float, high: float, min_sum: float, max_sum: float) -> Floats:
    """Move values towards an end of their range until the sum of the grown segments is within its limits.

    The results are rounded to the grid: each value by itself or, if that violates the limits of the sum, the cumulative
    sum; if that violates them too, they are not rounded.

    Args:
        x: Values of one feature, shape (n, n_parts).
        is_grown: Whether each segment is grown, same shape.
        low: Minimum of each value.
        high: Maximum of each value.
        min_sum: Minimum of the sum of the grown values.
        max_sum: Maximum of the sum of the grown values.

    Returns:
        Values, shape (n, n_parts).
    """
    tolerance = SUM_TOLERANCE * max_sum

    def sum_grown(x: Floats) -> Floats:
        return np.where(is_grown, x, 0.0).sum(axis=1, keepdims=True)

    def is_within_limits(x: Floats) -> NDArray[np.bool_]:
        return (min_sum - tolerance <= sum_grown(x)) & (sum_grown(x) <= max_sum + tolerance)

    lowest = sum_grown(np.full_like(x, low))
    highest = sum_grown(np.full_like(x, high))
    with np.errstate(divide="ignore", invalid="ignore"):
        decreased = low + (x - low) * (max_sum - lowest) / (sum_grown(x) - lowest)
        increased = high - (high - x) * (highest - min_sum) / (highest - sum_grown(x))
    is_too_high = sum_grown(x) > max_sum + tolerance
    is_too_low = sum_grown(x) < min_sum - tolerance
    exact = np.clip(np.where(is_too_high, decreased, np.where(is_too_low, increased, x)), low, high)

    steps = np.cumsum(np.where(is_grown, exact, 0.0), axis=1) * 10**GRID_DECIMALS
    is_in_upper_half = 2 * sum_grown(exact) > min_sum + max_sum
    steps = np.where(is_in_upper_half, np.floor(steps + GRID_TOLERANCE), np.ceil(steps - GRID_TOLERANCE))
    rounded_sums = np.clip(np.diff(steps, axis=1, prepend=0.0) / 10**GRID_DECIMALS, low, high)
    rounded = _on_grid(exact, low, high)
    fitted = np.where(is_within_limits(rounded), rounded, np.where(is_within_limits(rounded_sums), rounded_sums, exact))
    return np.where(is_grown, fitted, _on_grid(x, low, high))


def _fit_leg_pairs(legs: Floats, is_grown: NDArray[np.bool_], min_pairs: int, max_pairs: int) -> Floats:
    """Add pairs of legs from the front, or remove them from the rear, until the number of pairs is within its limits.

    Args:
        legs: Number of leg pairs of each segment, 0 or 1, shape (n, n_parts).
        is_grown: Whether each segment is grown, same shape.
        min_pairs: Minimum number of pairs.
        max_pairs: Maximum number of pairs.

    Returns:
        Number of leg pairs of each segment, shape (n, n_parts).
    """
    without_legs = is_grown & (legs < 1)
    with_legs = is_grown & (legs >= 1)
    n_pairs = with_legs.sum(axis=1, keepdims=True)
    is_added = without_legs & (np.cumsum(without_legs, axis=1) <= min_pairs - n_pairs)
    is_removed = with_legs & (np.cumsum(with_legs, axis=1) > max_pairs)
    return np.where(is_added, 1.0, np.where(is_removed, 0.0, legs))
