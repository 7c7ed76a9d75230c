"""Laws of all operators, and of the historical bugs that broke them."""

import inspect
from functools import partial

import numpy as np
import pytest

from walkerlab.ga import check_cross, check_mutate, check_select, crossover, mutation, selection

from . import laws
from .tables import CROSSOVERS, MUTATIONS, SELECTIONS, body, random_genomes, reals, rng

FITNESS = np.array([-2.0, 3.5, 3.5, -7.0, 0.0, 11.0, 0.25])


@pytest.mark.parametrize("select", SELECTIONS.values(), ids=SELECTIONS)
def test_selection_is_pure_and_never_shrinks(select):
    laws.is_pure(select, FITNESS, 9)
    laws.never_shrinks(select, FITNESS)
    laws.never_shrinks(select, FITNESS[:1])
    laws.bears_any_zero(select, FITNESS)
    check_select(select)


@pytest.mark.parametrize("table", [reals(6), body()], ids=["plain", "body"])
@pytest.mark.parametrize("cross", CROSSOVERS.values(), ids=CROSSOVERS)
def test_crossover_is_pure_and_makes_as_many_as_asked(cross, table):
    keywords = {"genes": table} if "genes" in inspect.signature(cross).parameters else {}
    parents = random_genomes(table, len(FITNESS))
    for n_children in (1, 2, 7, 20):
        laws.is_pure(cross, parents, FITNESS, n_children, **keywords)
        genomes, origins = cross(parents, FITNESS, n_children, rng=rng(), **keywords)
        assert genomes.shape == (n_children, len(table))
        assert len(origins) == n_children
    one = cross(parents[:1], FITNESS[:1], 3, rng=rng(), **keywords)
    assert np.array_equal(one.genomes, parents[[0, 0, 0]]), "one parent alone has copies for children"
    check_cross(cross, table)


@pytest.mark.parametrize("mutate", MUTATIONS.values(), ids=MUTATIONS)
def test_mutation_is_pure_and_obeys_ranges(mutate):
    table = body()
    genomes = random_genomes(table, 500)
    laws.is_pure(mutate, genomes, table)
    for scale in (0.2, 30.0):
        laws.obeys_ranges(partial(mutate, rate=0.7, scale=scale), genomes, table)
    check_mutate(mutate, table)


@pytest.mark.parametrize("mutate", MUTATIONS.values(), ids=MUTATIONS)
def test_a_rate_of_zero_changes_nothing_and_a_rate_in_percent_is_refused(mutate):
    table = body()
    genomes = random_genomes(table, 50)
    assert np.array_equal(mutate(genomes, table, rate=0.0, rng=rng()), genomes)
    with pytest.raises(ValueError, match="must be 0 to 1"):
        mutate(genomes, table, rate=8, rng=rng())


# Planted bugs: each has been shipped by a well-known library, and is caught by the law that ours obey.


def roulette_from_zero(fitness, n_parents, *, rng):
    """Spin from zero upward (DEAP, inspyred): with negative fitness the wheel turns backwards."""
    wheel = np.cumsum(fitness)
    spins = rng.random(n_parents) * wheel[-1]
    return np.minimum(np.searchsorted(wheel, spins), len(fitness) - 1)


def truncation_that_shrinks(fitness, n_parents, *, rng):
    """Return the best there are, however many were asked for (DEAP's selBest)."""
    return np.argsort(-fitness)[:n_parents]


def n_point_of_single_genes(parents, fitness, n_children, *, rng):
    """Swap single genes and call it a cut (inspyred)."""
    children = parents[:2].copy()
    swapped = rng.choice(parents.shape[1], size=1)
    children[:, swapped] = children[::-1, swapped]
    return crossover.Children(children[:n_children], np.array([[0, 1], [1, 0]])[:n_children])


def mutation_in_place(genomes, genes, *, rng):
    """Write into the population (DEAP)."""
    genomes += rng.normal(0, 0.1, genomes.shape)
    return np.clip(genomes, genes.low, genes.high, out=genomes)


def test_roulette_that_starts_from_zero_is_caught():
    for law in (
        laws.bears_any_zero,
        partial(laws.draws_with, chances=selection.gradient_probabilities(FITNESS)),
    ):
        law(selection.gradient, FITNESS)
        with pytest.raises(AssertionError):
            law(roulette_from_zero, FITNESS)


def test_truncation_that_shrinks_is_caught():
    laws.never_shrinks(selection.top_half, FITNESS)
    with pytest.raises(AssertionError):
        laws.never_shrinks(truncation_that_shrinks, FITNESS)


def test_n_point_crossover_of_single_genes_is_caught():
    laws.links_neighbours(crossover.one_point)
    with pytest.raises(AssertionError):
        laws.links_neighbours(n_point_of_single_genes)


def test_mutation_in_place_is_caught():
    table = reals(6)
    genomes = random_genomes(table, 20)
    laws.is_pure(mutation.gaussian, genomes.copy(), table)
    with pytest.raises(AssertionError):
        laws.is_pure(mutation_in_place, genomes.copy(), table)
