"""The limits: what gene table they ask for, and the repair that brings every genome within them."""

from functools import lru_cache

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from walkerlab.ga.genes import Floats, Genes, Kind
from walkerlab.settings.choices import Feature
from walkerlab.settings.robot import Robot

GRID = 3
"""Decimals that repair keeps: a gene is whole in millimetres, grams, milliradians, so that it can be copied by hand."""

MAX_SEGMENTS = Robot.declared()["segments"].high  # type: ignore[union-attr]

WHOLE = (Feature.segments, Feature.frequency)
PART = tuple(feature for feature in Feature if feature not in WHOLE)
FREQUENCY = (0.4, 2.2)  # Hz, of strides
_TURN = 6.283


def _ranges(robot: Robot) -> dict[Feature, tuple[float, float, str, Kind]]:
    """State low, high, unit and kind of every feature."""
    shortest, longest = robot.segment_length
    angle = "rad"
    return {
        Feature.segments: (*robot.segment_range, "", "count"),
        Feature.frequency: (*FREQUENCY, "Hz", "real"),
        Feature.length: (shortest, longest, "m", "real"),
        Feature.mass: (robot.weight[0] / (2 * robot.segments[1]), robot.weight[1], "kg", "real"),
        Feature.legs: (0, 1, "pair", "count"),
        Feature.leg_length: (0.5 * shortest, 1.2 * longest, "m", "real"),
        Feature.leg_force: (*robot.leg_force, "N·m", "real"),
        Feature.hip_amplitude: (0.0, 1.0, angle, "real"),
        Feature.hip_phase: (0.0, _TURN, angle, "cyclic"),
        Feature.hip_offset: (-0.8, 0.8, angle, "real"),
        Feature.knee_amplitude: (0.0, 1.0, angle, "real"),
        Feature.knee_phase: (0.0, _TURN, angle, "cyclic"),
        Feature.knee_offset: (-1.2, 1.2, angle, "real"),
        Feature.stride: (0.0, _TURN, angle, "cyclic"),
    }


@lru_cache(maxsize=64)
def genes_of(robot: Robot) -> Genes:
    """Return the gene table of robots within these limits: two genes of the whole body, twelve for each segment."""
    if not isinstance(robot, Robot):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(f"this takes the limits, a Robot such as settings.robot; got a {type(robot).__name__}")
    ranges = _ranges(robot)
    n_parts = robot.segments[1]
    columns = [(feature.name, feature) for feature in WHOLE]
    columns += [(f"seg{part}.{feature.name}", feature) for part in range(1, n_parts + 1) for feature in PART]
    low, high, units, kinds = zip(*(ranges[feature] for _, feature in columns), strict=True)
    return Genes(
        names=tuple(name for name, _ in columns),
        units=units,
        kinds=kinds,
        meanings=tuple(feature.about for _, feature in columns),
        low=np.array(low, dtype=np.float64),
        high=np.array(high, dtype=np.float64),
        n_parts=n_parts,
        n_whole=len(WHOLE),
        count=WHOLE.index(Feature.segments),
    )


def gene_table(robot: Robot) -> pd.DataFrame:
    """Return the gene table for people: a row for each gene, with its unit, range, kind and meaning.

    Raises:
        ValueError: if given anything but the limits.
    """
    genes = genes_of(robot)
    columns = ("names", "units", "low", "high", "kinds", "meanings")
    titles = ("gene", "unit", "low", "high", "kind", "meaning")
    return pd.DataFrame({title: list(getattr(genes, column)) for title, column in zip(titles, columns, strict=True)})


