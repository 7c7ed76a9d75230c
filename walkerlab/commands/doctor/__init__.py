"""Command ``doctor``: checks of the computer, each with a way to fix what is wrong.

Checks that could crash run in another process.
"""

from __future__ import annotations  # old versions of Python must be able to import this file

from collections.abc import Iterator

from walkerlab.commands.doctor.finding import Check
from walkerlab.commands.doctor.finding import Finding as Finding  # re-exported for users of this package
from walkerlab.commands.doctor.hardware import (
    check_cores,
    check_current_folder,
    check_graphics,
    check_run_file,
    check_workers,
    check_writing,
)
from walkerlab.commands.doctor.software import check_packages, check_python, check_walk

CHECKS: dict[Check, tuple[Check, ...]] = {
    check_python: (),
    check_packages: (check_python,),
    check_current_folder: (),
    check_writing: (check_current_folder,),
    check_cores: (check_packages,),
    check_walk: (check_packages, check_current_folder, check_cores),
    check_run_file: (check_walk, check_writing),
    check_workers: (check_walk,),
    check_graphics: (check_walk,),
}
"""All checks, quickest first, each with the checks that must pass before it."""


def run_checks() -> Iterator[Finding]:
    """Run all checks; a check is skipped if one that it requires has failed."""
    failed: set[Check] = set()
    for check, required in CHECKS.items():
        if not failed.isdisjoint(required):
            failed.add(check)
            continue
        for finding in _run_check(check):
            if finding.level == "fault":
                failed.add(check)
            yield finding


def _run_check(check: Check) -> Iterator[Finding]:
    """Run a check; an unexpected exception becomes a fault."""
    try:
        yield from check()
    except Exception as error:
        yield Finding(
            "fault",
            f"{check.__name__} failed: {type(error).__name__}: {error}",
            "close other programs and try again; if it fails again, report it with all of this output",
        )


def run_doctor(_: object = None) -> int:
    """Print all findings; return the exit code, which is 1 if there is a fault."""
    has_fault = False
    for finding in run_checks():
        print(finding, flush=True)
        has_fault = has_fault or finding.level == "fault"
    if has_fault:
        print("\nFix the faults above, then run this again: walkerlab doctor")
        return 1
    print("\nThis computer can evolve robots: walkerlab evolve")
    return 0
