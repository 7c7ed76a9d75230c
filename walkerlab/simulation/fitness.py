"""Fitness functions: each rates one rollout with a single number; higher is better."""

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Protocol, runtime_checkable

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.ga.population import NOT_COUNTED
from walkerlab.ga.user_functions import (
    CHECK_TIME_LIMIT,
    RUN_TIME_LIMIT,
    OperatorError,
    Slot,
    call_in_slot,
    describe_result,
)
from walkerlab.genome.genome import Genome
from walkerlab.genome.phenotype import Legs, Phenotype, Segment, Swing
from walkerlab.settings.choices import Fitness, Recording
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import function_name, short_repr
from walkerlab.simulation.recordings import requested_quantities
from walkerlab.simulation.rollout import Rollout, walk_from_every_start
from walkerlab.simulation.validity import REJECTED
from walkerlab.world.scene import compile_scene

FITNESS_UNITS = {Fitness.distance: "m", Fitness.velocity: "m/s", Fitness.efficiency: "m/J", Fitness.straightness: "m"}

FITNESS_SLOT = Slot(
    "the fitness function",
    "fitness(rollout)",
    "com = rollout.com.copy()",
    advice="It is called with one Rollout: .distance in m, .velocity in m/s, .time (n,) in s, .com (n, 3) in m, "
    ".up (n, 3), .on_ground (n,), .work (n,) in J, .phenotype; .poses are not recorded during evolution. "
    "Request others with the setting record, such as record=['joint_angles'].",
    repeatability_advice="It must depend only on the walk.",
)

MAX_FITNESS = 1e100  # maximum absolute value; the axes of plots cannot show greater ones
IDLE_WORK = 10.0  # J added to the work, so that standing still is not efficient; about the work of servos at rest


def distance(rollout: Rollout) -> float:
    """Return the net forward travel of the centre of mass after settling, in m; negative if it moved backward."""
    return rollout.distance


def velocity(rollout: Rollout) -> float:
    """Return the mean forward speed over the last two thirds of the walk, in m/s; excludes the start."""
    return rollout.velocity


def efficiency(rollout: Rollout) -> float:
    """Return the net forward travel per unit of work done by the legs, in m/J."""
    return distance(rollout) / (IDLE_WORK + float(rollout.work[-1]))


def straightness(rollout: Rollout) -> float:
    """Return the net forward travel minus the sideways displacement between start and end, in m."""
    return distance(rollout) - abs(float(rollout.com[-1, 1] - rollout.com[0, 1]))


FITNESS_FUNCTIONS: dict[Fitness, Callable[[Rollout], float]] = {
    Fitness.distance: distance,
    Fitness.velocity: velocity,
    Fitness.efficiency: efficiency,
    Fitness.straightness: straightness,
}


def name_and_unit(fitness: Fitness | Callable[..., Any]) -> tuple[str, str]:
    """Return the name and the unit of a fitness; the unit of a user function is unknown and returned as ""."""
    return (fitness.name, FITNESS_UNITS[fitness]) if isinstance(fitness, Fitness) else (function_name(fitness), "")


def score(rollout: Rollout, fitness: Fitness | Callable[..., Any], *, seconds: float = RUN_TIME_LIMIT) -> float:
    """Return the fitness of one walk; ``NOT_COUNTED`` if its verdict is not ``ok``.

    Args:
        rollout: Recorded walk.
        fitness: Fitness from the settings, or a user function.
        seconds: Time limit of a user function, in seconds.

    Raises:
        OperatorError: If the function returns anything but a finite number, -inf or None, or breaks another rule for
            user functions.
    """
    return rate_walk(rollout, fitness, seconds=seconds)[0]


def rate_walk(
    rollout: Rollout, fitness: Fitness | Callable[..., Any], *, seconds: float = RUN_TIME_LIMIT
) -> tuple[float, Rollout]:
    """Return the fitness of one walk, and the walk; its verdict is ``rejected`` if the function returns -inf or None.

    Arguments and errors are the same as for ``score``.
    """
    if not rollout.counts:
        return NOT_COUNTED, rollout
    function = FITNESS_FUNCTIONS[fitness] if isinstance(fitness, Fitness) else fitness
    value = call_in_slot(FITNESS_SLOT, function, lambda: function(rollout), seconds)
    number = NOT_COUNTED if value is None else as_number(value)
    if number is None:
        raise OperatorError(
            f"{FITNESS_SLOT.label(function)} must return one finite number, higher being better; it returned "
            f"{describe_result(value)}",
            "Reduce an array to one number with .mean(), .sum() or an index."
            if hasattr(value, "shape")
            else "Return a number, such as rollout.distance.",
        )
    if number == NOT_COUNTED:
        returned = "None" if value is None else "-inf"
        return NOT_COUNTED, replace(rollout, verdict=REJECTED, reason=f"the fitness function returned {returned}")
    if abs(number) < MAX_FITNESS:
        return number, rollout
    advice = (
        "Is something divided by zero?" if math.isnan(number) else f"Its absolute value must be below {MAX_FITNESS:g}."
    )
    raise OperatorError(
        f"{FITNESS_SLOT.label(function)} must return one finite number, higher being better; it returned "
        f"{short_repr(value)}",
        f"{advice} To exclude a robot, return -np.inf.",
    )


