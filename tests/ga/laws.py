"""Laws that every operator must obey, as functions that assert them; each is shown to fail for a broken operator."""

import numpy as np
from scipy.stats import binom, chisquare

from .tables import rng

MIN_P_VALUE = 1e-4
"""Significance level of the statistical tests; seeds are fixed, so that no test fails by chance."""


def selects_with_probabilities(select, fitness, probabilities, n=20_000):
    """Assert that a selection selects each individual with the given probability."""
    probabilities = np.asarray(probabilities)
    seen = np.bincount(select(fitness, n, rng=rng(1)), minlength=len(fitness))
    assert len(seen) == len(fitness)
    assert seen.sum() == n
    assert not np.any(seen[probabilities == 0])
    assert chisquare(seen[probabilities > 0], n * probabilities[probabilities > 0]).pvalue > MIN_P_VALUE


def selects_as_many_as_requested(select, fitness):
    """Assert that a selection returns the requested number of parents, also more than there are individuals."""
    for n_parents in (1, len(fitness) // 2, len(fitness), 3 * len(fitness) + 1):
        assert np.shape(select(fitness, n_parents, rng=rng(2))) == (n_parents,)


def does_not_depend_on_the_scale(select, fitness):
    """Assert that a shift or a positive factor of fitness does not change the selection."""
    expected = select(fitness, 50, rng=rng(3))
    for rescaled in (fitness - 100, fitness + 100, fitness * 2.0**20, fitness / 2.0**20 - 1):
        assert np.array_equal(select(rescaled, 50, rng=rng(3)), expected)


def linkage(cross, n_genes, n_couples=4000, n_parents=2):
    """Return how often two genes of a child come from the same parent, shape (n_genes, n_genes)."""
    parents = np.repeat(np.arange(n_parents, dtype=float)[:, None], n_genes, axis=1)
    children = [cross(parents, np.zeros(n_parents), 2, rng=rng(4, i))[0] for i in range(n_couples // 2)]
    origin = np.concatenate(children)  # the value of each gene is the number of its parent
    return np.mean(origin[:, :, None] == origin[:, None, :], axis=0)


def links_genes_by_distance(cross, n_genes=9):
    """Assert that two genes stay together with probability 1 - distance / (n - 1), as they do with one cut."""
    positions = np.arange(n_genes)
    distance = np.abs(positions[:, None] - positions)
    assert np.allclose(linkage(cross, n_genes), 1 - distance / (n_genes - 1), atol=0.06)


def changes_binomially(mutate, genomes, genes, rate):
    """Assert that the number of changed genes of a genome has a binomial distribution."""
    n, n_genes = genomes.shape
    changed = np.sum(mutate(genomes, genes, rng=rng(5)) != genomes, axis=1)
    expected = n * binom.pmf(np.arange(n_genes + 1), n_genes, rate)
    common = expected >= 5
    seen = np.bincount(changed, minlength=n_genes + 1)
    seen, expected = (np.append(counts[common], counts[~common].sum()) for counts in (seen, expected))
    assert chisquare(seen, expected * seen.sum() / expected.sum()).pvalue > MIN_P_VALUE


def obeys_ranges(mutate, genomes, genes):
    """Assert that values stay in range, counts stay whole, and cyclic genes stay below their upper end."""
    mutated = mutate(genomes, genes, rng=rng(6))
    assert np.all((mutated >= genes.low) & (mutated <= genes.high))
    assert np.all(mutated[:, genes.is_count] % 1 == 0)
    assert np.all((mutated < genes.high)[:, genes.is_cyclic])


def is_pure(operator, *arguments, **keywords):
    """Assert that an operator does not modify its arguments, and returns the same for the same random numbers."""
    copies = [np.copy(a) if isinstance(a, np.ndarray) else a for a in arguments]
    first = operator(*copies, rng=rng(7), **keywords)
    assert all(np.array_equal(a, b) for a, b in zip(arguments, copies, strict=True) if isinstance(a, np.ndarray))
    second = operator(*arguments, rng=rng(7), **keywords)
    first, second = (result if isinstance(result, tuple) else (result,) for result in (first, second))
    assert all(map(np.array_equal, first, second))
