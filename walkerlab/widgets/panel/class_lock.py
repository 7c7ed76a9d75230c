"""Limits of a panel: the settings that it shows, those that are fixed, and the number of walks of a run.

They come from the file of a class (see ``settings/classroom.py``) and from the arguments of ``wl.Lab``, which can only
add limits to those of the class.
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from walkerlab.evolution.forecast import n_walks
from walkerlab.evolution.run import Run
from walkerlab.genome.genome import Genome
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.classroom import (
    FIXED_REASON,
    SEED_REASON,
    Classroom,
    current_class,
    require_fixed_values,
)
from walkerlab.settings.model import SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.system.files import write_text
from walkerlab.system.randomness import seed_of_name
from walkerlab.widgets.form import Form

HIDDEN_REASON = "not among the settings of this panel"
STUDENT_VARIABLE = "JUPYTERHUB_USER"  # environment variable with the name of the user on a JupyterHub
MAX_FILE_NAME = 60  # characters
SMALLEST_SIZES = {"generations": 1, "population_size": 4}


@dataclass(frozen=True)
class ClassLock:
    """Limits of a panel.

    Attributes:
        classroom: Settings of the class, with the limits of the panel.
        settings: Initial settings, with the fixed values.
        fixed: Reason for each setting that cannot be changed, keyed by name.
        student: Name of the student; "" if it is unknown.
    """

    classroom: Classroom
    settings: Settings
    fixed: Mapping[str, str]
    student: str

    def describe_excess(self, settings: Settings) -> str:
        """Return why a run is too large, and how to reduce it; "" if it is within the budget.

        Args:
            settings: Settings of the complete run.
        """
        budget = self.classroom.budget
        if budget is None or (n_needed := count_walks(settings)) <= budget:
            return ""
        algorithm = settings.algorithm
        ways = [
            f"{name.replace('_', ' ')} to {largest}"
            for name, largest in _largest_sizes(settings, budget).items()
            if name not in self.fixed and largest >= SMALLEST_SIZES[name]
        ]
        fix = f" Reduce {' or '.join(ways)}." if ways else " Ask your teacher."
        return (
            f"This run needs {n_needed:,} walks ({algorithm.population_size} robots, "
            f"{pluralize(algorithm.generations, 'generation')}); {self._allowance} for a run.{fix}"
        )

    def describe_budget(self, settings: Settings) -> str:
        """Return how much of the budget a run uses; "" without a budget."""
        budget = self.classroom.budget
        name = f"{self.classroom.name}: " if self.classroom.name else ""
        return f" {name}{count_walks(settings):,} of at most {budget:,} walks." if budget else ""

    def require_within_limits(self, settings: Settings) -> None:
        """Check the settings of a run that is continued.

        Raises:
            SettingsError: If a fixed setting differs, or the run is too large.
        """
        locations = Settings.field_locations()
        require_fixed_values(settings, self.settings, {locations[name]: reason for name, reason in self.fixed.items()})
        if excess := self.describe_excess(settings):
            raise SettingsError(excess)

    def make_form(self) -> Form:
        """Return the form of the panel."""
        presets = self.classroom.presets
        return Form(self.settings, self.classroom.only, self.fixed, presets or None)

    def hand_in(self, robot: Genome | Run | None) -> Path:
        """Write a genome into the shared folder of the class; a student's earlier robot is replaced.

        Args:
            robot: Genome, or a run whose champion is handed in; None if there is no run.

        Returns:
            The path of the file.

        Raises:
            ValueError: If there is no run, the class has no shared folder, or the name of the student is unknown.
            OSError: If the file cannot be written.
        """
        if robot is None:
            raise ValueError("there is no run; evolve one, or give a genome: lab.hand_in(genome)")
        folder = self.classroom.shared_folder
        if folder is None:
            raise ValueError(
                'this class has no shared folder; the teacher can name one in the class file: "shared_folder"'
            )
        if not self.student:
            raise ValueError('your name is unknown; create the panel with it: wl.Lab(student="Ada")')
        name = "".join(letter if letter.isalnum() or letter in " -_" else "_" for letter in self.student)
        path = folder / f"{name[:MAX_FILE_NAME]}.txt"
        write_text(path, f"{robot.champion.genome if isinstance(robot, Run) else robot}\n")
        return path

    @property
    def _allowance(self) -> str:
        owner = f"the class {self.classroom.name}" if self.classroom.name else "your teacher"
        return f"{owner} allows {self.classroom.budget:,} walks"


def make_lock(
    settings: Settings | None,
    only: Sequence[str] = (),
    budget: int | None = None,
    locked: Mapping[str, Any] | None = None,
    student: str = "",
) -> ClassLock:
    """Combine the limits of the class with those of a panel.

    Args:
        settings: Initial settings, before any value is fixed; the defaults if None.
        only: Names of the domains and settings to show; all if empty.
        budget: Maximum number of walks of a run; None for no limit.
        locked: Fixed settings with their values.
        student: Name of the student; the name of the user on a JupyterHub if empty.

    Raises:
        SettingsError: If the file of the class or a limit is wrong.
        ValueError: If each student has a seed, and the name is unknown.
    """
    shared = current_class()
    asked = Classroom(only=(only,) if isinstance(only, str) else tuple(only), budget=budget, locked=dict(locked or {}))
    budgets = [one.budget for one in (shared, asked) if one.budget]
    names = Settings.field_locations()
    shown = tuple(name for name in names if shared.shows(name) and asked.shows(name))
    if not shown:
        raise SettingsError("the class shows none of the settings given as only=; choose from those that it shows.")
    values = {**asked.locked, **shared.locked}
    reasons = dict.fromkeys(values, FIXED_REASON)
    student = student.strip() or os.environ.get(STUDENT_VARIABLE, "")
    if shared.seed_per_student:
        if not student:
            raise ValueError(
                'in this class, each student has a seed; create the panel with your name: wl.Lab(student="Ada")'
            )
        values["seed"] = seed_of_name(student)
        reasons["seed"] = SEED_REASON
    hidden = {name: HIDDEN_REASON for name in names if name not in shown}
    classroom = shared.model_copy(update={"only": shown, "locked": values, "budget": min(budgets, default=None)})
    start = Settings() if settings is None else require_settings(settings)
    return ClassLock(classroom, start.with_(**values), {**hidden, **reasons}, student)


def count_walks(settings: Settings) -> int:
    """Return the number of walks of a complete run; every robot walks from each of its starts."""
    return n_walks(settings) * settings.simulation.n_starts


def _largest_sizes(settings: Settings, budget: int) -> dict[str, int]:
    """Return the largest number of generations, and the largest population, with which a run is within the budget."""
    algorithm = settings.algorithm
    n_children = budget // settings.simulation.n_starts - algorithm.n_elites
    return {
        "generations": n_children // (algorithm.population_size - algorithm.n_elites),
        "population_size": algorithm.n_elites + n_children // algorithm.generations,
    }
