"""What can go wrong, brought about on purpose: a few times in every test run; in full by ``python -m tests.faults``."""

import os


def number(reduced, full):
    """How often a fault is brought about."""
    return full if os.environ.get("FAULTS") == "full" else reduced
