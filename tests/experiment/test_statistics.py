"""The statistics agree with scipy, with enumeration and with theory, and are calibrated."""

from itertools import product

import numpy as np
import pytest
from scipy import stats

from walkerlab.experiment import statistics

N_REPEATS = 400


@pytest.mark.parametrize("n", [6, 10, 25])
def test_the_paired_test_equals_the_exact_test_of_scipy_without_ties(n):
    rng = np.random.default_rng(n)
    a, b = rng.normal(size=(2, n))
    assert statistics.paired_test(a, b) == pytest.approx(stats.wilcoxon(a, b, method="exact").pvalue)


def test_the_paired_test_is_exact_with_ties_and_without_counted_walks():
    differences = np.array([1.0, 1.0, -1.0, 2.0, 2.0, 0.0, np.inf, 3.0])
    a, b = np.where(np.isinf(differences), 0.0, differences), np.where(np.isinf(differences), -np.inf, 0.0)
    kept = differences[differences != 0]
    ranks = stats.rankdata(np.abs(kept))
    observed = ranks[kept > 0].sum()
    sums = [ranks[np.array(signs)].sum() for signs in product([False, True], repeat=len(kept))]
    far = max(observed, ranks.sum() - observed)
    assert statistics.paired_test(a, b) == pytest.approx(2 * np.mean(np.array(sums) >= far))
    assert statistics.paired_test(a, a) == 1.0
    assert statistics.paired_test([-np.inf] * 3, [-np.inf] * 3) == 1.0


def test_equal_conditions_are_significant_in_at_most_five_percent_of_repeats():
    rng = np.random.default_rng(1)
    p = np.array([statistics.paired_test(*rng.normal(size=(2, 10))) for _ in range(N_REPEATS)])
    assert (p < statistics.ALPHA).mean() <= 0.05 + 2 * np.sqrt(0.05 * 0.95 / N_REPEATS)


def test_a_difference_of_one_standard_deviation_is_found_as_often_as_theory_says():
    rng = np.random.default_rng(2)
    found = [
        statistics.paired_test(rng.normal(1.0, 1.0, 10), np.zeros(10)) < statistics.ALPHA for _ in range(N_REPEATS)
    ]
    of_t_test = stats.nct.sf(stats.t.ppf(0.975, 9), 9, np.sqrt(10))
    assert np.mean(found) >= of_t_test - 0.05
    assert statistics.power(10, 1.0) == pytest.approx(np.mean(found), abs=0.05)


def test_the_detectable_difference_is_found_in_four_of_five_experiments():
    rng = np.random.default_rng(3)
    limit = statistics.detectable_difference(np.array([-1.0, 1.0] * 6))
    spread = np.std([-1.0, 1.0] * 6, ddof=1)
    found = [statistics.paired_test(rng.normal(limit, spread, 12), np.zeros(12)) < 0.05 for _ in range(N_REPEATS)]
    assert np.mean(found) == pytest.approx(statistics.POWER, abs=0.06)
    assert statistics.detectable_difference(np.ones(5)) == np.inf
    assert np.isnan(statistics.detectable_difference([1.0, 2.0, 3.0, 4.0, 5.0, np.inf]))


def test_too_few_seeds_cannot_be_significant_and_enough_can():
    for n_comparisons in (1, 3, 36):
        n = statistics.seeds_required(n_comparisons)
        assert statistics.paired_test(np.arange(1, n + 1), np.zeros(n)) * n_comparisons <= statistics.ALPHA
        assert statistics.paired_test(np.arange(1, n), np.zeros(n - 1)) * n_comparisons > statistics.ALPHA


def test_the_interval_of_the_median_covers_it_about_as_often_as_it_says():
    rng = np.random.default_rng(4)
    intervals = [statistics.median_interval(rng.normal(size=10)) for _ in range(100)]
    assert np.mean([low <= 0 <= high for low, high in intervals]) >= 0.88


def test_the_interval_of_the_median_includes_runs_without_counted_walks():
    low, high = statistics.median_interval([-np.inf, -np.inf, -np.inf, 1.0, 2.0, 3.0, 4.0, 5.0])
    assert low == -np.inf
    assert 1.0 <= high <= 5.0
    assert statistics.median_interval([-np.inf] * 8) == (-np.inf, -np.inf)
    assert np.isnan(statistics.median_interval([1.0, 2.0, 3.0])).all()


def test_pairing_makes_the_interval_of_the_difference_narrower_if_seeds_matter():
    rng = np.random.default_rng(5)
    seed_effect = rng.normal(0, 1, 10)
    a, b = (seed_effect + shift + rng.normal(0, 0.2, 10) for shift in (0.5, 0.0))
    (low, high), (low_unpaired, high_unpaired) = (
        statistics.difference_interval(a, b, paired=paired) for paired in (True, False)
    )
    assert high - low < 0.7 * (high_unpaired - low_unpaired)


def test_the_effect_size_is_the_probability_to_be_better():
    assert statistics.effect_size([1, 2, 3], [0, 2, 4]) == pytest.approx((1 + 0 + 0 + 1 + 0.5 + 0 + 1 + 1 + 0) / 9)
    for a, b in (([5, 6, 7], [1, 2, 3]), ([1, 2, 3], [5, 6, 7]), ([1, 2, 3, 4], [1, 2, 3, 4])):
        low, high = statistics.effect_size_interval(a, b)
        assert 0 <= low <= statistics.effect_size(a, b) <= high <= 1
        assert high - low > 0.1  # also if all runs of one condition are better


def test_the_interval_of_the_effect_size_covers_it():
    rng = np.random.default_rng(6)
    true = stats.norm.cdf(1 / np.sqrt(2))
    intervals = [statistics.effect_size_interval(rng.normal(1, 1, 10), rng.normal(0, 1, 10)) for _ in range(N_REPEATS)]
    assert np.mean([low <= true <= high for low, high in intervals]) >= 0.95 - 2 * np.sqrt(0.05 * 0.95 / N_REPEATS)


def test_holm_multiplies_the_smallest_by_the_number_and_keeps_the_order():
    assert statistics.holm([0.04, 0.01, 0.03]).tolist() == pytest.approx([0.06, 0.03, 0.06])
    assert statistics.holm([0.9, 0.8]).tolist() == [1.0, 1.0]
