"""Crossover operators: ``cross(parents, fitness, n_children, *, rng)`` returns children and their parents' indices.

A function that also takes a keyword ``genes`` receives the gene table.
"""

from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats, Genes, Indices
from walkerlab.ga.ranges import wrap


class Children(NamedTuple):
    """Result of a crossover. An operator may also return a plain pair.

    Attributes:
        genomes: Genomes of the children, shape (n_children, n_genes).
        parents: Parents of each child as indices into the given parents, shape (n_children, k); any k, and a parent may
            occur several times.
    """

    genomes: Floats
    parents: Indices


def paired(
    parents: Floats, fitness: Floats, n_children: int, *, rng: Generator, genes: Genes | None = None
) -> Children:
    """Give half of each parent's genes to one child, and the other halves to a second child.

    Couples are parents 0 and 1, 2 and 3, and so on, cycling as needed. If the gene table defines parts, such as
    segments, only the expressed parts are divided into halves, so that short bodies do not just exchange unexpressed
    genes: the first child has the mother's front half (the larger half if the number of parts is odd) and the father's
    rear half, the second the father's front and the mother's rear. Each part of either parent goes to exactly one
    child: unexpressed parts fill up the first child, then the second. Whole-body genes come from the parent that
    contributes the front. Each child's number of parts lies between those of its parents, a and b, because
    ceil(a/2) + floor(b/2) does.

    Args:
        parents: Genomes, shape (n_parents, n_genes), in the order of the couples.
        fitness: Fitness of each parent, shape (n_parents,); unused.
        n_children: Number of children; if odd, the last couple has one child.
        rng: Random number generator; unused.
        genes: Gene table; if it is None or defines no parts, the list of genes itself is cut in half.

    Returns:
        ``Children`` whose ``parents`` has shape (n_children, 2); the first parent of each child contributed its front.
    """
    couples = _pair_parents(len(parents), n_children)
    if genes is None or not genes.n_parts:
        n_genes = parents.shape[1]
        front = np.arange(n_genes, dtype=np.intp) < n_genes / 2
        return _children_of_couples(_exchange_genes(parents[couples], front), couples, n_children)
    genomes = np.stack([_exchange_expressed_halves(couple, genes) for couple in parents[couples]])
    return _children_of_couples(genomes, couples, n_children)


def randomized(parents: Floats, fitness: Floats, n_children: int, *, rng: Generator) -> Children:
    """Take each gene of each child from a parent drawn at random from all parents (gene pool recombination).

    After Mühlenbein & Voigt 1996, Meta-Heuristics: Theory and Applications.

    Args:
        parents: Genomes, shape (n_parents, n_genes).
        fitness: Fitness of each parent, shape (n_parents,); unused.
        n_children: Number of children.
        rng: Random number generator.

    Returns:
        ``Children`` whose ``parents`` has shape (n_children, n_genes): the parent of each gene.
    """
    n_parents, n_genes = parents.shape
    donors = rng.integers(n_parents, size=(n_children, n_genes))
    return Children(parents[donors, np.arange(n_genes)], donors)


def weighted(
    parents: Floats, fitness: Floats, n_children: int, *, rng: Generator, genes: Genes | None = None
) -> Children:
    """Move the less fit of two parents towards the fitter one by a distance that grows with their fitness difference.

    The child lies a fraction of the way from the less fit to the fitter parent: their fitness difference divided by the
    fitness range of all parents. If both parents are equally fit, the child is a copy of the first. Couples are parents
    0 and 1, 1 and 2, and so on, cycling. (Heuristic crossover, Wright 1991, FOGA 1, but between the parents instead of
    beyond the fitter one, and with the fraction given by fitness.)

    Args:
        parents: Genomes, shape (n_parents, n_genes).
        fitness: Fitness of each parent, shape (n_parents,); higher is better.
        n_children: Number of children.
        rng: Random number generator; unused.
        genes: Gene table; if given, counts are rounded, and cyclic genes move the shorter way around.

    Returns:
        ``Children`` whose ``parents`` has shape (n_children, 2), the less fit first.
    """
    first = np.arange(n_children)
    neighbours = np.stack([first, first + 1], axis=1) % len(parents)
    less_fit_first = np.argsort(fitness[neighbours], axis=1, kind="stable")
    couples = np.take_along_axis(neighbours, less_fit_first, axis=1)
    less_fit, fitter = couples.T
    fitness_range = np.ptp(fitness)
    fraction = (fitness[fitter] - fitness[less_fit]) / (fitness_range if fitness_range > 0 else 1.0)
    difference = parents[fitter] - parents[less_fit]
    if genes is not None:
        half_turn = (genes.high - genes.low) / 2
        difference = np.where(genes.is_cyclic, wrap(difference, -half_turn, half_turn), difference)
    children = parents[less_fit] + fraction[:, None] * difference
    if genes is not None:
        children = np.where(genes.is_cyclic, wrap(children, genes.low, genes.high), children)
        children = np.where(genes.is_count, np.rint(children), children)
    return Children(children, couples)


