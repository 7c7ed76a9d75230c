"""Findings of the doctor, and the type of its checks."""

from __future__ import annotations  # old versions of Python must be able to import this file

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from shutil import get_terminal_size
from textwrap import wrap
from typing import Literal


@dataclass(frozen=True)
class Finding:
    """Result of one check.

    Attributes:
        level: ``ok``; ``note`` if something optional is missing; ``fault`` if an evolution requires it.
        message: Description of the result.
        fix: Commands or instructions that fix it, one per line.
    """

    level: Literal["ok", "note", "fault"]
    message: str
    fix: str = ""

    def __str__(self) -> str:
        """Format the level, the message, wrapped, and below it the fix, whose lines are not wrapped."""
        width = max(60, get_terminal_size((100, 0)).columns - 7)
        message = [part for line in self.message.splitlines() for part in wrap(line, width, break_on_hyphens=False)]
        return "\n".join([*_indent(f"{self.level:6}", message), *_indent("      fix: ", self.fix.splitlines())])


def _indent(label: str, lines: Sequence[str]) -> list[str]:
    """Put a label before the first line, and the same number of spaces before the others."""
    return [f"{' ' * len(label) if i else label}{line}" for i, line in enumerate(lines)]


Check = Callable[[], Iterator[Finding]]
"""Function that checks one property of the computer."""
