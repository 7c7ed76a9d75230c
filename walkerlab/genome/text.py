"""The text form of a genome: segments first, each with its legs, then the gait, a step for each segment.

wl1 segments=2 | seg length=0.31 mass=2.1 legs length=0.28 force=14 | seg … | gait frequency=1.6 | step …
"""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from operator import itemgetter
from typing import Final

from walkerlab.errors import WalkerlabError
from walkerlab.genome.repair import BODY_FEATURES, MAX_SEGMENTS, SEGMENT_FEATURES
from walkerlab.settings.choices import Feature
from walkerlab.settings.values import short_repr

SWING_PARAMETERS: Final = ("amplitude", "phase", "offset")
"""Genes of the motion of each joint."""

MAX_TEXT_LENGTH = 20_000
ERROR_CONTEXT = 30  # characters of the text that an error shows before and after its position

LEGS_VALUES = {"nolegs": 0.0, "legs": 1.0}
LEGS_WORDS = {"0": "nolegs", "1": "legs"}
FIRST_LEGS_INDEX = len(BODY_FEATURES) + SEGMENT_FEATURES.index(Feature.legs)

NUMBER_PATTERN = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,3})?"
DECIMAL_PATTERN = r"(-?\d{1,9}+\.?\d{0,17}+)"  # matches nearly all numbers that format_text writes


class GenomeError(WalkerlabError, ValueError):
    """The text is not a genome; the message gives the position, and what was expected there."""


def count_segments(n_genes: int) -> int:
    """Return the number of segments, grown or not, that a genome of this length describes."""
    return (n_genes - len(BODY_FEATURES)) // len(SEGMENT_FEATURES)


def format_text(values: Sequence[float]) -> str:
    """Return the text form, from which ``parse_text`` reads exactly the same numbers."""
    numbers = [repr(value).removesuffix(".0") for value in values]
    for index in range(FIRST_LEGS_INDEX, len(numbers), len(SEGMENT_FEATURES)):
        numbers[index] = LEGS_WORDS.get(numbers[index], f"legs={numbers[index]}")
    return _template(count_segments(len(numbers))).format(*numbers)


