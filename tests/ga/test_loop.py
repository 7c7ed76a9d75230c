from dataclasses import dataclass
from functools import partial
from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from walkerlab.ga import (
    NOT_COUNTED,
    OperatorError,
    Operators,
    crossover,
    first_population,
    mutation,
    next_population,
    selection,
)
from walkerlab.ga.operators import cross_in_turn, mutate_in_turn, select_in_turn
from walkerlab.system.randomness import random_stream

from .tables import bits, random_genomes, reals, rng


@dataclass(frozen=True)
class Score:
    fitness: float


def ones(genomes):
    return [Score(f) for f in genomes.sum(axis=1)]


def no_repair(genomes):
    return genomes


def no_mutation(genomes, genes, *, rng):
    return genomes


def operators(select=selection.tournament, cross=crossover.one_point, mutate=mutation.randomized):
    return Operators((select,), (cross,), (mutate,))


def evolve(ops, genes, n, generations, evaluate=ones, *, n_elites=1, seed=5, genomes=None):
    populations = [first_population(random_genomes(genes, n) if genomes is None else genomes, evaluate)]
    for _ in range(generations):
        populations.append(
            next_population(populations[-1], ops, genes, evaluate, repair=no_repair, n_elites=n_elites, seed=seed)
        )
    return populations


# OneMax: the fitness of a genome of bits is its number of ones. Uniform selection has no pressure and micro never
# changes a count, so these two cannot solve it; all combinations of the others can.


@pytest.mark.parametrize("mutate", [mutation.randomized, mutation.favored, mutation.macro, mutation.gaussian])
def test_onemax_is_solved(mutate):
    n_bits = 48
    n = 40
    generations = 60
    if mutate is mutation.favored:
        mutate = partial(mutate, favored="g0")
    selections = (selection.gradient, selection.top_half, selection.tournament, selection.rank)
    crossovers = (
        crossover.paired,
        crossover.randomized,
        crossover.weighted,
        crossover.one_point,
        crossover.uniform,
        crossover.none,
    )
    best_at_random = rng(1).integers(2, size=(n * (generations + 1), n_bits)).sum(axis=1).max()
    for select, cross in product(selections, crossovers):
        best = evolve(operators(select, cross, partial(mutate, rate=0.02)), bits(n_bits), n, generations)[-1]
        assert best.fitness.max() >= 42 > best_at_random + 4, (select.__name__, cross.__name__)


def test_without_selection_pressure_onemax_is_not_solved():
    last = evolve(operators(select=selection.uniform), bits(48), 40, 60, n_elites=0)[-1]
    assert last.fitness.max() < 40


def test_with_an_elite_the_best_fitness_never_decreases():
    best = [p.fitness.max() for p in evolve(operators(), bits(30), 20, 40)]
    assert np.all(np.diff(best) >= 0)


# The Price equation (Price 1970): without mutation, the mean of a trait changes by the covariance of the trait with the
# number of offspring, over the mean of that number; crossovers that preserve each couple's genes do not add to it.


@pytest.mark.parametrize("n", [20, 33])
@pytest.mark.parametrize("select", [selection.gradient, selection.top_half, selection.tournament, selection.uniform])
def test_the_price_equation_holds_without_crossover(select, n):
    before, after = evolve(operators(select, crossover.none, no_mutation), reals(6), n, 1, n_elites=0)
    assert_price_equation(before, after)


@pytest.mark.parametrize("cross", [crossover.paired, crossover.one_point, crossover.uniform])
def test_the_price_equation_holds_under_crossovers_that_preserve_genes(cross):
    before, after = evolve(operators(selection.gradient, cross, no_mutation), reals(6), 40, 1, n_elites=0)
    assert_price_equation(before, after)


def assert_price_equation(before, after):
    row = {individual: i for i, individual in enumerate(before.individuals.tolist())}
    offspring = np.zeros(len(row))
    for parents in after.parents:
        for parent in parents:
            offspring[row[parent]] += 1 / len(parents)
    traits = before.genomes
    covariance = np.mean((offspring - offspring.mean())[:, None] * (traits - traits.mean(axis=0)), axis=0)
    assert np.allclose(after.genomes.mean(axis=0) - traits.mean(axis=0), covariance / offspring.mean())
    assert np.any(np.abs(covariance) > 1e-3), "otherwise the test proves nothing"


# Repeatability.


def same(one, other):
    return (
        np.array_equal(one.genomes, other.genomes)
        and np.array_equal(one.individuals, other.individuals)
        and one.parents == other.parents
    )


def test_the_same_seed_gives_the_same_populations():
    start = random_genomes(bits(20), 16)
    a, b, c = (evolve(operators(), bits(20), 16, 5, seed=seed, genomes=start) for seed in (1, 1, 2))
    assert all(map(same, a, b))
    assert not same(a[-1], c[-1])


