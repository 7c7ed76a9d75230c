"""Statistics of paired runs, as functions of arrays: intervals, effect size, tests, and what n seeds can show.

A run in which no walk counted has the result ``-inf``, which is lower than any number.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy import optimize, stats

from walkerlab.ga.genes import Floats

CONFIDENCE = 0.95
ALPHA = 0.05  # probability of at least one false alarm among all comparisons of an experiment
POWER = 0.8  # probability with which the smallest detectable difference must be found
N_RESAMPLES = 4999
RANK_TEST_EFFICIENCY = 3 / np.pi  # of the signed-rank test, relative to the t-test with normal differences
NOTHING: tuple[float, float] = (np.nan, np.nan)


def median_interval(values: ArrayLike, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Return the bootstrap percentile interval of the median.

    Args:
        values: Results, shape (n,); higher is better, ``-inf`` if no walk counted.
        confidence: Probability that the interval covers the median.

    Returns:
        Lower and upper end; NaN if there are too few values for an interval of a median.
    """
    given = np.asarray(values, dtype=np.float64)
    if len(given) < seeds_required(alpha=1 - confidence):
        return NOTHING
    finite, floor = _with_finite_floor(given)
    found = stats.bootstrap((finite,), np.median, vectorized=True, **_bootstrap_options(confidence))
    low, high = found.confidence_interval
    return _restore_floor(low, floor), _restore_floor(high, floor)


def difference_interval(
    a: ArrayLike, b: ArrayLike, confidence: float = CONFIDENCE, *, paired: bool = True
) -> tuple[float, float]:
    """Return the bootstrap percentile interval of the difference of two medians, that of ``a`` minus that of ``b``.

    Args:
        a: Results of one condition, shape (n,).
        b: Results of the other condition, in the same order of seeds if paired.
        confidence: Probability that the interval covers the difference.
        paired: Whether seeds are drawn for both conditions together. If false, they are drawn for each one separately,
            as for runs that do not share their seeds.

    Returns:
        Lower and upper end; NaN if there are too few values for an interval of a median, or if a result is not finite.
    """
    first, second = (np.asarray(values, dtype=np.float64) for values in (a, b))
    n = min(len(first), len(second))
    if n < seeds_required(alpha=1 - confidence) or not (np.isfinite(first).all() and np.isfinite(second).all()):
        return NOTHING

    def difference(x: Floats, y: Floats, axis: int = -1) -> Floats:
        return np.median(x, axis=axis) - np.median(y, axis=axis)

    options = _bootstrap_options(confidence)
    found = stats.bootstrap((first, second), difference, paired=paired, vectorized=True, **options)
    low, high = found.confidence_interval
    return float(low), float(high)


def effect_size(a: ArrayLike, b: ArrayLike) -> float:
    """Return A12, the probability that a run of ``a`` is better than one of ``b``; ties count half.

    Vargha & Delaney 2000, Journal of Educational and Behavioral Statistics 25. A12 is 0.5 if both are equal.
    """
    first, second = (np.asarray(values, dtype=np.float64) for values in (a, b))
    greater = first[:, np.newaxis] > second
    equal = first[:, np.newaxis] == second
    return float(np.mean(greater + 0.5 * equal))


