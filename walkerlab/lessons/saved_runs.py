"""The small saved runs of the lessons, evolved by ``python -m walkerlab.lessons.saved``."""

from typing import Any

from walkerlab.evolution.loading import load
from walkerlab.evolution.run import Run
from walkerlab.lessons.exercises import LessonError
from walkerlab.runfile.records import Individual
from walkerlab.settings.values import did_you_mean
from walkerlab.system.package_files import find_package_file
from walkerlab.tournament.seals import Seal, open_seal

FOLDER = "data/runs"

SIZE: dict[str, Any] = {"population_size": 30, "generations": 16, "seed": 1}
RUN_CHANGES: dict[str, dict[str, Any]] = {
    "flat": SIZE,
    "stairs": SIZE | {"structure": "stairs", "step_height": 0.05, "step_depth": 0.6},
    "gravel": SIZE | {"texture": "gravel"},
    "incline": SIZE | {"structure": "incline", "incline": 5.0},
    "ice": SIZE | {"texture": "ice"},
    "moon": SIZE | {"gravity": "moon", "texture": "sand"},
}
"""Settings of each run that differ from the defaults, as arguments of ``Settings.with_``."""


def saved_run(name: str) -> Run:
    """Load a small run that was evolved before the lesson.

    Args:
        name: Name of the ground: flat, stairs, gravel, incline, ice or moon.

    Raises:
        LessonError: If there is no run with this name.
    """
    if name not in RUN_CHANGES:
        known = ", ".join(RUN_CHANGES)
        raise LessonError(
            f"there is no saved run {name!r}; the saved runs are {known}.{did_you_mean(name, RUN_CHANGES)}"
        )
    return load(find_package_file(f"{FOLDER}/{name}.walk"))


def saved_champion(name: str) -> Individual:
    """Return the best robot of a saved run: its ``genome``, ``fitness`` and ``verdict``.

    Args:
        name: Name of the ground, as for ``saved_run``.

    Raises:
        LessonError: If there is no run with this name.
    """
    return saved_run(name).champion


def mystery_terrain() -> Seal:
    """Return the sealed settings of lesson 11.

    They were sealed by ``walkerlab league --seal``; a copy of the settings is in the guide of the lesson for teachers.
    """
    return open_seal(find_package_file(f"{FOLDER}/mystery.json"))
