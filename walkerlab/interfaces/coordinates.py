"""Normalised coordinates of genomes: a number from 0 to 1 for each gene that is free to vary."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkerlab.ga.genes import Floats, Genes
from walkerlab.genome.features import is_expressed
from walkerlab.genome.frozen import frozen_features
from walkerlab.settings.choices import Feature
from walkerlab.settings.settings import Settings
from walkerlab.system.readonly import ReadOnlyArrays

BODY_PLAN = frozenset({Feature.segments, Feature.legs, Feature.repeat})
"""Features that determine which other genes have an effect."""


def find_free_genes(settings: Settings, genes: Genes, reference: Floats) -> NDArray[np.bool_]:
    """Return which genes are free to vary, shape (n_all_genes,).

    A gene is free if it is not frozen, can have more than one value and, if the body plan is frozen, has an effect.

    Args:
        settings: Settings; ``frozen`` names the frozen genes.
        genes: Gene table.
        reference: Genome with the values of the frozen genes, shape (n_all_genes,).
    """
    features = frozen_features(settings.algorithm.frozen)
    frozen = {feature.name for feature in features}
    free = np.array([name.rpartition(".")[2] not in frozen for name in genes.names])
    free &= genes.high > genes.low
    return free & is_expressed(reference[np.newaxis])[0] if features >= BODY_PLAN else free


@dataclass(frozen=True, eq=False)
class Coordinates(ReadOnlyArrays):
    """The map between points and gene values.

    Attributes:
        genes: Gene table.
        is_free: Whether each gene has a coordinate, shape (n_all_genes,).
        reference: Genome with the values of the other genes, shape (n_all_genes,).
    """

    genes: Genes
    is_free: NDArray[np.bool_]
    reference: Floats

    @property
    def low(self) -> Floats:
        """Minimum of each free gene, shape (n_free,)."""
        return self.genes.low[self.is_free]

    @property
    def high(self) -> Floats:
        """Maximum of each free gene, shape (n_free,)."""
        return self.genes.high[self.is_free]

    def encode(self, genomes: Floats) -> Floats:
        """Return the points of genomes, shape (n, n_free); a whole number has the middle of its interval."""
        values = genomes[:, self.is_free]
        share = (values - self.low) / (self.high - self.low)
        middle = (values - self.low + 0.5) / (self.high - self.low + 1)
        return np.where(self.genes.is_count[self.is_free], middle, share)

    def decode(self, points: ArrayLike) -> Floats:
        """Return the genomes at points before their repair, shape (n, n_all_genes).

        Raises:
            ValueError: If the shape is wrong, or a coordinate is not finite.
        """
        given = np.asarray(points, dtype=np.float64)
        n_free = int(self.is_free.sum())
        if given.ndim != 2 or given.shape[1] != n_free:
            raise ValueError(
                f"points must have the shape (n, {n_free}), with a column for each free gene; got {given.shape}"
            )
        if not np.isfinite(given).all():
            row, column = np.argwhere(~np.isfinite(given))[0]
            raise ValueError(f"point {row}: coordinate {column} is {given[row, column]}; it must be a finite number")
        is_beyond = (given < 0) | (given > 1)
        share = np.where(self.genes.is_cyclic[self.is_free] & is_beyond, given % 1, given.clip(0, 1))
        count = np.minimum(np.floor(self.low + share * (self.high - self.low + 1)), self.high)
        real = self.low * (1 - share) + self.high * share
        genomes = np.tile(self.reference, (len(given), 1))
        genomes[:, self.is_free] = np.where(self.genes.is_count[self.is_free], count, real)
        return genomes
