"""How parents are mixed: ``cross(parents, fitness, n_children, *, rng)`` makes children and says whose they are.

A function that also takes a keyword ``genes`` is handed the gene table.
"""

from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats, Genes, Indices
from walkerlab.ga.ranges import wrap


class Children(NamedTuple):
    """What a crossover hands back; any plain pair will do.

    Attributes:
        genomes: (n_children, n_genes).
        parents: (n_children, k) each child's parents, as indices into the parents given; k is free, and one
            parent may be named several times.
    """

    genomes: Floats
    parents: Indices


def paired(
    parents: Floats, fitness: Floats, n_children: int, *, rng: Generator, genes: Genes | None = None
) -> Children:
    """Give one child half of each parent's genes, and what is left to a second child.

    Couples are 0 and 1, 2 and 3, and so on, round again as often as needed. Where bodies have parts, halves
    are counted in grown parts, so that short bodies do not merely swap genes they have not grown: the first
    child is the mother's front half (the larger, of an odd number) and the father's rear half, the second
    the father's front and the mother's rear. Each part of either parent goes to exactly one child: unexpressed
    ones fill the children's tails, the first child's first. Whole-body genes come with the front. Both
    counts stay within the range of the parents' own: ceil(a/2) + floor(b/2) lies between a and b.

    Args:
        parents: (n_parents, n_genes) in the order in which they couple.
        fitness: (n_parents,) not looked at.
        n_children: how many; if odd, the last couple has one child.
        rng: not needed.
        genes: the gene table; without it, or without parts, a half is half of the gene positions.

    Returns:
        Children with (n_children, 2) parents, the one that gave the front first.
    """
    couples = _couples(len(parents), n_children)
    if genes is None or not genes.n_parts:
        n_genes = parents.shape[1]
        front = np.arange(n_genes, dtype=np.intp) < n_genes / 2
        return _litters(_exchange(parents[couples], front), couples, n_children)
    litters = np.stack([_exchange_grown_halves(couple, genes) for couple in parents[couples]])
    return _litters(litters, couples, n_children)


def randomized(parents: Floats, fitness: Floats, n_children: int, *, rng: Generator) -> Children:
    """Take each gene of each child from a parent drawn afresh from the whole pool (gene pool recombination).

    After Mühlenbein & Voigt 1996, Meta-Heuristics: Theory and Applications.

    Args:
        parents: (n_parents, n_genes).
        fitness: (n_parents,) not looked at.
        n_children: how many.
        rng: the only source of chance.

    Returns:
        Children with (n_children, n_genes) parents, one for each gene.
    """
    n_parents, n_genes = parents.shape
    donors = rng.integers(n_parents, size=(n_children, n_genes))
    return Children(parents[donors, np.arange(n_genes)], donors)


def weighted(
    parents: Floats, fitness: Floats, n_children: int, *, rng: Generator, genes: Genes | None = None
) -> Children:
    """Move the poorer of two parents towards the better, the more so the larger the gap between them.

    The child stands at the share gap / (best - worst of the pool) of the way; between equals it is the
    first parent unchanged. Couples are 0 and 1, 1 and 2, and so on round the pool. (Heuristic crossover,
    Wright 1991, FOGA 1, but inside the couple instead of beyond the better one, and with fitness as the share.)

    Args:
        parents: (n_parents, n_genes).
        fitness: (n_parents,) higher is better.
        n_children: how many.
        rng: not needed.
        genes: the gene table; with it counts are rounded, and cyclic genes take the shorter way round.

    Returns:
        Children with (n_children, 2) parents, the poorer first.
    """
    first = np.arange(n_children)
    neighbours = np.stack([first, first + 1], axis=1) % len(parents)
    poorer_first = np.argsort(fitness[neighbours], axis=1, kind="stable")
    couples = np.take_along_axis(neighbours, poorer_first, axis=1)
    poorer, better = couples.T
    spread = np.ptp(fitness)
    share = (fitness[better] - fitness[poorer]) / (spread if spread > 0 else 1.0)
    way = parents[better] - parents[poorer]
    if genes is not None:
        half_round = (genes.high - genes.low) / 2
        way = np.where(genes.is_cyclic, wrap(way, -half_round, half_round), way)
    children = parents[poorer] + share[:, None] * way
    if genes is not None:
        children = np.where(genes.is_cyclic, wrap(children, genes.low, genes.high), children)
        children = np.where(genes.is_count, np.rint(children), children)
    return Children(children, couples)


