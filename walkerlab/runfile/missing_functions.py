"""Stand-ins for the user functions of a loaded run: a run file holds their names and results, but no code."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from walkerlab.genome.genome import Genome
from walkerlab.runfile.opening import RunFileError
from walkerlab.settings.binding import arguments_as_python
from walkerlab.settings.settings import Settings
from walkerlab.settings.simulation import NO_EFFECT_ON_WALKS
from walkerlab.settings.values import function_name
from walkerlab.simulation.rollout import Rollout
from walkerlab.simulation.validity import REJECTED

PLACEHOLDER_NAME = "my_function"
"""Name used in suggested code for a function without a name, such as a lambda."""


class MissingFunction:
    """Stand-in for a user function whose name, but not its code, is in the run file."""

    def __init__(self, name: str, slot: str) -> None:
        """Create a stand-in.

        Args:
            name: Name of the function.
            slot: Slot that the function filled, such as ``mutation``.
        """
        self.__name__ = name
        self.slot = slot

    def __call__(self, *_: object, **__: object) -> Any:
        """Report that the function is missing, and how to supply it.

        Raises:
            RunFileError: Always.
        """
        argument = f"{self.slot}={function_as_python(self)}"
        confirm = f", or run.confirm({argument})" if self.slot == "fitness" else ""
        raise RunFileError(
            f"these settings come from a run file, which holds no code: Algorithm.{self.slot} was your function "
            f"{self.__name__!r}. Supply it again: settings.with_({argument}){confirm}"
        )


class MissingFitness(MissingFunction):
    """Stand-in for a fitness function that finds the counted walk of a robot from the table of the run."""

    table: pd.DataFrame | None = None
    conditions: object = None

    def select_counted_walk(self, genome: Genome, rollouts: Sequence[Rollout], settings: Settings) -> Rollout:
        """Select the walk that counted in the run from a robot's walks.

        Walks are repeatable, so this is the walk with the verdict, distance and velocity in the run file; on another
        kind of machine, it is the walk closest to these values. If the robot is not in the table, or the settings
        differ, it is the walk with the smallest distance.

        Args:
            genome: Genome of the robot, within the limits.
            rollouts: Walks of the robot, one from each start.
            settings: Settings of the walks.
        """
        rows = self.table[self.table.genome == str(genome)] if self.table is not None else ()
        if not len(rows) or self.conditions != _walk_conditions(settings):
            return min(rollouts, key=lambda rollout: rollout.distance if rollout.counts else -np.inf)
        row: Any = rows.iloc[0]  # type: ignore[union-attr]
        verdict_of_walk = "ok" if row.verdict == REJECTED else row.verdict

        def difference(rollout: Rollout) -> tuple[bool, float]:
            deviation = abs(rollout.distance - row.distance) + abs(rollout.velocity - row.velocity)
            return rollout.verdict != verdict_of_walk, deviation if np.isfinite(deviation) else np.inf

        nearest = min(rollouts, key=difference)
        return replace(nearest, verdict=REJECTED, reason=row.reason) if row.verdict == REJECTED else nearest


def remember_walks(settings: Settings, table: pd.DataFrame) -> None:
    """Pass the table of a run to the stand-in for its fitness function, if the settings have one."""
    fitness: Any = settings.algorithm.fitness
    function = fitness.func if isinstance(fitness, partial) else fitness
    if isinstance(function, MissingFitness):
        function.table = table
        function.conditions = _walk_conditions(settings)


def _walk_conditions(settings: Settings) -> object:
    """Return all settings that a walk depends on."""
    return settings.terrain, settings.robot, settings.simulation.model_copy(update=NO_EFFECT_ON_WALKS)


def function_as_python(function: Callable[..., Any]) -> str:
    """Return the Python code that names a function; ``my_function`` if its name is not valid in Python."""
    if isinstance(function, partial):
        return f"partial({', '.join([function_as_python(function.func), *arguments_as_python(function)])})"
    name = function_name(function)
    return name if name.isidentifier() else PLACEHOLDER_NAME