def effect_size_interval(a: ArrayLike, b: ArrayLike, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Return the confidence interval of A12; it is valid even if all runs of one condition are better.

    Method 5 of Newcombe 2006, Statistics in Medicine 25. It treats the runs as unpaired, so that for runs with the
    same seeds the interval is too wide rather than too narrow.
    """
    theta = effect_size(a, b)
    n_a = np.size(a)
    n_b = np.size(b)
    z = float(stats.norm.ppf((1 + confidence) / 2))
    n_extra = (n_a + n_b) / 2 - 1

    def excess(at: float) -> float:
        """Return how much farther than z standard errors a value is from the estimate."""
        inner = n_extra * (1 - at) / (2 - at) + n_extra * at / (1 + at)
        return (theta - at) ** 2 - z**2 * at * (1 - at) * (1 + inner) / (n_a * n_b)

    tiny = 1e-9  # at 0 and 1 the standard error is 0, so that these ends can solve the equation, too
    low = 0.0 if theta == 0 else float(optimize.brentq(excess, tiny, min(theta, 1 - tiny)))  # type: ignore[arg-type]
    high = 1.0 if theta == 1 else float(optimize.brentq(excess, max(theta, tiny), 1 - tiny))  # type: ignore[arg-type]
    return low, high


def paired_test(a: ArrayLike, b: ArrayLike) -> float:
    """Return the two-sided p-value of Wilcoxon's signed-rank test for paired results.

    The p-value is exact for any number of pairs, even with ties, for which ``scipy.stats.wilcoxon`` uses an
    approximation. Pairs without a difference are left out. A run without a counted walk is worse than its partner by
    more than any finite difference.

    Args:
        a: Results of one condition, shape (n,).
        b: Results of the other condition, in the same order of seeds.
    """
    first, second = (np.asarray(values, dtype=np.float64) for values in (a, b))
    differs = first != second  # two runs without a counted walk are equal
    differences = first[differs] - second[differs]
    if not differences.size:
        return 1.0
    doubled_ranks = np.rint(2 * stats.rankdata(np.abs(differences))).astype(int)
    probabilities = _rank_sum_probabilities(tuple(sorted(doubled_ranks.tolist())))
    positive = int(doubled_ranks[differences > 0].sum())
    extreme = min(positive, int(doubled_ranks.sum()) - positive)
    return min(1.0, float(2 * probabilities[: extreme + 1].sum()))


@lru_cache(maxsize=256)
def _rank_sum_probabilities(doubled_ranks: tuple[int, ...]) -> Floats:
    """Return the probability of each sum of doubled ranks with a positive sign, if each sign has probability 1/2."""
    probability = np.zeros(sum(doubled_ranks) + 1)
    probability[0] = 1.0
    for rank in doubled_ranks:
        shifted = np.zeros_like(probability)
        shifted[rank:] = probability[: len(probability) - rank]
        probability = (probability + shifted) / 2
    return probability


def holm(p_values: Sequence[float]) -> Floats:
    """Return p-values corrected for the number of comparisons, in the order given.

    Holm 1979, Scandinavian Journal of Statistics 6: the smallest is multiplied by their number, the next by one less.
    """
    given = np.asarray(p_values, dtype=np.float64)
    order = np.argsort(given, kind="stable")
    factors = np.arange(len(given), 0, -1)
    corrected = np.empty_like(given)
    corrected[order] = np.minimum(1.0, np.maximum.accumulate(given[order] * factors))
    return corrected


def seeds_required(n_comparisons: int = 1, alpha: float = ALPHA) -> int:
    """Return the lowest number of seeds with which the test can find any difference at all."""
    return int(np.ceil(1 - np.log2(alpha / n_comparisons) - 1e-9))


def detectable_difference(differences: ArrayLike, n_comparisons: int = 1) -> float:
    """Return the smallest true difference that is found with a probability of 80 %.

    It is computed as for a t-test with the spread of the given differences and slightly fewer seeds, because the
    signed-rank test uses only ranks. The level is divided by the number of comparisons, as Holm's correction does for
    the first.

    Args:
        differences: Paired differences, shape (n,).
        n_comparisons: Number of comparisons in the experiment.

    Returns:
        A positive difference; ``inf`` if there are too few seeds to find any, NaN if it cannot be estimated.
    """
    given = np.asarray(differences, dtype=np.float64)
    if len(given) < seeds_required(n_comparisons):
        return np.inf
    if not np.isfinite(given).all():
        return np.nan
    return _detectable_effect(len(given), n_comparisons) * float(given.std(ddof=1))


@lru_cache(maxsize=64)
def _detectable_effect(n: int, n_comparisons: int) -> float:
    """Return the smallest effect that is found with a probability of 80 %, in the unit that ``power`` expects."""
    return float(optimize.brentq(lambda effect: power(n, effect, n_comparisons) - POWER, 1e-6, 1e3))  # type: ignore


def power(n: int, effect: float, n_comparisons: int = 1) -> float:
    """Return the probability that the paired test finds a difference.

    Args:
        n: Number of seeds.
        effect: True difference, in standard deviations of the paired differences.
        n_comparisons: Number of comparisons in the experiment.
    """
    effective = n * RANK_TEST_EFFICIENCY
    degrees = effective - 1
    critical = stats.t.ppf(1 - ALPHA / n_comparisons / 2, degrees)
    shift = effect * np.sqrt(effective)
    found = stats.nct.sf(critical, degrees, shift)  # NaN if the effect is so large that it is always found
    return 1.0 if np.isnan(found) else float(found)


def _bootstrap_options(confidence: float) -> dict[str, Any]:
    return {
        "confidence_level": confidence,
        "method": "percentile",
        "n_resamples": N_RESAMPLES,
        "rng": np.random.default_rng(0),  # the same results give the same interval
    }


def _with_finite_floor(values: Floats) -> tuple[Floats, float]:
    """Replace ``-inf`` with a number far below all others, because interpolation with it would give NaN."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return np.zeros_like(values), np.inf
    floor = float(finite.min())
    return np.where(np.isfinite(values), values, floor - 1e6 * (1 + np.ptp(finite) + abs(floor))), floor


def _restore_floor(value: float, floor: float) -> float:
    """Return ``-inf`` for a number that was interpolated from the replacement for ``-inf``."""
    return float(value) if value >= floor else -np.inf
