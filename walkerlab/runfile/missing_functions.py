"""Stand-ins for functions of the user's own: a run file holds their names and results, but no code."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from walkerlab.genome.genome import Genome
from walkerlab.runfile.store import RunFileError
from walkerlab.settings.binding import arguments_as_python
from walkerlab.settings.choices import Camera
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import function_name
from walkerlab.simulation.rollout import Rollout
from walkerlab.simulation.validity import REJECTED

NAMELESS = "my_function"
"""How a function without a name, such as a lambda, is called in code that a message suggests."""


class Missing:
    """Stands for a function of which the run file has the name only."""

    def __init__(self, name: str, slot: str) -> None:
        """Keep the name of the function and of the slot that it filled."""
        self.__name__ = name
        self.slot = slot

    def __call__(self, *_: object, **__: object) -> Any:
        """Say that the function is missing, and how to give it again.

        Raises:
            RunFileError: always.
        """
        again = f"{self.slot}={typed_name(self)}"
        confirm = f", or run.confirm({again})" if self.slot == "fitness" else ""
        raise RunFileError(
            f"these settings come from a run file, which holds no code: Algorithm.{self.slot} was your own function "
            f"{self.__name__!r}. Give it again: settings.with_({again}){confirm}"
        )


class MissingFitness(Missing):
    """Stands for a fitness function: which of a robot's walks counted follows from what the run file has of it."""

    table: pd.DataFrame | None = None
    world: object = None

    def counted(self, genome: Genome, rollouts: Sequence[Rollout], settings: Settings) -> Rollout:
        """Return the one of a robot's walks that counted in the run.

        Walks are repeatable: it is the walk whose verdict, distance and velocity the run file has, or on another kind
        of machine the nearest. Of a robot or a world that the file does not have, it is the walk of the least distance.

        Args:
            genome: of the robot, within the limits.
            rollouts: its walks, one from each start.
            settings: in which it walked.
        """
        rows = self.table[self.table.genome == str(genome)] if self.table is not None else ()
        if not len(rows) or self.world != _world(settings):
            return min(rollouts, key=lambda one: one.distance if one.counts else -np.inf)
        row: Any = rows.iloc[0]  # type: ignore[union-attr]
        judged = "ok" if row.verdict == REJECTED else row.verdict

        def difference(rollout: Rollout) -> tuple[bool, float]:
            far = abs(rollout.distance - row.distance) + abs(rollout.velocity - row.velocity)
            return rollout.verdict != judged, far if np.isfinite(far) else np.inf

        walk = min(rollouts, key=difference)
        return replace(walk, verdict=REJECTED, reason=row.reason) if row.verdict == REJECTED else walk


def remember_walks(settings: Settings, table: pd.DataFrame) -> None:
    """Let the stand-in for a loaded run's fitness function, if there is one, know the table of that run."""
    fitness: Any = settings.algorithm.fitness
    function = fitness.func if isinstance(fitness, partial) else fitness
    if isinstance(function, MissingFitness):
        function.table, function.world = table, _world(settings)


def _world(settings: Settings) -> object:
    """Return all on which a walk depends."""
    return settings.terrain, settings.robot, settings.simulation.model_copy(update={"camera": Camera.side})


def typed_name(function: Callable[..., Any]) -> str:
    """Write a function as it is typed in Python; one whose name cannot be typed is called ``my_function``."""
    if isinstance(function, partial):
        return f"partial({', '.join([typed_name(function.func), *arguments_as_python(function)])})"
    name = function_name(function)
    return name if name.isidentifier() else NAMELESS
