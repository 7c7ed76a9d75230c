"""What this machine can do, and the mend for what it cannot. All that could crash is tried in another process."""

from __future__ import annotations  # a Python that is too old must be able to read this file, and say so

from collections.abc import Iterator

from walkerlab.commands.doctor.finding import Finding as Finding
from walkerlab.commands.doctor.finding import Look
from walkerlab.commands.doctor.hardware import cores, drawing, folder, keep, place, workers
from walkerlab.commands.doctor.software import packages, python, walk

LOOKS: dict[Look, tuple[str, ...]] = {
    python: (),
    packages: ("python",),
    place: (),
    folder: ("place",),
    cores: ("packages",),
    walk: ("packages", "place", "cores"),
    keep: ("walk", "folder"),
    workers: ("walk",),
    drawing: ("walk",),
}
"""What is looked at, and what must be sound before that has a meaning."""


def examine() -> Iterator[Finding]:
    """Look at everything, quickest first; but at nothing that cannot be right where something else is wrong."""
    ill = set[str]()
    for look, needs in LOOKS.items():
        if not ill.isdisjoint(needs):
            ill.add(look.__name__)
            continue
        for finding in _survived(look):
            if finding.level == "fault":
                ill.add(look.__name__)
            yield finding


def _survived(look: Look) -> Iterator[Finding]:
    """Make a fault of whatever a look dies of."""
    try:
        yield from look()
    except Exception as error:
        yield Finding(
            "fault",
            f"the look at {look.__name__} failed: {type(error).__name__}: {error}",
            "close other programs and ask again; if that is not it, show all of this to whoever keeps walkerlab",
        )


def tell(_: object = None) -> int:
    """Print all that is found, and return the exit code: 1 if there is a fault."""
    faults = 0
    for finding in examine():
        print(finding, flush=True)
        faults += finding.level == "fault"
    print(
        "\nMend the faults above, and ask again." if faults else "\nThis machine can evolve walkers: walkerlab evolve"
    )
    return 1 if faults else 0
