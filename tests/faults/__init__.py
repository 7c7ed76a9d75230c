"""Fault injection: a few cases in each test run, all of them with ``python -m tests.faults``."""

import os


def number(reduced, full):
    """Return the number of cases, or the cases: reduced, or all if the environment variable FAULTS is ``full``."""
    return full if os.environ.get("FAULTS") == "full" else reduced
