"""Results of walks, to compare an edited robot with the robot before the edit."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.simulation.fitness import name_and_unit, poorest_walk, score
from walkerlab.simulation.validity import VERDICTS
from walkerlab.text.numbers import with_unit

MINUS_SIGN = "\N{MINUS SIGN}"


@dataclass(frozen=True)
class Outcome:
    """Result of a walk.

    Attributes:
        distance: Forward distance [m]; NaN if the simulation diverged.
        verdict: ``ok``, or why the walk does not count.
        reason: Explanation of the verdict; "" if it is ``ok``.
        fitness: Fitness with its unit, such as "efficiency 0.12 m/J"; "" if the fitness is the distance, or if the walk
            does not count.
    """

    distance: float
    verdict: str
    reason: str
    fitness: str


def simulate_outcome(genome: Genome, settings: Settings) -> Outcome:
    """Simulate the walk of a robot, as evolution does.

    Raises:
        OperatorError: If a user function for the fitness breaks a rule.
    """
    rollout = poorest_walk(genome, settings, poses=False)
    fitness = score(rollout, settings.algorithm.fitness)
    return Outcome(rollout.distance, rollout.verdict, rollout.reason, _fitness_text(fitness, settings))


def recorded_outcome(row: Any, settings: Settings) -> Outcome:
    """Return the result of a walk that is recorded in the table of a run.

    Args:
        row: Row of the robot.
        settings: Settings of the run.
    """
    reason = row.reason if isinstance(row.reason, str) else ""
    return Outcome(float(row.distance), row.verdict, reason, _fitness_text(float(row.fitness), settings))


def compare_outcomes(after: Outcome, before: Outcome) -> dict[str, Any]:
    """Compare the results of the walks after and before an edit, as the ``result`` of the editor."""
    change = round(round(after.distance, 2) - round(before.distance, 2), 2)  # difference of the distances as shown
    sign = "+" if change > 0 else MINUS_SIGN
    counts = after.verdict == "ok"
    verdict = VERDICTS.get(after.verdict, after.verdict)
    details = f" Details: {after.reason}." if after.reason else ""
    counted = "" if before.verdict == "ok" else f" (did not count: {before.verdict})"
    return {
        "distance": with_unit(after.distance, "m").replace("-", MINUS_SIGN),
        "change": f"{sign}{abs(change):.2f} m" if change and np.isfinite(change) else "",
        "before": f"before: {with_unit(before.distance, 'm').replace('-', MINUS_SIGN)}{counted}",
        "verdict": verdict if counts else f"Does not count: {after.verdict}. {verdict}{details}",
        "counts": counts,
        "is_better": bool(counts and change > 0),
        "others": [f"{after.fitness}, before: {before.fitness or 'not counted'}"] if after.fitness else [],
    }


def _fitness_text(fitness: float, settings: Settings) -> str:
    name, unit = name_and_unit(settings.algorithm.fitness)
    return f"{name} {with_unit(fitness, unit)}" if name != "distance" and np.isfinite(fitness) else ""
