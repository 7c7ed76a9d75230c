"""What the doctor finds."""

from __future__ import annotations  # a Python that is too old must be able to read this file, and say so

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from shutil import get_terminal_size
from textwrap import wrap
from typing import Literal


@dataclass(frozen=True)
class Finding:
    """One thing looked at.

    Attributes:
        level: ``ok``; ``note``, something is missing that evolving does not need; ``fault``, it cannot evolve.
        says: what was found.
        mend: what to type or do about it, a line each.
    """

    level: Literal["ok", "note", "fault"]
    says: str
    mend: str = ""

    def __str__(self) -> str:
        """Lay it out: the level, what was found, and below it the mend, of which no line is broken."""
        wide = max(60, get_terminal_size((100, 0)).columns - 7)
        said = [part for line in self.says.splitlines() for part in wrap(line, wide, break_on_hyphens=False)]
        return "\n".join([*_led_by(f"{self.level:6}", said), *_led_by("      mend: ", self.mend.splitlines())])


def _led_by(word: str, lines: Sequence[str]) -> list[str]:
    return [f"{' ' * len(word) if i else word}{line}" for i, line in enumerate(lines)]


Look = Callable[[], Iterator[Finding]]
"""Looks at one thing."""
