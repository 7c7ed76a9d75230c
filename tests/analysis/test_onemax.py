"""OneMax converges as fast as theory predicts from the selection intensity alone."""

import math
from functools import partial

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.analysis.onemax import onemax_theory
from walkerlab.ga.selection import tournament

SELECTIONS = {"two": partial(tournament, size=2), "five": partial(tournament, size=5), "top": "top_half"}
INTENSITIES = {"two": 1 / math.sqrt(math.pi), "five": 1.16296, "top": math.sqrt(2 / math.pi)}


@pytest.fixture(scope="module")
def table():
    return wl.analysis.evolve_onemax(SELECTIONS, seeds=range(2))


def test_the_generations_are_within_10_percent_of_theory(table):
    times = wl.analysis.onemax_times(table).set_index("selection")
    for name, intensity in INTENSITIES.items():
        predicted = math.pi / 2 * math.sqrt(100) / intensity
        assert times.theory[name] == pytest.approx(predicted, rel=1e-4)
        assert times.generations[name] == pytest.approx(predicted, rel=0.1)


def test_every_run_ends_with_ones_only_and_follows_the_curve(table):
    last = table.groupby(["selection", "seed"]).mean_fitness.last()
    assert (last == 100).all()
    assert abs(table.mean_fitness - table.theory).max() < 4
    assert (table.best_fitness >= table.mean_fitness).all()


def test_with_one_mating_the_bits_stay_linked_and_evolution_is_slower(table):
    linked = wl.analysis.evolve_onemax({"top": "top_half"}, n_matings=1, seeds=[0])
    mixed = table[(table.selection == "top") & (table.seed == 0)]
    assert len(linked) > 1.1 * len(mixed)
    assert abs(linked.mean_fitness - linked.theory_linked).max() < abs(linked.mean_fitness - linked.theory).max() / 3


def test_the_theory_solves_its_equation():
    generation = np.arange(0.0, 20, 0.01)
    share = onemax_theory(0.5, 100, generation) / 100
    slope = np.gradient(share, generation)
    assert np.allclose(slope, 0.5 * np.sqrt(share * (1 - share) / 100), atol=1e-5)
    assert onemax_theory(0.5, 100, 10 * math.pi) == pytest.approx(100)


def test_an_operator_without_theory_is_run_too():
    table = wl.analysis.evolve_onemax("gradient", n_bits=8, population_size=30, seeds=[0])
    assert table.theory.isna().all()
    assert table.theory_linked.isna().all()
    assert np.isnan(wl.analysis.onemax_times(table).ratio[0])
