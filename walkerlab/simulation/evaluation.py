"""Many genomes become many evaluations, on any executor; the answers come in the order of the questions."""

from collections.abc import Callable, Sequence
from concurrent.futures import CancelledError, Executor
from contextlib import closing
from dataclasses import dataclass
from uuid import uuid4

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.ga.user_functions import OperatorError
from walkerlab.genome.genome import Genome, read_genomes
from walkerlab.genome.phenotype import express
from walkerlab.genome.repair import genes_of, repair
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.simulation import fitness as measures
from walkerlab.simulation.rollout import Rollout, walk_from_every_start
from walkerlab.simulation.timeouts import results_in_order
from walkerlab.simulation.workers import check_executor, default_executor, n_workers
from walkerlab.text.numbers import significant, with_unit
from walkerlab.world.scene import reusable_scene_of

LARGEST = 16  # robots of a task, some half a second of walks, so that a run can be paused at once
LONGEST = LARGEST * 1600  # physics steps of a task of more than one robot, for the same reason
SHARE = 3  # a task is at most one part in so many of what is left for a worker, so that all are done at once

START = 60.0  # s that workers are given to begin
SLOWEST = 0.002  # s for a physics step, as long as ten of the costliest world on a slow laptop


@dataclass(frozen=True, eq=False)
class Evaluation:
    """What one walk was worth.

    Attributes:
        genome: as it walked, within the limits.
        fitness: higher is better; ``-inf`` if the walk does not count.
        verdict: ``ok``, or why it does not count.
        reason: the figures behind the verdict, in words.
        distance: net forward travel, m.
        velocity: mean forward speed over the last two thirds, m/s.
        n_segments: grown segments.
        n_legs: legs.
        weight: kg.
        body_length: m.
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

    def __repr__(self) -> str:
        """Say in a line what came of it; the genome is a long text."""
        why = f", {self.reason}" if self.reason else ""
        measured = f"fitness {significant(self.fitness)}" if self.verdict == "ok" else "does not count"
        return f"Evaluation({measured}, {with_unit(self.distance, 'm')} forward, verdict {self.verdict}{why})"


def evaluate(
    genomes: Sequence[Genome | str] | Floats,
    settings: Settings,
    executor: Executor | None = None,
    *,
    on_done: Callable[[int], None] = lambda _: None,
) -> list[Evaluation]:
    """Let each individual walk, and rate it.

    Genomes travel to the workers, scenes are compiled and stepped there, and a few numbers come back; the fitness
    is computed here, so that a function written in a notebook cell never travels. A fitness function that returns
    ``-inf`` (or None) excludes the robot: its verdict is ``rejected``, and it has no children. From several starts, one
    such answer is enough. Any other answer must be one finite number; Python's and numpy's numbers, booleans, fractions
    and arrays of one element are all converted to a float.

    Args:
        genomes: genomes, their texts, or an (n, n_genes) array; brought within the robot limits first.
        settings: of all four domains.
        executor: any ``concurrent.futures.Executor``; loky on all cores if None.
        on_done: told how many more walks are done, in the order in which they are gathered.

    Returns:
        An evaluation each, in the order given, whatever the executor and its number of workers.

    Raises:
        GenomeError: if a text is no genome.
        ValueError: if a single genome is given, an array is none, or a fitness function returns anything but a finite
            number, -inf or None.
        TypeError: if the executor is none, or ``settings`` are not a ``Settings``.
        RuntimeError: if it is closed.
        WorkersLostError: if its workers give no answer, or have no memory left.
    """
    robots = _within(genomes, require_settings(settings).robot)
    world = settings.model_copy(update={"algorithm": Algorithm()})
    check_executor(executor)
    pool = executor or default_executor()
    steps = round(settings.simulation.duration / settings.simulation.timestep) * settings.simulation.n_starts
    tasks = _tasks(robots, n_workers(pool), largest=max(1, min(LARGEST, LONGEST // steps)))
    limit = START + SLOWEST * steps * len(max(tasks, key=len, default=()))
    asked = uuid4().hex
    futures = [pool.submit(_walk_all, [robots[i] for i in task], world, asked) for task in tasks]
    evaluations = dict[int, Evaluation]()
    try:
        with closing(results_in_order(futures, pool, limit)) as answers:
            for task, walks in zip(tasks, answers, strict=True):
                for i, rollouts in zip(task, walks, strict=True):
                    evaluations[i] = _rate(i, robots[i], rollouts, settings)
                on_done(len(task))
    except CancelledError as error:
        raise RuntimeError("the executor was closed while robots were walking in it") from error
    finally:
        for future in futures:
            future.cancel()
    return [evaluations[i] for i in range(len(robots))]


evaluate_population = evaluate
"""The name of the design of 2017 for ``evaluate``."""


def _within(genomes: Sequence[Genome | str] | Floats, robot: Robot) -> list[Genome]:
    """Read the genomes, and bring them within the limits."""
    if isinstance(genomes, np.ndarray) and genomes.shape[1:] == (len(genes_of(robot)),):
        return [Genome(values) for values in repair(genomes, robot)]
    return [genome.within(robot) for genome in read_genomes(genomes)]


def _tasks(robots: Sequence[Genome], n_workers: int, largest: int = LARGEST) -> list[list[int]]:
    """Deal robots out, by their places: the costly ones first and many at a time, at last one by one.

    So no worker is left with a long task when all others are done.
    """
    costly_first = sorted(range(len(robots)), key=lambda i: _cost(robots[i]), reverse=True)
    tasks: list[list[int]] = []
    while costly_first:
        size = min(largest, max(1, len(costly_first) // (SHARE * n_workers)))
        tasks.append(costly_first[:size])
        del costly_first[:size]
    return tasks


def _cost(robot: Genome) -> int:
    """Guess how long a robot's walk takes to compute, against others' in the same world: its limbs are what counts."""
    phenotype = express(robot)
    return len(phenotype.segments) + phenotype.n_legs


def _walk_all(genomes: Sequence[Genome], settings: Settings, asked: str = "") -> list[list[Rollout]]:  # noqa: ARG001
    """Let each walk from every start, in a worker.

    Args:
        genomes: within the limits.
        settings: of the world.
        asked: what tells this question from an equal one of another run, for Dask answers equal ones together, and
            gives both up when one of them is.
    """
    return [walk_from_every_start(*reusable_scene_of(genome, settings), poses=False) for genome in genomes]


def _rate(place: int, genome: Genome, rollouts: Sequence[Rollout], settings: Settings) -> Evaluation:
    """Rate the poorest of its walks.

    Raises:
        OperatorError: if the fitness function goes wrong; it says for which of the robots given.
    """
    try:
        rated = [measures.rate(rollout, settings.algorithm.fitness) for rollout in rollouts]
    except OperatorError as error:
        error.place, error.genome, error.where = place, genome, f"for robot {place} of those given"
        raise
    fitness, rollout = measures.poorest(rated)
    phenotype = rollout.phenotype
    return Evaluation(
        genome=genome,
        fitness=fitness,
        verdict=rollout.verdict,
        reason=rollout.reason,
        distance=measures.distance(rollout),
        velocity=measures.velocity(rollout),
        n_segments=len(phenotype.segments),
        n_legs=phenotype.n_legs,
        weight=phenotype.weight,
        body_length=phenotype.body_length,
    )
