import random
from functools import partial

import numpy as np
import pytest
from deap import tools
from hypothesis import given, settings
from hypothesis import strategies as st

from walkerlab.ga.crossover import none, one_point, paired, randomized, uniform, weighted

from .laws import linkage, links_genes_by_distance
from .tables import body, make_genes, random_genomes, reals, rng

N_PARTS = 5
BODY = body(N_PARTS)


def couple_of(n_mother, n_father):
    """Return a couple with these numbers of grown parts, whose other values are all different."""
    couple = np.arange(2.0 * len(BODY)).reshape(2, -1) + 100
    couple[:, 0] = n_mother, n_father
    return couple


def blocks(genomes):
    return [tuple(part) for genome in BODY.parts(genomes) for part in genome]


counts = st.integers(1, N_PARTS)


@given(counts, counts)
def test_paired_passes_every_part_of_both_parents_to_exactly_one_child(a, b):
    couple = couple_of(a, b)
    children, _ = paired(couple, np.zeros(2), 2, rng=rng(), genes=BODY)
    assert sorted(blocks(children)) == sorted(blocks(couple))
    assert BODY.n_expressed(children).sum() == a + b

    def grown(genomes):
        return sorted(
            tuple(part)
            for genome, n in zip(BODY.parts(genomes), BODY.n_expressed(genomes), strict=True)
            for part in genome[:n]
        )

    assert grown(children) == grown(couple), "grown parts stay grown, and unexpressed ones unexpressed"
    assert np.all((children[:, 0] >= min(a, b)) & (children[:, 0] <= max(a, b)))


@given(counts, counts)
def test_paired_joins_front_to_rear(a, b):
    couple = couple_of(a, b)
    mother, father = couple
    (one, two), parents = paired(couple, np.zeros(2), 2, rng=rng(), genes=BODY)
    mother_parts, father_parts, one_parts, two_parts = (BODY.parts(g[None])[0] for g in (mother, father, one, two))
    half_a = (a + 1) // 2
    half_b = (b + 1) // 2
    n_one, n_two = BODY.n_expressed(np.stack([one, two]))
    assert np.array_equal(one_parts[:n_one], [*mother_parts[:half_a], *father_parts[half_b:b]])
    assert np.array_equal(two_parts[:n_two], [*father_parts[:half_b], *mother_parts[half_a:a]])
    assert np.array_equal(one[1:3], mother[1:3]), "whole-body genes come with the front"
    assert np.array_equal(two[1:3], father[1:3])
    assert parents.tolist() == [[0, 1], [1, 0]]


def test_paired_exchanges_grown_parts_of_short_bodies():
    """If halves were counted over all genes, short bodies would exchange only unexpressed genes."""
    couple = couple_of(2, 2)
    one = paired(couple, np.zeros(2), 2, rng=rng(), genes=BODY).genomes[0]
    assert np.array_equal(BODY.parts(one[None])[0, 1], BODY.parts(couple[1:])[0, 1])


def test_couples_cycle_as_needed():
    parents = np.arange(3.0)[:, None] * np.ones(4)
    for cross in (paired, one_point, uniform):
        assert cross(parents, np.zeros(3), 7, rng=rng()).parents.tolist() == [
            [0, 1], [1, 0], [2, 0], [0, 2], [1, 2], [2, 1], [0, 1],
        ]  # fmt: skip


@pytest.mark.parametrize("cross", [paired, one_point, uniform])
@given(n_couples=st.integers(1, 5), n_genes=st.integers(1, 9), seed=st.integers(0, 99))
@settings(max_examples=30)
def test_two_children_together_have_all_genes_of_their_parents(cross, n_couples, n_genes, seed):
    parents = random_genomes(reals(n_genes), 2 * n_couples, seed)
    children = cross(parents, np.zeros(2 * n_couples), 2 * n_couples, rng=rng(seed)).genomes
    pools = [np.sort(g.reshape(n_couples, 2, n_genes), axis=1) for g in (parents, children)]
    assert np.array_equal(*pools)


