"""Exclude robots that walk well only from their exact start, so that no robot becomes the champion by luck.

Robots that would be among the elites of the next generation walk again from a few slightly different starts. The others
are not tested: they cannot become the champion, and testing all robots would take five times as many walks.
"""

from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np

from walkerlab.ga.population import NOT_COUNTED
from walkerlab.runfile.records import EvaluationRow
from walkerlab.settings.choices import Guard
from walkerlab.settings.settings import Settings
from walkerlab.simulation.evaluation import Evaluation
from walkerlab.simulation.fitness import name_and_unit
from walkerlab.simulation.validity import forgiven_guards
from walkerlab.text.numbers import with_unit

N_TEST_STARTS = 4  # number of other starts from which a robot is tested
MIN_KEPT_SHARE = 0.9  # minimum fitness from the poorest of these starts, as a share of the original fitness
SUFFICIENT_QUANTILE = 0.9  # quantile of the fitness of the generation that is also sufficient
FRAGILE = Guard.fragile.name


def further_starts(settings: Settings) -> range:
    """Return the numbers of the test starts, which follow those of every walk; empty if the guard is off."""
    first = settings.simulation.n_starts
    return range(first, first if Guard.fragile in forgiven_guards(settings) else first + N_TEST_STARTS)


def exclude_fragile(
    rows: Mapping[str, EvaluationRow],
    passed: Collection[str],
    settings: Settings,
    walk_again: Callable[[Sequence[str]], Sequence[Evaluation]],
) -> dict[str, EvaluationRow]:
    """Test the best robots of a generation until all that would be elites have passed.

    The result does not depend on the order of the tests: every robot that is at least as good as the poorest of the
    final elites is tested. Robots that are no better than the median of their generation are not tested, so that at
    least half of the generation remains.

    Args:
        rows: Evaluations of the generation, keyed by genome text.
        passed: Texts of genomes that need no test.
        settings: Settings of the run.
        walk_again: Function that simulates genomes, given as texts, from the test starts, and returns the evaluation of
            the poorest walk of each.

    Returns:
        The evaluations, with the verdict ``fragile`` for those that did not pass.
    """
    counted = [row.fitness for row in rows.values() if row.fitness != NOT_COUNTED]
    if not (counted and further_starts(settings)):
        return dict(rows)
    median, sufficient = map(float, np.quantile(counted, [0.5, SUFFICIENT_QUANTILE]))
    unit = name_and_unit(settings.algorithm.fitness)[1]
    n_best = max(1, settings.algorithm.n_elites)
    rated = dict(rows)
    tested = set(passed)
    while True:
        best = sorted(rated, key=lambda text: -rated[text].fitness)[:n_best]
        untested = [text for text in best if text not in tested and rated[text].fitness > median]
        if not untested:
            return rated
        for text, again in zip(untested, walk_again(untested), strict=True):
            if reason := _find_fault(rated[text].fitness, again, sufficient, unit):
                rated[text] = rated[text]._replace(fitness=NOT_COUNTED, verdict=FRAGILE, reason=reason)
        tested.update(untested)


def _find_fault(fitness: float, again: Evaluation, sufficient: float, unit: str) -> str:
    """Return why the fitness of a robot depends too much on its start, or ""."""
    if again.verdict != "ok":
        return f"from a slightly different start, its walk did not count: {again.reason}"
    required = min(sufficient, fitness - (1 - MIN_KEPT_SHARE) * abs(fitness))
    if again.fitness >= required:
        return ""
    found, limit = with_unit(again.fitness, unit), with_unit(required, unit)
    return f"from a slightly different start, its fitness was {found}; {limit} or more is required"
