"""Distances between genomes of robots with different numbers of segments: the bodies are aligned at the front."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkerlab.ga.genes import Floats, Genes
from walkerlab.genome.features import BODY_FEATURES, SEGMENT_FEATURES, build_genes, is_expressed
from walkerlab.genome.genome import Genome, read_genomes
from walkerlab.settings.robot import Robot


def aligned_distances(genomes: Iterable[Genome | str | ArrayLike]) -> Floats:
    """Return the distance between each pair of genomes: the typical difference of two robots in one gene.

    The bodies are compared segment by segment, from the front. A gene that has an effect on both robots contributes the
    difference of its values, as a fraction of its range in the default limits. For a cyclic gene, the difference is the
    chord between two points on a circle, as a fraction of the diameter. A gene that has an effect on only one of the
    robots contributes 1, for example a gene of a segment or of legs that the other robot lacks. Genes without an effect
    on either robot are left out. The distance is the root mean square of the contributions, from 0 to 1.

    Args:
        genomes: Genomes or their texts; their numbers of segments, expressed or not, may differ.

    Returns:
        Distances, shape (n, n); symmetric, with zeros on the diagonal.

    Raises:
        GenomeError: If a string is not a valid genome.
    """
    values, genes = _align(read_genomes(genomes))
    return np.sqrt(_mean_squares(values, genes))


def aligned_diversity(genomes: Iterable[Genome | str | ArrayLike]) -> float:
    """Return the diversity of a population: the root mean square of ``aligned_distances`` over all pairs.

    Args:
        genomes: Genomes or their texts; the diversity of fewer than two is 0.
    """
    values, genes = _align(read_genomes(genomes))
    n = len(values)
    return float(np.sqrt(_mean_squares(values, genes).sum() / (n * (n - 1)))) if n > 1 else 0.0


def _align(genomes: Sequence[Genome]) -> tuple[Floats, Genes]:
    """Return the values of genomes with zeros for the segments that a genome lacks, and their gene table."""
    n_parts = max((genome.n_parts for genome in genomes), default=1)
    genes = build_genes(Robot(segments=(1, n_parts), legs=(2, 2 * n_parts)))
    values = np.zeros((len(genomes), len(BODY_FEATURES) + n_parts * len(SEGMENT_FEATURES)))
    for row, genome in zip(values, genomes, strict=True):
        row[: len(genome.values)] = genome.values
    return values, genes


def _mean_squares(values: Floats, genes: Genes) -> Floats:
    """Return the mean square difference of each pair of robots over the genes with an effect on at least one of them.

    Args:
        values: Aligned genomes, shape (n, n_genes).
        genes: Gene table; differences are fractions of its ranges.

    Returns:
        Mean squares, shape (n, n).
    """
    expressed = is_expressed(values)
    position = (values - genes.low) / np.where(genes.high > genes.low, genes.high - genes.low, 1)
    return np.array(
        [
            _mean_squares_to(row, has_effect, position, expressed, genes.is_cyclic)
            for row, has_effect in zip(position, expressed, strict=True)
        ]
    ).reshape(len(values), len(values))


def _mean_squares_to(
    row: Floats,
    has_effect: NDArray[np.bool_],
    position: Floats,
    expressed: NDArray[np.bool_],
    cyclic: NDArray[np.bool_],
) -> Floats:
    """Return the mean square difference between one robot and each of the others, shape (n,)."""
    difference = position - row
    squares = np.where(cyclic, np.sin(np.pi * difference) ** 2, np.minimum(difference**2, 1.0))
    squares = np.where(expressed & has_effect, squares, expressed ^ has_effect)
    return squares.sum(axis=1) / (expressed | has_effect).sum(axis=1)
