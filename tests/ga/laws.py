"""What must hold of an operator, whoever wrote it. Each law asserts, and is broken by a planted bug somewhere."""

import numpy as np
from scipy.stats import binom, chisquare

from .tables import rng

SURE = 1e-4
"""A chi-square less likely than this is no accident; seeds are fixed, so none is met by one."""


def draws_with(select, fitness, chances, n=20_000):
    """A selection names each individual as often as it should."""
    chances = np.asarray(chances)
    seen = np.bincount(select(fitness, n, rng=rng(1)), minlength=len(fitness))
    assert len(seen) == len(fitness)
    assert seen.sum() == n
    assert not np.any(seen[chances == 0])
    assert chisquare(seen[chances > 0], n * chances[chances > 0]).pvalue > SURE


def never_shrinks(select, fitness):
    """A selection names as many as it is asked for."""
    for n_parents in (1, len(fitness) // 2, len(fitness), 3 * len(fitness) + 1):
        assert np.shape(select(fitness, n_parents, rng=rng(2))) == (n_parents,)


def bears_any_zero(select, fitness):
    """Fitness has no natural zero: moving or stretching the scale changes nobody's lot."""
    expected = select(fitness, 50, rng=rng(3))
    for moved in (fitness - 100, fitness + 100, fitness * 2.0**20, fitness / 2.0**20 - 1):
        assert np.array_equal(select(moved, 50, rng=rng(3)), expected)


def linkage(cross, n_genes, n_couples=4000, n_parents=2):
    """(n_genes, n_genes) how often two genes of a child come from one parent; a parent's genes bear its number."""
    parents = np.repeat(np.arange(n_parents, dtype=float)[:, None], n_genes, axis=1)
    litters = [cross(parents, np.zeros(n_parents), 2, rng=rng(4, i))[0] for i in range(n_couples // 2)]
    origin = np.concatenate(litters)
    return np.mean(origin[:, :, None] == origin[:, None, :], axis=0)


def links_neighbours(cross, n_genes=9):
    """Under one cut, two genes stay together the oftener the closer they stand: 1 - distance / (n - 1)."""
    places = np.arange(n_genes)
    distance = np.abs(places[:, None] - places)
    assert np.allclose(linkage(cross, n_genes), 1 - distance / (n_genes - 1), atol=0.06)


def changes_binomially(mutate, genomes, genes, rate):
    """A genome has as many changed genes as so many coins of that rate have heads."""
    n, n_genes = genomes.shape
    changed = np.sum(mutate(genomes, genes, rng=rng(5)) != genomes, axis=1)
    expected = n * binom.pmf(np.arange(n_genes + 1), n_genes, rate)
    common = expected >= 5
    seen = np.bincount(changed, minlength=n_genes + 1)
    seen, expected = (np.append(counts[common], counts[~common].sum()) for counts in (seen, expected))
    assert chisquare(seen, expected * seen.sum() / expected.sum()).pvalue > SURE


def obeys_ranges(mutate, genomes, genes):
    """Nothing leaves its range, counts stay whole, and what is cyclic never stands at its upper end."""
    mutated = mutate(genomes, genes, rng=rng(6))
    assert np.all((mutated >= genes.low) & (mutated <= genes.high))
    assert np.all(mutated[:, genes.is_count] % 1 == 0)
    assert np.all((mutated < genes.high)[:, genes.is_cyclic])


def is_pure(operator, *arguments, **keywords):
    """An operator leaves its arguments as they were, and answers the same to the same chance."""
    given = [np.copy(a) if isinstance(a, np.ndarray) else a for a in arguments]
    first = operator(*given, rng=rng(7), **keywords)
    assert all(np.array_equal(a, b) for a, b in zip(arguments, given, strict=True) if isinstance(a, np.ndarray))
    again = operator(*arguments, rng=rng(7), **keywords)
    first, again = (x if isinstance(x, tuple) else (x,) for x in (first, again))
    assert all(map(np.array_equal, first, again))