def test_changing_only_the_mutation_leaves_selection_and_crossover_unchanged():
    seen = []

    def record(genomes, genes, *, rng):
        seen.append(genomes.copy())
        return genomes

    parents = []
    for change in (mutation.randomized, mutation.macro):
        ops = Operators((selection.gradient,), (crossover.one_point,), (record, change))
        parents.append(evolve(ops, reals(8), 20, 1)[1].parents)
    assert np.array_equal(*seen)
    assert parents[0] == parents[1]


def test_each_operator_draws_from_its_own_stream():
    drawn = []

    def draw(rng):
        drawn.append(rng.random())

    def select(fitness, n_parents, *, rng):
        draw(rng)
        return np.resize(np.arange(len(fitness)), n_parents)

    def cross(parents, fitness, n_children, *, rng):
        draw(rng)
        return crossover.none(parents, fitness, n_children, rng=rng)

    def mutate(genomes, genes, *, rng):
        draw(rng)
        return genomes

    evolve(Operators((select, select), (cross, cross), (mutate, mutate)), bits(4), 6, 2, seed=9)
    addresses = product((1, 2), ("selection", "crossover", "mutation"), (0, 1))
    assert drawn == [random_stream(9, slot, generation, position).random() for generation, slot, position in addresses]


# Elites, births and individuals that do not count.


def test_elites_are_the_best_and_are_carried_over_unchanged():
    seen = []

    def evaluate(genomes):
        seen.append(genomes.copy())
        return ones(genomes)

    populations = evolve(operators(), bits(20), 12, 6, evaluate, n_elites=3)
    assert [len(genomes) for genomes in seen] == [12] + [9] * 6, "elites are never evaluated again"
    for before, after in pairwise(populations):
        best = sorted(range(12), key=lambda i: (-before.fitness[i], i))[:3]
        for place, i in enumerate(best):
            assert np.array_equal(after.genomes[place], before.genomes[i])
            assert after.individuals[place] == before.individuals[i]
            assert after.born[place] == before.born[i]
            assert after.parents[place] == before.parents[i]
            assert after.evaluations[place] is before.evaluations[i]


def test_individual_numbers_are_consecutive_and_unique():
    populations = evolve(operators(), bits(20), 12, 6, n_elites=3)
    born: dict[int, np.ndarray] = {}
    for population in populations:
        assert len(set(population.individuals)) == 12
        for i, individual in enumerate(population.individuals.tolist()):
            is_new = individual not in born
            assert is_new == (population.born[i] == population.generation)
            born.setdefault(individual, population.genomes[i])
            assert np.array_equal(born[individual], population.genomes[i])
            assert all(parent < individual for parent in population.parents[i])
    assert sorted(born) == list(range(12 + 6 * 9))
    assert populations[-1].n_born == len(born)


def counted_if_first_gene(genomes):
    return [Score(genome.sum() if genome[0] > 0.5 else NOT_COUNTED) for genome in genomes]


@pytest.mark.parametrize(
    "select",
    [selection.gradient, selection.top_half, selection.tournament, selection.rank, selection.uniform],
)
def test_individuals_that_do_not_count_have_no_children_and_are_not_elites(select):
    populations = evolve(operators(select), reals(6), 15, 5, counted_if_first_gene, n_elites=14)
    for before, after in pairwise(populations):
        not_counted = set(before.individuals[before.fitness == NOT_COUNTED].tolist())
        assert not not_counted & {
            parent for parents in after.parents for parent in parents if parent in before.individuals
        }
        assert not not_counted & set(after.individuals.tolist())


def test_if_no_individual_counts_all_are_selected_from_equally():
    def none_counts(genomes):
        return [Score(NOT_COUNTED)] * len(genomes)

    ops = operators(selection.gradient, crossover.weighted)
    _, after = evolve(ops, reals(4), 200, 1, none_counts, n_elites=2)
    assert np.array_equal(after.born, np.ones(200)), "no individual is an elite"
    assert len({parent for parents in after.parents for parent in parents}) > 100


# Several operators in one slot.


@given(st.lists(st.integers(-20, 20), min_size=2, max_size=15), st.integers(0, 50))
@settings(max_examples=50)
def test_the_second_selection_selects_among_those_of_the_first(fitness, seed):
    fitness = np.array(fitness, float)
    both = select_in_turn((selection.top_half, selection.gradient), fitness, 8, seed=seed, generation=1)
    first = select_in_turn((selection.top_half,), fitness, 8, seed=seed, generation=1)
    assert set(both) <= set(first)


def test_two_selections_increase_the_selection_pressure():
    fitness = np.arange(40.0)
    once, twice = (
        np.mean([fitness[select_in_turn(ops, fitness, 40, seed=s, generation=1)].mean() for s in range(30)])
        for ops in ((selection.gradient,), (selection.gradient, selection.gradient))
    )
    assert twice > once + 2


