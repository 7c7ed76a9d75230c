"""Evaluation of genomes on any executor; the results are in the order of the genomes."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import CancelledError, Executor
from contextlib import closing
from dataclasses import dataclass, field
from uuid import uuid4

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.ga.user_functions import OperatorError
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome, read_genomes
from walkerlab.genome.phenotype import express
from walkerlab.genome.repair import repair
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import short_repr
from walkerlab.simulation.descriptors import Descriptor, describe_walk, read_descriptors
from walkerlab.simulation.fitness import find_poorest, rate_walk
from walkerlab.simulation.rollout import Rollout, walk_from_every_start
from walkerlab.simulation.timeouts import results_in_order
from walkerlab.simulation.workers import check_executor, default_executor, n_workers
from walkerlab.text.numbers import format_significant, with_unit
from walkerlab.world.scene import reusable_scene_of

MAX_TASK_SIZE = 16  # maximum number of robots; about half a second of walks, so that a run can be paused quickly
MAX_TASK_STEPS = MAX_TASK_SIZE * 1600  # maximum physics steps of a task with several robots, for the same reason
MIN_TASKS_LEFT = 3  # minimum tasks per worker that the remaining robots can fill; balances the load at the end

START_TIME_LIMIT = 60.0  # s within which workers must start
MAX_SECONDS_PER_STEP = 0.002  # ten times the duration of a physics step of the slowest world on a slow laptop


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Result of the walk of one individual.

    Attributes:
        genome: Genome that was simulated, within the robot limits.
        fitness: Fitness, higher is better; ``-inf`` if the walk does not count.
        verdict: ``ok``, or why the walk does not count: a key of ``VERDICTS``.
        reason: Explanation of the verdict with the measured value and the limit; "" if the verdict is ``ok``.
        distance: Net forward travel, m.
        velocity: Mean forward speed over the last two thirds of the walk, m/s.
        n_segments: Number of segments of the body.
        n_legs: Number of legs.
        weight: Weight of the robot, kg.
        body_length: Length of the body, m.
        descriptors: Behaviour descriptors of the walk by name; empty if the walk does not count.
    """

    genome: Genome
    fitness: float
    verdict: str
    reason: str
    distance: float
    velocity: float
    n_segments: int
    n_legs: int
    weight: float
    body_length: float
    descriptors: Mapping[str, float] = field(default_factory=dict[str, float])

    def __repr__(self) -> str:
        """Return a one-line summary; the genome is too long to print."""
        why = f", {self.reason}" if self.reason else ""
        rating = f"fitness {format_significant(self.fitness)}" if self.verdict == "ok" else "does not count"
        return f"Evaluation({rating}, {with_unit(self.distance, 'm')} forward, verdict {self.verdict}{why})"


