import random
from functools import partial
from unittest.mock import patch

import numpy as np
import pytest
from deap import tools
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chisquare, ks_2samp, kstest

from walkerlab.ga import mutation
from walkerlab.ga.mutation import (
    FAVORED_RATE_FACTOR,
    MICRO_STEP_FACTOR,
    PART_RATE_FACTOR,
    favored,
    gaussian,
    macro,
    micro,
    randomized,
)

from .laws import MIN_P_VALUE, changes_binomially
from .tables import bits, body, make_genes, random_genomes, reals, rng


@pytest.mark.parametrize("mutate", [randomized, gaussian, macro])
@pytest.mark.parametrize("rate", [0.02, 0.08, 0.5])
def test_the_number_of_changed_genes_is_binomial(mutate, rate):
    kinds = ["real", "count", "cyclic"] * 8
    table = make_genes(kinds, [0, 0, -np.pi] * 8, [5, 1, np.pi] * 8)
    genomes = random_genomes(table, 3000)
    changes_binomially(partial(mutate, rate=rate), genomes, table, rate)


def test_the_number_of_changes_agrees_with_deap(monkeypatch):
    monkeypatch.setattr("deap.tools.mutation.random", random.Random(2))
    table = reals(20, -50, 50)
    n = 2000
    genomes = np.zeros((n, 20))
    theirs = np.array([tools.mutGaussian([0.0] * 20, 0, 1.0, 0.1)[0] for _ in range(n)])
    ours = gaussian(genomes, table, rate=0.1, scale=0.01, rng=rng())
    assert ks_2samp((ours != 0).sum(axis=1), (theirs != 0).sum(axis=1)).pvalue > MIN_P_VALUE
    assert ks_2samp(ours[ours != 0], theirs[theirs != 0]).pvalue > MIN_P_VALUE


def test_a_randomized_step_is_relative_to_the_value_and_a_zero_can_change():
    table = reals(4, -1e3, 1e3)
    genomes = np.tile([0.0, 100.0, -400.0, 800.0], (4000, 1))
    step = randomized(genomes, table, rate=1.0, scale=0.01, rng=rng()) - genomes
    for column, size in zip(step.T, (200.0, 200.0, 400.0, 800.0), strict=True):
        assert kstest(column / (0.01 * size), "norm").pvalue > MIN_P_VALUE


def test_a_micro_step_is_a_fifth_of_a_randomized_one():
    table = reals(3, -1e3, 1e3)
    genomes = np.full((4000, 3), 500.0)
    large, small = (mutate(genomes, table, rate=1.0, scale=0.01, rng=rng()) - genomes for mutate in (randomized, micro))
    assert np.allclose(small, MICRO_STEP_FACTOR * large)


def test_micro_never_changes_a_count():
    table = body()
    genomes = random_genomes(table, 300)
    mutated = micro(genomes, table, rate=1.0, rng=rng())
    assert np.array_equal(mutated != genomes, np.broadcast_to(~table.is_count, genomes.shape))


@given(low=st.integers(-5, 5), width=st.integers(1, 6), scale=st.floats(0, 50), seed=st.integers(0, 99))
@settings(max_examples=100)
@pytest.mark.parametrize("mutate", [randomized, gaussian, macro])
def test_a_mutated_count_always_changes(mutate, low, width, scale, seed):
    table = make_genes(["count"], [low], [low + width])
    genomes = np.repeat(np.arange(low, low + width + 1.0), 20)[:, None]
    mutated = mutate(genomes, table, rate=1.0, scale=scale, rng=rng(seed))
    assert np.all(mutated != genomes)
    assert np.all((mutated >= low) & (mutated <= low + width))
    assert np.all(mutated % 1 == 0)


def test_a_gene_with_an_empty_range_does_not_change():
    table = make_genes(["real", "count", "cyclic"], [2, 2, 2], [2, 2, 2])
    genomes = np.full((50, 3), 2.0)
    for mutate in (randomized, micro, macro, gaussian):
        assert np.array_equal(mutate(genomes, table, rate=1.0, rng=rng()), genomes)


def test_a_cyclic_gene_wraps_around():
    table = make_genes(["cyclic"], [-np.pi], [np.pi])
    at_the_end = np.full((2000, 1), np.pi - 1e-3)
    mutated = gaussian(at_the_end, table, rate=1.0, scale=0.02, rng=rng())
    turned = np.angle(np.exp(1j * (mutated - at_the_end))) / (0.02 * 2 * np.pi)
    assert kstest(turned[:, 0], "norm").pvalue > MIN_P_VALUE
    assert 0.4 < np.mean(mutated < 0) < 0.6


