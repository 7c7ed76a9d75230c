"""Resuming with a function that has changed: the fitness must rate the last generation as the file does."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from walkerlab.breeding import in_turn
from walkerlab.evolution.run import own_slots
from walkerlab.ga.genes import Floats
from walkerlab.ga.loop import Population
from walkerlab.ga.user_functions import OperatorError
from walkerlab.runfile.provenance import UNKNOWN, source_digest
from walkerlab.runfile.records import Walked
from walkerlab.runfile.store import RunFileError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import function_name
from walkerlab.simulation.evaluation import Evaluation

FITNESS = "fitness function"


def function_facts(settings: Settings) -> dict[str, str]:
    """Return the name and source digest of each function of the user's own, to be recorded with each generation."""
    return {
        f"{slot} function": ", ".join(
            f"{function_name(one)} (source {source_digest(one) or UNKNOWN})"
            for one in in_turn(getattr(settings.algorithm, slot))
            if callable(one)
        )
        for slot in own_slots(settings)
    }


def changed_operators(then: Mapping[str, str], now: Mapping[str, str]) -> str:
    """Name the operators whose source is not the recorded one; "" where all that is known is the same."""
    return " and ".join(
        name.removesuffix(" function")
        for name, fact in now.items()
        if name != FITNESS and name in then and then[name] != fact
    )


@dataclass(frozen=True)
class Recorded:
    """What a run file says of the fitness function.

    Attributes:
        path: The run file.
        facts: What its last generation was made with.
        is_elsewhere: Whether it was made with other versions or on another processor, where walks can end differently.
        has_fitness: Whether any robot of the run has a fitness other than -inf.
    """

    path: Path
    facts: Mapping[str, str]
    is_elsewhere: bool
    has_fitness: bool


def confirm_ratings(
    population: Population[Walked],
    settings: Settings,
    recorded: Recorded,
    evaluate: Callable[[Floats], Sequence[Evaluation]],
    *,
    rerate: bool,
) -> tuple[Population[Walked], bool]:
    """Let the last generation walk again if its fitness is a function of the user's own, and compare the ratings.

    Args:
        population: The last generation, with the ratings in the file.
        settings: Settings of the run, with the functions given.
        recorded: What the file says of the fitness function.
        evaluate: Function that returns the evaluations of (n, n_genes) genomes.
        rerate: Whether to take new ratings where they differ.

    Returns:
        The population to breed from, and whether it has new ratings.

    Raises:
        RunFileError: If the ratings differ, or cannot be compared, and ``rerate`` is false.
        OperatorError: If the function fails on one of these walks.
    """
    now = function_facts(settings).get(FITNESS)
    is_same_source = recorded.facts.get(FITNESS) == now and UNKNOWN not in (now or "")
    if not rerate and (now is None or (recorded.is_elsewhere and is_same_source)):
        return population, False
    rated = _rate(population, evaluate)
    counted = np.isfinite(population.fitness)
    is_comparable = bool(counted.any()) or is_same_source or not recorded.has_fitness
    if is_comparable and np.array_equal(rated.fitness, population.fitness):
        return population, False
    if rerate:
        return rated, True
    raise RunFileError(_refusal(population, rated, settings, recorded))


def _rate(population: Population[Walked], evaluate: Callable[[Floats], Sequence[Evaluation]]) -> Population[Walked]:
    """Return a population with new ratings; equal genomes walk once."""
    texts = [walked.genome for walked in population.evaluations]
    rows = {text: row for row, text in enumerate(texts)}
    try:
        evaluations = evaluate(population.genomes[list(rows.values())])
    except OperatorError as error:
        individual = population.individuals[list(rows.values())[error.place]]
        error.where = f"for individual {individual} of generation {population.generation}, rated again to resume"
        raise
    rated = {text: Walked.of(one, text) for text, one in zip(rows, evaluations, strict=True)}
    return replace(population, evaluations=[rated[text] for text in texts])


def _refusal(population: Population[Walked], rated: Population[Walked], settings: Settings, recorded: Recorded) -> str:
    """Say how the ratings differ, by the fittest robot that has two, and how to go on."""
    number, path = population.generation, str(recorded.path)
    differing = np.flatnonzero(rated.fitness != population.fitness)
    if differing.size:
        row = differing[np.argmax(population.fitness[differing])]
        why = (
            f"Robot {population.individuals[row]} of generation {number} has fitness {population.fitness[row]:.10g} in "
            f"the file, and {rated.fitness[row]:.10g} with the function given."
        )
    else:
        why = f"No walk of generation {number} counts, so that the function given cannot be compared with the file."
    if recorded.is_elsewhere:
        why += " The run was made with other versions or on another processor, so the walks may differ as well."
    functions = ", ".join(f"{slot}={how}" for slot, how in own_slots(settings).items())
    return (
        f"{path} is not resumed, because its fitness function may have changed. {why} A run must not mix the numbers "
        f"of two functions. Either start a new run with this function:\n"
        f"    wl.evolve(wl.load({path!r}).settings.with_({functions}), 'new.walk')\n"
        f"or continue this one from new ratings of generation {number}:\n"
        f"    wl.resume({path!r}, {functions}, rerate=True)\n"
        f"Then generations 0 to {number} keep their numbers in the file, and the champion is taken from later ones."
    )
