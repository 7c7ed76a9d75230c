"""One birth, gene by gene: which parent each gene comes from, and what mutation and repair changed."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walkerlab.analysis.tracing import NO_SOURCE, Sources
from walkerlab.ga.genes import Floats, Genes
from walkerlab.ga.ranges import wrap
from walkerlab.genome.features import is_expressed
from walkerlab.genome.genome import Genome
from walkerlab.genome.repair import GRID_DECIMALS
from walkerlab.system.readonly import ReadOnlyArrays

Origin = Literal["parent", "same", "blend", "new"]
"""Where a gene comes from: one parent, parents that have the same value, a blend of parents, or none of them."""

ROUNDING_TOLERANCE = 0.51 * 10.0**-GRID_DECIMALS
"""Changes by repair up to this size only round a value to the grid."""

SAME_TOLERANCE = 1e-9
"""Differences from a parent's value up to this size, as a fraction of the gene's range, are rounding errors."""


@dataclass(frozen=True, eq=False)
class Birth(ReadOnlyArrays):
    """Origin and changes of each gene of one child.

    A gene passes through three steps: crossover takes it from the parents, mutation changes it, and repair brings it
    within the limits of the robots and rounds it.

    Attributes:
        genes: Gene table.
        parents: Genomes of the parents that contributed, shape (n_parents, n_genes).
        names: Name of each parent, such as ``robot 12``.
        sources: Where each gene comes from.
        inherited: Values before mutation, shape (n_genes,). If mutation moved a gene, its value is at the new position.
        mutated: Values after mutation, shape (n_genes,).
        child: Values after repair, shape (n_genes,).
        name: Name of the child.
        operators: Names of the operators that produced the child, in the order in which they were applied.
        is_exact: Whether the sources were traced through the operators; otherwise they were inferred from the values.
    """

    genes: Genes
    parents: Floats
    names: tuple[str, ...]
    sources: Sources
    inherited: Floats
    mutated: Floats
    child: Floats
    name: str = "child"
    operators: tuple[str, ...] = ()
    is_exact: bool = True

    @property
    def genome(self) -> Genome:
        """Genome of the child."""
        return Genome(self.child)

    @cached_property
    def origins(self) -> tuple[Origin, ...]:
        """Origin of each gene, length n_genes."""
        return tuple(self._origin(j) for j in range(len(self.genes)))

    def _origin(self, j: int) -> Origin:
        parent = self.sources.parent[j]
        if parent == NO_SOURCE:
            return "blend" if self.sources.shares[:, j].any() else "new"
        gene = self.sources.gene[j]
        is_same = gene == j and len(self.parents) > 1 and (self.parents[:, j] == self.parents[parent, j]).all()
        return "same" if is_same else "parent"

    @property
    def is_moved(self) -> NDArray[np.bool_]:
        """Whether each gene comes from another position of its parent's genome, shape (n_genes,)."""
        return (self.sources.gene != NO_SOURCE) & (self.sources.gene != np.arange(len(self.genes)))

    @property
    def is_expressed(self) -> NDArray[np.bool_]:
        """Whether each gene has an effect on the child, shape (n_genes,)."""
        return is_expressed(self.child[np.newaxis])[0]

    @property
    def crossover(self) -> Floats:
        """Change of each gene from a single parent by crossover, in the gene's unit, shape (n_genes,)."""
        has_source = self.sources.parent != NO_SOURCE
        values = np.where(has_source, self.parents[self.sources.parent, self.sources.gene], self.inherited)
        change = shortest_change(values, self.inherited, self.genes)
        return np.where(np.abs(change) > SAME_TOLERANCE * gene_widths(self.genes), change, 0.0)

    @property
    def mutation(self) -> Floats:
        """Change of each gene by mutation, in its unit, shape (n_genes,); the shorter way around for a cyclic gene."""
        return shortest_change(self.inherited, self.mutated, self.genes)

    @property
    def repair(self) -> Floats:
        """Change of each gene by repair, in its unit, including rounding, shape (n_genes,)."""
        return shortest_change(self.mutated, self.child, self.genes)

    @property
    def is_repaired(self) -> NDArray[np.bool_]:
        """Whether repair changed each gene by more than rounding, shape (n_genes,)."""
        return np.abs(self.repair) > ROUNDING_TOLERANCE

    @property
    def change(self) -> Floats:
        """Change of each gene by all three steps, in its unit, shape (n_genes,); 0 if repair only rounded it."""
        repaired = np.where(self.is_repaired | (self.mutation != 0) | (self.crossover != 0), self.repair, 0.0)
        return self.crossover + self.mutation + repaired

    @property
    def table(self) -> pd.DataFrame:
        """Table with a row for each gene: origin, values and changes.

        ``change`` is the change by all steps as a share of the gene's range. ``source`` is the parent's gene from
        which the value comes, and ``share A`` is the share of parent A in the inherited value.
        """
        letters = list(map(parent_letter, range(len(self.names))))
        parents = [letters[parent] if parent != NO_SOURCE else "" for parent in self.sources.parent]
        columns = {
            "gene": self.genes.names,
            "unit": self.genes.units,
            "expressed": self.is_expressed,
            "origin": [
                one if origin == "parent" else origin for one, origin in zip(parents, self.origins, strict=True)
            ],
            "source": [self.genes.names[gene] if gene != NO_SOURCE else "" for gene in self.sources.gene],
            **{f"parent {letter}": values for letter, values in zip(letters, self.parents, strict=True)},
            **{f"share {letter}": shares for letter, shares in zip(letters, self.sources.shares, strict=True)},
            "inherited": self.inherited,
            "mutated": self.mutated,
            "child": self.child,
            "crossover": self.crossover,
            "mutation": self.mutation,
            "repair": self.repair,
            "change": self.change / gene_widths(self.genes),
        }
        table = pd.DataFrame(columns)
        table.attrs["parents"] = dict(zip(letters, self.names, strict=True))
        return table


def parent_letter(parent: int) -> str:
    """Return the letter of a parent: A to Z, then A2, B2 and so on."""
    n_rounds, letter = divmod(parent, 26)
    return f"{chr(ord('A') + letter)}{n_rounds + 1 if n_rounds else ''}"


def shortest_change(before: Floats, after: Floats, genes: Genes) -> Floats:
    """Return the changes of genes in their units; the shorter way around for cyclic genes.

    Args:
        before: Genomes, shape (…, n_genes).
        after: Genomes, same shape.
        genes: Gene table.
    """
    difference = after - before
    half_turn = (genes.high - genes.low) / 2
    return np.where(genes.is_cyclic, wrap(difference, -half_turn, half_turn), difference)


def gene_widths(genes: Genes) -> Floats:
    """Return the width of the range of each gene, shape (n_genes,); 1 for a range of a single value."""
    return np.where(genes.high > genes.low, genes.high - genes.low, 1.0)
