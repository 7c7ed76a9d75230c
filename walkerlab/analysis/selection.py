"""Measure selection: each individual's probability of becoming a parent, and the pressure of an operator."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, cast

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from walkerlab.analysis.selection_theory import (
    Curve,
    exact_probabilities,
    selection_curve,
    selection_theory,
    takeover_theory,
)
from walkerlab.ga.genes import Floats, Indices
from walkerlab.ga.operators import select_in_turn
from walkerlab.ga.population import NOT_COUNTED, fitness_for_comparison
from walkerlab.ga.slots import Select, unbound_keywords
from walkerlab.genome.breeding import check_user_operators, resolve_operators, slot_entries
from walkerlab.genome.features import build_genes
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.arguments import require_count
from walkerlab.settings.choices import Choice
from walkerlab.settings.robot import Robot
from walkerlab.settings.values import function_name
from walkerlab.system.randomness import random_stream

N_DRAWS = 20_000  # number of parents drawn to estimate the probabilities of an operator without a formula
MIN_CALLS = 30  # minimum number of calls for an estimate; their variation gives the standard error
MAX_CALLS = 300  # maximum number of calls for an estimate; limits its duration
MAX_TAKEOVER_GENERATIONS = 1000  # generations after which a trial ends even if the takeover is not complete

MEASURES = {
    "intensity": "mean fitness of the parents minus that of the population, in standard deviations",
    "loss_of_diversity": "share of the places among the parents that poorer individuals lose to fitter ones",
    "unselected": "share of the population that is never selected",
    "takeover": "generations until all individuals are copies of the best, without crossover and mutation",
    "best_lost": "share of the trials in which the best individual died out",
}
"""Each measure of a selection operator, and its meaning."""

Operators = tuple[Select, ...]


def selection_probabilities(
    fitness: ArrayLike, select: Any = "gradient", *, n_parents: int | None = None, seed: int = 0
) -> pd.DataFrame:
    """Return each individual's probability of being selected as the next parent.

    The probability is exact for the operators of walkerlab, with any parameters. For other functions, and for several
    operators applied in turn, it is estimated from 30 to 300 calls. They select at least 20,000 parents in total if
    ``n_parents`` is 67 or more.

    Args:
        fitness: Fitness of each individual, shape (n,); higher is better. Individuals with -inf do not count, and have
            the probability 0.
        select: Selection operator, in any form that ``Algorithm.selection`` accepts: a name, a function, a partial, or
            a list of these that are applied in turn.
        n_parents: Number of parents selected together; as many as there are individuals if None.
        seed: Seed of the random numbers of an estimate.

    Returns:
        Table with a row for each individual, in the order given: ``individual`` (index), ``fitness``, ``rank`` (1 is
        the fittest), ``probability`` and ``standard_error`` (0 if exact). ``.attrs`` has the name of the operator.

    Raises:
        ValueError: If ``fitness`` is empty, is not one-dimensional, or contains NaN or +inf.
        OperatorError: If a user function fails.
    """
    values = _as_fitness(fitness)
    name, operators = next(iter(read_selections(select if not isinstance(select, list) else [select]).items()))
    n = len(values)
    n_parents = n if n_parents is None else require_count(n_parents, "n_parents", "the number of parents to select")
    counted = values != NOT_COUNTED if (values != NOT_COUNTED).any() else np.ones(n, dtype=np.bool_)
    exact = None
    if len(operators) == 1:
        exact = exact_probabilities(operators[0], fitness_for_comparison(values)[counted], n_parents)
    probability = np.zeros(n)
    error = np.zeros(n)
    if exact is not None:
        probability[counted] = exact
    else:
        n_calls = min(max(MIN_CALLS, math.ceil(N_DRAWS / n_parents)), MAX_CALLS)
        calls = _select_repeatedly(operators, values, n_parents, n_calls, seed)
        copies = np.array([np.bincount(selected, minlength=n) for selected in calls])
        probability = copies.mean(axis=0) / n_parents
        error = copies.std(axis=0, ddof=1) / n_parents / math.sqrt(n_calls)
    rank = np.empty(n, dtype=np.intp)
    rank[np.argsort(-values, kind="stable")] = np.arange(1, n + 1)
    columns = {"individual": np.arange(n), "fitness": values, "rank": rank, "probability": probability}
    table = pd.DataFrame(columns | {"standard_error": error})
    table.attrs = {"selection": name, "exact": exact is not None}
    return table


def measure_selection(
    selections: Any, *, population_size: int = 400, n_populations: int = 100, seed: int = 0
) -> pd.DataFrame:
    """Measure selection operators on populations with normally distributed fitness, and compare them with theory.

    Args:
        selections: Selection operator, in any form that ``Algorithm.selection`` accepts; to compare several, a list or
            a dict from names to operators. A list inside it contains operators applied in turn.
        population_size: Number of individuals, and of selected parents.
        n_populations: Number of random populations, and of trials of the takeover.
        seed: Seed of the random numbers.

    Returns:
        Table with a row for each operator and measure: ``selection``, ``measure``, ``measured`` (NaN if no trial
        ended), ``standard_error``, ``theory`` (for a large population; NaN if unknown) and ``meaning``.

    Raises:
        OperatorError: If a user function fails.
        ValueError: If a number is too small.
    """
    n = require_count(population_size, "population_size", "the number of individuals", low=2)
    n_populations = require_count(n_populations, "n_populations", "the number of random populations", low=2)
    rows: list[dict[str, object]] = []
    for name, operators in read_selections(selections).items():
        curve = curve_of(operators)
        times, lost = _takeover_times(operators, n, n_populations, seed)
        measured = _measure_populations(operators, n, n_populations, seed)
        measured["takeover"] = _mean_and_error(times)
        measured["best_lost"] = (lost, math.sqrt(lost * (1 - lost) / n_populations))
        theory = {} if curve is None else selection_theory(curve)._asdict()
        if curve is not None:
            expected = takeover_theory(curve, n, MAX_TAKEOVER_GENERATIONS)
            theory["takeover"] = len(expected) - 1 if expected[-1] >= 1 - 1 / n else math.nan
        for measure, meaning in MEASURES.items():
            value, error = measured[measure]
            row: dict[str, object] = {"selection": name, "measure": measure, "measured": value}
            row |= {"standard_error": error, "theory": theory.get(measure, math.nan), "meaning": meaning}
            rows.append(row)
    table = pd.DataFrame(rows)
    table.attrs = {"population_size": n, "n_populations": n_populations}
    return table


def follow_takeover(selections: Any, *, population_size: int = 100, n_trials: int = 20, seed: int = 0) -> pd.DataFrame:
    """Measure how copies of the best individual spread by selection alone, and compare this with theory.

    Args:
        selections: One or several selection operators; see ``measure_selection``.
        population_size: Number of individuals; a single one is the best in generation 0.
        n_trials: Number of trials; those in which the best individual dies out are left out.
        seed: Seed of the random numbers.

    Returns:
        Table with a row for each operator and generation: ``selection``, ``generation``, ``share`` of copies of the
        best (mean over the trials; NaN if it died out in all), ``lowest`` and ``highest`` over the trials, and
        ``theory`` (NaN if unknown).

    Raises:
        OperatorError: If a user function fails.
        ValueError: If a number is too small.
    """
    n = require_count(population_size, "population_size", "the number of individuals", low=2)
    n_trials = require_count(n_trials, "n_trials", "the number of trials")
    tables: list[pd.DataFrame] = []
    for name, operators in read_selections(selections).items():
        histories = [_takeover_shares(operators, n, trial, seed) for trial in range(n_trials)]
        survived = [shares for shares in histories if shares[-1] > 0]
        curve = curve_of(operators)
        theory = np.empty(0) if curve is None else takeover_theory(curve, n, MAX_TAKEOVER_GENERATIONS)
        length = max(map(len, [*survived, theory, [0.0]]))
        padded = np.full((max(1, len(survived)), length), 1.0 if survived else np.nan)
        for row, shares in zip(padded, survived, strict=False):
            row[: len(shares)] = shares
        expected = np.pad(theory, (0, length - len(theory)), constant_values=theory[-1] if len(theory) else np.nan)
        columns = {"share": padded.mean(0), "lowest": padded.min(0), "highest": padded.max(0), "theory": expected}
        tables.append(pd.DataFrame({"selection": name, "generation": np.arange(length)} | columns))
    table = pd.concat(tables, ignore_index=True)
    table.attrs = {"population_size": n, "n_trials": n_trials}
    return table


def read_selections(selections: Any) -> dict[str, Operators]:
    """Return the functions of one or several selection operators, keyed by name; user functions are checked.

    Raises:
        OperatorError: If a user function fails.
        ValueError: If there is no operator, or a name is unknown.
    """
    if isinstance(selections, Mapping):
        named = dict(cast(Mapping[str, Any], selections))
    else:
        entries = cast(Sequence[Any], selections) if isinstance(selections, list) else [selections]
        named = {_selection_name(entry): entry for entry in entries}
    if not named:
        raise ValueError('there is no selection operator; pass at least one, such as "top_half"')
    operators: dict[str, Operators] = {}
    for name, entry in named.items():
        algorithm = Algorithm(selection=entry)
        check_user_operators(algorithm, build_genes(Robot()))
        operators[str(name)] = resolve_operators(algorithm).select
    return operators


def _selection_name(entry: Any) -> str:
    """Return the name of an operator: ``tournament(size=2)``; joined by ``+`` if several are applied in turn."""
    chosen = slot_entries(Algorithm(selection=entry).selection)
    return "+".join(each.name if isinstance(each, Choice) else function_name(each) for each in chosen)


def curve_of(operators: Operators) -> Curve | None:
    """Return the curve of an operator; None if its theory is unknown, as for several operators in turn."""
    return selection_curve(operators[0]) if len(operators) == 1 else None


def _as_fitness(given: ArrayLike) -> Floats:
    values = np.asarray(given, dtype=np.float64)
    if values.ndim != 1 or not len(values):
        raise ValueError(f"fitness must be a row of at least one number; got an array of shape {values.shape}")
    return values


def _select_repeatedly(
    operators: Operators, fitness: Floats, n_parents: int, n_calls: int, seed: int, genomes: Floats | None = None
) -> list[Indices]:
    """Select parents several times, each time with different random numbers."""
    rng = random_stream(seed, "analysis", 0)
    if genomes is None:
        genomes = _random_genomes(operators, len(fitness), rng)
    return [
        select_in_turn(operators, fitness, n_parents, seed=int(each), generation=1, generations=2, genomes=genomes)
        for each in rng.integers(2**62, size=n_calls)
    ]


def _random_genomes(operators: Operators, n: int, rng: np.random.Generator) -> Floats | None:
    """Return random genomes, shape (n, n_genes), if an operator also takes the genomes; None otherwise."""
    if not any("genomes" in unbound_keywords(operator) for operator in operators):
        return None
    genes = build_genes(Robot())
    return genes.low + (genes.high - genes.low) * rng.random((n, len(genes)))


def _measure_populations(operators: Operators, n: int, n_populations: int, seed: int) -> dict[str, tuple[float, float]]:
    """Return intensity, loss of diversity and unselected share, each with its standard error."""
    rng = random_stream(seed, "analysis", 1)
    copies = np.empty((n_populations, n))
    intensity = np.empty(n_populations)
    for i in range(n_populations):
        fitness = np.sort(rng.normal(size=n))
        (selected,) = _select_repeatedly(operators, fitness, n, 1, int(rng.integers(2**62)))
        copies[i] = np.bincount(selected, minlength=n)
        intensity[i] = (fitness[selected].mean() - fitness.mean()) / fitness.std()
    others = (copies.sum(axis=0) - copies) / (n_populations - 1)  # jackknife: the mean over all populations but one
    losses = np.array([_loss_of_diversity(mean_copies) for mean_copies in others])
    loss_error = math.sqrt((n_populations - 1) * losses.var())
    return {
        "intensity": _mean_and_error(intensity),
        "loss_of_diversity": (_loss_of_diversity(copies.mean(axis=0)), loss_error),
        "unselected": _mean_and_error((copies == 0).mean(axis=1)),
    }


def _loss_of_diversity(copies: Floats) -> float:
    """Return the loss of diversity from the mean number of copies of each individual, poorest first, shape (n,)."""
    return max(0.0, float(np.cumsum(1 - copies).max())) / len(copies)


def _takeover_times(operators: Operators, n: int, n_trials: int, seed: int) -> tuple[Floats, float]:
    """Return the takeover time of each trial in which the best individual takes over.

    Returns:
        Takeover times [generations], and the share of the trials in which the best individual died out.
    """
    histories = [_takeover_shares(operators, n, trial, seed) for trial in range(n_trials)]
    times = np.array([len(shares) - 1 for shares in histories if shares[-1] == 1.0], dtype=np.float64)
    return times, float(np.mean([shares[-1] == 0.0 for shares in histories]))


def _takeover_shares(operators: Operators, n: int, trial: int, seed: int) -> Floats:
    """Return the share of copies of the best individual in each generation, until it is 0 or 1."""
    rng = random_stream(seed, "analysis", 2, trial)
    fitness = rng.normal(size=n)
    genomes = _random_genomes(operators, n, rng)
    best = fitness.max()
    shares = [1 / n]
    while 0 < shares[-1] < 1 and len(shares) <= MAX_TAKEOVER_GENERATIONS:
        (selected,) = _select_repeatedly(operators, fitness, n, 1, int(rng.integers(2**62)), genomes)
        fitness = fitness[selected]
        genomes = None if genomes is None else genomes[selected]
        shares.append(float((fitness == best).mean()))
    return np.array(shares)


def _mean_and_error(values: Floats) -> tuple[float, float]:
    """Return the mean and its standard error; NaN if there are too few values."""
    if not len(values):
        return math.nan, math.nan
    error = float(values.std(ddof=1)) / math.sqrt(len(values)) if len(values) > 1 else math.nan
    return float(values.mean()), error
