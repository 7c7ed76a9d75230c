"""The slots' names become functions, and the sliders reach whoever asks for them."""

from functools import partial

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.breeding import ROOMS, check_own_operators, lost_pressure, operators, slot_names
from walkerlab.ga import mutation, selection
from walkerlab.genome.repair import genes_of
from walkerlab.randomness import stream

ROBOT = wl.Robot()
POPULATION = wl.generate_robot_population(ROBOT, 12, seed=1)
FITNESS = np.arange(12.0)


@pytest.mark.parametrize(
    "choice", [choice for kind in ROOMS for choice in kind], ids=lambda c: f"{type(c).__name__}.{c.name}"
)
def test_every_choice_has_a_function_of_its_name(choice):
    assert callable(getattr(ROOMS[type(choice)], choice.name))


@pytest.mark.parametrize(
    ("fitness", "changes", "is_lost"),
    [
        ([*range(11), -1e6], {}, True),
        ([*range(11), -1e6, -np.inf], {}, True),
        ([*range(11), -1e6], {"selection": "rank"}, False),
        ([*range(11), -1e6], {"selection": ["top_half", "gradient"]}, False),
        ([*range(11), -np.inf], {}, False),
        ([*[1.0] * 11, -1e6], {}, False),
        ([*np.linspace(9.9, 10.0, 11), 0.0], {}, False),  # a converged population with one poor mutant
        ([0.0, 9.8, 9.9, 10.0], {}, False),
        ([-np.inf] * 12, {}, False),
        ([2.0] * 12, {}, False),
        (range(12), {}, False),
    ],
)
def test_lost_pressure_is_explained_where_an_outlier_hides_the_best(fitness, changes, is_lost):
    said = lost_pressure(np.array(fitness, dtype=float), wl.Settings().with_(**changes).algorithm)
    assert bool(said) == is_lost
    assert ('with_(selection="rank")' in said) == is_lost


def test_sliders_reach_those_that_ask_and_spare_what_is_bound():
    def asks(genomes, genes, *, rng, rate):
        return genomes

    def does_not(genomes, genes, *, rng):
        return genomes

    bound = partial(mutation.randomized, rate=0.5)
    algorithm = wl.Algorithm(mutation=[asks, does_not, bound, "favored"], mutation_rate=0.25, favored_gene="mass")
    first, second, third, fourth = operators(algorithm).mutate
    assert first.keywords == {"rate": 0.25}
    assert second is does_not
    assert third.keywords["rate"] == 0.5
    assert fourth.keywords["favored"] == "mass"


def test_sliders_are_for_mutation_alone():
    def select(fitness, n_parents, *, rng, rate=0.9, scale=0.8):
        return np.arange(n_parents) % len(fitness)

    def cross(parents, fitness, n_children, *, rng, rate=0.9, favored="mine"):
        return np.resize(parents, (n_children, parents.shape[1])), np.arange(n_children)[:, None] % len(parents)

    filled = operators(wl.Algorithm(selection=select, crossover=cross))
    assert filled.select == (select,)
    assert filled.cross == (cross,)


@pytest.mark.parametrize("slot", ["selection", "crossover", "mutation"])
@pytest.mark.parametrize(("name", "operator"), [("max", max), ("tournament", partial(selection.tournament, siez=2))])
def test_an_operator_that_does_not_say_what_it_takes_is_named_with_its_slot(slot, name, operator):
    algorithm = wl.Algorithm(**{slot: operator})
    with pytest.raises(wl.OperatorError, match=f"^{slot} '{name}' "):
        check_own_operators(algorithm, genes_of(ROBOT))


def test_a_child_is_told_by_the_operators_that_made_it():
    algorithm = wl.Algorithm(selection=partial(selection.tournament, size=7), crossover=["paired", "weighted"])
    assert slot_names(algorithm) == "tournament(size=7) > paired+weighted > randomized"


