"""Three searches for a fast walker: evolution, random search and CMA-ES, each of which can be resumed.

An evaluation is one walk; a robot that walks from two starts takes two of them, and the walks with which evolution
tests its best robots from other starts are counted, too. Random search evaluates the random robots of other seeds.
CMA-ES evaluates ``N_RANDOM`` random robots, keeps the body of the best one, and optimises its gait. Both store the
fitness of each batch in a text file, one line for each batch. They propose the same robots again when they are given
the same fitness, so a search is resumed by replaying that file without any walk.
"""

import json
import math
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

import cma
import numpy as np
import pandas as pd

import walkerlab as wl
from walkerlab.evolution.fragility import FRAGILE, further_starts
from walkerlab.ga.genes import Floats, Indices
from walkerlab.genome.features import build_genes
from walkerlab.genome.repair import repair
from walkerlab.runfile import records
from walkerlab.system.files import write_text

BATCH_SIZE = 50  # robots that are evaluated between two lines of the file
RANDOM_SEED_OFFSET = 1000  # added to the seed, so that random search evaluates other robots than generation 0
CMA_SEED_OFFSET = 2000
N_RANDOM = 200  # random robots from which CMA-ES takes the best body
CMA_POPULATION_SIZE = 24
CMA_STEP_SIZE = 0.2  # initial standard deviation, as a share of the range of each gene

Proposals = Generator[Floats, Floats, None]
"""Generator that yields genomes, shape (n, n_genes), and receives their fitness, shape (n,)."""


@dataclass(frozen=True)
class Champion:
    """Best robot of a search within a number of evaluations.

    Attributes:
        genome: Genome of the robot.
        n_evaluations: Number of evaluations used.
    """

    genome: wl.Genome
    n_evaluations: int


Search = Callable[[wl.Settings, int, Sequence[int], Path, Executor], dict[int, Champion]]
"""Search for settings, a seed and several numbers of evaluations, with a path without suffix, on an executor."""