def test_repeated_crossover_returns_the_original_parents():
    parents = np.repeat(np.arange(8.0)[:, None], 6, axis=1)
    ops = (crossover.one_point, crossover.randomized, crossover.uniform)
    genomes, origins = cross_in_turn(ops, parents, np.zeros(8), 7, genes=reals(6), seed=1, generation=1)
    assert genomes.shape == (7, 6)
    for genome, origin in zip(genomes, origins, strict=True):
        assert set(genome) <= set(origin)


@pytest.mark.parametrize("n_elites", [0, 1, 2, 5])
def test_parents_are_requested_in_whole_couples(n_elites):
    requested: list[int] = []

    def record(fitness, n_parents, *, rng):
        requested.append(n_parents)
        return selection.uniform(fitness, n_parents, rng=rng)

    after = evolve(operators(select=record), bits(4), 6, 1, n_elites=n_elites)[-1]
    assert requested == [2 * -(-(6 - n_elites) // 2)]
    assert len(after.genomes) == 6


def test_between_crossovers_a_child_has_the_mean_fitness_of_its_parents():
    seen = []

    def record(parents, fitness, n_children, *, rng):
        seen.append((len(parents), fitness))
        return crossover.none(parents, fitness, n_children, rng=rng)

    fitness = np.array([1.0, 3.0, 10.0, 20.0])
    cross_in_turn((crossover.paired, record), np.zeros((4, 2)), fitness, 3, genes=reals(2), seed=1, generation=1)
    ((n_parents, expected),) = seen
    assert n_parents == 4, "a second crossover gets whole couples too"
    assert np.array_equal(expected, [2, 2, 15, 15])


def test_two_mutations_change_more_genes():
    genomes = random_genomes(reals(50), 50)
    once, twice = (
        np.mean(mutate_in_turn(ops, genomes, reals(50), seed=1, generation=1) != genomes)
        for ops in ((mutation.gaussian,), (mutation.gaussian, mutation.gaussian))
    )
    assert np.isclose(once, 0.04, atol=0.01)
    assert np.isclose(twice, 1 - 0.96**2, atol=0.01)


def test_a_crossover_with_a_keyword_genes_gets_the_gene_table():
    table = reals(3)
    seen = []

    def with_genes(parents, fitness, n_children, *, rng, genes):
        seen.append(genes)
        return crossover.none(parents, fitness, n_children, rng=rng)

    evolve(operators(cross=with_genes), table, 4, 1)
    assert seen == [table]


# Errors.


def test_an_exception_is_reported_with_operator_and_generation():
    def faulty(genomes, genes, *, rng):
        raise KeyError("oops")

    with pytest.raises(
        OperatorError, match=r"^mutation 'faulty' raised KeyError: 'oops' \(line .*generation 1\."
    ) as caught:
        evolve(Operators((selection.rank,), (crossover.none,), (no_mutation, partial(faulty))), bits(4), 6, 1)
    assert isinstance(caught.value.__cause__, KeyError)


def test_a_selection_that_returns_too_few_is_rejected():
    def best_only(fitness, n_parents, *, rng):
        return np.argsort(-fitness)[: n_parents // 2]

    with pytest.raises(ValueError, match="selection 'best_only' must return n_parents = 6 parents"):
        evolve(operators(select=best_only), bits(4), 6, 1, n_elites=0)


def test_a_nan_fitness_is_reported_with_the_individual():
    def faulty(genomes):
        return [Score(np.nan if i == 3 else 1.0) for i in range(len(genomes))]

    with pytest.raises(ValueError, match="individual 3 has fitness nan"):
        first_population(random_genomes(bits(3), 5), faulty)


def test_missing_evaluations_too_many_elites_and_empty_slots_are_rejected():
    with pytest.raises(ValueError, match="returned 4 results for 5 genomes"):
        first_population(random_genomes(bits(3), 5), lambda genomes: ones(genomes)[1:])
    with pytest.raises(ValueError, match="n_elites is 6; it must be between 0 and 5"):
        evolve(operators(), bits(4), 6, 1, n_elites=6)
    with pytest.raises(ValueError, match=r"Operators\.cross is empty"):
        Operators((selection.rank,), (), (no_mutation,))


def test_repair_is_the_last_step_before_evaluation():
    def to_half(genomes):
        return np.full_like(genomes, 0.5)

    start = first_population(random_genomes(reals(4), 6), ones)
    after = next_population(start, operators(), reals(4), ones, repair=to_half, n_elites=1, seed=1)
    assert np.all(after.genomes[1:] == 0.5)
    assert np.all(after.fitness[1:] == 2.0)


def test_a_population_is_read_only_and_independent_of_the_genomes_given():
    genomes = random_genomes(reals(4), 6)
    population = first_population(genomes, ones)
    genomes += 1
    assert np.all(population.genomes <= 1)
    for column in (population.genomes, population.fitness, population.individuals, population.born):
        with pytest.raises(ValueError, match="read-only"):
            column[0] = 0
