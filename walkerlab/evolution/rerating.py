"""Check, before a run is resumed, that its user functions are still the same.

The fitness function must rate the last generation as the file does; a changed operator is reported.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from walkerlab.evolution.fragility import FRAGILE
from walkerlab.evolution.rating import retest_best
from walkerlab.evolution.stored_functions import user_functions
from walkerlab.ga.population import Population
from walkerlab.ga.user_functions import OperatorError
from walkerlab.genome.breeding import slot_entries
from walkerlab.runfile.opening import RunFileError
from walkerlab.runfile.provenance import UNKNOWN_SOURCE, source_digest
from walkerlab.runfile.records import EvaluationRow
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import function_name, number_text
from walkerlab.simulation.evaluation import Evaluation
from walkerlab.system.files import display_path

FITNESS_FACT = "fitness function"


def function_facts(settings: Settings) -> dict[str, str]:
    """Return the name and source digest of each user function, to be recorded with each generation."""
    return {
        f"{slot} function": ", ".join(
            f"{function_name(function)} (source {source_digest(function) or UNKNOWN_SOURCE})"
            for function in slot_entries(getattr(settings.algorithm, slot))
            if callable(function)
        )
        for slot in user_functions(settings)
    }


def changed_operators(then: Mapping[str, str], now: Mapping[str, str]) -> str:
    """Name the operators whose source differs from the recorded one; "" if there is no difference.

    Args:
        then: Recorded facts.
        now: Facts of the given functions.
    """
    return " and ".join(
        name.removesuffix(" function")
        for name, fact in now.items()
        if name != FITNESS_FACT and name in then and then[name] != fact
    )


@dataclass(frozen=True)
class Recorded:
    """What a run file records about its ratings.

    Attributes:
        path: Run file.
        facts: Provenance of its last generation.
        is_elsewhere: Whether it was made with other versions or on another processor, where walks can differ.
        has_fitness: Whether any robot of the run has a fitness other than -inf.
    """

    path: Path
    facts: Mapping[str, str]
    is_elsewhere: bool
    has_fitness: bool


def confirm_ratings(
    population: Population[EvaluationRow],
    settings: Settings,
    recorded: Recorded,
    evaluate: Callable[..., Sequence[Evaluation]],
    *,
    rerate: bool,
) -> tuple[Population[EvaluationRow], bool]:
    """Simulate the last generation again if its fitness is a user function, and compare the ratings.

    Args:
        population: Last generation, with the ratings in the file.
        settings: Settings of the run, with the given functions.
        recorded: What the file records about its ratings.
        evaluate: Function like ``evaluate``, with the settings and the executor bound.
        rerate: Whether to take new ratings if they differ.

    Returns:
        Population to breed from, and whether it has new ratings.

    Raises:
        RunFileError: If the ratings differ, or cannot be compared, and ``rerate`` is false.
        OperatorError: If the function fails on one of these walks.
    """
    now = function_facts(settings).get(FITNESS_FACT)
    is_same_source = recorded.facts.get(FITNESS_FACT) == now and UNKNOWN_SOURCE not in (now or "")
    if not rerate and (now is None or (recorded.is_elsewhere and is_same_source)):
        return population, False
    walked = _walk_again(population, evaluate)
    rated = _keep_fragile(population, walked)
    counted = np.isfinite(population.fitness)
    is_comparable = bool(counted.any()) or is_same_source or not recorded.has_fitness
    if is_comparable and np.array_equal(rated.fitness, population.fitness):
        return population, False
    if rerate:
        return _test_again(walked, settings, evaluate), True
    raise RunFileError(_difference_message(population, rated, settings, recorded))


def rate_again(
    population: Population[EvaluationRow], settings: Settings, evaluate: Callable[..., Sequence[Evaluation]]
) -> Population[EvaluationRow]:
    """Return a population with new ratings, the best of which are tested from other starts."""
    return _test_again(_walk_again(population, evaluate), settings, evaluate)


def _walk_again(
    population: Population[EvaluationRow], evaluate: Callable[..., Sequence[Evaluation]]
) -> Population[EvaluationRow]:
    """Return a population with the ratings of new walks; equal genomes are simulated once."""
    texts = [walked.genome for walked in population.evaluations]
    rows = {text: row for row, text in enumerate(texts)}
    try:
        evaluations = evaluate(population.genomes[list(rows.values())])
    except OperatorError as error:
        individual = population.individuals[list(rows.values())[error.robot_index]]
        error.context = f"for individual {individual} of generation {population.generation}, rated again to resume"
        raise
    rated = {text: EvaluationRow.of(one, text) for text, one in zip(rows, evaluations, strict=True)}
    return replace(population, evaluations=[rated[text] for text in texts])


def _keep_fragile(
    population: Population[EvaluationRow], walked: Population[EvaluationRow]
) -> Population[EvaluationRow]:
    """Return a population with the new ratings, but keep the ratings of robots that were excluded as fragile.

    Whether a robot is fragile depends on the other robots of the generation in which it was born.
    """
    pairs = zip(population.evaluations, walked.evaluations, strict=True)
    return replace(population, evaluations=[old if old.verdict == FRAGILE else new for old, new in pairs])


def _test_again(
    population: Population[EvaluationRow], settings: Settings, evaluate: Callable[..., Sequence[Evaluation]]
) -> Population[EvaluationRow]:
    """Return a population in which the robots that are fragile by its own ratings are excluded."""
    rows = {row.genome: row for row in population.evaluations}
    tested = retest_best(rows, (), settings, evaluate, population.generation)
    return replace(population, evaluations=[tested[row.genome] for row in population.evaluations])


def _difference_message(
    population: Population[EvaluationRow], rated: Population[EvaluationRow], settings: Settings, recorded: Recorded
) -> str:
    """Describe how the ratings differ, for the fittest robot whose rating changed, and how to continue."""
    number = population.generation
    path = display_path(recorded.path)
    differing = np.flatnonzero(rated.fitness != population.fitness)
    if differing.size:
        row = differing[np.argmax(population.fitness[differing])]
        stored, now = (number_text(float(ratings.fitness[row])) for ratings in (population, rated))
        problem = (
            f"Robot {population.individuals[row]} of generation {number} has fitness {stored} in the file, and {now} "
            "with the given function."
        )
    else:
        problem = f"No walk of generation {number} counts, so the given function cannot be compared with the file."
    if recorded.is_elsewhere:
        problem += " The run was made with other versions or on another processor, so the walks may differ as well."
    functions = ", ".join(f"{slot}={code}" for slot, code in user_functions(settings).items())
    return (
        f"{path} is not resumed, because its fitness function may have changed. {problem} A run must not mix the "
        f"ratings of two functions. Either start a new run with this function:\n"
        f"    wl.evolve(wl.load({path!r}).settings.with_({functions}), 'new.walk')\n"
        f"or continue this run with the new function:\n"
        f"    wl.resume({path!r}, {functions}, rerate=True)\n"
        f"Generation {number} is then rated again, but only to choose parents: in the file, generations 0 to {number} "
        "keep their old ratings, and the champion is the best of the later generations."
    )