def test_paired_links_each_half_and_cuts_between_them():
    half = np.arange(7) < 3.5
    assert np.array_equal(linkage(paired, 7, n_couples=2), half[:, None] == half)


def test_randomized_links_no_genes():
    n_parents = 4
    seen = linkage(randomized, 8, n_parents=n_parents)[~np.eye(8, dtype=bool)]
    assert np.allclose(seen, 1 / n_parents, atol=0.04)


def test_uniform_links_no_genes():
    assert np.allclose(linkage(uniform, 8)[~np.eye(8, dtype=bool)], 1 / 2, atol=0.05)


def test_one_point_links_genes_by_their_distance():
    links_genes_by_distance(one_point)


def test_none_copies_the_parents_in_turn():
    parents = random_genomes(reals(4), 3)
    children, origins = none(parents, np.zeros(3), 5, rng=rng())
    assert np.array_equal(children, parents[[0, 1, 2, 0, 1]])
    assert origins.tolist() == [[0], [1], [2], [0], [1]]


def from_deap(mate):
    """Return a DEAP crossover, which exchanges values of two lists in place, as one with our signature."""

    def cross(parents, fitness, n_children, *, rng):
        one, two = (list(parent) for parent in parents)
        return np.array(mate(one, two)), None

    return cross


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [(one_point, tools.cxOnePoint), (uniform, partial(tools.cxUniform, indpb=0.5))],
    ids=["one_point", "uniform"],
)
def test_linkage_agrees_with_deap(ours, theirs, monkeypatch):
    monkeypatch.setattr("deap.tools.crossover.random", random.Random(3))
    assert np.allclose(linkage(ours, 8), linkage(from_deap(theirs), 8), atol=0.08)


@given(gaps=st.lists(st.floats(0, 1), min_size=2, max_size=8), base=st.floats(-100, 100))
def test_weighted_moves_the_less_fit_by_its_fraction_of_the_fitness_range(gaps, base):
    fitness = base + np.array([0.0, 1.0, *np.ravel([(0.0, gap) for gap in gaps])])
    parents = np.where(np.arange(len(fitness)) % 2, 10.0, 0.0)[:, None] * np.ones(3)
    children, origins = weighted(parents, fitness, len(fitness), rng=rng())
    moved = children[::2, 0]  # couples (0, 1), (2, 3), …; odd children come from the couples in between
    assert np.allclose(moved, 10 * np.array([1.0, *gaps]), atol=1e-9)
    assert np.all(np.diff(moved[np.argsort([1.0, *gaps])]) >= -1e-9), "the larger the difference, the further"
    assert np.all(fitness[origins[:, 0]] <= fitness[origins[:, 1]])


def test_weighted_does_not_change_equals():
    parents = random_genomes(BODY, 4)
    children, _ = weighted(parents, np.full(4, 2.0), 4, rng=rng(), genes=BODY)
    assert np.array_equal(children, parents)


def test_weighted_takes_the_shorter_way_for_cyclic_genes_and_rounds_counts():
    table = make_genes(["cyclic", "cyclic", "count", "real"], [0, -180, 1, 0], [360, 180, 9, 1])
    parents = np.array([[350.0, -170.0, 2.0, 0.2], [20.0, 160.0, 5.0, 0.4], [0.0, 0.0, 1.0, 0.0]])
    child = weighted(parents, np.array([1.0, 2.0, 0.0]), 1, rng=rng(), genes=table).genomes[0]
    assert np.allclose(child, [5.0, 175.0, 4.0, 0.3])
    assert child[2] % 1 == 0


@given(st.integers(0, 500))
@settings(max_examples=50)
def test_weighted_stays_in_range(seed):
    fitness = rng(seed).normal(size=6)
    children, _ = weighted(random_genomes(BODY, 6, seed), fitness, 6, rng=rng(), genes=BODY)
    assert np.all((children >= BODY.low) & (children <= BODY.high))
    assert np.all((children < BODY.high)[:, BODY.is_cyclic])
