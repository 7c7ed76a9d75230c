"""Gene tables and populations for tests of operators."""

from functools import partial

import numpy as np

from walkerlab.ga import crossover, mutation, selection
from walkerlab.ga.genes import Genes
from walkerlab.system.randomness import random_stream


def rng(*address):
    return random_stream(11, "check", *address)


def make_genes(kinds, low, high, names=None, **body):
    n = len(kinds)
    names = tuple(f"g{i}" for i in range(n)) if names is None else names
    return Genes(names, ("",) * n, tuple(kinds), ("",) * n, np.array(low, float), np.array(high, float), **body)


def bits(n):
    return make_genes(["count"] * n, [0] * n, [1] * n)


def reals(n, low=0.0, high=1.0):
    return make_genes(["real"] * n, [low] * n, [high] * n)


def body(n_parts=5, min_parts=1):
    """Return a table of three genes of the whole body, then a length, an angle and a whole number for each part."""
    names = ("parts", "frequency", "phase")
    names += tuple(f"p{i}.{feature}" for i in range(n_parts) for feature in ("length", "angle", "teeth"))
    kinds = ["count", "real", "cyclic"] + ["real", "cyclic", "count"] * n_parts
    low = [min_parts, 0.5, 0.0] + [-1.0, -np.pi, 2] * n_parts
    high = [n_parts, 3.0, 2 * np.pi] + [1.0, np.pi, 9] * n_parts
    return make_genes(kinds, low, high, names, n_parts=n_parts, n_whole=3, count=0)


def random_genomes(genes, n, *address):
    values = genes.low + (genes.high - genes.low) * rng(*address).random((n, len(genes)))
    return np.where(genes.is_count, np.rint(values), values)


SELECTIONS = {
    f.__name__: f
    for f in (selection.gradient, selection.top_half, selection.tournament, selection.rank, selection.uniform)
}
CROSSOVERS = {
    f.__name__: f
    for f in (
        crossover.paired,
        crossover.randomized,
        crossover.weighted,
        crossover.one_point,
        crossover.uniform,
        crossover.none,
    )
}
MUTATIONS = {
    "randomized": mutation.randomized,
    "favored": partial(mutation.favored, favored="length"),
    "micro": mutation.micro,
    "macro": mutation.macro,
    "gaussian": mutation.gaussian,
}
