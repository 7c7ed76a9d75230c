"""What was done to a genome that somebody wrote by hand, to bring it within the limits: in words, gene by gene."""

import re
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from walkerlab.genome.genome import Genome
from walkerlab.genome.repair import GRID, PART, WHOLE, genes_of
from walkerlab.settings.choices import Feature
from walkerlab.settings.robot import Robot

ROUNDED = 0.51 * 10.0**-GRID  # a change that is no more than the rounding to the grid, and is not spoken of


def laid_out(genome: Genome) -> str:
    """Write a genome as its text form, with a line to each segment and step."""
    return str(genome).replace(" | ", "\n| ")


_GENES = genes_of(Robot())
_KINDS = [
    (Feature[name.rpartition(".")[2]], unit, kind)
    for name, unit, kind in zip(_GENES.names, _GENES.units, _GENES.kinds, strict=True)
]
UNITS = {feature: unit for feature, unit, _ in _KINDS if feature != Feature.legs}
CYCLIC = {feature for feature, _, kind in _KINDS if kind == "cyclic"}


class Place(NamedTuple):
    """From which to which character of a text something is, the last left out; counted as browsers count."""

    start: int
    end: int


def place_of(fault: str, text: str) -> Place | None:
    """Find the place at which a ``GenomeError`` points, in the text that it is about.

    Returns:
        The word at which it points, or where one is missing; None if it points nowhere.
    """
    named = re.search(r"at character (\d+) ", fault)
    if not named:
        return None
    start = int(named[1]) - 1
    word = re.compile(r"\||[^\s|]+").match(text, start)
    return Place(_in_browser(text[:start]), _in_browser(text[: word.end() if word else start]))


def _in_browser(text: str) -> int:
    """Count the characters of a text as JavaScript does, to which those of rare scripts are two."""
    return len(text.encode("utf-16-le", "surrogatepass")) // 2


def mended(genome: Genome, robot: Robot) -> list[str]:
    """Say which genes had to change for a genome to be within the limits: a sentence each.

    Genes of segments that it does not grow, and of legs that it does not have, are passed over.
    """
    genes, values = genes_of(robot), genome.within(robot).values
    used, given = genes.parts(values[np.newaxis])[0], genome.values[len(WHOLE) :].reshape(genome.n_parts, -1)
    lows, highs = (genes.parts(ends[np.newaxis])[0] for ends in (genes.low, genes.high))
    said = list(_about_parts(genome, robot))
    for i, kind in enumerate(WHOLE):
        said += _about_gene(kind, genome.values[i], values[i], (genes.low[i], genes.high[i]), robot)
    for part in range(min(genome.n_parts, int(values[genes.count or 0]))):
        features = PART if used[part, PART.index(Feature.legs)] else (Feature.length, Feature.mass, Feature.legs)
        for kind in features:
            at = part, PART.index(kind)
            about = _about_gene(kind, given[at], used[at], (lows[at], highs[at]), robot)
            said += [f"Segment {part + 1}: {sentence}" for sentence in about]
    return said


def _about_parts(genome: Genome, robot: Robot) -> Iterator[str]:
    most, wanted = robot.segments[1], min(genome.values[0], robot.segments[1])
    if genome.n_parts > most:
        yield f"{genome.n_parts} segments are described, and the limits allow {most}: the others are left out."
    if genome.n_parts < wanted:
        yield f"{wanted:g} segments are to be grown, and {genome.n_parts} described: the last is grown again."


def _about_gene(kind: Feature, given: float, used: float, ends: tuple[float, float], robot: Robot) -> Iterator[str]:
    """Say of one gene what it was, why that cannot stay, and what is used in its place; nothing, if it stays."""
    if abs(given - used) <= ROUNDED:
        return
    low, high = ends
    was, least, most, now = (_written(value, kind) for value in (given, low, high, used))
    if kind in CYCLIC:
        why = "is not within one turn"
    elif given > high:
        why = f"is over the limit {most}"
    elif given < low:
        why = f"is under the limit {least}"
    elif kind == Feature.length:
        why = f"does not fit, for the whole body is to be {_span(robot.body_length)} m long"
    elif kind == Feature.mass:
        why = f"does not fit, for the whole robot is to weigh {_span(robot.weight)} kg"
    elif kind == Feature.legs and given in (0, 1):
        why = f"does not fit, for the whole robot is to have {_span(robot.legs)} legs"
    else:
        why = "is not a whole number"
    yield f"{kind.name.replace('_', ' ')} {was} {why}: {now} is used."


def _written(value: float, kind: Feature) -> str:
    return f"{value:.4g} {UNITS.get(kind, '')}".rstrip()


def _span(ends: tuple[float, float]) -> str:
    return f"{ends[0]:g} to {ends[1]:g}"
