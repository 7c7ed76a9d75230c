"""What is printed, and with which exit code a command ends."""

from __future__ import annotations  # as the doctor's

import sys
from typing import TextIO

from walkerlab.text.html import printable

INTERRUPTED = 130  # what a shell expects of a program that Ctrl-C ended
REFUSED = 2  # what it expects of one that was asked for something impossible


def tell(text: str, to: TextIO | None = None) -> None:
    """Print what has texts from a file or a user in it: none of them may move the cursor."""
    print(printable(text, keep="\n"), file=to)


def say(message: str, *, to: int) -> int:
    """Tell people on stderr, and return the exit code."""
    tell(message, to=sys.stderr)
    return to
