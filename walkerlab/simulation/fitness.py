"""What makes one robot better than another: a function from a rollout to a number, higher being better."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Protocol, runtime_checkable

import numpy as np

from walkerlab.ga.loop import NOT_COUNTED
from walkerlab.ga.user_functions import IN_A_CHECK, IN_A_RUN, OperatorError, Slot, ask, portrait
from walkerlab.genome.genome import Genome
from walkerlab.genome.phenotype import Legs, Phenotype, Segment, Swing
from walkerlab.settings.choices import Fitness
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import brief, function_name
from walkerlab.simulation.rollout import Rollout, walk_from_every_start
from walkerlab.simulation.validity import REJECTED
from walkerlab.world.scene import compile_scene

UNITS = {Fitness.distance: "m", Fitness.velocity: "m/s", Fitness.efficiency: "m/J", Fitness.straightness: "m"}
SLOT = Slot(
    "the fitness function",
    "fitness(rollout)",
    "com = rollout.com.copy()",
    advice="It is called with one Rollout: .distance in m, .velocity in m/s, .time (n,) in s, .com (n, 3) in m, "
    ".on_ground (n,), .work (n,) in J, .phenotype; .poses are not recorded in an evolution.",
    chance="It must look at nothing but the walk.",
)
LARGEST = 1e100  # that a fitness may be, or there is no axis for it
IDLE = 10.0  # J counted on top, about what trembling contacts do to a robot that stands: doing nothing is not efficient


def distance(rollout: Rollout) -> float:
    """Net forward travel of the centre of mass after settling, in m; negative if it went backward."""
    return rollout.distance


def velocity(rollout: Rollout) -> float:
    """Mean forward speed over the last two thirds of the walk, in m/s: what is left once the start is over."""
    return rollout.velocity


def efficiency(rollout: Rollout) -> float:
    """Net forward travel for each joule of work that the legs do, in m/J."""
    return distance(rollout) / (IDLE + float(rollout.work[-1]))


def straightness(rollout: Rollout) -> float:
    """Net forward travel, less how far it ended to either side of where it began, in m."""
    return distance(rollout) - abs(float(rollout.com[-1, 1] - rollout.com[0, 1]))


FUNCTIONS: dict[Fitness, Callable[[Rollout], float]] = {
    Fitness.distance: distance,
    Fitness.velocity: velocity,
    Fitness.efficiency: efficiency,
    Fitness.straightness: straightness,
}


def label(fitness: Fitness | Callable[..., Any]) -> tuple[str, str]:
    """Return the name and the unit of a fitness; that of a function of the user's own is not known."""
    return (fitness.name, UNITS[fitness]) if isinstance(fitness, Fitness) else (function_name(fitness), "")


def score(rollout: Rollout, fitness: Fitness | Callable[..., Any], *, seconds: float = IN_A_RUN) -> float:
    """Rate one walk; a walk that does not count gets ``NOT_COUNTED``, whatever the function would say.

    Args:
        rollout: the walk.
        fitness: one of ours, or a function of the user's own.
        seconds: that such a function may take.

    Raises:
        OperatorError: if the function returns anything but a finite number, -inf or None, or does anything else that
            it must not.
    """
    return rate(rollout, fitness, seconds=seconds)[0]


def rate(
    rollout: Rollout, fitness: Fitness | Callable[..., Any], *, seconds: float = IN_A_RUN
) -> tuple[float, Rollout]:
    """Return the fitness of one walk, and the walk with its verdict: ``rejected`` if the function returns -inf or None.

    Arguments and errors are those of ``score``.
    """
    if not rollout.counts:
        return NOT_COUNTED, rollout
    function = FUNCTIONS[fitness] if isinstance(fitness, Fitness) else fitness
    value = ask(SLOT, function, lambda: function(rollout), seconds)
    number = NOT_COUNTED if value is None else as_number(value)
    if number is None:
        raise OperatorError(
            f"{SLOT.who(function)} must return one finite number, higher being better; it returned {portrait(value)}",
            "An array becomes one number by .mean(), .sum() or an index.",
        )
    if number == NOT_COUNTED:
        returned = "None" if value is None else "-inf"
        return NOT_COUNTED, replace(rollout, verdict=REJECTED, reason=f"the fitness function returned {returned}")
    if abs(number) < LARGEST:
        return number, rollout
    advice = "Is something divided by zero?" if math.isnan(number) else f"It must be under {LARGEST:g} in size."
    raise OperatorError(
        f"{SLOT.who(function)} must return one finite number, higher being better; it returned {brief(value)}",
        f"{advice} To exclude a robot, return -np.inf.",
    )