def one_point(parents: Floats, fitness: Floats, n_children: int, *, rng: Generator) -> Children:
    """Cut both parents at one place drawn by chance, and join the ends crosswise (Holland 1975).

    Args:
        parents: (n_parents, n_genes) couples are 0 and 1, 2 and 3, and so on, round again as often as needed.
        fitness: (n_parents,) not looked at.
        n_children: how many; if odd, the last couple has one child.
        rng: the only source of chance.

    Returns:
        Children with (n_children, 2) parents, the one that gave the front first.
    """
    couples = _couples(len(parents), n_children)
    n_genes = parents.shape[1]
    cuts = rng.integers(1, max(n_genes, 2), size=(len(couples), 1))
    front = np.arange(n_genes, dtype=np.intp) < cuts
    return _litters(_exchange(parents[couples], front), couples, n_children)


def uniform(parents: Floats, fitness: Floats, n_children: int, *, rng: Generator) -> Children:
    """Toss a coin for each gene: which of two children gets which parent's (Syswerda 1989, ICGA 3).

    Args:
        parents: (n_parents, n_genes) couples are 0 and 1, 2 and 3, and so on, round again as often as needed.
        fitness: (n_parents,) not looked at.
        n_children: how many; if odd, the last couple has one child.
        rng: the only source of chance.

    Returns:
        Children with (n_children, 2) parents.
    """
    couples = _couples(len(parents), n_children)
    heads = rng.random((len(couples), parents.shape[1])) < 1 / 2
    return _litters(_exchange(parents[couples], heads), couples, n_children)


def none(parents: Floats, fitness: Floats, n_children: int, *, rng: Generator) -> Children:
    """Let the children be copies of the parents, in turn: no crossover, so that mutation stands alone.

    Args:
        parents: (n_parents, n_genes).
        fitness: (n_parents,) not looked at.
        n_children: how many.
        rng: not needed.

    Returns:
        Children with (n_children, 1) parents.
    """
    copied = np.arange(n_children) % len(parents)
    return Children(parents[copied], copied[:, None])


def _couples(n_parents: int, n_children: int) -> Indices:
    """(n_couples, 2) mother and father of every two children: 0 and 1, 2 and 3, round and round."""
    n_couples = -(-n_children // 2)
    return np.arange(2 * n_couples).reshape(n_couples, 2) % n_parents


def _litters(litters: Floats, couples: Indices, n_children: int) -> Children:
    """Line up (n_couples, 2, n_genes) children; the second one's first parent is the father."""
    parents = np.stack([couples, couples[:, ::-1]], axis=1)
    return Children(litters.reshape(-1, litters.shape[-1])[:n_children], parents.reshape(-1, 2)[:n_children])


def _exchange(couples: Floats, kept: NDArray[np.bool_]) -> Floats:
    """Give the first child the mother's genes where ``kept`` and the father's elsewhere, the second the reverse."""
    mothers, fathers = couples[:, 0], couples[:, 1]
    return np.stack([np.where(kept, mothers, fathers), np.where(kept, fathers, mothers)], axis=1)


def _exchange_grown_halves(couple: Floats, genes: Genes) -> Floats:
    """Make the two children (2, n_genes) of a (2, n_genes) couple whose bodies have parts; see ``paired``."""
    mother, father = genes.parts(couple)
    n_mother, n_father = genes.n_grown(couple)
    half_mother, half_father = -(-n_mother // 2), -(-n_father // 2)
    first = np.concatenate([mother[:half_mother], father[half_father:n_father]])
    second = np.concatenate([father[:half_father], mother[half_mother:n_mother]])
    spare = np.concatenate([mother[n_mother:], father[n_father:]])
    room = genes.n_parts - len(first)

    children = couple.copy()
    genes.parts(children)[:] = [np.concatenate([first, spare[:room]]), np.concatenate([second, spare[room:]])]
    if genes.count is not None:
        children[:, genes.count] = len(first), len(second)
    return children