def one_point(parents: Floats, fitness: Floats, n_children: int, *, rng: Generator) -> Children:
    """Cut both parents at one random position, and exchange the ends (Holland 1975).

    Args:
        parents: Genomes, shape (n_parents, n_genes); couples are 0 and 1, 2 and 3, and so on, cycling as needed.
        fitness: Fitness of each parent, shape (n_parents,); unused.
        n_children: Number of children; if odd, the last couple has one child.
        rng: Random number generator.

    Returns:
        ``Children`` whose ``parents`` has shape (n_children, 2); the first parent of each child contributed its front.
    """
    couples = _pair_parents(len(parents), n_children)
    n_genes = parents.shape[1]
    cuts = rng.integers(1, max(n_genes, 2), size=(len(couples), 1))
    front = np.arange(n_genes, dtype=np.intp) < cuts
    return _children_of_couples(_exchange_genes(parents[couples], front), couples, n_children)


def uniform(parents: Floats, fitness: Floats, n_children: int, *, rng: Generator) -> Children:
    """Choose at random, for each gene, which parent the first child inherits it from (Syswerda 1989, ICGA 3).

    The second child inherits the gene from the other parent.

    Args:
        parents: Genomes, shape (n_parents, n_genes); couples are 0 and 1, 2 and 3, and so on, cycling as needed.
        fitness: Fitness of each parent, shape (n_parents,); unused.
        n_children: Number of children; if odd, the last couple has one child.
        rng: Random number generator.

    Returns:
        ``Children`` whose ``parents`` has shape (n_children, 2).
    """
    couples = _pair_parents(len(parents), n_children)
    from_mother = rng.random((len(couples), parents.shape[1])) < 1 / 2
    return _children_of_couples(_exchange_genes(parents[couples], from_mother), couples, n_children)


def none(parents: Floats, fitness: Floats, n_children: int, *, rng: Generator) -> Children:
    """Copy the parents in turn: no crossover, so that children vary by mutation alone.

    Args:
        parents: Genomes, shape (n_parents, n_genes).
        fitness: Fitness of each parent, shape (n_parents,); unused.
        n_children: Number of children.
        rng: Random number generator; unused.

    Returns:
        ``Children`` whose ``parents`` has shape (n_children, 1).
    """
    copied = np.arange(n_children) % len(parents)
    return Children(parents[copied], copied[:, None])


def _pair_parents(n_parents: int, n_children: int) -> Indices:
    """Return the mother and the father of each pair of children, shape (n_couples, 2): 0 and 1, 2 and 3, cycling."""
    n_couples = -(-n_children // 2)
    return np.arange(2 * n_couples).reshape(n_couples, 2) % n_parents


def _children_of_couples(genomes: Floats, couples: Indices, n_children: int) -> Children:
    """Flatten the (n_couples, 2, n_genes) children of couples; the second child of a couple has the father first."""
    parents = np.stack([couples, couples[:, ::-1]], axis=1)
    return Children(genomes.reshape(-1, genomes.shape[-1])[:n_children], parents.reshape(-1, 2)[:n_children])


def _exchange_genes(couples: Floats, from_mother: NDArray[np.bool_]) -> Floats:
    """Return the (n_couples, 2, n_genes) children of couples.

    The first child has the mother's genes where ``from_mother`` is true and the father's elsewhere, the second the
    reverse.
    """
    mothers = couples[:, 0]
    fathers = couples[:, 1]
    return np.stack([np.where(from_mother, mothers, fathers), np.where(from_mother, fathers, mothers)], axis=1)


def _exchange_expressed_halves(couple: Floats, genes: Genes) -> Floats:
    """Return the (2, n_genes) children of a (2, n_genes) couple whose bodies have parts; see ``paired``."""
    mother, father = genes.parts(couple)
    n_mother, n_father = genes.n_expressed(couple)
    half_mother = -(-n_mother // 2)  # rounded up
    half_father = -(-n_father // 2)
    first = np.concatenate([mother[:half_mother], father[half_father:n_father]])
    second = np.concatenate([father[:half_father], mother[half_mother:n_mother]])
    unexpressed = np.concatenate([mother[n_mother:], father[n_father:]])
    n_missing = genes.n_parts - len(first)

    children = couple.copy()
    genes.parts(children)[:] = [
        np.concatenate([first, unexpressed[:n_missing]]),
        np.concatenate([second, unexpressed[n_missing:]]),
    ]
    if genes.count is not None:
        children[:, genes.count] = len(first), len(second)
    return children
