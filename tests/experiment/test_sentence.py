"""The sentence about an experiment names the better condition only if that is shown, and says what was not."""

import numpy as np
import pytest

from walkerlab.experiment import comparison, sentence, statistics
from walkerlab.experiment.conditions import Condition
from walkerlab.settings.settings import Settings

CONDITIONS = [Condition(name, Settings()) for name in ("left", "right", "third")]


def describe(*finals):
    """Return the comparisons and the sentence of results, one array for each condition."""
    conditions = CONDITIONS[: len(finals)]
    table = comparison.tabulate_comparisons(conditions, finals, comparison.pairs_to_compare(conditions))
    medians = {"condition": [one.name for one in conditions], "best": [np.median(one) for one in finals]}
    return table, sentence.describe(table, medians_table(medians), len(finals[0]), "distance", "m")


def medians_table(medians):
    import pandas as pd

    return pd.DataFrame(medians)


@pytest.mark.parametrize("difference", [0.0, 1.0])
def test_the_sentence_of_two_conditions_agrees_with_the_test(difference, monkeypatch):
    for slow in ("difference_interval", "effect_size_interval"):  # the sentence has no interval
        monkeypatch.setattr(statistics, slow, lambda *_: (np.nan, np.nan))
    rng = np.random.default_rng(int(difference) + 7)
    n_clear = 0
    for _ in range(400):
        left = rng.normal(difference, 1.0, 10)
        table, text = describe(left, rng.normal(0.0, 0.01, 10))
        row = table.iloc[0]
        is_clear = row.p_corrected < statistics.ALPHA
        n_clear += is_clear
        better = "left" if row.a_better >= row.b_better else "right"
        assert (f"{better} is better than" in text) == (is_clear and better in text.split(" is better")[0])
        assert ("is better than" in text) == is_clear
        assert ("This does not mean that they are equal" in text) == (not is_clear)
        assert ("would be missed in more than one of five" in text) == (not is_clear)
    if difference:
        assert n_clear / 400 >= statistics.power(10, 1.0) - 0.05
    else:
        assert n_clear / 400 <= 0.05 + 2 * np.sqrt(0.05 * 0.95 / 400)


def test_with_five_seeds_the_sentence_says_that_nothing_could_have_been_found():
    _, text = describe(np.arange(5) + 100.0, np.arange(5) + 0.0)
    assert text == (
        "The medians are 102 m (left) and 2.00 m (right), but this may be due to chance: with 5 seeds, no difference "
        "of any size could have been found; at least 6 seeds are required."
    )
    assert "With 6 seeds and 3 comparisons, no difference" in describe(*np.random.default_rng(1).normal(size=(3, 6)))[1]


def test_the_sentence_of_several_conditions_lists_the_clear_differences():
    rng = np.random.default_rng(3)
    base = rng.normal(size=10)
    _, text = describe(base + 5 + rng.normal(0, 0.1, 10), base, base + rng.normal(0, 0.5, 10))
    assert "2 of 3 differences are clear with 10 seeds" in text
    assert "left is better than right" in text
    assert "left is better than third" in text
    assert "The other one may be due to chance" in text
    _, text = describe(base + 5, base, base - 5 + rng.normal(0, 0.1, 10))
    assert text.startswith("All 3 differences are clear")


def test_equal_results_and_runs_without_counted_walks_have_sentences_of_their_own():
    assert "have the same result with each of 8 seeds" in describe(np.ones(8), np.ones(8))[1]
    void = np.array([-np.inf, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
    assert "is unknown, because there are runs in which no walk counted" in describe(void, void[::-1].copy())[1]


def test_only_conditions_of_the_same_world_are_compared_if_there_are_several_of_each():
    worlds = [Settings(), Settings().with_(structure="stairs")]
    each = [Condition(f"{name} {number}", world) for number, world in enumerate(worlds) for name in ("ga", "random")]
    assert comparison.compared_groups(each) == [[0, 1], [2, 3]]
    assert comparison.pairs_to_compare(each) == [(0, 1), (2, 3)]
    assert comparison.compared_groups(each[:3]) == [[0, 1, 2]]
    assert comparison.pairs_to_compare(each[:3]) == [(0, 1), (0, 2), (1, 2)]
    assert comparison.pairs_to_compare(each[:3], against="random 0") == [(0, 1), (2, 1)]


def test_a_run_that_does_not_reach_the_threshold_counts_as_longer_than_all_others():
    assert comparison._censored_median([10, np.inf, np.inf]) == np.inf
    assert comparison._censored_median([10, 20, np.inf]) == 20
    assert comparison._censored_median([10, np.inf]) == np.inf
    assert comparison._censored_median([10, 20]) == 15
