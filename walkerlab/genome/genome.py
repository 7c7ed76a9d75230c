"""Genomes: what a robot inherits, as numbers and as text.

Segments first, each with its legs; then the gait, a step for each segment:

    wl1 segments=2 | seg length=0.31 mass=2.1 legs length=0.28 force=14 | seg … | gait frequency=1.6 | step …
"""

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import itemgetter
from typing import Any, Protocol, Self, cast

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from walkerlab.errors import Fault
from walkerlab.ga.genes import Floats
from walkerlab.genome.repair import MAX_SEGMENTS, PART, WHOLE, genes_of, repair
from walkerlab.readonly import ReadOnlyArrays
from walkerlab.settings.arguments import require_generator
from walkerlab.settings.choices import Feature
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import brief, count
from walkerlab.text.html import Html, code, details, join, shown, table, tag


class GenomeError(Fault, ValueError):
    """A text that is no genome; it says where, and what was expected there."""


class HasGenome(Protocol):
    """What stands for its genome wherever one is asked for: an ``Individual``, an ``Evaluation``."""

    @property
    def genome(self) -> "Genome | str":
        """Its genome, or the text of it."""
        ...


@dataclass(frozen=True, eq=False)
class Genome(ReadOnlyArrays):
    """One individual's gene values.

    Attributes:
        values: (n_genes,) in physical units, read-only; columns as in ``gene_table``. The number of segments
            that it describes, grown or not, follows from its length.

    Raises:
        ValueError: if it is no row of numbers, its length is that of no genome, or a value is not finite.
    """

    values: Floats

    def __post_init__(self) -> None:
        """Take a read-only copy."""
        try:
            values = np.asarray(self.values, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise ValueError(f"a genome's values are a row of numbers; got {brief(self.values)}") from None
        n_parts, rest = divmod(values.size - len(WHOLE), len(PART))
        if values.ndim != 1 or rest or not 1 <= n_parts <= MAX_SEGMENTS:
            got = f"an array of shape {values.shape}" if values.ndim else brief(self.values)
            raise ValueError(
                f"a genome has {len(WHOLE)} genes and {len(PART)} more for each of 1 to {MAX_SEGMENTS} segments, "
                f"in one row; got {got}"
            )
        if not np.isfinite(values).all():
            raise ValueError(f"gene {int(np.argmin(np.isfinite(values)))} of the genome is not a finite number")
        values = values + 0.0  # a copy, in which -0.0 is 0.0: equal genomes are alike bit for bit
        object.__setattr__(self, "values", values)
        super().__post_init__()

    @classmethod
    def random(cls, robot: Robot, *, rng: Generator) -> Self:
        """Draw every gene evenly from its range, and repair: the first generation.

        Raises:
            ValueError: If ``robot`` is not a ``Robot``.
            TypeError: If ``rng`` is not a numpy random Generator.
        """
        genes = genes_of(robot)
        rng = require_generator(rng)
        drawn = rng.uniform(genes.low, genes.high)
        whole = rng.integers(genes.low.astype(int), genes.high.astype(int), endpoint=True)
        return cls(repair(np.where(genes.is_count, whole, drawn)[np.newaxis], robot)[0])

    @classmethod
    def of(cls, given: "Genome | str | ArrayLike | HasGenome") -> "Genome":
        """Take a genome as it is, or that of an individual, or read it from its text or its (n_genes,) values.

        Raises:
            GenomeError: if a text is no genome.
            ValueError: if values are no genome.
            TypeError: if it is a run, a table or settings.
        """
        if isinstance(given, Genome):
            return given
        if isinstance(given, str):
            return cls.parse(given)
        _refuse_what_has_none(given)
        return cls.of(given.genome) if hasattr(given, "genome") else cls(given)  # type: ignore[arg-type,union-attr]

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read a genome from its text form; the numbers may be edited by hand.

        Raises:
            GenomeError: pointing at the place, and saying what was expected there.
        """
        return cls(np.array(_parse(text)))

    def __str__(self) -> str:
        """Write the text form, from which ``parse`` gives back the very same numbers."""
        numbers = [repr(value).removesuffix(".0") for value in self.values.tolist()]
        for place in range(_FIRST_LEGS, len(numbers), len(PART)):
            numbers[place] = _LEG_WORDS.get(numbers[place], f"legs={numbers[place]}")
        return _form(self.n_parts).format(*numbers)

    def __repr__(self) -> str:
        """Show what can be pasted back."""
        return f"Genome.parse({str(self)!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Genome) and np.array_equal(self.values, other.values)

    def __hash__(self) -> int:
        return hash(self.values.tobytes())

    def _repr_html_(self) -> str:
        return shown(in_words(self))

    @property
    def n_parts(self) -> int:
        """How many segments it describes, grown or not."""
        return (self.values.size - len(WHOLE)) // len(PART)

    def within(self, robot: Robot) -> Self:
        """Return the nearest genome that obeys these limits; segments beyond what they allow are cut off.

        Where it describes fewer segments than the limits allow, it gets copies of its last, grown if its count says so.
        """
        genes_of(robot)  # which checks it
        whole, parts = self.values[: len(WHOLE)], self.values[len(WHOLE) :].reshape(self.n_parts, -1)
        parts = parts[np.minimum(np.arange(robot.segments[1]), self.n_parts - 1)]
        return type(self)(repair(np.concatenate([whole, parts.ravel()])[np.newaxis], robot)[0])


def _refuse_what_has_none(given: Any) -> None:
    """Name the mend for what is often given in place of a genome."""
    if hasattr(given, "columns"):  # before it is asked for its genome: it has a column of that name
        raise TypeError("this is a table, and a genome is wanted; give a cell of its column genome: table.genome[0]")
    if hasattr(given, "champion"):
        raise TypeError("this is a run, and a genome is wanted, of one robot; give run.champion")
    if hasattr(given, "phenotype"):
        raise TypeError("this is a walk, or the scene of one, and a genome is wanted; give the genome that walked")
    if given is None:
        raise TypeError("a genome is wanted: a Genome, its text, its values or an individual; got None")
    if (
        isinstance(given, list | tuple)
        and not hasattr(given, "genome")
        and any(isinstance(one, Genome | str) for one in cast(Iterable[Any], given))
    ):
        raise TypeError("this takes one genome, and got several; give one of them: genomes[0]")
    if isinstance(given, Settings):
        raise TypeError("these are settings, and a genome is wanted; it comes first, and then the settings")


def in_words(genome: Genome) -> Html:
    """Write a genome for people, under the names of its text form: its body, its gait, and the text to copy.

    What is not grown is faint: whole segments, and the legs of those that have none.
    """
    n_meant, frequency = genome.values[: len(WHOLE)].tolist()
    parts = genome.values[len(WHOLE) :].reshape(genome.n_parts, -1).tolist()
    genes = [dict(zip(PART, values, strict=True)) for values in parts]
    n_grown = sum(place < n_meant for place in range(genome.n_parts))
    kinds = ["" if place < n_meant else "faint" for place in range(genome.n_parts)]

    def rows(features: tuple[Feature, ...]) -> Iterator[list[object]]:
        for place, gene in enumerate(genes):
            cells = (_cell(feature, gene[feature], expressed=gene[Feature.legs] != 0) for feature in features)
            yield [f"{place + 1}{' (not grown)' if kinds[place] else ''}", *cells]

    segments = count(genome.n_parts, "segment")
    body = table(
        f"Body: {f'{n_grown} of {segments} grown' if n_grown < genome.n_parts else segments}",
        ["seg", "length [m]", "mass [kg]", "legs", "length [m]", "force [N·m]"],
        rows(PART[:5]),
        numbers=(1, 2, 4, 5),
        classes=kinds,
    )
    gait = table(
        f"Gait: frequency {_number(frequency)} Hz; angles in rad",
        ["step", *_MOTIONS, *_MOTIONS, "stride"],
        rows(PART[5:]),
        groups=[("", 1), ("hip", 3), ("knee", 3), ("", 1)],
        numbers=range(1, 8),
        classes=kinds,
    )
    idle = tag("p", "What is not grown is inherited and mutated all the same.", class_="faint")
    text = details("The gene as text, to copy and to edit", code(str(genome)))
    return join(tag("div", body, gait, class_="beside"), idle if n_grown < genome.n_parts else "", text)


def _cell(feature: Feature, value: float, *, expressed: bool) -> object:
    if feature == Feature.legs:
        return "legs" if value else "nolegs"
    text = _number(value)
    return text if expressed or feature in (Feature.length, Feature.mass) else tag("span", text, class_="faint")


def _number(value: float) -> str:
    return f"{value:.3f}" if abs(value) < 1e6 else f"{value:.3g}"


def read_genomes(given: Iterable[Genome | str | ArrayLike | HasGenome]) -> list[Genome]:
    """Read several genomes, each as ``Genome.of`` does.

    Raises:
        GenomeError: if a text is no genome.
        ValueError: if values are no genome, or a single one is given, which has parts that could be taken for several.
        TypeError: if it is a run, a table or settings.
    """
    is_row = isinstance(given, np.ndarray) and given.ndim == 1 and given.dtype.kind in "fiu" and given.size
    if hasattr(given, "champion") or hasattr(given, "columns"):
        where = "run.records.genome" if hasattr(given, "champion") else "table.genome"
        raise TypeError(f"this takes several genomes, as a list; those of a run or its table are {where}")
    if isinstance(given, Mapping):
        raise TypeError("this takes several genomes, as a list; got a dict: give list(genomes.values())")
    if given is not None and not isinstance(given, list | tuple):  # pyright: ignore[reportUnnecessaryComparison]
        _refuse_what_has_none(given)
    if not isinstance(given, Iterable | Genome) and not hasattr(given, "genome"):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"this takes several genomes, as a list; got {brief(given)}")
    if is_row or isinstance(given, Genome | str) or hasattr(given, "genome"):
        raise ValueError("this takes several genomes, and got a single one; put it in a list: [genome]")
    return [Genome.of(one) for one in given]


@lru_cache(maxsize=int(MAX_SEGMENTS))
def _layout(n_parts: int) -> tuple[tuple[str, int | None], ...]:
    """List the tokens of the text form in order: a word, or a key and the index of its gene."""

    def gene(feature: Feature, part: int = 0) -> int:
        return WHOLE.index(feature) if feature in WHOLE else 2 + part * len(PART) + PART.index(feature)

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
                for motion in _MOTIONS:
                    yield f"{motion}=", gene(Feature[f"{joint}_{motion}"], part)
            yield "stride=", gene(Feature.stride, part)

    return tuple(tokens())


_MOTIONS = ("amplitude", "phase", "offset")
_LEGS = {"nolegs": 0.0, "legs": 1.0}
_LEG_WORDS = {"0": "nolegs", "1": "legs"}
_FIRST_LEGS = len(WHOLE) + PART.index(Feature.legs)
_MAX_TEXT = 20_000
_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,3})?"
_PLAIN = r"(-?\d{1,9}+\.?\d{0,17}+)"  # as nearly all of our own numbers are


@lru_cache
def _pattern(key: str) -> re.Pattern[str]:
    return re.compile(re.escape(key) + _NUMBER, re.ASCII)


@lru_cache(maxsize=int(MAX_SEGMENTS))
def _form(n_parts: int) -> str:
    """Return the text form with a gap for each gene."""
    return " ".join(
        token if index is None else f"{{{index}}}" if token == "legs" else f"{token}{{{index}}}"
        for token, index in _layout(n_parts)
    )


@lru_cache(maxsize=int(MAX_SEGMENTS))
def _plain(n_parts: int) -> tuple[re.Pattern[str], Callable[[Sequence[str]], tuple[str, ...]]]:
    """Return what the text form is like where all numbers are plain decimals, and what puts its genes in order."""
    layout = _layout(n_parts)
    words = (
        re.escape(token) if index is None else "((?:no)?legs)" if token == "legs" else re.escape(token) + _PLAIN
        for token, index in layout
    )
    written = [index for _, index in layout if index is not None]
    return re.compile(" ".join(words), re.ASCII), itemgetter(*(written.index(gene) for gene in range(len(written))))


def _parse(text: str) -> list[float]:
    if not isinstance(text, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise GenomeError(f"a genome is read from its text, a str; got {brief(text)}")
    if len(text) > _MAX_TEXT:
        raise GenomeError(f"a genome's text has at most {_MAX_TEXT} characters; this one has {len(text)}")
    pattern, in_order = _plain(min(max(text.count("| seg "), 1), int(MAX_SEGMENTS)))
    if plain := pattern.fullmatch(text):  # what was edited may not be, and is read word by word
        return [_LEGS[gene] if gene in _LEGS else float(gene) for gene in in_order(plain.groups())]
    found = [(match.group(), match.start()) for match in re.finditer(r"\||[^\s|]+", text)]
    n_parts = sum(word == "seg" for word, _ in found)
    n_parts = min(max(n_parts, 1), int(MAX_SEGMENTS))
    layout = _layout(n_parts)
    values = [0.0] * (len(WHOLE) + n_parts * len(PART))
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
            if not _pattern(key).fullmatch(word):
                expected = "'legs' or 'nolegs'" if token == "legs" else f"'{token}' and a number, as in '{token}1.5'"
                raise _error(text, start, expected, word)
            values[index] = float(word.removeprefix(key))
            if not math.isfinite(values[index]):
                raise _error(text, start, f"'{token}' and a finite number", word)
    if len(found) > len(layout):
        word, start = found[len(layout)]
        raise _error(text, start, "the end of the text", word)
    return values


def _error(text: str, start: int, expected: str, got: str) -> GenomeError:
    """Point at a place; a sign that cannot be printed, or does things to a terminal, is shown by another."""
    n_before = min(start, 30)
    near = text[start - n_before : start + 30]
    signs = (" " if sign.isspace() else sign if sign.isprintable() else "�" for sign in near)
    return GenomeError(
        f"not a genome: at character {start + 1} expected {expected}, got {brief(got)}\n"
        f"    {''.join(signs)}\n    {' ' * n_before}^"
    )
