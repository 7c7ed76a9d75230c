"""Explain the birth of a robot: repeat it with the operators, and compare the result with the stored genome."""

from dataclasses import replace
from functools import partial

import pandas as pd

from walkerlab.analysis.comparison import compare_with_parents
from walkerlab.analysis.inheritance import Birth
from walkerlab.analysis.mating import trace_birth
from walkerlab.evolution.founders import fit_genomes
from walkerlab.evolution.run import Run
from walkerlab.ga.loop import find_elites
from walkerlab.ga.operators import select_in_turn
from walkerlab.ga.population import fitness_for_comparison
from walkerlab.ga.user_functions import OperatorError
from walkerlab.genome.breeding import resolve_operators
from walkerlab.genome.genome import Genome
from walkerlab.runfile.opening import RunFileError
from walkerlab.runfile.records import birth_rows, last_population, parent_numbers
from walkerlab.settings.settings import Settings


def explain_birth(run: Run, individual: int | None = None) -> Birth:
    """Explain gene by gene how a robot of a run was made from its parents.

    The selection, crossover and mutation of its generation are repeated with the same random numbers. If the
    result differs from the stored genome, for example because a user function is missing, the stored genome is compared
    with those of its parents instead, and ``Birth.is_exact`` is false.

    Args:
        run: Run of the robot.
        individual: Number of the robot; the champion if None.

    Raises:
        ValueError: If the run has no such robot, or does not contain its parents.
    """
    records = run.records
    number = run.champion.individual if individual is None else individual
    births = birth_rows(records)
    if number not in births.index:
        raise ValueError(
            f"individual {number} is not in this run; its individuals are numbered {births.index.min()} to "
            f"{births.index.max()}"
        )
    row = births.loc[number]
    parents = [one for one in parent_numbers(row.parents) if one in births.index]
    if not parents:
        raise ValueError(f"robot {number} has no parents in this table; it is {row.operators}")
    settings = next(stage.settings for stage in reversed(run.stages) if stage.first <= row.born)
    birth = _repeat_birth(run, records, settings, number, int(row.born))
    if birth is not None and str(birth.genome) == row.genome:
        return birth
    genomes: list[Genome | str] = [str(births.genome[one]) for one in parents]
    names = [f"robot {one}" for one in parents]
    inferred = compare_with_parents(str(row.genome), genomes, settings.robot, names)
    return replace(inferred, name=f"robot {number}", operators=tuple(str(row.operators).split(" > ")[1:]))


def _repeat_birth(run: Run, records: pd.DataFrame, settings: Settings, number: int, born: int) -> Birth | None:
    """Repeat a birth; return None if the table lacks the previous generation, or an operator fails."""
    earlier = records.loc[records.generation < born, :]
    if earlier.empty or earlier.generation.max() != born - 1:
        return None
    population = last_population(earlier)
    algorithm = settings.algorithm
    n_children = len(population.genomes) - len(find_elites(population.fitness, algorithm.n_elites))
    child = number - population.n_born
    if not 0 <= child < n_children:
        return None
    try:
        selected = select_in_turn(
            resolve_operators(algorithm).select, population.fitness, n_children + n_children % 2,
            seed=algorithm.seed, generation=born, generations=algorithm.generations, genomes=population.genomes,
        )  # fmt: skip
        return trace_birth(
            population.genomes[selected], fitness_for_comparison(population.fitness)[selected], settings,
            names=[f"robot {one}" for one in population.individuals[selected]],
            seed=algorithm.seed, generation=born, n_children=n_children, child=child,
            name=f"robot {number}",
            repair_rows=partial(fit_genomes, settings=settings, founders=run.founders),
        )  # fmt: skip
    except (OperatorError, RunFileError, ValueError):
        return None
