"""Detect generations in which selection cannot distinguish the robots."""

import numpy as np

from walkerlab.ga import selection
from walkerlab.ga.genes import Floats
from walkerlab.ga.population import NOT_COUNTED, Population
from walkerlab.genome.breeding import resolve_operators
from walkerlab.runfile.records import EvaluationRow
from walkerlab.settings.algorithm import Algorithm
from walkerlab.simulation.validity import REJECTED
from walkerlab.text.numbers import format_significant

MIN_LEAD = 0.05  # minimum lead of the best fitness over the median, as a fraction of the larger absolute value
MIN_COUNTED = 8  # minimum number of individuals that count; with fewer, the median can be near the best by chance


def explain_random_selection(population: Population[EvaluationRow], algorithm: Algorithm) -> str:
    """Return why selection cannot distinguish the robots of a generation and how to fix that, or "" if it can.

    Args:
        population: Evaluated generation.
        algorithm: Settings of the algorithm.
    """
    if all(walked.verdict == REJECTED for walked in population.evaluations):
        cause = population.evaluations[0].reason
        advice = "Check that the function ends with a return statement."
        return f"{cause} for every robot, so parents are chosen at random. {advice}"
    return explain_lost_pressure(population.fitness, algorithm)


def explain_lost_pressure(fitness: Floats, algorithm: Algorithm) -> str:
    """Return why ``gradient`` hardly prefers the best individual and how to fix that, or "" if there is no problem.

    The measure is ``selection_pressure``. The pressure counts as lost if it is below ``MIN_PRESSURE`` although the best
    fitness exceeds the median by at least ``MIN_LEAD``. With a smaller lead the population has converged, and there is
    nothing to fix.

    Args:
        fitness: Fitness of each individual of a generation, shape (n,).
        algorithm: Settings of the algorithm.

    Returns:
        Explanation, or "".
    """
    counted = fitness[fitness != NOT_COUNTED]
    if resolve_operators(algorithm).select[0] is not selection.gradient or len(counted) < MIN_COUNTED:
        return ""
    worst, median, best = np.quantile(counted, [0, 0.5, 1])
    pressure = selection.selection_pressure(selection.gradient_probabilities(counted))
    if pressure >= selection.MIN_PRESSURE or best - median < MIN_LEAD * max(abs(best), abs(median)):
        return ""
    return (
        f"the lowest fitness, {format_significant(worst)}, is so far below the others that gradient selection hardly "
        f"prefers the best robot: its fitness is {format_significant(best)} and the median "
        f"{format_significant(median)}, yet "
        f"it is selected only {pressure - 1:.2%} more often than the median robot. Select by rank instead: "
        'settings.with_(selection="rank"), or set a lower bound on the fitness.'
    )