def test_the_steps_of_2017_make_a_generation():
    """select, cross and mutate by hand: the children of an evolution's own next generation."""
    algorithm = wl.Algorithm(seed=9)
    chosen = wl.select_from_population(FITNESS, 10, algorithm, generation=1)
    children = wl.crossover_population(POPULATION[chosen], FITNESS[chosen], 10, ROBOT, algorithm, generation=1)
    genomes = wl.mutate_population(children.genomes, ROBOT, algorithm, generation=1)
    again = wl.mutate_population(children.genomes, ROBOT, algorithm, generation=1)
    later = wl.mutate_population(children.genomes, ROBOT, algorithm, generation=2)
    np.testing.assert_array_equal(genomes, again)
    assert (genomes != later).any()
    assert genomes.shape == (10, POPULATION.shape[1])


def test_the_steps_take_lists_of_numbers_genomes_and_texts_as_they_take_arrays():
    algorithm = wl.Algorithm(selection="top_half", crossover="weighted", seed=2)
    chosen = wl.select_from_population(FITNESS.tolist(), 8, algorithm, generation=1)
    np.testing.assert_array_equal(chosen, wl.select_from_population(FITNESS, 8, algorithm, generation=1))
    assert set(chosen) == set(range(6, 12))

    genomes = [wl.Genome(values) for values in POPULATION]
    children = wl.crossover_population(POPULATION, FITNESS, 12, ROBOT, algorithm, generation=1).genomes
    mutants = wl.mutate_population(POPULATION, ROBOT, algorithm, generation=1)
    for same in (genomes, list(map(str, genomes)), POPULATION.tolist()):
        crossed = wl.crossover_population(same, FITNESS.tolist(), 12, ROBOT, algorithm, generation=1).genomes
        np.testing.assert_array_equal(crossed, children)
        np.testing.assert_array_equal(wl.mutate_population(same, ROBOT, algorithm, generation=1), mutants)


@pytest.mark.parametrize("crossover", wl.Crossover)
def test_parents_that_do_not_count_are_crossed_as_in_an_evolution_with_a_fitness_of_0(crossover):
    algorithm = wl.Algorithm(crossover=crossover)
    first, second = (
        wl.crossover_population(POPULATION, np.append(FITNESS[1:], worst), 12, ROBOT, algorithm, generation=1)
        for worst in (-np.inf, 0.0)
    )
    np.testing.assert_array_equal(first.genomes, second.genomes)


def test_the_steps_say_what_they_cannot_take():
    algorithm, other = wl.Algorithm(), wl.Robot(segments=(1, 5))
    cross = partial(wl.crossover_population, n_children=4, robot=ROBOT, algorithm=algorithm, generation=1)
    mutate = partial(wl.mutate_population, robot=ROBOT, algorithm=algorithm, generation=1)
    longer = wl.generate_robot_population(other, 2, seed=0)
    with pytest.raises(ValueError, match=r"individual 3 has fitness nan"):
        cross(POPULATION[:4], [1, 2, 3, np.nan])
    with pytest.raises(ValueError, match=r"fitness must have the shape \(4,\).* got \(12,\).* fitness\[chosen\]"):
        cross(POPULATION[:4], FITNESS)
    for bad in (longer, [POPULATION[0], wl.Genome(longer[0])]):
        with pytest.raises(ValueError, match=r"genome \d has 62 genes; .* must have 50"):
            mutate(bad)
    for single in (POPULATION[0], wl.Genome(POPULATION[0]), str(wl.Genome(POPULATION[0]))):
        with pytest.raises(ValueError, match="put it in a list"):
            mutate(single)
    for size in (0, -1):
        with pytest.raises(ValueError, match=f"size is {size}; it must be a whole number, 1 or more"):
            wl.generate_robot_population(ROBOT, size, seed=1)


def test_the_first_population_is_the_same_however_large_it_is():
    np.testing.assert_array_equal(wl.generate_robot_population(ROBOT, 5, seed=1), POPULATION[:5])
    gene = wl.generate_robot_gene(ROBOT, rng=stream(1, "population", 0, 0))
    np.testing.assert_array_equal(gene.values, POPULATION[0])
