"""What makes one robot better than another: a function from a rollout to a number, higher being better."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from walkerlab.quantity import function_name
from walkerlab.rollout import Rollout
from walkerlab.settings import Fitness

NOT_COUNTED = -math.inf
"""The fitness of a walk that does not count: under every other, so that its robot has no children."""

UNITS = {Fitness.distance: "m", Fitness.velocity: "m/s"}


def distance(rollout: Rollout) -> float:
    """Net forward travel of the centre of mass after settling, in m; negative if it went backward."""
    return float(rollout.com[-1, 0] - rollout.com[0, 0])


def velocity(rollout: Rollout) -> float:
    """Mean forward speed over the last two thirds of the walk, in m/s: what is left once the start is over."""
    start = int(np.searchsorted(rollout.time, rollout.time[-1] / 3))
    return float((rollout.com[-1, 0] - rollout.com[start, 0]) / (rollout.time[-1] - rollout.time[start]))


FUNCTIONS: dict[Fitness, Callable[[Rollout], float]] = {Fitness.distance: distance, Fitness.velocity: velocity}


def label(fitness: Fitness | Callable[..., Any]) -> tuple[str, str]:
    """Return the name and the unit of a fitness; that of a function of the user's own is not known."""
    return (fitness.name, UNITS[fitness]) if isinstance(fitness, Fitness) else (function_name(fitness), "")


def score(rollout: Rollout, fitness: Fitness | Callable[..., Any]) -> float:
    """Rate one walk; a walk that does not count gets ``NOT_COUNTED``, whatever the function would say.

    Raises:
        ValueError: if a function of the user's own gives anything but a finite number.
    """
    if not rollout.counts:
        return NOT_COUNTED
    function = FUNCTIONS[fitness] if isinstance(fitness, Fitness) else fitness
    value = function(rollout)
    if not isinstance(value, int | float | np.number) or not math.isfinite(value):
        raise ValueError(
            f"the fitness function {function_name(function)!r} returned {value!r} for a walk; it must return "
            "one finite number, higher being better"
        )
    return float(value)
