"""Find where the genes of a child come from by running an operator again on tagged genomes.

A tag is a tiny change of one gene. If an operator copies a gene, the child has its tag; if it blends the genes of
several parents, it has the same blend of their tags; if it draws a new value, it has no tag. The operator needs no
changes, and it may move genes to other positions. The method assumes that the operator draws the same random numbers
in each call and that tiny changes do not alter its decisions; each result is therefore checked against the values.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats, Genes, Indices
from walkerlab.ga.ranges import wrap
from walkerlab.system.readonly import ReadOnlyArrays

TAG_SIZE = 1e-5  # largest tag, as a fraction of the gene's range
COUNT_TAG_SIZE = 1e-7  # largest tag of a count; positive, so that rounding and truncation remove it
MIN_TAG_RUNS = 3
MAX_BLENDED = 12  # maximum number of parents whose shares in a blend are determined
SHARE_TOLERANCE = 1e-5
BLEND_TOLERANCE = 1e-5  # of a blended value, as a fraction of the gene's range
COUNT_TOLERANCE = 1e-3  # by which a tagged count may differ from the original one

NO_SOURCE = -1
"""Index of the parent and of its gene if a value does not come from a single parent."""

Operation = Callable[[Floats], Floats]
"""Function from the (k, n_genes) genomes of the parents to the (n_genes,) genome of one child."""


@dataclass(frozen=True, eq=False)
class Sources(ReadOnlyArrays):
    """Where each gene of a child comes from.

    Attributes:
        parent: Index of the parent from which each gene comes, shape (n_genes,); ``NO_SOURCE`` if it does not come from
            a single parent. The operator may have changed the value.
        gene: Index of the gene of that parent, or ``NO_SOURCE``, shape (n_genes,); differs from the position if the
            gene was moved.
        shares: Share of each parent in each value, shape (n_parents, n_genes): a single 1 for a gene of one parent; all
            0 for a new value. The shares of a blend can be negative or exceed 1.
    """

    parent: Indices
    gene: Indices
    shares: Floats


def trace_sources(
    operation: Operation, parents: Floats, genes: Genes, *, rng: Generator, involved: Sequence[int] | None = None
) -> Sources:
    """Find where each gene of the child that an operation produces comes from.

    Args:
        operation: Function that produces the child; it must return the same child for the same parents.
        parents: Genomes of the parents, shape (k, n_genes).
        genes: Gene table.
        rng: Random generator for the tags.
        involved: Indices of the parents that may contribute; all if None.

    Returns:
        Sources with indices into ``parents``. If the tags of a gene do not reach the child, for example because the
        operator rounds the gene, the first parent with the same value is the source.
    """
    rows = np.arange(len(parents)) if involved is None else np.unique(np.asarray(involved, dtype=np.intp))
    child = operation(parents)
    n_runs = max(MIN_TAG_RUNS, min(len(rows), MAX_BLENDED) + 1)
    trial = _run_tagged(operation, parents, child, genes, rows, n_runs, tag_counts=True, rng=rng)
    if trial is None:
        trial = _run_tagged(operation, parents, child, genes, rows, n_runs, tag_counts=False, rng=rng)
    values = parents[rows]
    parent = np.full(len(genes), NO_SOURCE)
    gene = np.full(len(genes), NO_SOURCE)
    shares = np.zeros((len(parents), len(genes)))

    def assign(j: int, row: int, column: int) -> None:
        parent[j] = rows[row]
        gene[j] = column
        shares[rows[row], j] = 1.0

    unresolved: list[int] = []
    for j in range(len(genes)):
        if trial is None:
            unresolved.append(j)
        elif (source := _find_source(trial, values, child, j)) is not None:
            assign(j, *source)
        elif (blend := trial.find_blend(j)) is not None and _is_blend_of(values[:, j], blend, child[j], j, genes):
            shares[rows, j] = blend
        else:
            unresolved.append(j)
    usual = _most_frequent_blend(shares[:, parent == NO_SOURCE])
    for j in unresolved:
        equal = np.flatnonzero(values[:, j] == child[j])
        if usual is not None and genes.is_count[j] and np.rint(usual @ parents[:, j]) == child[j]:
            shares[:, j] = usual
        elif len(equal):
            assign(j, int(equal[0]), j)
    return Sources(parent, gene, shares)


@dataclass(frozen=True, eq=False)
class _Trial:
    """Runs of an operation on tagged genomes.

    Attributes:
        tags: Tags of the parents in each run, shape (n_runs, n_rows, n_genes).
        tagged: Tagged genomes of the parents, same shape.
        results: Child of each run, shape (n_runs, n_genes).
        changes: Difference of each child from the original child, same shape.
    """

    tags: Floats
    tagged: Floats
    results: Floats
    changes: Floats

    def find_copy(self, j: int) -> tuple[int, int] | None:
        """Return the row and gene that gene ``j`` copies in every run; its own position is preferred."""
        is_copy = (self.tagged == self.results[:, j, np.newaxis, np.newaxis]).all(axis=0) & (self.tags != 0).all(axis=0)
        return _find_true_element(is_copy, j)

    def find_single_source(self, j: int) -> tuple[int, int] | None:
        """Return the row and gene whose tags are proportional to the changes of gene ``j`` in all runs."""
        changes = self.changes[:, j, np.newaxis, np.newaxis]
        if not changes.all():
            return None
        ratios = np.divide(changes, self.tags, out=np.full(self.tags.shape, np.nan), where=self.tags != 0)
        spread = np.ptp(ratios, axis=0)
        return _find_true_element(spread <= SHARE_TOLERANCE * np.abs(ratios[0]), j)

    def find_blend(self, j: int) -> Floats | None:
        """Return the share of each row in gene ``j`` that explains its changes in all runs, shape (n_rows,)."""
        tags = self.tags[:, :, j]
        changes = self.changes[:, j]
        if tags.shape[1] >= len(tags) or not changes.any():
            return None
        shares: Floats = np.linalg.lstsq(tags, changes, rcond=None)[0].astype(np.float64)
        is_explained = np.abs(tags @ shares - changes).max() <= SHARE_TOLERANCE * np.abs(changes).max()
        return np.round(shares, 6) if is_explained else None


def _find_source(trial: _Trial, values: Floats, child: Floats, j: int) -> tuple[int, int] | None:
    """Return the row and gene from which gene ``j`` of a child was copied, or computed without other genes."""
    copied = trial.find_copy(j)
    return copied if copied is not None and values[copied] == child[j] else trial.find_single_source(j)


def _run_tagged(
    operation: Operation,
    parents: Floats,
    child: Floats,
    genes: Genes,
    rows: Indices,
    n_runs: int,
    *,
    tag_counts: bool,
    rng: Generator,
) -> _Trial | None:
    """Run an operation on tagged genomes; return None if tags of counts change a count of the child.

    Tags point towards the middle of the range, so that no value leaves it; tags of counts point upward.
    """
    width = _widths(genes)
    middle = (genes.low + genes.high) / 2
    sizes = np.where(parents[rows] < middle, TAG_SIZE, -TAG_SIZE) * width
    sizes = np.where(genes.is_count, COUNT_TAG_SIZE if tag_counts else 0.0, sizes)
    tagged = parents[rows] + sizes * rng.uniform(0.5, 1.0, (n_runs, len(rows), len(genes)))
    results = np.empty((n_runs, len(genes)))
    for run, given in enumerate(tagged):
        whole = parents.copy()
        whole[rows] = given
        results[run] = operation(whole)
    changes = results - child
    changes = np.where(genes.is_cyclic, wrap(changes, -width / 2, width / 2), changes)
    if tag_counts and np.abs(changes[:, genes.is_count]).max(initial=0.0) > COUNT_TOLERANCE:
        return None
    return _Trial(tagged - parents[rows], tagged, results, changes)


def _widths(genes: Genes) -> Floats:
    """Return the width of the range of each gene; 1 for a range of a single value."""
    return np.where(genes.high > genes.low, genes.high - genes.low, 1.0)


def _find_true_element(mask: NDArray[np.bool_], j: int) -> tuple[int, int] | None:
    """Return row and column of a true element, preferably in column ``j``; None if all elements are false."""
    found = np.argwhere(mask)
    if not len(found):
        return None
    at_position = found[found[:, 1] == j]
    row, column = (at_position if len(at_position) else found)[0].tolist()
    return row, column


def _is_blend_of(values: Floats, shares: Floats, result: float, j: int, genes: Genes) -> bool:
    """Return whether a value is a blend; values of a cyclic gene can be blended the shorter way around.

    Args:
        values: Value of each parent, shape (n_rows,).
        shares: Share of each parent, same shape.
        result: Value of the child.
        j: Index of the gene.
        genes: Gene table.
    """
    width = _widths(genes)[j]
    difference = shares @ values - result
    if genes.is_cyclic[j]:
        turns = np.mod(values - values[0] + width / 2, width) - width / 2
        around = values[0] + shares @ turns - result
        differences = [np.mod(one + width / 2, width) - width / 2 for one in (difference, around)]
        difference = min(differences, key=abs)
    return bool(abs(difference) <= BLEND_TOLERANCE * width)


def _most_frequent_blend(shares: Floats) -> Floats | None:
    """Return the most frequent nonzero column of shares, shape (n_parents,); None if no column is nonzero."""
    blends, n_uses = np.unique(shares[:, shares.any(axis=0)], axis=1, return_counts=True)
    return blends[:, np.argmax(n_uses)] if len(n_uses) else None
