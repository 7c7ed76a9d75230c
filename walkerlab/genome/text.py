"""The text form of a genome: segments first, each with its legs, then the gait, a step for each segment.

wl2 segments=2 | seg length=0.31 mass=2.1 legs own length=0.28 force=14 | seg … legs repeat … |
gait frequency=1.6 lag=1.9 duty=0.55 | step hip amplitude=0.4 phase=0 offset=0.2 knee … stride=3.14 | step …

Genomes of version 1 (``wl1``) are read as well. They have no ``lag``, ``duty`` and ``repeat``: each segment has its own
legs and step, and the motion of each joint is a sine.
"""

import math
import re
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Final

from walkerlab.genome.features import BODY_FEATURES, MAX_SEGMENTS, SEGMENT_FEATURES
from walkerlab.settings.choices import Feature
from walkerlab.settings.values import short_repr
from walkerlab.system.errors import WalkerlabError

SWING_PARAMETERS: Final = ("amplitude", "phase", "offset")
"""Genes of the motion of each joint."""

MAX_TEXT_LENGTH = 20_000
ERROR_CONTEXT = 30  # characters of the text that an error shows before and after its position

FEATURE_WORDS = {Feature.legs: ("nolegs", "legs"), Feature.repeat: ("own", "repeat")}
"""Words of the text form for the values 0 and 1 of a feature; other values are written as ``legs=0.5``."""

CHOICES = {feature.name: words for feature, words in FEATURE_WORDS.items()}
WORD_VALUES = {word: float(value) for words in FEATURE_WORDS.values() for value, word in enumerate(words)}

VERSION = 2
FEATURES_SINCE_2 = {Feature.lag: 0.0, Feature.duty: 0.5, Feature.repeat: 0.0}
"""Features that genomes of version 1 lack, and the values that give the same robots."""

NUMBER_PATTERN = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,3})?"
DECIMAL_PATTERN = r"(-?\d{1,9}+\.?\d{0,17}+)"  # matches nearly all numbers that format_text writes


class GenomeError(WalkerlabError, ValueError):
    """The text is not a valid genome; the message gives the position, and what was expected there."""


def count_segments(n_genes: int) -> int:
    """Return the number of segments, expressed or not, that a genome of this length describes."""
    return (n_genes - len(BODY_FEATURES)) // len(SEGMENT_FEATURES)


def format_text(values: Sequence[float]) -> str:
    """Return the text form, from which ``parse_text`` reads exactly the same numbers."""
    numbers = [repr(value).removesuffix(".0") for value in values]
    for feature, words in FEATURE_WORDS.items():
        for index in range(_gene_index(feature), len(numbers), len(SEGMENT_FEATURES)):
            number = numbers[index]
            numbers[index] = words[int(number)] if number in ("0", "1") else f"{feature.name}={number}"
    return _template(count_segments(len(numbers))).format(*numbers)


