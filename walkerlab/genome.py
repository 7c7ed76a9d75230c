"""Genomes: what a robot inherits, as numbers and as text, and the repair that keeps it within the limits.

wl1 segments=2 | seg length=0.31 mass=2.1 legs length=0.28 force=14 | seg … | gait frequency=1.6 | step …
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Self

import numpy as np
import pandas as pd
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from walkerlab.genes import Floats, Genes, Kind
from walkerlab.settings import Feature, Robot

GRID = 3
"""Decimals that repair keeps: a gene is whole in millimetres, grams, milliradians, so that it can be copied by hand."""

MAX_SEGMENTS = Robot.declared()["segments"].high  # type: ignore[union-attr]

_WHOLE = (Feature.segments, Feature.frequency)
_PART = tuple(feature for feature in Feature if feature not in _WHOLE)
_TURN = 6.283


class GenomeError(ValueError):
    """A text that is no genome; it says where, and what was expected there."""


def _ranges(robot: Robot) -> dict[Feature, tuple[float, float, str, Kind]]:
    """State low, high, unit and kind of every feature."""
    shortest, longest = robot.segment_length
    angle = "rad"
    return {
        Feature.segments: (*robot.segment_range, "", "count"),
        Feature.frequency: (0.4, 2.5, "Hz", "real"),
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
    ranges = _ranges(robot)
    n_parts = robot.segments[1]
    columns = [(feature.name, feature) for feature in _WHOLE]
    columns += [(f"seg{part}.{feature.name}", feature) for part in range(1, n_parts + 1) for feature in _PART]
    low, high, units, kinds = zip(*(ranges[feature] for _, feature in columns), strict=True)
    return Genes(
        names=tuple(name for name, _ in columns),
        units=units,
        kinds=kinds,
        meanings=tuple(feature.about for _, feature in columns),
        low=np.array(low, dtype=np.float64),
        high=np.array(high, dtype=np.float64),
        n_parts=n_parts,
        n_whole=len(_WHOLE),
        count=_WHOLE.index(Feature.segments),
    )


def gene_table(robot: Robot) -> pd.DataFrame:
    """Return the gene table for people: a row for each gene, with its unit, range, kind and meaning."""
    genes = genes_of(robot)
    columns = ("names", "units", "low", "high", "kinds", "meanings")
    titles = ("gene", "unit", "low", "high", "kind", "meaning")
    return pd.DataFrame({title: list(getattr(genes, column)) for title, column in zip(titles, columns, strict=True)})


@dataclass(frozen=True, eq=False)
class Genome:
    """One individual's gene values.

    Attributes:
        values: (n_genes,) in physical units, read-only; columns as in ``gene_table``. The number of segments
            that it describes, grown or not, follows from its length.

    Raises:
        ValueError: if the length is that of no genome, or a value is not finite.
    """

    values: Floats

    def __post_init__(self) -> None:
        """Take a read-only copy."""
        values = np.array(self.values, dtype=np.float64) + 0.0  # -0.0 becomes 0.0: equal genomes are alike bit for bit
        n_parts, rest = divmod(values.size - len(_WHOLE), len(_PART))
        if values.ndim != 1 or rest or not 1 <= n_parts <= MAX_SEGMENTS:
            raise ValueError(
                f"a genome has {len(_WHOLE)} genes and {len(_PART)} more for each of 1 to {MAX_SEGMENTS} segments, "
                f"in one row; got an array of shape {values.shape}"
            )
        if not np.isfinite(values).all():
            raise ValueError(f"gene {int(np.argmin(np.isfinite(values)))} of the genome is not a finite number")
        values.setflags(write=False)
        object.__setattr__(self, "values", values)

    @classmethod
    def random(cls, robot: Robot, *, rng: Generator) -> Self:
        """Draw every gene evenly from its range, and repair: the first generation."""
        genes = genes_of(robot)
        drawn = rng.uniform(genes.low, genes.high)
        whole = rng.integers(genes.low.astype(int), genes.high.astype(int), endpoint=True)
        return cls(repair(np.where(genes.is_count, whole, drawn)[np.newaxis], robot)[0])

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read a genome from its text form; the numbers may be edited by hand.

        Raises:
            GenomeError: pointing at the place, and saying what was expected there.
        """
        return cls(np.array(_parse(text)))

    def __str__(self) -> str:
        """Write the text form, from which ``parse`` gives back the very same numbers."""
        return " ".join(_write(token, index, self.values) for token, index in _layout(self.n_parts))

    def __repr__(self) -> str:
        """Show what can be pasted back."""
        return f"Genome.parse({str(self)!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Genome) and np.array_equal(self.values, other.values)

    def __hash__(self) -> int:
        return hash(self.values.tobytes())

    @property
    def n_parts(self) -> int:
        """How many segments it describes, grown or not."""
        return (self.values.size - len(_WHOLE)) // len(_PART)

    def within(self, robot: Robot) -> Self:
        """Return the nearest genome that obeys these limits; segments beyond what they allow are cut off.

        A genome that describes fewer segments than the limits allow gets copies of its last, unexpressed.
        """
        whole, parts = self.values[: len(_WHOLE)], self.values[len(_WHOLE) :].reshape(self.n_parts, -1)
        parts = parts[np.minimum(np.arange(robot.segments[1]), self.n_parts - 1)]
        return type(self)(repair(np.concatenate([whole, parts.ravel()])[np.newaxis], robot)[0])


