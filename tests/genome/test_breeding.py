"""Settings are resolved to operators, and the public functions perform the steps of one generation."""

from functools import partial

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.evolution.lost_pressure import explain_lost_pressure
from walkerlab.ga import mutation, selection
from walkerlab.genome.breeding import (
    OPERATOR_MODULES,
    check_user_operators,
    describe_operators,
    resolve_operators,
)
from walkerlab.genome.features import build_genes
from walkerlab.system.randomness import random_stream

ROBOT = wl.Robot()
POPULATION = wl.generate_robot_population(ROBOT, 12, seed=1)
FITNESS = np.arange(12.0)


@pytest.mark.parametrize(
    "choice", [choice for kind in OPERATOR_MODULES for choice in kind], ids=lambda c: f"{type(c).__name__}.{c.name}"
)
def test_every_choice_has_a_function_of_its_name(choice):
    assert callable(getattr(OPERATOR_MODULES[type(choice)], choice.name))


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
def test_lost_pressure_is_explained_if_an_outlier_hides_the_best(fitness, changes, is_lost):
    algorithm = wl.Settings().with_(**{"selection": "gradient"} | changes).algorithm
    explanation = explain_lost_pressure(np.array(fitness, dtype=float), algorithm)
    assert bool(explanation) == is_lost
    assert ('with_(selection="rank")' in explanation) == is_lost


def test_mutation_settings_are_bound_to_keywords_that_are_not_bound_already():
    def with_rate(genomes, genes, *, rng, rate):
        return genomes

    def without_rate(genomes, genes, *, rng):
        return genomes

    bound = partial(mutation.randomized, rate=0.5)
    algorithm = wl.Algorithm(
        mutation=[with_rate, without_rate, bound, "favored"], mutation_rate=0.25, favored_gene="mass"
    )
    first, second, third, fourth = resolve_operators(algorithm).mutate
    assert first.keywords == {"rate": 0.25}
    assert second is without_rate
    assert third.keywords["rate"] == 0.5
    assert fourth.keywords["favored"] == "mass"


def test_mutation_settings_are_not_bound_to_selections_and_crossovers():
    def select(fitness, n_parents, *, rng, rate=0.9, scale=0.8):
        return np.arange(n_parents) % len(fitness)

    def cross(parents, fitness, n_children, *, rng, rate=0.9, favored="mine"):
        return np.resize(parents, (n_children, parents.shape[1])), np.arange(n_children)[:, None] % len(parents)

    resolved = resolve_operators(wl.Algorithm(selection=select, crossover=cross))
    assert resolved.select == (select,)
    assert resolved.cross == (cross,)


@pytest.mark.parametrize("slot", ["selection", "crossover", "mutation"])
@pytest.mark.parametrize(("name", "operator"), [("max", max), ("tournament", partial(selection.tournament, siez=2))])
def test_an_operator_without_a_usable_signature_is_named_with_its_slot(slot, name, operator):
    algorithm = wl.Algorithm(**{slot: operator})
    with pytest.raises(wl.OperatorError, match=f"^{slot} '{name}' "):
        check_user_operators(algorithm, build_genes(ROBOT))


def test_the_operators_of_an_algorithm_are_described_with_their_parameters():
    algorithm = wl.Algorithm(selection=partial(selection.tournament, size=7), crossover=["paired", "weighted"])
    assert describe_operators(algorithm) == "tournament(size=7) > paired+weighted > gaussian"


def test_the_steps_of_2017_make_a_generation():
    """The public functions for selection, crossover and mutation can be called one by one, with repeatable results."""
    algorithm = wl.Algorithm(seed=9)
    selected = wl.select_from_population(FITNESS, 10, algorithm, generation=1)
    children = wl.crossover_population(POPULATION[selected], FITNESS[selected], 10, ROBOT, algorithm, generation=1)
    genomes = wl.mutate_population(children.genomes, ROBOT, algorithm, generation=1)
    again = wl.mutate_population(children.genomes, ROBOT, algorithm, generation=1)
    later = wl.mutate_population(children.genomes, ROBOT, algorithm, generation=2)
    np.testing.assert_array_equal(genomes, again)
    assert (genomes != later).any()
    assert genomes.shape == (10, POPULATION.shape[1])


def test_the_steps_accept_lists_genomes_and_texts_as_well_as_arrays():
    algorithm = wl.Algorithm(selection="top_half", crossover="weighted", seed=2)
    selected = wl.select_from_population(FITNESS.tolist(), 8, algorithm, generation=1)
    np.testing.assert_array_equal(selected, wl.select_from_population(FITNESS, 8, algorithm, generation=1))
    assert set(selected) == set(range(6, 12))

    genomes = [wl.Genome(values) for values in POPULATION]
    children = wl.crossover_population(POPULATION, FITNESS, 12, ROBOT, algorithm, generation=1).genomes
    mutants = wl.mutate_population(POPULATION, ROBOT, algorithm, generation=1)
    for same in (genomes, list(map(str, genomes)), POPULATION.tolist()):
        crossed = wl.crossover_population(same, FITNESS.tolist(), 12, ROBOT, algorithm, generation=1).genomes
        np.testing.assert_array_equal(crossed, children)
        np.testing.assert_array_equal(wl.mutate_population(same, ROBOT, algorithm, generation=1), mutants)


@pytest.mark.parametrize("crossover", wl.Crossover)
def test_parents_that_do_not_count_are_crossed_with_fitness_0_as_in_a_run(crossover):
    algorithm = wl.Algorithm(crossover=crossover)
    first, second = (
        wl.crossover_population(POPULATION, np.append(FITNESS[1:], worst), 12, ROBOT, algorithm, generation=1)
        for worst in (-np.inf, 0.0)
    )
    np.testing.assert_array_equal(first.genomes, second.genomes)


def test_wrong_arguments_of_the_steps_are_explained():
    algorithm = wl.Algorithm()
    other = wl.Robot(segments=(1, 5))
    cross = partial(wl.crossover_population, n_children=4, robot=ROBOT, algorithm=algorithm, generation=1)
    mutate = partial(wl.mutate_population, robot=ROBOT, algorithm=algorithm, generation=1)
    longer = wl.generate_robot_population(other, 2, seed=0)
    with pytest.raises(ValueError, match=r"individual 3 has fitness nan"):
        cross(POPULATION[:4], [1, 2, 3, np.nan])
    with pytest.raises(ValueError, match=r"fitness must have the shape \(4,\).* got \(12,\).* fitness\[selected\]"):
        cross(POPULATION[:4], FITNESS)
    for bad in (longer, [POPULATION[0], wl.Genome(longer[0])]):
        with pytest.raises(ValueError, match=r"genome \d has 69 genes; .* must have 56"):
            mutate(bad)
    for single in (POPULATION[0], wl.Genome(POPULATION[0]), str(wl.Genome(POPULATION[0]))):
        with pytest.raises(ValueError, match="put it in a list"):
            mutate(single)
    for size in (0, -1):
        with pytest.raises(ValueError, match=f"size is {size}; it must be a whole number, 1 or more"):
            wl.generate_robot_population(ROBOT, size, seed=1)


def test_the_first_genomes_do_not_depend_on_the_population_size():
    np.testing.assert_array_equal(wl.generate_robot_population(ROBOT, 5, seed=1), POPULATION[:5])
    gene = wl.generate_robot_gene(ROBOT, rng=random_stream(1, "population", 0, 0))
    np.testing.assert_array_equal(gene.values, POPULATION[0])
