"""The text of a genome in the editor, and the position of an error in it."""

import re
from typing import NamedTuple

from walkerlab.genome.genome import Genome
from walkerlab.genome.text import GenomeError
from walkerlab.settings.robot import Robot


def format_genome(genome: Genome) -> str:
    """Return the text form of a genome, with a line for each segment and each step."""
    return str(genome).replace(" | ", "\n| ")


def parse_within(text: str, robot: Robot) -> Genome | None:
    """Parse a genome and bring it within the limits; return None if the text is not valid."""
    try:
        return Genome.parse(text).within(robot)
    except GenomeError:
        return None


class Span(NamedTuple):
    """A range of a string in UTF-16 code units, as JavaScript counts them; the end is exclusive."""

    start: int
    end: int


def find_fault(fault: str, text: str) -> Span | None:
    """Find the position in a text to which the message of a ``GenomeError`` refers.

    Args:
        fault: Message of the error.
        text: Text that was parsed.

    Returns:
        Span of the wrong word, an empty span where a word is missing, or None if the message gives no position.
    """
    found = re.search(r"at character (\d+) ", fault)
    if not found:
        return None
    start = int(found[1]) - 1
    word = re.compile(r"\||[^\s|]+").match(text, start)
    return Span(_utf16_length(text[:start]), _utf16_length(text[: word.end() if word else start]))


def describe_fault(fault: str, text: str) -> str:
    """Return the first line of a ``GenomeError`` message, with the line number instead of the character number."""
    first_line = fault.partition("\n")[0]
    found = re.fullmatch(r"not a genome: at character (\d+) (expected .*)", first_line)
    if not found:
        return first_line
    line = text.count("\n", 0, int(found[1]) - 1) + 1
    return f"Line {line}: {found[2]}."


def _utf16_length(text: str) -> int:
    return len(text.encode("utf-16-le", "surrogatepass")) // 2
