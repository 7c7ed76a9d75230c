"""Operators with the keywords ``generation``, ``generations`` and ``genomes`` receive them."""

from functools import partial

import numpy as np
import pytest

import walkerlab as wl
from tests.ga.tables import reals
from walkerlab.ga import check_cross, check_mutate, check_select, crossover, mutation, selection
from walkerlab.ga.loop import first_population, next_population
from walkerlab.ga.operators import Operators

GENES = reals(4)


class Score(float):
    @property
    def fitness(self):
        return float(self)


def score(genomes):
    return [Score(total) for total in genomes.sum(axis=1)]


def breed(select=selection.rank, cross=crossover.uniform, mutate=mutation.gaussian, *, first_again=()):
    start = first_population(
        np.random.default_rng(3).random((6, 4)), lambda genomes: [*map(Score, genomes.sum(axis=1))]
    )
    operators = Operators((*first_again, select), (cross,), (mutate,))
    population = start
    for _ in range(2):
        population = next_population(
            population, operators, GENES, score,
            repair=lambda genomes: genomes, n_elites=1, seed=1, generations=9,
        )  # fmt: skip
    return start, population


def test_each_slot_receives_the_number_of_the_generation_that_is_created_and_the_total():
    seen = []

    def select(fitness, n_parents, *, rng, generation, generations):
        seen.append(("select", generation, generations))
        return np.arange(n_parents) % len(fitness)

    def cross(parents, fitness, n_children, *, rng, generation, generations=0):
        seen.append(("cross", generation, generations))
        return crossover.uniform(parents, fitness, n_children, rng=rng)

    def mutate(genomes, genes, rng, generations, generation):
        seen.append(("mutate", generation, generations))
        return genomes

    breed(select, cross, mutate)
    assert seen == [(slot, number, 9) for number in (1, 2) for slot in ("select", "cross", "mutate")]


def test_a_value_bound_by_partial_is_kept():
    seen = []

    def mutate(genomes, genes, *, rng, generation, generations=None):
        seen.append((generation, generations))
        return genomes

    breed(mutate=partial(mutate, generation=40))
    assert seen == [(40, 9), (40, 9)]


@pytest.mark.parametrize("first_again", [(), (selection.top_half,)], ids=["alone", "second"])
def test_a_selection_receives_the_genomes_of_the_individuals_in_fitness(first_again):
    seen = []

    def select(fitness, n_parents, *, rng, genomes):
        seen.append((fitness, genomes))
        return np.arange(n_parents) % len(fitness)

    breed(select, first_again=first_again)
    for fitness, genomes in seen:
        np.testing.assert_allclose(genomes.sum(axis=1), fitness)
        assert not genomes.flags.writeable


def test_the_trial_calls_an_operator_that_depends_on_time_early_and_late():
    def divides(genomes, genes, *, rng, generation, generations):
        return genomes / (generations - 1 - generation)

    with pytest.raises(wl.OperatorError, match="mutation 'divides' raised RuntimeWarning: divide by zero"):
        check_mutate(divides, GENES)

    def spread(fitness, n_parents, *, rng, genomes, generation):
        return rng.choice(len(genomes), size=n_parents)

    check_select(spread, GENES)
    check_cross(lambda parents, fitness, n, *, rng, generation: crossover.uniform(parents, fitness, n, rng=rng), GENES)


def test_an_operator_that_changes_its_genomes_is_rejected():
    def select(fitness, n_parents, *, rng, genomes):
        genomes[:] = 0
        return np.arange(n_parents) % len(fitness)

    with pytest.raises(wl.OperatorError, match="selection 'select' must not modify its arguments"):
        check_select(select, GENES)


def test_the_steps_of_2017_pass_the_time_of_the_settings_and_the_genomes():
    seen = []

    def select(fitness, n_parents, *, rng, genomes, generation, generations):
        seen.append((len(genomes), generation, generations))
        return np.arange(n_parents) % len(fitness)

    algorithm = wl.Algorithm(selection=select, generations=7)
    genomes = wl.generate_robot_population(wl.Robot(), 4, seed=0)
    wl.select_from_population([1, 2, 3, 4], 4, algorithm, generation=3, genomes=genomes)
    assert seen == [(4, 3, 7)]
    with pytest.raises(ValueError, match="one genome for each fitness, 3; got 4"):
        wl.select_from_population([1, 2, 3], 4, algorithm, generation=3, genomes=genomes)