def count_generations(settings: wl.Settings, n_evaluations: int) -> int:
    """Return the number of generations that take at most the given number of evaluations, at least 1."""
    algorithm = settings.algorithm
    n_robots = n_evaluations // settings.simulation.n_starts
    children = algorithm.population_size - algorithm.n_elites
    return max(1, (n_robots - algorithm.n_elites) // children)


def search_by_evolution(
    settings: wl.Settings, seed: int, budgets: Sequence[int], path: Path, executor: Executor
) -> dict[int, Champion]:
    """Evolve, and return the champion within each number of evaluations.

    The table of a run does not depend on its total number of generations, so one run serves all numbers of evaluations.
    """
    path = path.with_suffix(".walk")
    n_generations = count_generations(settings, max(budgets))
    if not path.exists():
        run = wl.evolve(settings.with_(seed=seed, generations=n_generations), path, executor, progress=False)
    else:
        run = wl.load(path)
        if run.n_generations < n_generations:
            run = wl.resume(path, n_generations, executor, progress=False)
    champions: dict[int, Champion] = {}
    table = run.records
    n_walks = count_walks(table, settings)
    for budget in budgets:
        last = max(0, int(np.searchsorted(n_walks, budget, side="right")) - 1)
        within: Any = table[table.generation <= last]
        champions[budget] = Champion(records.find_champion(within).genome, int(n_walks[last]))
    return champions


def count_walks(table: pd.DataFrame, settings: wl.Settings) -> Indices:
    """Return the largest possible number of walks up to each generation of a run, shape (n_generations,).

    The best robots of each generation are tested in further walks from other starts. They are the robots excluded as
    fragile, and the new elites, which passed the test. A test stops at the first walk that does not count, and elites
    that are no better than the median are not tested; the table shows neither.
    """
    n_best = max(1, settings.algorithm.n_elites)
    n_test_starts = len(further_starts(settings))
    is_new = ~table.duplicated("genome")  # a copy is counted as an evaluation, but it is not tested
    counts: list[int] = []
    for number in range(int(table.generation.max()) + 1):
        robots: Any = table[table.generation == number]
        new = robots[is_new[robots.index]]
        best = set(robots.drop_duplicates("genome").nlargest(n_best, "fitness").genome)
        has_passed = new.genome.isin(best) & (new.verdict == "ok")
        n_tested = int((has_passed | (new.verdict == FRAGILE)).sum())
        n_born = int((robots.born == number).sum())
        counts.append(n_born * settings.simulation.n_starts + n_tested * n_test_starts)
    return np.cumsum(counts)


def search_at_random(
    settings: wl.Settings, seed: int, budgets: Sequence[int], path: Path, executor: Executor
) -> dict[int, Champion]:
    """Evaluate random robots, and return the best within each number of evaluations."""
    return _run_search(
        propose_at_random(settings, seed, _n_robots(settings, budgets)), settings, budgets, path, executor
    )


def search_by_cma(
    settings: wl.Settings, seed: int, budgets: Sequence[int], path: Path, executor: Executor
) -> dict[int, Champion]:
    """Optimise the gait of the best random body by CMA-ES, and return the best within each number of evaluations."""
    return _run_search(propose_by_cma(settings, seed, _n_robots(settings, budgets)), settings, budgets, path, executor)


METHODS: dict[str, Search] = {"evolution": search_by_evolution, "random": search_at_random, "cma": search_by_cma}
"""Searches by name."""


def _n_robots(settings: wl.Settings, budgets: Sequence[int]) -> int:
    return max(1, max(budgets) // settings.simulation.n_starts)


def propose_at_random(settings: wl.Settings, seed: int, n_robots: int) -> Proposals:
    """Yield random genomes, at least ``n_robots`` in total."""
    n_rounded = -(-n_robots // BATCH_SIZE) * BATCH_SIZE  # so that a longer search has the same batches
    genomes = wl.generate_robot_population(settings.robot, n_rounded, seed=RANDOM_SEED_OFFSET + seed)
    for start in range(0, n_rounded, BATCH_SIZE):
        yield genomes[start : start + BATCH_SIZE]


def propose_by_cma(settings: wl.Settings, seed: int, n_robots: int) -> Proposals:
    """Yield random genomes, then genomes with the best body of these and a gait that CMA-ES proposes, endlessly.

    Genes are scaled to their range. Cyclic genes have no bounds. If CMA-ES has converged, it starts again at the best
    gait found so far.
    """
    n_random = max(1, min(N_RANDOM, n_robots // 2))
    genomes = wl.generate_robot_population(settings.robot, n_random, seed=CMA_SEED_OFFSET + seed)
    scores: list[float] = []
    for start in range(0, n_random, BATCH_SIZE):
        scores += (yield genomes[start : start + BATCH_SIZE]).tolist()
    best, best_score = genomes[np.argmax(scores)], max(scores)

    genes = build_genes(settings.robot)
    gait = find_gait_genes(best, settings.robot)
    low = genes.low[gait]
    span = genes.high[gait] - low
    is_bounded = ~genes.is_cyclic[gait]
    bounds = [
        [0.0 if bounded else None for bounded in is_bounded],
        [1.0 if bounded else None for bounded in is_bounded],
    ]
    for restart in count():
        options = {
            "popsize": CMA_POPULATION_SIZE,
            "bounds": bounds,
            "seed": 1 + seed + 10_000 * restart,  # 0 would be the time
            "verbose": -9,
            "verb_log": 0,
        }
        strategy = cma.CMAEvolutionStrategy((best[gait] - low) / span, CMA_STEP_SIZE, options)
        while not strategy.stop():
            points = strategy.ask()
            genomes = np.tile(best, (len(points), 1))
            genomes[:, gait] = low + span * np.array(points)
            fitness = yield genomes
            strategy.tell(points, [-score if math.isfinite(score) else math.inf for score in fitness])
            if fitness.max() > best_score:
                best, best_score = genomes[np.argmax(fitness)], fitness.max()


def find_gait_genes(genome: Floats, robot: wl.Robot) -> Indices:
    """Return the indices of the real and cyclic genes that change the gait of a robot, but not its body.

    Args:
        genome: Genome of the robot, shape (n_genes,).
        robot: Limits of the robots.
    """
    genes = build_genes(robot)
    found: list[int] = []
    for gene in np.flatnonzero(~genes.is_count):
        variants: list[wl.Phenotype] = []
        for value in (genes.low[gene], (genes.low[gene] + genes.high[gene]) / 2):
            values = genome.copy()
            values[gene] = value
            variants.append(wl.express(wl.Genome(values)))
        one, other = variants
        if one != other and _body(one) == _body(other):
            found.append(int(gene))
    return np.array(found, dtype=np.intp)


def _body(phenotype: wl.Phenotype) -> list[tuple[float, ...]]:
    """Return length and mass of each segment, and length and force of its legs."""
    return [
        (segment.length, segment.mass, *((segment.legs.length, segment.legs.force) if segment.legs else ()))
        for segment in phenotype.segments
    ]


def _run_search(
    proposals: Proposals, settings: wl.Settings, budgets: Sequence[int], path: Path, executor: Executor
) -> dict[int, Champion]:
    """Evaluate proposals, after those whose fitness is stored, and return the best within each number of evaluations.

    Raises:
        ValueError: If the stored fitness is not that of these proposals.
    """
    log = path.with_suffix(".fitness").absolute()
    stored = log.read_text(encoding="utf-8") if log.exists() else ""
    stored = stored[: stored.rfind("\n") + 1]  # without a line that was being written when the process was killed
    write_text(log, stored)
    lines = iter(stored.splitlines())
    n_robots = _n_robots(settings, budgets)
    genomes: list[Floats] = []
    scores: list[float] = []
    batch = next(proposals)
    while True:
        batch = repair(batch, settings.robot)
        if line := next(lines, ""):
            fitness = json.loads(line)
            if len(fitness) != len(batch):
                raise ValueError(f"{log} holds the fitness of another search; delete it, or use another folder")
        else:
            fitness = [evaluation.fitness for evaluation in wl.evaluate(batch, settings, executor)]
            with log.open("a", encoding="utf-8") as file:
                file.write(json.dumps(fitness) + "\n")
        genomes += list(batch)
        scores += fitness
        if len(scores) >= n_robots:
            break
        batch = proposals.send(np.array(fitness))
    n_starts = settings.simulation.n_starts
    champions: dict[int, Champion] = {}
    for budget in budgets:
        n_within = max(1, budget // n_starts)
        champions[budget] = Champion(wl.Genome(genomes[int(np.argmax(scores[:n_within]))]), n_within * n_starts)
    return champions
