"""The slots' names become functions, and the sliders reach whoever asks for them."""

from functools import partial

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.algorithm import ROOMS, operators, slot_names
from walkerlab.ga import mutation, selection
from walkerlab.randomness import stream

ROBOT = wl.Robot()
POPULATION = wl.generate_robot_population(ROBOT, 12, seed=1)
FITNESS = np.arange(12.0)


@pytest.mark.parametrize(
    "choice", [choice for kind in ROOMS for choice in kind], ids=lambda c: f"{type(c).__name__}.{c.name}"
)
def test_every_choice_has_a_function_of_its_name(choice):
    assert callable(getattr(ROOMS[type(choice)], choice.name))


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


def test_the_first_population_is_the_same_however_large_it_is():
    np.testing.assert_array_equal(wl.generate_robot_population(ROBOT, 5, seed=1), POPULATION[:5])
    gene = wl.generate_robot_gene(ROBOT, rng=stream(1, "population", 0, 0))
    np.testing.assert_array_equal(gene.values, POPULATION[0])