def test_the_favored_feature_changes_more_often():
    table = body()
    rate = 0.03
    genomes = random_genomes(table, 4000)
    changed = np.mean(favored(genomes, table, favored="length", rate=rate, rng=rng()) != genomes, axis=0)
    expected = np.full(len(table), rate)
    expected[table.find("length")] = FAVORED_RATE_FACTOR * rate
    assert np.allclose(changed, expected, atol=0.03)


def test_an_unknown_favored_gene_is_rejected_with_the_allowed_names():
    table = body()
    with pytest.raises(ValueError, match="there is no gene 'wings'; the genes are parts, frequency, phase, length"):
        favored(random_genomes(table, 2), table, favored="wings", rng=rng())


def test_macro_draws_from_the_whole_range():
    table = reals(1, -3, 7)
    mutated = macro(np.full((4000, 1), 6.5), table, rate=1.0, rng=rng())
    assert kstest(mutated[:, 0], "uniform", args=(-3, 10)).pvalue > MIN_P_VALUE


def test_macro_draws_a_count_from_the_whole_range_except_its_old_value():
    table = make_genes(["count"], [1], [9])
    n = 9000
    mutated = macro(np.full((n, 1), 5.0), table, rate=1.0, rng=rng())[:, 0].astype(int)
    expected = np.full(9, n / 9)
    expected[[3, 4, 5]] = n / 6, 0, n / 6  # where 5 is drawn, the count changes by one
    seen = np.bincount(mutated - 1, minlength=9)
    assert not seen[4]
    assert chisquare(np.delete(seen, 4), np.delete(expected, 4)).pvalue > MIN_P_VALUE


def macro_of_parts_only(genomes, table, *address):
    """Apply ``macro`` so that each genome has a part duplicated or dropped, and no gene is changed by itself."""
    with patch.object(mutation, "PART_RATE_FACTOR", np.inf):
        return macro(genomes, table, rate=1e-12, rng=rng(*address))


@given(n_expressed=st.integers(1, 5), seed=st.integers(0, 300))
@settings(max_examples=150)
def test_macro_duplicates_a_grown_part_next_to_itself_or_drops_one(n_expressed, seed):
    table = body(5)
    genome = random_genomes(table, 1, seed)
    genome[0, 0] = n_expressed
    changed = macro_of_parts_only(genome, table, seed)
    before, after = (table.parts(g)[0].tolist() for g in (genome, changed))
    n_after = int(changed[0, 0])
    assert np.array_equal(changed[0, 1:3], genome[0, 1:3])
    if n_after == n_expressed + 1:
        assert after in [[*before[:k], before[k], *before[k:-1]] for k in range(n_expressed)]
    else:
        assert n_after == n_expressed - 1
        head = before[:n_expressed]
        tail = before[n_expressed:]
        assert after in [head[:k] + head[k + 1 :] + [head[k]] + tail for k in range(n_expressed)]
    assert 1 <= n_after <= 5


def test_all_parts_are_duplicated_and_dropped_equally_often():
    table = body(5)
    genome = random_genomes(table, 1)
    genome[0, 0] = 3
    before = table.parts(genome)[0].tolist()
    seen: dict[str, int] = {}
    for i in range(1200):
        after = table.parts(macro_of_parts_only(genome, table, i))[0].tolist()
        seen[str(after)] = seen.get(str(after), 0) + 1
    assert len(seen) == 6
    assert str(before) in seen, "dropping the last grown part changes only the count"
    assert chisquare(list(seen.values())).pvalue > MIN_P_VALUE


def test_macro_duplicates_or_drops_parts_at_the_stated_rate():
    table = body(5)
    rate = 0.04
    n = 4000
    genomes = random_genomes(table, n)
    genomes[:, 0] = 3
    lengths = table.find("length")
    moved = macro(genomes, table, rate=rate, rng=rng())[:, lengths] != genomes[:, lengths]
    rate_seen = np.mean(moved.sum(axis=1) >= 2)  # 2/6 of the cases move fewer than two; few single mutations move two
    assert 0.6 * PART_RATE_FACTOR * rate < rate_seen < PART_RATE_FACTOR * rate


def test_bits_flip():
    genomes = random_genomes(bits(10), 100)
    assert np.array_equal(randomized(genomes, bits(10), rate=1.0, rng=rng()), 1 - genomes)
