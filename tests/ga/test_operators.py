"""All operators obey the laws of operators; known bugs of other libraries break them."""

import inspect
from functools import partial

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.ga import check_cross, check_mutate, check_select, crossover, mutation, selection

from . import laws
from .tables import CROSSOVERS, MUTATIONS, SELECTIONS, body, random_genomes, reals, rng

FITNESS = np.array([-2.0, 3.5, 3.5, -7.0, 0.0, 11.0, 0.25])


@pytest.mark.parametrize("select", SELECTIONS.values(), ids=SELECTIONS)
def test_selection_is_pure_and_returns_as_many_as_requested(select):
    laws.is_pure(select, FITNESS, 9)
    laws.selects_as_many_as_requested(select, FITNESS)
    laws.selects_as_many_as_requested(select, FITNESS[:1])
    laws.does_not_depend_on_the_scale(select, FITNESS)
    check_select(select)


@pytest.mark.parametrize("table", [reals(6), body()], ids=["plain", "body"])
@pytest.mark.parametrize("cross", CROSSOVERS.values(), ids=CROSSOVERS)
def test_crossover_is_pure_and_returns_as_many_as_requested(cross, table):
    keywords = {"genes": table} if "genes" in inspect.signature(cross).parameters else {}
    parents = random_genomes(table, len(FITNESS))
    for n_children in (1, 2, 7, 20):
        laws.is_pure(cross, parents, FITNESS, n_children, **keywords)
        genomes, origins = cross(parents, FITNESS, n_children, rng=rng(), **keywords)
        assert genomes.shape == (n_children, len(table))
        assert len(origins) == n_children
    one = cross(parents[:1], FITNESS[:1], 3, rng=rng(), **keywords)
    assert np.array_equal(one.genomes, parents[[0, 0, 0]]), "the children of a single parent are copies"
    check_cross(cross, table)


@pytest.mark.parametrize("mutate", MUTATIONS.values(), ids=MUTATIONS)
def test_mutation_is_pure_and_obeys_ranges(mutate):
    table = body()
    genomes = random_genomes(table, 500)
    laws.is_pure(mutate, genomes, table)
    for scale in (0.2, 30.0):
        laws.obeys_ranges(partial(mutate, rate=0.7, scale=scale), genomes, table)
    check_mutate(mutate, table)


@pytest.mark.parametrize("name", sorted({"favored", *MUTATIONS} & set(vars(mutation))))
def test_a_mutation_called_directly_has_the_default_rate_and_scale_of_the_settings(name):
    parameters = inspect.signature(getattr(mutation, name)).parameters
    algorithm = wl.Algorithm()
    assert parameters["rate"].default == algorithm.mutation_rate
    assert parameters["scale"].default == algorithm.mutation_scale


@pytest.mark.parametrize("mutate", MUTATIONS.values(), ids=MUTATIONS)
def test_a_rate_of_zero_changes_nothing_and_a_rate_in_percent_is_rejected(mutate):
    table = body()
    genomes = random_genomes(table, 50)
    assert np.array_equal(mutate(genomes, table, rate=0.0, rng=rng()), genomes)
    with pytest.raises(ValueError, match="must be between 0 and 1"):
        mutate(genomes, table, rate=8, rng=rng())


# Bugs of well-known libraries, each of which breaks a law that our operators obey.


def roulette_from_zero(fitness, n_parents, *, rng):
    """Select with probabilities that start from zero (DEAP, inspyred), so that negative fitness gives negative ones."""
    wheel = np.cumsum(fitness)
    spins = rng.random(n_parents) * wheel[-1]
    return np.minimum(np.searchsorted(wheel, spins), len(fitness) - 1)


def truncation_that_returns_too_few(fitness, n_parents, *, rng):
    """Return at most as many parents as there are individuals (DEAP's selBest)."""
    return np.argsort(-fitness)[:n_parents]


def n_point_of_single_genes(parents, fitness, n_children, *, rng):
    """Exchange single genes instead of the ends behind a cut (inspyred)."""
    children = parents[:2].copy()
    swapped = rng.choice(parents.shape[1], size=1)
    children[:, swapped] = children[::-1, swapped]
    return crossover.Children(children[:n_children], np.array([[0, 1], [1, 0]])[:n_children])


def mutation_in_place(genomes, genes, *, rng):
    """Modify the population in place (DEAP)."""
    genomes += rng.normal(0, 0.1, genomes.shape)
    return np.clip(genomes, genes.low, genes.high, out=genomes)


def test_roulette_selection_from_zero_breaks_the_laws():
    for law in (
        laws.does_not_depend_on_the_scale,
        partial(laws.selects_with_probabilities, probabilities=selection.gradient_probabilities(FITNESS)),
    ):
        law(selection.gradient, FITNESS)
        with pytest.raises(AssertionError):
            law(roulette_from_zero, FITNESS)


def test_truncation_that_returns_too_few_breaks_the_law():
    laws.selects_as_many_as_requested(selection.top_half, FITNESS)
    with pytest.raises(AssertionError):
        laws.selects_as_many_as_requested(truncation_that_returns_too_few, FITNESS)


def test_n_point_crossover_of_single_genes_breaks_the_law():
    laws.links_genes_by_distance(crossover.one_point)
    with pytest.raises(AssertionError):
        laws.links_genes_by_distance(n_point_of_single_genes)


def test_mutation_in_place_breaks_the_law():
    table = reals(6)
    genomes = random_genomes(table, 20)
    laws.is_pure(mutation.gaussian, genomes.copy(), table)
    with pytest.raises(AssertionError):
        laws.is_pure(mutation_in_place, genomes.copy(), table)