def parse_text(text: str) -> list[float]:
    """Return the gene values in a text form; spacing and the notation of numbers may vary.

    Raises:
        GenomeError: If the text is not a valid genome; the message gives the position, and what was expected there.
    """
    if not isinstance(text, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise GenomeError(f"a genome's text must be a str; got {short_repr(text)}")
    if len(text) > MAX_TEXT_LENGTH:
        raise GenomeError(f"a genome's text has at most {MAX_TEXT_LENGTH} characters; this one has {len(text)}")
    n_segments = _clip_n_segments(text.count("| seg "))
    version = 1 if is_of_version_1(text) else VERSION
    pattern, indices = _decimal_form(n_segments, version)
    if match := pattern.fullmatch(text):
        values = _initial_values(n_segments)
        for index, word in zip(indices, match.groups(), strict=True):
            values[index] = WORD_VALUES[word] if word in WORD_VALUES else float(word)
        return values
    return _parse_word_by_word(text, version)


def is_of_version_1(text: str) -> bool:
    """Return whether a text form was written by a release before 0.2, whose robots walk differently."""
    return text.lstrip().startswith("wl1")


def _initial_values(n_segments: int) -> list[float]:
    """Return gene values to start from; features that a text may lack have the values that the text implies."""
    body = [FEATURES_SINCE_2.get(feature, 0.0) for feature in BODY_FEATURES]
    return body + n_segments * [FEATURES_SINCE_2.get(feature, 0.0) for feature in SEGMENT_FEATURES]


def _parse_word_by_word(text: str, version: int) -> list[float]:
    """Return the gene values in a text form that may have been edited; see ``parse_text``."""
    words = [(match.group(), match.start()) for match in re.finditer(r"\||[^\s|]+", text)]
    n_segments = _clip_n_segments(sum(word == "seg" for word, _ in words))
    layout = text_layout(n_segments, version)
    values = _initial_values(n_segments)
    for position, (token, index) in enumerate(layout):
        word, start = words[position] if position < len(words) else ("the end of the text", len(text.rstrip()))
        if index is None:
            if word != token:
                condition = f" after at most {MAX_SEGMENTS} segments" if (token, word) == ("gait", "seg") else ""
                raise _position_error(text, start, f"'{token}'{condition}", word)
        elif word in CHOICES.get(token, ()):
            values[index] = WORD_VALUES[word]
        else:
            values[index] = _parse_number(text, start, token, word)
    if len(words) > len(layout):
        word, start = words[len(layout)]
        raise _position_error(text, start, "the end of the text", word)
    return values


def _parse_number(text: str, start: int, token: str, word: str) -> float:
    """Return the number of a word such as ``mass=2.1``.

    Args:
        text: Whole text, for the error.
        start: Position of the word.
        token: Key that is expected, such as ``mass=``, or a key of ``CHOICES``.
        word: The word.

    Raises:
        GenomeError: If the word has another key, or its value is not a finite number.
    """
    key = f"{token}=" if token in CHOICES else token
    if not _key_and_number(key).fullmatch(word):
        expected = f"'{token}' and a number, as in '{token}0.5'"
        if token in CHOICES:
            expected = " or ".join(f"'{choice}'" for choice in reversed(CHOICES[token]))
        raise _position_error(text, start, expected, word)
    number = float(word.removeprefix(key))
    if not math.isfinite(number):
        raise _position_error(text, start, f"'{token}' and a finite number", word)
    return number


def _clip_n_segments(n_segments: int) -> int:
    """Limit the number of segments counted in a text to the range that a genome can have."""
    return min(max(n_segments, 1), int(MAX_SEGMENTS))


def _gene_index(feature: Feature, segment: int = 0) -> int:
    if feature in BODY_FEATURES:
        return BODY_FEATURES.index(feature)
    return len(BODY_FEATURES) + segment * len(SEGMENT_FEATURES) + SEGMENT_FEATURES.index(feature)


@lru_cache
def text_layout(n_segments: int, version: int = VERSION) -> tuple[tuple[str, int | None], ...]:
    """Return the tokens of the text form in order: a word and None, or a key and the index of its gene."""

    def tokens() -> Iterator[tuple[str, Feature | None, int]]:
        yield f"wl{version}", None, 0
        yield "segments=", Feature.segments, 0
        for segment in range(n_segments):
            yield from (("|", None, 0), ("seg", None, 0))
            yield "length=", Feature.length, segment
            yield "mass=", Feature.mass, segment
            yield "legs", Feature.legs, segment
            yield "repeat", Feature.repeat, segment
            yield "length=", Feature.leg_length, segment
            yield "force=", Feature.leg_force, segment
        yield from (("|", None, 0), ("gait", None, 0))
        yield "frequency=", Feature.frequency, 0
        yield "lag=", Feature.lag, 0
        yield "duty=", Feature.duty, 0
        for segment in range(n_segments):
            yield from (("|", None, 0), ("step", None, 0))
            for joint in ("hip", "knee"):
                yield joint, None, 0
                for parameter in SWING_PARAMETERS:
                    yield f"{parameter}=", Feature[f"{joint}_{parameter}"], segment
            yield "stride=", Feature.stride, segment

    return tuple(
        (token, None if feature is None else _gene_index(feature, segment))
        for token, feature, segment in tokens()
        if version > 1 or feature not in FEATURES_SINCE_2
    )


@lru_cache
def _key_and_number(key: str) -> re.Pattern[str]:
    return re.compile(re.escape(key) + NUMBER_PATTERN, re.ASCII)


@lru_cache(maxsize=int(MAX_SEGMENTS))
def _template(n_segments: int) -> str:
    """Return the text form with a replacement field for each gene."""
    return " ".join(
        token if index is None else f"{{{index}}}" if token in CHOICES else f"{token}{{{index}}}"
        for token, index in text_layout(n_segments)
    )


@lru_cache
def _decimal_form(n_segments: int, version: int) -> tuple[re.Pattern[str], tuple[int, ...]]:
    """Return a fast pattern of the text form, for plain decimals only, and the gene of each of its groups."""
    layout = text_layout(n_segments, version)
    patterns = (
        re.escape(token)
        if index is None
        else f"({'|'.join(CHOICES[token])})"
        if token in CHOICES
        else re.escape(token) + DECIMAL_PATTERN
        for token, index in layout
    )
    return re.compile(" ".join(patterns), re.ASCII), tuple(index for _, index in layout if index is not None)


def _position_error(text: str, start: int, expected: str, got: str) -> GenomeError:
    """Return an error that shows a position in the text; characters that are not printable are replaced."""
    n_before = min(start, ERROR_CONTEXT)
    excerpt = text[start - n_before : start + ERROR_CONTEXT]
    shown = "".join(" " if char.isspace() else char if char.isprintable() else "�" for char in excerpt)
    return GenomeError(
        f"not a genome: at character {start + 1} expected {expected}, got {short_repr(got)}\n"
        f"    {shown}\n    {' ' * n_before}^"
    )
