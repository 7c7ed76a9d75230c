"""The numbers behind the tools of lesson 09 expose each planted bug in every seed, and find none in sound operators.

- ``operator_a`` drops the sign of the fitness: robots that walk backward fastest get wide slices of the wheel.
- ``operator_b`` draws one row of random numbers for all genomes: all robots change in the same way.
- ``operator_c`` divides a difference by the range of the couple instead of all parents: the child is the fitter parent.
- ``operator_d`` is sound: stochastic universal sampling (Baker 1987) with linear ranks.
- ``operator_e`` clips at the limits instead of reflecting: genes gather there.
- ``operator_f`` draws ranks up to n - 2, because the end of ``rng.integers`` is exclusive: the fittest never wins.
"""

import inspect

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.analysis import measure_selection, selection_probabilities
from walkerlab.analysis.mating import mate
from walkerlab.ga.checks import check_cross, check_mutate, check_select
from walkerlab.genome.features import build_genes
from walkerlab.lessons import broken
from walkerlab.lessons.contents.lesson_09 import CROSSOVER, EXERCISES, MUTATION, SELECTION
from walkerlab.settings.choices import Crossover, Mutation, Selection

N_ROBOTS = 30
N_ROUNDS = 40
SETTINGS = wl.Settings()
GENES = build_genes(SETTINGS.robot)
IS_REAL = ~GENES.is_count & ~GENES.is_cyclic

FITTEST_NEVER_SELECTED, LEAST_FIT_FAVOURED, SAME_CHANGE, AT_THE_ENDS, COPY_OF_ONE_PARENT = 2, 3, 4, 5, 6
RIGHT = {name: {number} - {1} for name, (number, _) in (SELECTION | CROSSOVER | MUTATION).items()}
"""Numbers of the symptoms of each operator, as in the lesson; 1 means that it has none."""

each_seed = pytest.mark.parametrize("seed", range(5))


def operator_named(letter):
    return getattr(broken, f"operator_{letter}")


def find_selection_symptoms(select, seed):
    """Return the symptoms that the wheel shows; the plot of lost best individuals must agree."""
    fitness = np.random.default_rng(seed).normal(0.3, 0.8, N_ROBOTS)  # m; some robots walk backward
    table = selection_probabilities(fitness, select, seed=seed).sort_values("rank")
    thirds = np.array_split(table.probability.to_numpy(), 3)
    symptoms = {FITTEST_NEVER_SELECTED} if table.probability.iloc[0] == 0 else set()
    if thirds[2].mean() > thirds[1].mean():
        symptoms.add(LEAST_FIT_FAVOURED)
    measured = measure_selection({"measured": select}, population_size=20, n_populations=10, seed=seed)
    lost = measured.set_index("measure").measured["best_lost"]
    assert (lost == 1) == (FITTEST_NEVER_SELECTED in symptoms), "both tools agree"
    return symptoms


def find_crossover_symptoms(cross, seed):
    """Return the symptoms that the microscope shows in the crossing of two of several parents."""
    rng = np.random.default_rng(seed)
    parents = [wl.Genome.random(SETTINGS.robot, rng=rng) for _ in range(5)]
    fitness = [*rng.permutation([1.0, 3.0]), 0.0, 2.0, 4.0]  # m; neither of the couple is the fittest or the least fit
    birth = mate(*parents[:2], SETTINGS.with_(crossover=cross), rng=rng, others=parents[2:], fitness=fitness)
    differs = [np.abs(birth.inherited - parent) > 1e-9 * (GENES.high - GENES.low) for parent in birth.parents]
    return {COPY_OF_ONE_PARENT} if not all(one.any() for one in differs) else set()


def mutate_often(mutate, genomes, n_rounds, seed):
    algorithm = SETTINGS.with_(mutation=mutate, seed=seed).algorithm
    for generation in range(n_rounds):
        genomes = wl.mutate_population(genomes, SETTINGS.robot, algorithm, generation=generation)
    return genomes


def find_mutation_symptoms(mutate, seed):
    """Return the symptoms that thirty mutated copies, and the positions of genes after many rounds, show."""
    random_robots = wl.generate_robot_population(SETTINGS.robot, N_ROBOTS, seed=seed)
    mutants = mutate_often(mutate, np.repeat(random_robots[:1], N_ROBOTS, axis=0), 1, seed)
    symptoms = {SAME_CHANGE} if len(np.unique(mutants, axis=0)) == 1 else set()
    position = (mutate_often(mutate, random_robots, N_ROUNDS, seed) - GENES.low) / (GENES.high - GENES.low)
    share, _ = np.histogram(position[:, IS_REAL], bins=20, range=(0, 1))
    if min(share[0], share[-1]) > 2 * np.median(share):
        symptoms.add(AT_THE_ENDS)
    return symptoms


@each_seed
@pytest.mark.parametrize("letter", SELECTION)
def test_the_wheel_shows_the_symptoms_of_each_selection_operator(letter, seed):
    assert find_selection_symptoms(operator_named(letter), seed) == RIGHT[letter]


@each_seed
def test_the_microscope_shows_the_symptom_of_the_crossover_operator(seed):
    assert find_crossover_symptoms(broken.operator_c, seed) == RIGHT["c"]


@each_seed
@pytest.mark.parametrize("letter", MUTATION)
def test_copies_and_positions_show_the_symptoms_of_each_mutation_operator(letter, seed):
    assert find_mutation_symptoms(operator_named(letter), seed) == RIGHT[letter]


@each_seed
def test_walkerlabs_operators_have_no_symptoms(seed):
    for selection in (Selection.gradient, Selection.tournament):
        assert find_selection_symptoms(selection, seed) == set()
    for crossover in (Crossover.weighted, Crossover.uniform):
        assert find_crossover_symptoms(crossover, seed) == set()
    assert find_mutation_symptoms(Mutation.gaussian, seed) == set()


def test_exactly_one_operator_is_sound():
    assert len(RIGHT) == 6
    assert [name for name, symptoms in RIGHT.items() if not symptoms] == ["d"]


def test_all_operators_pass_the_checks_before_a_run():
    for letter in SELECTION:
        check_select(operator_named(letter))
    check_cross(broken.operator_c, GENES)
    for letter in MUTATION:
        check_mutate(operator_named(letter), GENES)


def test_neither_names_nor_descriptions_of_the_operators_contain_the_bug():
    for letter in RIGHT:
        text = inspect.getdoc(operator_named(letter)) or ""
        assert not {"never", "copy", "clip", "sign", "same", "bug", "broken"} & set(text.lower().split())


def test_the_repair_of_the_tournament_is_recognised():
    def repaired(fitness, n_parents, *, rng):
        ranks = rng.integers(len(fitness), size=(n_parents, 3))
        return np.argsort(fitness)[ranks.max(axis=1)]

    check = EXERCISES["09.7"].check
    assert check(repaired) is True
    assert check(broken.operator_f) is not True
    assert check(operator_named("d")) is not True
