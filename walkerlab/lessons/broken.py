"""The six operators of lesson 09, five of which have a bug.

All of them pass the checks of ``walkerlab.ga.checks`` and run without an error. Their docstrings say what they are
meant to do; the teacher's guide of the lesson and ``tests/lessons/test_broken.py`` say what they do.
"""

import numpy as np
from numpy.random import Generator

from walkerlab.ga.crossover import Children
from walkerlab.ga.genes import Floats, Genes, Indices
from walkerlab.ga.ranges import reflect


def operator_a(fitness: Floats, n_parents: int, *, rng: Generator) -> Indices:
    """Select parents with a roulette wheel: the fitter a robot is, the wider is its slice.

    Args:
        fitness: Fitness of each robot, shape (n,); higher is better.
        n_parents: Number of parents to select.
        rng: Random number generator.

    Returns:
        Indices into ``fitness``, shape (n_parents,).
    """
    slices = np.abs(fitness) + 1e-9
    return rng.choice(len(fitness), size=n_parents, p=slices / slices.sum())


def operator_b(genomes: Floats, genes: Genes, *, rng: Generator) -> Floats:
    """Mutate: change each gene of each genome with a probability of 10 %, by a random step.

    Args:
        genomes: Genomes, shape (n, n_genes).
        genes: Gene table.
        rng: Random number generator.

    Returns:
        Mutated genomes, shape (n, n_genes).
    """
    n_genes = len(genes)
    steps = 0.1 * (genes.high - genes.low) * rng.standard_normal(n_genes)
    is_mutated = (rng.random(n_genes) < 0.1) & ~genes.is_count
    return np.where(is_mutated, reflect(genomes + steps, genes.low, genes.high), genomes)


def operator_c(
    parents: Floats,
    fitness: Floats,
    n_children: int,
    *,
    rng: Generator,  # noqa: ARG001  # part of the signature
) -> Children:
    """Cross each parent with the next: move the less fit of the two towards the fitter one.

    The larger the difference of their fitness, the further it moves.

    Args:
        parents: Genomes, shape (n_parents, n_genes).
        fitness: Fitness of each parent, shape (n_parents,); higher is better.
        n_children: Number of children.
        rng: Random number generator; unused.

    Returns:
        ``Children`` whose ``parents`` has shape (n_children, 2), the less fit first.
    """
    first = np.arange(n_children)
    couples = np.stack([first, first + 1], axis=1) % len(parents)
    less_fit, fitter = np.take_along_axis(couples, np.argsort(fitness[couples], axis=1), axis=1).T
    differences = fitness[fitter] - fitness[less_fit]
    fitness_range = np.ptp(fitness[couples], axis=1)
    shares = differences / np.where(fitness_range > 0, fitness_range, 1.0)
    shares = shares[:, np.newaxis]
    children = (1 - shares) * parents[less_fit] + shares * parents[fitter]
    return Children(children, np.stack([less_fit, fitter], axis=1))


def operator_d(fitness: Floats, n_parents: int, *, rng: Generator) -> Indices:
    """Select parents with one spin of a wheel that has as many pointers as parents are needed.

    The width of a slice falls linearly with the rank of the robot, from the fittest to the least fit.

    Args:
        fitness: Fitness of each robot, shape (n,); higher is better.
        n_parents: Number of parents to select.
        rng: Random number generator.

    Returns:
        Indices into ``fitness``, shape (n_parents,).
    """
    order = np.argsort(-fitness)
    n = len(fitness)
    slices = np.arange(n, 0, -1) / (n * (n + 1) / 2)
    pointers = (rng.random() + np.arange(n_parents)) / n_parents
    positions = np.searchsorted(np.cumsum(slices)[:-1], pointers)
    return rng.permutation(order[positions])


def operator_e(genomes: Floats, genes: Genes, *, rng: Generator) -> Floats:
    """Mutate: change each gene of each genome with a probability of 10 %, by a random step within its limits.

    Args:
        genomes: Genomes, shape (n, n_genes).
        genes: Gene table.
        rng: Random number generator.

    Returns:
        Mutated genomes, shape (n, n_genes).
    """
    steps = 0.3 * (genes.high - genes.low) * rng.standard_normal(genomes.shape)
    is_mutated = (rng.random(genomes.shape) < 0.1) & ~genes.is_count
    return np.where(is_mutated, np.clip(genomes + steps, genes.low, genes.high), genomes)


def operator_f(fitness: Floats, n_parents: int, *, rng: Generator) -> Indices:
    """Select the winners of tournaments: each is the fittest of three robots drawn at random.

    Args:
        fitness: Fitness of each robot, shape (n,); higher is better.
        n_parents: Number of parents to select.
        rng: Random number generator.

    Returns:
        Indices into ``fitness``, shape (n_parents,).
    """
    worst_first = np.argsort(fitness)
    ranks = rng.integers(len(fitness) - 1, size=(n_parents, 3))
    return worst_first[ranks.max(axis=1)]