def as_number(value: Any) -> float | None:
    """Convert any single real number from Python, numpy or another library to a float.

    Booleans count as 0 and 1, and an array of one element as that element. A number too large for a float becomes inf,
    regardless of its sign.

    Returns:
        The number; None for anything else, such as a string, a complex number or an array of several elements.
    """
    if np.ma.is_masked(value):
        return math.nan
    if getattr(getattr(value, "dtype", None), "kind", "f") not in "biufO":  # such as dates and complex numbers
        return None
    try:
        if callable(item := getattr(value, "item", None)):  # array or scalar of numpy, pandas, jax or torch
            value = item()
        return float(value) if hasattr(value, "__float__") or hasattr(value, "__index__") else None
    except OverflowError:
        return math.inf
    except (TypeError, ValueError, RuntimeError):  # such as an array of several elements
        return None


@runtime_checkable
class MissingFitnessFunction(Protocol):
    """Stand-in for a user function of a loaded run: the run file holds its name and results, but not its code."""

    def select_counted_walk(self, genome: Genome, rollouts: Sequence[Rollout], settings: Settings) -> Rollout:
        """Select the walk that counted in the run from a robot's walks, one from each start."""
        ...


def poorest_walk(genome: Genome | str, settings: Settings, *, poses: bool = True) -> Rollout:
    """Simulate a robot from each of its starts, as evolution does, and return the walk with the lowest fitness.

    If the fitness function of a loaded run is missing, return the walk that matches the distance and velocity in the
    run file.

    Args:
        genome: Genome or its text.
        settings: Complete settings of the run.
        poses: Whether to record poses.

    Raises:
        GenomeError: If the text is not a valid genome.
    """
    scene = compile_scene(genome, settings)
    fitness = settings.algorithm.fitness
    rollouts = walk_from_every_start(scene, poses=poses)
    function = fitness.func if isinstance(fitness, partial) else fitness
    if isinstance(function, MissingFitnessFunction):
        return function.select_counted_walk(scene.genome, rollouts, settings)
    return find_poorest([rate_walk(rollout, fitness) for rollout in rollouts])[1]


def find_poorest(rated: Sequence[tuple[float, Rollout]]) -> tuple[float, Rollout]:
    """Return the lowest fitness and its walk; if several are equal, the first."""
    return min(rated, key=lambda pair: pair[0])


def check_user_function(settings: Settings) -> None:
    """Call a user function with a made-up walk, before any simulation; do nothing for a built-in fitness.

    Args:
        settings: Settings with the fitness and the quantities that walks record on request.

    Raises:
        OperatorError: If it fails, returns anything but a finite number, -inf or None, or returns different numbers for
            the same walk.
    """
    fitness = settings.algorithm.fitness
    if isinstance(fitness, Fitness):
        return
    requested = requested_quantities(settings)
    try:
        first, second = (score(_create_made_up_walk(requested), fitness, seconds=CHECK_TIME_LIMIT) for _ in range(2))
        if first != second:
            raise OperatorError(
                f"{FITNESS_SLOT.label(fitness)} returned {first} and then {second} for the same walk, so "
                "a run would not be reproducible",
                FITNESS_SLOT.repeatability_advice,
            )
    except OperatorError as error:
        error.context = "when tried on a made-up walk"
        raise


def _create_made_up_walk(requested: Collection[Recording] = ()) -> Rollout:
    """Create a regular walk of 8 s at 0.5 m/s, with a foot on the ground for three quarters of the time.

    Args:
        requested: Quantities that are recorded in addition.
    """
    time = np.arange(401) / 50
    com = np.stack([0.5 * time, 0.01 * np.sin(time), 0.2 + 0.01 * np.cos(9 * time)], axis=1)
    swing = Swing(amplitude=0.5, phase=0.0, offset=0.0)
    legs = Legs(length=0.3, force=8.0, phase=0.0, stride=math.pi, hip=swing, knee=swing)
    segment = Segment(length=0.4, mass=4.0, legs=legs)
    on_ground = np.arange(401) % 4 > 0
    stride = math.tau * 1.5 * time[:, np.newaxis] + [0.0, 0.5, math.pi, math.pi + 0.5]
    quantities: dict[Recording, Floats] = {
        Recording.joint_angles: 0.5 * np.sin(stride),
        Recording.joint_velocities: 0.5 * math.tau * 1.5 * np.cos(stride),
        Recording.orientation: np.tile(np.eye(3), (401, 1, 1)),
        Recording.contact_forces: np.where(
            on_ground[:, np.newaxis, np.newaxis], np.tile([1.0, 0.0, 20.0], (401, 2, 1)), 0.0
        ),
    }
    return Rollout(
        time=time,
        com=com,
        up=np.tile([0.0, 0.0, 1.0], (401, 1)),
        on_ground=on_ground,
        sink=np.where(on_ground, 0.001, 0.0),
        work=20 * time,
        load=np.empty((0, 3)),
        rope=np.empty(0),
        phenotype=Phenotype((segment,), frequency=1.5, duty=0.5),
        settled=0.25,
        creep=0.0,
        overlap=0.0,
        drive=1.5,
        warnings=0,
        level_speed=math.nan,
        verdict="ok",
        reason="",
        poses=np.empty((0, 11)),
        recorded={quantity.name: quantities[quantity] for quantity in requested},
    )