def parse_text(text: str) -> list[float]:
    """Return the gene values in a text form; spacing and notation of numbers are free.

    Raises:
        GenomeError: If the text is not a genome; the message gives the position, and what was expected there.
    """
    if not isinstance(text, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise GenomeError(f"a genome is read from its text, a str; got {short_repr(text)}")
    if len(text) > MAX_TEXT_LENGTH:
        raise GenomeError(f"a genome's text has at most {MAX_TEXT_LENGTH} characters; this one has {len(text)}")
    pattern, in_gene_order = _decimal_form(_clip_n_segments(text.count("| seg ")))
    if match := pattern.fullmatch(text):
        return [LEGS_VALUES[word] if word in LEGS_VALUES else float(word) for word in in_gene_order(match.groups())]
    return _parse_word_by_word(text)


def _parse_word_by_word(text: str) -> list[float]:
    """Return the gene values in a text form that may have been edited; see ``parse_text``."""
    words = [(match.group(), match.start()) for match in re.finditer(r"\||[^\s|]+", text)]
    n_segments = _clip_n_segments(sum(word == "seg" for word, _ in words))
    layout = _text_layout(n_segments)
    values = [0.0] * (len(BODY_FEATURES) + n_segments * len(SEGMENT_FEATURES))
    for position, (token, index) in enumerate(layout):
        word, start = words[position] if position < len(words) else ("the end of the text", len(text.rstrip()))
        if index is None:
            if word != token:
                condition = f" after at most {MAX_SEGMENTS} segments" if (token, word) == ("gait", "seg") else ""
                raise _position_error(text, start, f"'{token}'{condition}", word)
        elif token == "legs" and word in LEGS_VALUES:
            values[index] = LEGS_VALUES[word]
        else:
            key = "legs=" if token == "legs" else token
            if not _key_and_number(key).fullmatch(word):
                expected = "'legs' or 'nolegs'" if token == "legs" else f"'{token}' and a number, as in '{token}1.5'"
                raise _position_error(text, start, expected, word)
            values[index] = float(word.removeprefix(key))
            if not math.isfinite(values[index]):
                raise _position_error(text, start, f"'{token}' and a finite number", word)
    if len(words) > len(layout):
        word, start = words[len(layout)]
        raise _position_error(text, start, "the end of the text", word)
    return values


def _clip_n_segments(n_segments: int) -> int:
    """Limit the number of segments counted in a text to the range that a genome can have."""
    return min(max(n_segments, 1), int(MAX_SEGMENTS))


@lru_cache(maxsize=int(MAX_SEGMENTS))
def _text_layout(n_segments: int) -> tuple[tuple[str, int | None], ...]:
    """Return the tokens of the text form in order: a word and None, or a key and the index of its gene."""

    def gene_index(feature: Feature, segment: int = 0) -> int:
        if feature in BODY_FEATURES:
            return BODY_FEATURES.index(feature)
        return len(BODY_FEATURES) + segment * len(SEGMENT_FEATURES) + SEGMENT_FEATURES.index(feature)

    def tokens() -> Iterator[tuple[str, int | None]]:
        yield "wl1", None
        yield "segments=", gene_index(Feature.segments)
        for segment in range(n_segments):
            yield from (("|", None), ("seg", None))
            yield "length=", gene_index(Feature.length, segment)
            yield "mass=", gene_index(Feature.mass, segment)
            yield "legs", gene_index(Feature.legs, segment)
            yield "length=", gene_index(Feature.leg_length, segment)
            yield "force=", gene_index(Feature.leg_force, segment)
        yield from (("|", None), ("gait", None))
        yield "frequency=", gene_index(Feature.frequency)
        for segment in range(n_segments):
            yield from (("|", None), ("step", None))
            for joint in ("hip", "knee"):
                yield joint, None
                for motion in SWING_PARAMETERS:
                    yield f"{motion}=", gene_index(Feature[f"{joint}_{motion}"], segment)
            yield "stride=", gene_index(Feature.stride, segment)

    return tuple(tokens())


@lru_cache
def _key_and_number(key: str) -> re.Pattern[str]:
    return re.compile(re.escape(key) + NUMBER_PATTERN, re.ASCII)


@lru_cache(maxsize=int(MAX_SEGMENTS))
def _template(n_segments: int) -> str:
    """Return the text form with a replacement field for each gene."""
    return " ".join(
        token if index is None else f"{{{index}}}" if token == "legs" else f"{token}{{{index}}}"
        for token, index in _text_layout(n_segments)
    )


@lru_cache(maxsize=int(MAX_SEGMENTS))
def _decimal_form(n_segments: int) -> tuple[re.Pattern[str], Callable[[Sequence[str]], tuple[str, ...]]]:
    """Return a fast pattern of the text form, for plain decimals only, and a function that sorts its groups by gene."""
    layout = _text_layout(n_segments)
    patterns = (
        re.escape(token)
        if index is None
        else "((?:no)?legs)"
        if token == "legs"
        else re.escape(token) + DECIMAL_PATTERN
        for token, index in layout
    )
    group_genes = [index for _, index in layout if index is not None]
    in_gene_order = itemgetter(*(group_genes.index(gene) for gene in range(len(group_genes))))
    return re.compile(" ".join(patterns), re.ASCII), in_gene_order


def _position_error(text: str, start: int, expected: str, got: str) -> GenomeError:
    """Return an error that shows a position in the text; characters that are not printable are replaced."""
    n_before = min(start, ERROR_CONTEXT)
    excerpt = text[start - n_before : start + ERROR_CONTEXT]
    shown = "".join(" " if char.isspace() else char if char.isprintable() else "�" for char in excerpt)
    return GenomeError(
        f"not a genome: at character {start + 1} expected {expected}, got {short_repr(got)}\n"
        f"    {shown}\n    {' ' * n_before}^"
    )
