"""The repair that brings any genome within the limits of the robots."""

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from walkerlab.ga.genes import Floats
from walkerlab.genome.features import LEG_LENGTH, LEGS, LENGTH, MASS, build_genes, feature_ranges, find_leg_sources
from walkerlab.settings.choices import Feature
from walkerlab.settings.proportions import MAX_LEGS_MASS, MAX_TRUNK_MASS, MIN_LEGS_MASS, MIN_TRUNK_MASS
from walkerlab.settings.robot import Robot

GRID_DECIMALS = 3
"""Decimals to which repair rounds genes (millimetres, grams, milliradians), so that the text form is short."""

SUM_TOLERANCE = 1e-10  # relative to the maximum of the sum
GRID_TOLERANCE = 1e-6  # steps of the grid


def repair(genomes: ArrayLike, robot: Robot) -> Floats:
    """Return a nearby genome within all limits for each genome; a genome already within them is unchanged.

    Genes are brought into their ranges, including the number of segments, and rounded to a grid. Lengths and masses of
    the expressed segments are moved towards an end of their range until their sum is within the limits. Pairs of legs
    are added from the front, or removed from the rear, until their number is within the limits. The range of a mass is
    what a trunk and legs of this length can weigh at a plausible density. Limits have priority over the grid: if no
    value on the grid is within them, a gene is not rounded.

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
    is_expressed = np.arange(genes.n_parts) < genes.n_expressed(values)[:, np.newaxis]
    parts[:, :, LEGS] = _fit_leg_pairs(parts[:, :, LEGS], is_expressed, *robot.leg_pairs)
    exact = genes.parts(clipped)
    sums = _body_lengths(robot, genes.n_expressed(values))
    parts[:, :, LENGTH] = _fit_sum(exact[:, :, LENGTH], is_expressed, *robot.segment_length, *sums)
    fitted = _fit_sum(exact[:, :, MASS], is_expressed, *_mass_limits(parts, robot), *robot.weight)
    parts[:, :, MASS] = np.where(is_expressed, fitted, parts[:, :, MASS])
    return values


def draw_sizes(genomes: Floats, robot: Robot, rng: Generator) -> Floats:
    """Return repaired genomes with new sums of lengths and masses, drawn uniformly within the limits.

    Repair moves a sum that is outside its limits to the nearest limit, and the sums of uniformly drawn genes are often
    outside. Each length and mass is moved towards an end of its range until the sum has the drawn value.

    Args:
        genomes: Repaired genomes, shape (n, n_genes); not modified.
        robot: Limits of the robots.
        rng: Random number generator.
    """
    genes = build_genes(robot)
    values = genomes.copy()
    parts = genes.parts(values)
    is_expressed = np.arange(genes.n_parts) < genes.n_expressed(values)[:, np.newaxis]
    shortest, longest = (np.full(is_expressed.shape, end) for end in robot.segment_length)
    sums = _body_lengths(robot, genes.n_expressed(values))
    parts[:, :, LENGTH] = _draw_sum(parts[:, :, LENGTH], is_expressed, shortest, longest, *sums, rng=rng)
    lightest, heaviest = _mass_limits(parts, robot)
    parts[:, :, MASS] = _draw_sum(parts[:, :, MASS], is_expressed, lightest, heaviest, *robot.weight, rng=rng)
    return repair(values, robot)


def _draw_sum(
    x: Floats,
    is_expressed: NDArray[np.bool_],
    low: Floats,
    high: Floats,
    min_sum: float | Floats,
    max_sum: float | Floats,
    *,
    rng: Generator,
) -> Floats:
    """Move the values of expressed segments to a random sum within its limits; shapes as in ``_fit_sum``."""
    min_sum = np.maximum(min_sum, np.where(is_expressed, low, 0.0).sum(axis=1, keepdims=True))
    max_sum = np.minimum(max_sum, np.where(is_expressed, high, 0.0).sum(axis=1, keepdims=True))
    drawn = np.round(rng.uniform(min_sum, np.maximum(min_sum, max_sum)), GRID_DECIMALS).clip(min_sum, max_sum)
    return np.where(is_expressed, _fit_sum(x, is_expressed, low, high, drawn, drawn), x)


def _body_lengths(robot: Robot, n_segments: NDArray[np.intp]) -> tuple[Floats, Floats]:
    """Return the lowest and highest length [m] of bodies with these numbers of segments, shape (n, 1) each."""
    ranges = np.array([robot.length_for_weight(n) for n in range(1, robot.segments[1] + 1)])
    low, high = ranges[n_segments - 1, :, np.newaxis].swapaxes(0, 1)
    return low, high


def _mass_limits(parts: Floats, robot: Robot) -> tuple[Floats, Floats]:
    """Return the lowest and highest mass of segments with their legs [kg], on the grid, shape (n, n_parts) each."""
    trunk = parts[:, :, LENGTH] ** 3
    sources = find_leg_sources(parts)
    leg_lengths = np.take_along_axis(parts[:, :, LEG_LENGTH], np.maximum(sources, 0), axis=1)
    legs = np.where(sources >= 0, leg_lengths, 0.0) ** 3
    low, high, *_ = feature_ranges(robot)[Feature.mass]
    scale = 10**GRID_DECIMALS
    lowest = np.ceil((MIN_TRUNK_MASS * trunk + MIN_LEGS_MASS * legs) * scale) / scale
    highest = np.floor((MAX_TRUNK_MASS * trunk + MAX_LEGS_MASS * legs) * scale) / scale
    return np.maximum(lowest, low), np.minimum(highest, high)


def _on_grid(x: Floats, low: float | Floats, high: float | Floats) -> Floats:
    """Round values to the grid; values equal to ``low`` or ``high``, which may be off the grid, are unchanged."""
    return np.where((x == low) | (x == high), x, np.clip(np.round(x, GRID_DECIMALS), low, high))


def _fit_sum(
    x: Floats,
    is_expressed: NDArray[np.bool_],
    low: float | Floats,
    high: float | Floats,
    min_sum: float | Floats,
    max_sum: float | Floats,
) -> Floats:
    """Move values towards an end of their range until the sum of the expressed segments is within its limits.

    The results are rounded to the grid: each value on its own; if the sum is then outside its limits, the cumulative
    sums instead; if it is still outside, nothing is rounded.

    Args:
        x: Values of one feature, shape (n, n_parts).
        is_expressed: Whether each segment is expressed, same shape.
        low: Minimum of each value; a number, or shape (n, n_parts).
        high: Maximum of each value, likewise.
        min_sum: Minimum of the sum over the expressed segments; a number, or shape (n, 1).
        max_sum: Maximum of the sum over the expressed segments, likewise.

    Returns:
        Values, shape (n, n_parts).
    """
    tolerance = SUM_TOLERANCE * max_sum
    x = np.clip(x, low, high)

    def sum_expressed(x: Floats) -> Floats:
        return np.where(is_expressed, x, 0.0).sum(axis=1, keepdims=True)

    def is_within_limits(x: Floats) -> NDArray[np.bool_]:
        return (min_sum - tolerance <= sum_expressed(x)) & (sum_expressed(x) <= max_sum + tolerance)

    lowest = sum_expressed(np.full_like(x, low))
    highest = sum_expressed(np.full_like(x, high))
    with np.errstate(divide="ignore", invalid="ignore"):
        decreased = low + (x - low) * (max_sum - lowest) / (sum_expressed(x) - lowest)
        increased = high - (high - x) * (highest - min_sum) / (highest - sum_expressed(x))
    is_too_high = sum_expressed(x) > max_sum + tolerance
    is_too_low = sum_expressed(x) < min_sum - tolerance
    exact = np.clip(np.where(is_too_high, decreased, np.where(is_too_low, increased, x)), low, high)

    steps = np.cumsum(np.where(is_expressed, exact, 0.0), axis=1) * 10**GRID_DECIMALS
    is_in_upper_half = 2 * sum_expressed(exact) > min_sum + max_sum
    steps = np.where(is_in_upper_half, np.floor(steps + GRID_TOLERANCE), np.ceil(steps - GRID_TOLERANCE))
    rounded_sums = np.clip(np.diff(steps, axis=1, prepend=0.0) / 10**GRID_DECIMALS, low, high)
    rounded = _on_grid(exact, low, high)
    fitted = np.where(is_within_limits(rounded), rounded, np.where(is_within_limits(rounded_sums), rounded_sums, exact))
    return np.where(is_expressed, fitted, _on_grid(x, low, high))


def _fit_leg_pairs(legs: Floats, is_expressed: NDArray[np.bool_], min_pairs: int, max_pairs: int) -> Floats:
    """Add pairs of legs from the front, or remove them from the rear, until the number of pairs is within its limits.

    Args:
        legs: Number of leg pairs of each segment, 0 or 1, shape (n, n_parts).
        is_expressed: Whether each segment is expressed, same shape.
        min_pairs: Minimum number of pairs.
        max_pairs: Maximum number of pairs.

    Returns:
        Number of leg pairs of each segment, shape (n, n_parts).
    """
    without_legs = is_expressed & (legs < 1)
    with_legs = is_expressed & (legs >= 1)
    n_pairs = with_legs.sum(axis=1, keepdims=True)
    is_added = without_legs & (np.cumsum(without_legs, axis=1) <= min_pairs - n_pairs)
    is_removed = with_legs & (np.cumsum(with_legs, axis=1) > max_pairs)
    return np.where(is_added, 1.0, np.where(is_removed, 0.0, legs))