def repair(genomes: ArrayLike, robot: Robot) -> Floats:
    """Move each genome to a nearby one whose robot obeys every limit; one that obeys, on the grid, stays as it is.

    Genes are brought into their ranges and onto the grid; the segment count into what the limits allow; lengths
    (and masses) of the grown segments are stretched towards an end of their range until their sum fits; pairs of
    legs sprout from the front, or are lost from the rear, until their number fits. Limits go before the grid: where
    no place on it obeys them, a gene stays off it.

    Args:
        genomes: (n, n_genes) in physical units; not changed.
        robot: the limits.

    Returns:
        (n, n_genes), such that ``repair(repair(g)) == repair(g)``.

    Raises:
        ValueError: if a value is not finite, or the shape does not fit.
    """
    genes = genes_of(robot)
    given = np.asarray(genomes, dtype=np.float64)
    if given.ndim != 2 or given.shape[1] != len(genes):
        raise ValueError(f"genomes must have the shape (n, {len(genes)}) for these limits; got {given.shape}")
    if not np.isfinite(given).all():
        row, column = np.argwhere(~np.isfinite(given))[0]
        raise ValueError(f"genome {row}: {genes.names[column]} is {given[row, column]}; it must be a finite number")

    clipped = np.clip(given, genes.low, genes.high)
    turned = np.mod(np.round(np.mod(given, genes.high), GRID), genes.high)
    values = np.where(genes.is_cyclic, turned, _on_grid(clipped, genes.low, genes.high))
    values = np.where(genes.is_count, np.rint(clipped), values)

    parts = genes.parts(values)
    grown = np.arange(genes.n_parts) < genes.n_grown(values)[:, np.newaxis]
    for feature, (least, most) in ((Feature.length, robot.body_length), (Feature.mass, robot.weight)):
        low, high, *_ = _ranges(robot)[feature]
        column = PART.index(feature)
        parts[:, :, column] = _with_sum(genes.parts(clipped)[:, :, column], grown, low, high, least, most)
    column = PART.index(Feature.legs)
    parts[:, :, column] = _with_pairs(parts[:, :, column], grown, *robot.leg_pairs)
    return values


def _on_grid(x: Floats, low: float | Floats, high: float | Floats) -> Floats:
    """Round to the grid; the ends of low..high stay, wherever they lie."""
    return np.where((x == low) | (x == high), x, np.clip(np.round(x, GRID), low, high))


def _with_sum(x: Floats, grown: NDArray[np.bool_], low: float, high: float, least: float, most: float) -> Floats:
    """Stretch the grown of (n, n_parts) values within low..high until each row's sum lies in least..most.

    They are put on the grid one by one, or if that spoils the sum, by the steps of their running sum, or not at all.
    """
    tolerance = 1e-10 * most

    def total(x: Floats) -> Floats:
        return np.where(grown, x, 0.0).sum(axis=1, keepdims=True)

    def fits(x: Floats) -> NDArray[np.bool_]:
        return (least - tolerance <= total(x)) & (total(x) <= most + tolerance)

    lows, highs = total(np.full_like(x, low)), total(np.full_like(x, high))
    with np.errstate(divide="ignore", invalid="ignore"):
        shrunk = low + (x - low) * (most - lows) / (total(x) - lows)
        longer = high - (high - x) * (highs - least) / (highs - total(x))
    free = np.where(total(x) > most + tolerance, shrunk, np.where(total(x) < least - tolerance, longer, x))
    free = np.clip(free, low, high)

    running = np.cumsum(np.where(grown, free, 0.0), axis=1) * 10**GRID
    running = np.where(2 * total(free) > least + most, np.floor(running + 1e-6), np.ceil(running - 1e-6))
    tiled = np.clip(np.diff(running, axis=1, prepend=0.0) / 10**GRID, low, high)
    rounded = _on_grid(free, low, high)
    fitted = np.where(fits(rounded), rounded, np.where(fits(tiled), tiled, free))
    return np.where(grown, fitted, _on_grid(x, low, high))


def _with_pairs(legs: Floats, grown: NDArray[np.bool_], least: int, most: int) -> Floats:
    """Give legs to bare grown segments from the front, or take them from the rear, until each row has its number."""
    bare, legged = grown & (legs < 1), grown & (legs >= 1)
    count = legged.sum(axis=1, keepdims=True)
    sprouting = bare & (np.cumsum(bare, axis=1) <= least - count)
    losing = legged & (np.cumsum(legged, axis=1) > most)
    return np.where(sprouting, 1.0, np.where(losing, 0.0, legs))