# ------------------------------------------------------------------------------------------- what it expresses


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
    count, frequency = genome.values[: len(_WHOLE)].tolist()
    parts = genome.values[len(_WHOLE) :].reshape(genome.n_parts, -1)[: int(count)]

    def segment(values: list[float]) -> Segment:
        gene = dict(zip(_PART, values, strict=True))
        swings = [
            Swing(*(gene[Feature[f"{joint}_{motion}"]] for motion in ("amplitude", "phase", "offset")))
            for joint in ("hip", "knee")
        ]
        legs = Legs(gene[Feature.leg_length], gene[Feature.leg_force], swings[0], swings[1], gene[Feature.stride])
        return Segment(gene[Feature.length], gene[Feature.mass], legs if gene[Feature.legs] else None)

    return Phenotype(tuple(map(segment, parts.tolist())), frequency)


# ---------------------------------------------------------------------------------------------- the limits


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
        column = _PART.index(feature)
        parts[:, :, column] = _with_sum(genes.parts(clipped)[:, :, column], grown, low, high, least, most)
    column = _PART.index(Feature.legs)
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


# ------------------------------------------------------------------------------------------------- the text


@lru_cache(maxsize=int(MAX_SEGMENTS))
def _layout(n_parts: int) -> tuple[tuple[str, int | None], ...]:
    """List the tokens of the text form in order: a word, or a key and the index of its gene."""

    def gene(feature: Feature, part: int = 0) -> int:
        return _WHOLE.index(feature) if feature in _WHOLE else 2 + part * len(_PART) + _PART.index(feature)

    def tokens() -> Iterator[tuple[str, int | None]]:
        yield "wl1", None
        yield "segments=", gene(Feature.segments)
        for part in range(n_parts):
            yield from (("|", None), ("seg", None))
            yield "length=", gene(Feature.length, part)
            yield "mass=", gene(Feature.mass, part)
            yield "legs", gene(Feature.legs, part)
            yield "length=", gene(Feature.leg_length, part)
            yield "force=", gene(Feature.leg_force, part)
        yield from (("|", None), ("gait", None))
        yield "frequency=", gene(Feature.frequency)
        for part in range(n_parts):
            yield from (("|", None), ("step", None))
            for joint in ("hip", "knee"):
                yield joint, None
                for motion in ("amplitude", "phase", "offset"):
                    yield f"{motion}=", gene(Feature[f"{joint}_{motion}"], part)
            yield "stride=", gene(Feature.stride, part)

    return tuple(tokens())


_LEGS = {"nolegs": 0.0, "legs": 1.0}
_MAX_TEXT = 20_000
_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,3})?"


def _write(token: str, index: int | None, values: Floats) -> str:
    if index is None:
        return token
    value = float(values[index])
    number = repr(value).removesuffix(".0")
    if token == "legs":
        return next((word for word, meaning in _LEGS.items() if meaning == value), f"legs={number}")
    return token + number


def _parse(text: str) -> list[float]:
    if len(text) > _MAX_TEXT:
        raise GenomeError(f"a genome's text has at most {_MAX_TEXT} characters; this one has {len(text)}")
    found = [(match.group(), match.start()) for match in re.finditer(r"\||[^\s|]+", text)]
    n_parts = sum(word == "seg" for word, _ in found)
    n_parts = min(max(n_parts, 1), int(MAX_SEGMENTS))
    layout = _layout(n_parts)
    values = [0.0] * (len(_WHOLE) + n_parts * len(_PART))
    for place, (token, index) in enumerate(layout):
        word, start = found[place] if place < len(found) else ("the end of the text", len(text.rstrip()))
        if index is None:
            if word != token:
                why = f" after at most {MAX_SEGMENTS} segments" if (token, word) == ("gait", "seg") else ""
                raise _error(text, start, f"'{token}'{why}", word)
        elif token == "legs" and word in _LEGS:
            values[index] = _LEGS[word]
        else:
            key = "legs=" if token == "legs" else token
            if not re.fullmatch(re.escape(key) + _NUMBER, word):
                expected = "'legs' or 'nolegs'" if token == "legs" else f"'{token}' and a number, as in '{token}1.5'"
                raise _error(text, start, expected, word)
            values[index] = float(word.removeprefix(key))
            if not np.isfinite(values[index]):
                raise _error(text, start, f"'{token}' and a finite number", word)
    if len(found) > len(layout):
        word, start = found[len(layout)]
        raise _error(text, start, "the end of the text", word)
    return values


def _error(text: str, start: int, expected: str, got: str) -> GenomeError:
    before, after = (re.sub(r"\s", " ", part) for part in (text[max(0, start - 30) : start], text[start : start + 30]))
    got = got if len(got) <= 40 else got[:40] + "…"
    return GenomeError(
        f"not a genome: at character {start + 1} expected {expected}, got '{got}'\n"
        f"    {before}{after}\n    {' ' * len(before)}^"
    )
