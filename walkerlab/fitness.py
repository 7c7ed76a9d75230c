"""What makes one robot better than another: a function from a rollout to a number, higher being better."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from walkerlab.choices import Fitness
from walkerlab.ga.loop import NOT_COUNTED
from walkerlab.ga.own import IN_A_CHECK, IN_A_RUN, OperatorError, Slot, ask, portrait
from walkerlab.genome import Genome
from walkerlab.phenotype import Legs, Phenotype, Segment, Swing
from walkerlab.quantity import function_name
from walkerlab.rollout import Rollout, walk_from_every_start
from walkerlab.scene import compile_scene
from walkerlab.settings import Settings

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
        rollout: the walk; it is read-only from then on.
        fitness: one of ours, or a function of the user's own.
        seconds: that such a function may take.

    Raises:
        OperatorError: if it gives anything but a finite number, or does anything else that it must not.
    """
    if not rollout.counts:
        return NOT_COUNTED
    for record in vars(rollout).values():
        if isinstance(record, np.ndarray):  # who comes from another process can be written into
            record.setflags(write=False)
    function = FUNCTIONS[fitness] if isinstance(fitness, Fitness) else fitness
    value = ask(SLOT, function, lambda: function(rollout), seconds)
    is_number = isinstance(value, int | float | np.integer | np.floating)
    if is_number and abs(value) < LARGEST:
        return float(value)
    returned = f"{value!s:.60}" if is_number else portrait(value)
    raise OperatorError(
        f"{SLOT.who(function)} must return one finite number, higher being better; it returned {returned}",
        "Is a return missing, something divided by zero, or an array not yet made one number, as by .mean()?",
    )


def poorest_walk(genome: Genome | str, settings: Settings, *, poses: bool = True) -> Rollout:
    """Let a robot walk as evolution does: from each of its starts, of which the poorest walk counts.

    Args:
        genome: a genome or its text.
        settings: of all four domains.
        poses: whether to record every pose.

    Raises:
        GenomeError: if a text is no genome.
    """
    rollouts = walk_from_every_start(compile_scene(genome, settings), poses=poses)
    return rollouts[0] if len(rollouts) == 1 else min(rollouts, key=lambda one: score(one, settings.algorithm.fitness))


def check_own(fitness: Fitness | Callable[..., Any]) -> None:
    """Try a function of the user's own on a made-up walk before any physics runs.

    Raises:
        OperatorError: if it fails, gives anything but a finite number, or two numbers for one walk.
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
