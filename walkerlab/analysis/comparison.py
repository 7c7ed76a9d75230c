"""Infer from the genomes alone where the genes of a child come from."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from walkerlab.analysis.inheritance import ROUNDING_TOLERANCE, Birth, gene_widths, shortest_change
from walkerlab.analysis.mating import AnyGenome
from walkerlab.analysis.tracing import NO_SOURCE, Sources
from walkerlab.ga.genes import Floats, Genes
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome
from walkerlab.settings.robot import Robot


def compare_with_parents(child: AnyGenome, parents: Sequence[AnyGenome], robot: Robot, names: Sequence[str]) -> Birth:
    """Infer the origin of each gene of a child from the values alone.

    A gene with the same value as the gene at the same position in a parent comes from that parent. A segment that
    matches another segment of a parent better than the segments at its own position was moved. If most genes that
    differ between two parents lie at the same fraction of the way from one parent to the other, the genes at this
    fraction are blends. All other genes are assigned to the parent with the nearest value, and the difference counts as
    mutation.

    Args:
        child: Genome of the child.
        parents: Genomes of its parents, at least one.
        robot: Limits of the robots.
        names: Name of each parent.
    """
    genes = build_genes(robot)
    values = Genome.of(child).values
    table = np.array([Genome.of(one).values for one in parents])
    gene = np.tile(np.arange(len(genes)), (len(table), 1))
    parent, is_moved = _match_parts(values, table, genes)
    distance = np.abs(shortest_change(table, values, genes)) / gene_widths(genes)
    nearest = np.argmin(distance, axis=0)
    source_parent = np.where(is_moved, parent.parent, nearest)
    source_gene = np.where(is_moved, parent.gene, gene[0])
    shares = (np.arange(len(table))[:, np.newaxis] == source_parent).astype(np.float64)
    share = _blend_share(values, table, genes) if len(table) == 2 else None
    if share is not None:
        weights = np.array([1 - share, share])
        blended = table[0] + share * shortest_change(table[0], table[1], genes)
        error = np.abs(shortest_change(blended, values, genes))
        is_blend = (error <= np.where(genes.is_count, 0.5, ROUNDING_TOLERANCE)) & (table[0] != table[1])
        source_parent = np.where(is_blend, NO_SOURCE, source_parent)
        source_gene = np.where(is_blend, NO_SOURCE, source_gene)
        shares = np.where(is_blend, weights[:, np.newaxis], shares)
    sources = Sources(source_parent, source_gene, shares)
    has_source = source_parent != NO_SOURCE
    inherited = np.where(has_source, table[source_parent, source_gene], values)
    return Birth(genes, table, tuple(names), sources, inherited, values, values, is_exact=False)


def _match_parts(values: Floats, table: Floats, genes: Genes) -> tuple[Sources, NDArray[np.bool_]]:
    """Find the moved parts of a child: each matches a part of a parent better than the genes at its own position.

    Returns:
        Sources, valid only for the genes of moved parts, and whether each gene belongs to a moved part.
    """
    n_genes = len(genes)
    parent = np.zeros(n_genes, dtype=np.intp)
    gene = np.arange(n_genes)
    is_moved = np.zeros(n_genes, dtype=np.bool_)
    if not genes.n_parts:
        return Sources(parent, gene, np.zeros((len(table), n_genes))), is_moved
    child_parts = genes.parts(values[np.newaxis])[0]
    parent_parts = genes.parts(table)
    n_equal = (child_parts[:, np.newaxis, np.newaxis] == parent_parts).sum(axis=-1)  # (parts, parents, parts)
    for part, counts in enumerate(n_equal):
        at_position = (child_parts[part] == parent_parts[:, part]).any(axis=0).sum()
        row, column = np.unravel_index(np.argmax(counts), counts.shape)
        if counts[row, column] > at_position:
            width = child_parts.shape[1]
            positions = genes.n_whole + part * width + np.arange(width)
            parent[positions] = row
            gene[positions] = genes.n_whole + column * width + np.arange(width)
            is_moved[positions] = True
    return Sources(parent, gene, np.zeros((len(table), n_genes))), is_moved


def _blend_share(values: Floats, table: Floats, genes: Genes) -> float | None:
    """Return the share of the second parent that most differing genes have in common, or None."""
    difference = shortest_change(table[0], table[1], genes)
    is_used = (np.abs(difference) > 20 * ROUNDING_TOLERANCE) & ~genes.is_count
    if not is_used.any():
        return None
    shares = shortest_change(table[0], values, genes)[is_used] / difference[is_used]
    share = float(np.median(shares))
    error = np.abs(shares - share) * np.abs(difference[is_used])
    is_between = 1e-3 < share < 1 - 1e-3
    return share if is_between and (error <= 2 * ROUNDING_TOLERANCE).mean() > 1 / 2 else None
