"""Many genomes become many evaluations, on any executor; the answers come in the order of the questions."""

import os
import signal
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache

import numpy as np

from walkerlab import fitness as measures
from walkerlab.genes import Floats
from walkerlab.genome import Genome, read_genomes
from walkerlab.interrupts import interrupts_held
from walkerlab.limits import genes_of, repair
from walkerlab.rollout import Rollout, from_every_start
from walkerlab.scene import scene_of
from walkerlab.settings import Algorithm, Robot, Settings

CHUNKS = 8  # tasks for each core and batch: enough to level out slow walks, few enough to cost nothing
LARGEST = 16  # robots of a task, some half a second of walks, so that a run can be paused at once
IDLE_TIMEOUT = 300  # s without work after which loky's workers go home


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
        return f"Evaluation(fitness {self.fitness:.3f}, {self.distance:.2f} m, verdict {self.verdict}{why})"


def evaluate(
    genomes: Sequence[Genome | str] | Floats,
    settings: Settings,
    executor: Executor | None = None,
    *,
    on_done: Callable[[int], None] = lambda _: None,
) -> list[Evaluation]:
    """Let each individual walk, and rate it.

    Genomes travel to the workers, scenes are compiled and stepped there, and a few numbers come back; the fitness
    is computed here, so that a function written in a notebook cell never travels.

    Args:
        genomes: genomes, their texts, or an (n, n_genes) array; brought within the robot limits first.
        settings: of all four domains.
        executor: any ``concurrent.futures.Executor``; loky on all cores if None.
        on_done: told how many more walks are done, in the order in which they are gathered.

    Returns:
        An evaluation each, in the order given, whatever the executor and its number of workers.

    Raises:
        GenomeError: if a text is no genome.
        ValueError: if a single genome is given, an array is none, or a fitness function gives anything but a finite
            number.
    """
    robots = _within(genomes, settings.robot)
    world = settings.model_copy(update={"algorithm": Algorithm()})
    size = min(LARGEST, max(1, len(robots) // (CHUNKS * n_cores())))
    chunks = [robots[i : i + size] for i in range(0, len(robots), size)]
    pool = executor or default_executor()
    futures = [pool.submit(_walk_all, chunk, world) for chunk in chunks]
    evaluations: list[Evaluation] = []
    try:
        for chunk, future in zip(chunks, futures, strict=True):
            evaluations += [_rate(*pair, settings) for pair in zip(chunk, future.result(), strict=True)]
            on_done(len(chunk))
    finally:
        for future in futures:
            future.cancel()
    return evaluations


evaluate_population = evaluate
"""The name of the design of 2017 for ``evaluate``."""


def n_cores() -> int:
    """How many cores this process may use, which on a shared machine can be fewer than there are."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def default_executor() -> Executor:
    """Return loky's pool on all cores, started at first use and kept for the next, whichever thread asks."""
    return _keeper().submit(_pool).result()


@cache
def _keeper() -> ThreadPoolExecutor:
    """Start the one thread that asks for the pool, for loky keeps a pool for each thread that does."""
    return ThreadPoolExecutor(1, "walkerlab pool")


def _pool() -> Executor:
    from loky import get_reusable_executor

    with interrupts_held():
        pool = get_reusable_executor(
            n_cores(), timeout=IDLE_TIMEOUT, initializer=_prepare_worker, initargs=(os.getpid(),)
        )
        pool.submit(int)  # starts the workers now, so that they inherit the hold
    return pool


def _prepare_worker(caller: int) -> None:
    """Make a worker leave Ctrl-C to its caller, and follow it when it is gone.

    Ctrl-C reaches every process of a terminal; one of them is enough to stop a run in good order. And a caller that
    is killed, as a notebook's kernel is when it is restarted, can't send its workers home.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_leave_with, args=(caller,), daemon=True).start()


def _leave_with(caller: int) -> None:
    while os.getppid() == caller:  # on Windows this stays as it is, and the idle timeout has to do
        time.sleep(1)
    os._exit(0)


def _within(genomes: Sequence[Genome | str] | Floats, robot: Robot) -> list[Genome]:
    """Read the genomes, and bring them within the limits."""
    if isinstance(genomes, np.ndarray) and genomes.shape[1:] == (len(genes_of(robot)),):
        return [Genome(values) for values in repair(genomes, robot)]
    return [genome.within(robot) for genome in read_genomes(genomes)]


def _walk_all(genomes: Sequence[Genome], settings: Settings) -> list[list[Rollout]]:
    """Let each walk from every start, in a worker."""
    return [from_every_start(scene_of(genome, settings), poses=False) for genome in genomes]


def _rate(genome: Genome, rollouts: Sequence[Rollout], settings: Settings) -> Evaluation:
    """Rate the poorest of its walks."""
    scores = [measures.score(rollout, settings.algorithm.fitness) for rollout in rollouts]
    fitness = min(scores)
    rollout = rollouts[scores.index(fitness)]
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
