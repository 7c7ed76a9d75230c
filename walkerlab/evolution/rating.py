"""Rate the new robots of a generation: each genome once, and the best genomes also from other starts."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from walkerlab.evolution.fragility import exclude_fragile, further_starts
from walkerlab.ga.genes import Floats
from walkerlab.ga.loop import find_elites
from walkerlab.ga.population import Population
from walkerlab.ga.user_functions import OperatorError
from walkerlab.genome.genome import Genome
from walkerlab.runfile.records import EvaluationRow
from walkerlab.settings.settings import Settings
from walkerlab.simulation.evaluation import Evaluation


def rate_children(
    genomes: Floats,
    texts: Sequence[str],
    known: Mapping[str, EvaluationRow],
    previous: Population[EvaluationRow] | None,
    settings: Settings,
    evaluate: Callable[..., Sequence[Evaluation]],
) -> dict[str, EvaluationRow]:
    """Evaluate the genomes without a known evaluation, and test the robots that would be elites.

    Args:
        genomes: Genomes of the children, shape (n, n_genes).
        texts: Texts of these genomes.
        known: Known evaluations, keyed by text.
        previous: Previous generation, whose elites have passed the test; None for generation 0.
        settings: Settings of the run.
        evaluate: Function like ``evaluate``, with the settings and the executor bound.

    Returns:
        Evaluations, keyed by genome text.

    Raises:
        OperatorError: If the fitness function fails.
    """
    generation = 0 if previous is None else previous.generation + 1
    new = {text: row for row, text in enumerate(texts) if text not in known}
    rows = {text: known[text] for text in texts if text in known}
    if new:
        indices = list(new.values())
        try:
            evaluations = evaluate(genomes[indices])
        except OperatorError as error:
            individual = indices[error.robot_index] + (previous.n_born if previous else 0)
            error.context = f"for individual {individual} of generation {generation}"
            raise
        rows |= {text: EvaluationRow.of(one, text) for text, one in zip(new, evaluations, strict=True)}
    best = find_elites(previous.fitness, settings.algorithm.n_elites) if previous else []
    elites = {previous.evaluations[i].genome: previous.evaluations[i] for i in best} if previous else {}
    return retest_best(elites | rows, list(elites), settings, evaluate, generation)


def retest_best(
    rows: Mapping[str, EvaluationRow],
    passed: Sequence[str],
    settings: Settings,
    evaluate: Callable[..., Sequence[Evaluation]],
    generation: int,
) -> dict[str, EvaluationRow]:
    """Test the best robots of a generation from other starts, and give those that fail the verdict ``fragile``.

    Args:
        rows: Evaluations, keyed by genome text.
        passed: Texts of the genomes that need no test.
        settings: Settings of the run.
        evaluate: Function like ``evaluate``, with the settings and the executor bound.
        generation: Number of the generation, for errors.

    Raises:
        OperatorError: If the fitness function fails.
    """

    def walk_again(texts: Sequence[str]) -> Sequence[Evaluation]:
        unreported: dict[str, Any] = {"on_done": lambda _: None, "on_rated": lambda *_: None}
        genomes = np.array([Genome.parse(text).values for text in texts])
        try:
            return evaluate(genomes, starts=further_starts(settings), **unreported)
        except OperatorError as error:
            error.context = f"for a robot of generation {generation} that walked again from another start"
            raise

    return exclude_fragile(rows, passed, settings, walk_again)