def evaluate(
    genomes: Sequence[Genome | str] | Floats,
    settings: Settings,
    executor: Executor | None = None,
    *,
    on_done: Callable[[int], None] = lambda _: None,
    starts: Sequence[int] | None = None,
    on_rated: Callable[[int, Evaluation], None] = lambda *_: None,
    descriptors: Iterable[str] | Mapping[str, Descriptor] = (),
) -> list[Evaluation]:
    """Simulate the walk of each individual and rate it.

    The workers receive genomes, compile and simulate their scenes, and return rollouts without poses. The fitness is
    computed in this process, so a function defined in a notebook cell is never sent to a worker. A fitness function
    that returns ``-inf`` or None for any start excludes the robot: its verdict is ``rejected``, and it has no children.
    Any other return value must be one finite number; Python and numpy numbers, booleans, fractions and arrays of one
    element are converted to a float.

    Args:
        genomes: Genomes, their texts, or an array of shape (n, n_genes); repaired to be within the robot limits.
        settings: Complete settings of the run.
        executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        on_done: Function called with the number of newly finished robots after each task, in the order of the tasks.
        starts: Numbers of the starts from which each robot walks: 0 is the exact start, and each other number is a
            slightly different start. By default, 0 up to the number in ``settings.simulation.n_starts``.
        on_rated: Function called with the index of each genome and its evaluation, before ``on_done``.
        descriptors: Names of built-in behaviour descriptors, or a dict from names to functions of a ``Rollout``; each
            evaluation has their values for its walk.

    Returns:
        One evaluation per genome, in the same order; it does not depend on the executor or its number of workers.

    Raises:
        GenomeError: If a string is not a valid genome.
        ValueError: If ``genomes`` is a single genome or an array of another shape, if ``starts`` are not whole numbers
            of 0 or more, if there is no descriptor of a name, or if the fitness function returns anything but a finite
            number, -inf or None.
        TypeError: If ``executor`` is not an executor, ``settings`` is not a ``Settings``, or a descriptor is not a
            function.
        RuntimeError: If the executor is closed.
        WorkersLostError: If the workers do not answer or run out of memory.
    """
    functions = read_descriptors(descriptors)
    robots = _read_and_repair(genomes, require_settings(settings).robot)
    world = settings.model_copy(update={"algorithm": Algorithm()})
    check_executor(executor)
    pool = executor or default_executor()
    starts = _read_starts(starts, settings)
    steps = round(settings.simulation.duration / settings.simulation.timestep) * len(starts)
    tasks = _divide_into_tasks(robots, n_workers(pool), max_size=max(1, min(MAX_TASK_SIZE, MAX_TASK_STEPS // steps)))
    limit = START_TIME_LIMIT + MAX_SECONDS_PER_STEP * steps * len(max(tasks, key=len, default=()))
    call_id = uuid4().hex
    futures = [pool.submit(_simulate_task, [robots[i] for i in task], world, starts, call_id) for task in tasks]
    evaluations: dict[int, Evaluation] = {}
    try:
        with closing(results_in_order(futures, pool, limit)) as results:
            for task, rollouts_of_task in zip(tasks, results, strict=True):
                for i, rollouts in zip(task, rollouts_of_task, strict=True):
                    evaluations[i] = _rate_robot(i, robots[i], rollouts, settings, functions)
                    on_rated(i, evaluations[i])
                on_done(len(task))
    except CancelledError as error:
        raise RuntimeError("the executor was closed while its workers simulated walks") from error
    finally:
        for future in futures:
            future.cancel()
    return [evaluations[i] for i in range(len(robots))]


evaluate_population = evaluate
"""Original name of ``evaluate``, from 2017."""


def _read_starts(starts: Sequence[int] | None, settings: Settings) -> list[int]:
    """Return the numbers of the starts; those in the settings if None."""
    if starts is None:
        return list(range(settings.simulation.n_starts))
    numbers = np.asarray(starts)
    if not numbers.size or numbers.ndim != 1 or numbers.dtype.kind not in "iu" or numbers.min() < 0:
        raise ValueError(
            f"starts is {short_repr(starts)}; it must contain at least one whole number: 0 for the exact start, and 1, "
            "2, … for slightly different starts, such as range(1, 6)"
        )
    return numbers.tolist()


def _read_and_repair(genomes: Sequence[Genome | str] | Floats, robot: Robot) -> list[Genome]:
    """Read genomes and repair them to be within the robot limits."""
    if isinstance(genomes, np.ndarray) and genomes.shape[1:] == (len(build_genes(robot)),):
        return [Genome(values) for values in repair(genomes, robot)]
    return [genome.within(robot) for genome in read_genomes(genomes)]


def _divide_into_tasks(robots: Sequence[Genome], n_workers: int, max_size: int = MAX_TASK_SIZE) -> list[list[int]]:
    """Divide robots into tasks: slow robots first, and smaller tasks towards the end.

    This way, no worker has a long task left when all others are done.

    Returns:
        For each task, the indices of its robots.
    """
    slowest_first = sorted(range(len(robots)), key=lambda i: _estimate_cost(robots[i]), reverse=True)
    tasks: list[list[int]] = []
    while slowest_first:
        size = min(max_size, max(1, len(slowest_first) // (MIN_TASKS_LEFT * n_workers)))
        tasks.append(slowest_first[:size])
        del slowest_first[:size]
    return tasks


def _estimate_cost(robot: Genome) -> int:
    """Estimate the relative computing time of a robot's walk from its number of limbs."""
    phenotype = express(robot)
    return len(phenotype.segments) + phenotype.n_legs


def _simulate_task(
    genomes: Sequence[Genome],
    settings: Settings,
    starts: Sequence[int],
    call_id: str = "",  # noqa: ARG001
) -> list[list[Rollout]]:
    """Simulate each robot from every start; runs in a worker.

    Args:
        genomes: Genomes within the robot limits.
        settings: Settings of the world.
        starts: Numbers of the starts.
        call_id: Unique string of one call of ``evaluate``. Dask computes equal calls only once and cancels them
            together; this makes the same tasks of two runs different.
    """
    return [
        walk_from_every_start(*reusable_scene_of(genome, settings), poses=False, starts=starts) for genome in genomes
    ]


def _rate_robot(
    index: int,
    genome: Genome,
    rollouts: Sequence[Rollout],
    settings: Settings,
    descriptors: Mapping[str, Descriptor],
) -> Evaluation:
    """Rate the walks of one robot and return the evaluation of the poorest.

    Raises:
        OperatorError: If the fitness function or a descriptor fails; the error contains the index and the genome of the
            robot.
    """
    try:
        rated = [rate_walk(rollout, settings.algorithm.fitness) for rollout in rollouts]
        fitness, rollout = find_poorest(rated)
        described = describe_walk(rollout, descriptors) if rollout.counts else {}
    except OperatorError as error:
        error.robot_index = index
        error.genome = genome
        error.context = f"for the robot at index {index}"
        raise
    phenotype = rollout.phenotype
    return Evaluation(
        genome=genome,
        fitness=fitness,
        verdict=rollout.verdict,
        reason=rollout.reason,
        distance=rollout.distance,
        velocity=rollout.velocity,
        n_segments=len(phenotype.segments),
        n_legs=phenotype.n_legs,
        weight=phenotype.weight,
        body_length=phenotype.body_length,
        descriptors=described,
    )
