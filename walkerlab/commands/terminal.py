"""Output to the terminal, and exit codes."""

from __future__ import annotations  # the doctor must run on old versions of Python

import sys
from typing import TextIO

from walkerlab.text.escape import printable

# Exit codes.
EXIT_INTERRUPTED = 130  # convention of shells after Ctrl-C
INVALID_REQUEST = 2


def print_safely(text: str, file: TextIO | None = None) -> None:
    """Print text that may come from a file or a user, without control characters; to stdout if ``file`` is None."""
    print(printable(text, keep="\n"), file=file)


def print_error(message: str, exit_code: int) -> int:
    """Print a message to stderr and return the exit code."""
    print_safely(message, file=sys.stderr)
    return exit_code
