"""Detect generations in which one very low fitness removes the pressure from gradient selection."""

import numpy as np

from walkerlab.breeding import resolve_operators
from walkerlab.ga import selection
from walkerlab.ga.genes import Floats
from walkerlab.ga.population import NOT_COUNTED
from walkerlab.settings.algorithm import Algorithm
from walkerlab.text.numbers import format_significant

MIN_LEAD = 0.05  # of the best fitness over the median, as a share of the larger of their absolute values
MIN_COUNTED = 8  # individuals; with fewer, the median can be close to the best by coincidence


def explain_lost_pressure(fitness: Floats, algorithm: Algorithm) -> str:
    """Explain why ``gradient`` hardly prefers the best of a generation, and how to fix it; "" if it does prefer it.

    The measure is ``selection_pressure``: the pressure is lost below ``MIN_PRESSURE`` if the best fitness exceeds the
    median by ``MIN_LEAD`` or more. With a smaller lead the population has converged, and there is nothing to fix.

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
        f"it is selected only {pressure - 1:.2%} more often than the median robot. Select by order instead, with "
        'settings.with_(selection="rank"), or limit the fitness from below.'
    )