def as_number(value: Any) -> float | None:
    """Convert any single real number to a float: of Python, numpy or another library; None if it is not one.

    Booleans count as 0 and 1, and an array of one element as that element. Texts and complex numbers are not converted.
    A number too large for a float becomes inf, whatever its sign.
    """
    if np.ma.is_masked(value):
        return math.nan
    if getattr(getattr(value, "dtype", None), "kind", "f") not in "biufO":  # as dates and complex numbers
        return None
    try:
        if callable(item := getattr(value, "item", None)):  # an array or a scalar of numpy, pandas, jax or torch
            value = item()
        return float(value) if hasattr(value, "__float__") or hasattr(value, "__index__") else None
    except OverflowError:
        return math.inf
    except (TypeError, ValueError, RuntimeError):  # as of an array of several elements
        return None


@runtime_checkable
class FromRunFile(Protocol):
    """Stands for a fitness function whose run file holds its name and its results, but not its code."""

    def counted(self, genome: Genome, rollouts: Sequence[Rollout], settings: Settings) -> Rollout:
        """Return the one of a robot's walks that counted in the run."""
        ...


def poorest_walk(genome: Genome | str, settings: Settings, *, poses: bool = True) -> Rollout:
    """Let a robot walk as evolution does: from each of its starts, of which the poorest walk counts.

    Of a loaded run, whose fitness function may be missing, it is the walk whose distance and velocity the run file has.

    Args:
        genome: a genome or its text.
        settings: of all four domains.
        poses: whether to record every pose.

    Raises:
        GenomeError: if a text is no genome.
    """
    scene, fitness = compile_scene(genome, settings), settings.algorithm.fitness
    rollouts = walk_from_every_start(scene, poses=poses)
    function = fitness.func if isinstance(fitness, partial) else fitness
    if isinstance(function, FromRunFile):
        return function.counted(scene.genome, rollouts, settings)
    return poorest([rate(rollout, fitness) for rollout in rollouts])[1]


def poorest(rated: Sequence[tuple[float, Rollout]]) -> tuple[float, Rollout]:
    """Return the walk of the lowest fitness, of equals the first, with that fitness."""
    return min(rated, key=lambda pair: pair[0])


def check_own(fitness: Fitness | Callable[..., Any]) -> None:
    """Try a function of the user's own on a made-up walk before any physics runs.

    Raises:
        OperatorError: if it fails, returns anything but a finite number, -inf or None, or two numbers for one walk.
    """
    if isinstance(fitness, Fitness):
        return
    try:
        first, second = (score(_made_up_walk(), fitness, seconds=IN_A_CHECK) for _ in range(2))
        if first != second:
            gave = f"gave {first} and then {second} for the same walk, so that no run could be repeated"
            raise OperatorError(f"{SLOT.who(fitness)} {gave}", SLOT.chance)
    except OperatorError as error:
        error.where = "when tried on a made-up walk"
        raise


def _made_up_walk() -> Rollout:
    """Return a robot's even walk of 8 s at 0.5 m/s, with a foot on the ground three quarters of the time."""
    time = np.arange(401) / 50
    com = np.stack([0.5 * time, 0.01 * np.sin(time), 0.2 + 0.01 * np.cos(9 * time)], axis=1)
    swing = Swing(amplitude=0.5, phase=0.0, offset=0.0)
    segment = Segment(length=0.4, mass=4.0, legs=Legs(length=0.3, force=8.0, hip=swing, knee=swing, stride=math.pi))
    on_ground = np.arange(401) % 4 > 0
    sink, work, poses = np.where(on_ground, 0.001, 0.0), 20 * time, np.empty((0, 11))
    return Rollout(
        time, com, on_ground, sink, work, np.empty((0, 3)), np.empty(0), Phenotype((segment,), frequency=1.5),
        settled=0.25, creep=0.0, overlap=0.0, drive=1.5, warnings=0, verdict="ok", reason="", poses=poses,
    )  # fmt: skip
