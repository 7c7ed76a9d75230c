from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from deap import tools
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chi2_contingency

from walkerlab.ga import selection
from walkerlab.ga.selection import gradient, gradient_probabilities, rank, rank_probabilities, top_half, tournament

from .laws import MIN_P_VALUE, selects_with_probabilities
from .tables import rng

FITNESS = np.array([-2.0, 3.5, 3.5, -7.0, 0.0, 11.0])
fitness_lists = st.lists(st.integers(-1000, 1000), min_size=1, max_size=12).map(lambda f: np.array(f, float))


def test_gradient_follows_its_formula():
    weights = FITNESS + 7 + 0.05 * 18
    assert np.allclose(gradient_probabilities(FITNESS), weights / weights.sum())
    selects_with_probabilities(gradient, FITNESS, weights / weights.sum())


def test_equal_fitness_gives_equal_probabilities():
    equal = np.full(4, -3.0)
    assert np.array_equal(gradient_probabilities(equal), np.full(4, 0.25))
    selects_with_probabilities(gradient, equal, np.full(4, 0.25))
    selects_with_probabilities(rank, equal, np.full(4, 0.25))


def test_an_outlier_at_the_lower_end_removes_the_pressure_of_gradient_but_not_of_rank():
    outlier = np.array([1.0, 2.0, 3.0, -1e6])
    assert np.allclose(gradient_probabilities(outlier), [0.328, 0.328, 0.328, 0.016], atol=1e-3)
    assert selection.selection_pressure(gradient_probabilities(outlier)) < selection.MIN_PRESSURE
    assert selection.selection_pressure(rank_probabilities(outlier)) > 1.5
    assert selection.selection_pressure(gradient_probabilities(np.arange(20.0))) > 1.5


@given(fitness_lists, st.randoms(use_true_random=False))
def test_gradient_does_not_depend_on_the_order_of_individuals(fitness, random):
    order = np.array(random.sample(range(len(fitness)), len(fitness)))
    assert np.allclose(gradient_probabilities(fitness[order]), gradient_probabilities(fitness)[order])


@given(fitness_lists, st.integers(-(10**6), 10**6), st.floats(1e-3, 1e6))
def test_gradient_does_not_depend_on_the_zero_or_unit_of_fitness(fitness, shift, unit):
    expected = gradient_probabilities(fitness)
    assert np.allclose(gradient_probabilities((fitness + shift) * unit), expected, atol=1e-6)


@given(fitness_lists)
def test_probabilities_sum_to_one_and_increase_with_fitness(fitness):
    for probabilities in (gradient_probabilities(fitness), rank_probabilities(fitness)):
        assert np.isclose(probabilities.sum(), 1)
        assert np.all(probabilities > 0)
        assert np.all(np.diff(probabilities[np.argsort(fitness, kind="stable")]) >= -1e-15)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("select", [gradient, top_half, tournament, rank])
def test_an_individual_with_infinite_or_nan_fitness_is_named(select, bad):
    with pytest.raises(ValueError, match=f"individual 2 has fitness {bad}"):
        select(np.array([1.0, 2.0, bad, 3.0]), 4, rng=rng())


@settings(max_examples=50)
@given(fitness_lists, st.integers(1, 6))
def test_top_half_selects_each_of_the_better_half_equally_often(fitness, times):
    half = -(-len(fitness) // 2)
    best = sorted(range(len(fitness)), key=lambda i: (-fitness[i], i))[:half]
    used = np.bincount(top_half(fitness, times * half, rng=rng()), minlength=len(fitness))
    assert np.array_equal(np.flatnonzero(used), sorted(best))
    assert set(used[best]) == {times}


def test_top_half_shuffles():
    fitness = np.arange(8.0)
    firsts = [top_half(fitness, 8, rng=rng(i))[0] for i in range(100)]
    assert set(firsts) == {4, 5, 6, 7}


@pytest.mark.parametrize("size", [1, 2, 3, 7])
def test_tournament_selects_the_best_of_those_drawn(size):
    fitness = np.array([5.0, -1.0, 3.0, 0.0])
    place = np.array([4, 1, 3, 2])  # 4: the best
    selects_with_probabilities(partial(tournament, size=size), fitness, (place / 4) ** size - ((place - 1) / 4) ** size)


def test_tournament_agrees_with_deap(monkeypatch):
    import random

    monkeypatch.setattr("deap.tools.selection.random", random.Random(5))
    individuals = [SimpleNamespace(fitness=f, index=i) for i, f in enumerate(FITNESS)]
    theirs = [one.index for one in tools.selTournament(individuals, 20_000, tournsize=3)]
    ours = tournament(FITNESS, 20_000, size=3, rng=rng())
    # in DEAP, too, the first drawn of two equals wins
    assert chi2_contingency([np.bincount(theirs), np.bincount(ours)]).pvalue > MIN_P_VALUE


def test_rank_depends_on_the_order_only():
    fitness = np.array([1000.0, -3.0, -2.0, 0.0, 0.0])
    probabilities = (1 + 0.8 * np.array([2, -2, -1, 0.5, 0.5]) / 2) / 5
    assert np.allclose(rank_probabilities(fitness, pressure=1.8), probabilities)
    selects_with_probabilities(rank, fitness, probabilities)


def test_uniform_has_no_selection_pressure():
    selects_with_probabilities(selection.uniform, FITNESS, np.full(6, 1 / 6))


def test_parameters_out_of_range_are_rejected():
    with pytest.raises(ValueError, match="size is 0"):
        tournament(FITNESS, 2, size=0, rng=rng())
    with pytest.raises(ValueError, match="pressure is 3"):
        rank(FITNESS, 2, pressure=3, rng=rng())
