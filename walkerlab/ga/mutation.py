"""How children vary: ``mutate(genomes, genes, *, rng)`` changes a few genes, within their ranges.

A real gene that would leave its range is reflected back into it, a cyclic one goes round. A count that is
hit moves by whole steps, at least one; at an end of its range it turns round. So a hit gene really changes,
wherever its range leaves room.
"""

import numpy as np
from numpy.random import Generator

from walkerlab.ga.genes import Floats, Genes
from walkerlab.ga.ranges import reflect, wrap

FLOOR = 0.1
"""Least size that a step is measured by, as a part of the gene's range: without it a zero would stay a zero."""

FAVOR = 10.0
"""How many times likelier the favored feature is to change."""

MICRO = 0.2
"""The size of a micro step, as a part of a randomized one."""

UPHEAVAL = 5.0
"""How many times likelier a part is to come or go in a genome, under ``macro``, than one gene is to change."""


def randomized(genomes: Floats, genes: Genes, *, rate: float = 0.08, scale: float = 0.2, rng: Generator) -> Floats:
    """Give each gene the same chance to change, by an amount relative to its value.

    Args:
        genomes: (n, n_genes).
        genes: the gene table.
        rate: each gene's chance to change, 0 to 1.
        scale: the standard deviation of a step, as a part of the value (or of a tenth of the range, if larger).
        rng: the only source of chance.

    Returns:
        (n, n_genes)

    Raises:
        ValueError: if ``rate`` is outside 0 to 1.
    """
    return _change(genomes, genes, _relative_step(genomes, genes, scale, rng), rate=rate, rng=rng)


def favored(
    genomes: Floats,
    genes: Genes,
    *,
    favored: str = "leg_length",
    rate: float = 0.08,
    scale: float = 0.2,
    rng: Generator,
) -> Floats:
    """Change as ``randomized`` does, but one named feature ``FAVOR`` times likelier.

    Args:
        genomes: (n, n_genes).
        genes: the gene table.
        favored: a gene, or a feature of every part.
        rate: each other gene's chance to change, 0 to 1.
        scale: the standard deviation of a step, as a part of the value (or of a tenth of the range, if larger).
        rng: the only source of chance.

    Returns:
        (n, n_genes)

    Raises:
        ValueError: if no gene is called ``favored``, or ``rate`` is outside 0 to 1.
    """
    rates = np.full(len(genes), rate)
    rates[genes.find(favored)] = min(1.0, FAVOR * rate)
    return _change(genomes, genes, _relative_step(genomes, genes, scale, rng), rate=rates, rng=rng)


def micro(genomes: Floats, genes: Genes, *, rate: float = 0.08, scale: float = 0.2, rng: Generator) -> Floats:
    """Change as ``randomized`` does, by steps a fifth as large; counts stay, as a whole number has no small step.

    Args:
        genomes: (n, n_genes).
        genes: the gene table.
        rate: the chance to change of each gene that is not a count, 0 to 1.
        scale: as for ``randomized``, of which each step is a fifth.
        rng: the only source of chance.

    Returns:
        (n, n_genes)

    Raises:
        ValueError: if ``rate`` is outside 0 to 1.
    """
    rates = np.where(genes.is_count, 0.0, rate)
    return _change(genomes, genes, _relative_step(genomes, genes, MICRO * scale, rng), rate=rates, rng=rng)


def macro(genomes: Floats, genes: Genes, *, rate: float = 0.08, scale: float = 0.2, rng: Generator) -> Floats:
    """Draw the genes that are hit anew from their whole range, and let whole parts come and go.

    With a chance of ``UPHEAVAL`` times the rate, one grown part of a genome, any of them alike, is doubled
    beside itself (the last unexpressed part is lost for it) or dropped (it becomes the first of the unexpressed
    ones); the count follows, within its range. A copy is free to vary (gene duplication: Ohno 1970).

    Args:
        genomes: (n, n_genes).
        genes: the gene table.
        rate: each gene's chance to be drawn anew, 0 to 1; a count drawn as it was moves by one.
        scale: not needed, as a value drawn anew forgets the old one.
        rng: the only source of chance.

    Returns:
        (n, n_genes)

    Raises:
        ValueError: if ``rate`` is outside 0 to 1.
    """
    whole = genes.is_count.astype(float)  # a count's ends are as likely as what lies between them
    anew = genes.low - whole / 2 + (genes.high - genes.low + whole) * rng.random(genomes.shape)
    changed = _change(genomes, genes, anew - genomes, rate=rate, rng=rng)
    for i in np.flatnonzero(rng.random(len(genomes)) < UPHEAVAL * rate):
        changed[i] = _come_or_go(changed[i], genes, rng)
    return changed


def gaussian(genomes: Floats, genes: Genes, *, rate: float = 0.08, scale: float = 0.2, rng: Generator) -> Floats:
    """Give each gene the same chance to change, by an amount relative to its range.

    Args:
        genomes: (n, n_genes).
        genes: the gene table.
        rate: each gene's chance to change, 0 to 1.
        scale: the standard deviation of a step, as a part of the range.
        rng: the only source of chance.

    Returns:
        (n, n_genes)

    Raises:
        ValueError: if ``rate`` is outside 0 to 1.
    """
    step = scale * (genes.high - genes.low) * rng.standard_normal(genomes.shape)
    return _change(genomes, genes, step, rate=rate, rng=rng)


def _relative_step(genomes: Floats, genes: Genes, scale: float, rng: Generator) -> Floats:
    size = np.maximum(np.abs(genomes), FLOOR * (genes.high - genes.low))
    return scale * size * rng.standard_normal(genomes.shape)


def _change(genomes: Floats, genes: Genes, step: Floats, *, rate: float | Floats, rng: Generator) -> Floats:
    """Let each gene take its step with its chance, and stay in its range."""
    if not np.all((np.asarray(rate) >= 0) & (np.asarray(rate) <= 1)):
        raise ValueError(f"rate is {np.max(rate)}; it must be 0 to 1. It is the chance of each gene to change.")
    hit = rng.random(genomes.shape) < rate
    moved = np.where(
        genes.is_cyclic,
        wrap(genomes + step, genes.low, genes.high),
        reflect(genomes + step, genes.low, genes.high),
    )
    moved = np.where(genes.is_count, _whole_steps(genomes, genes, step), moved)
    return np.where(hit, moved, genomes)


def _whole_steps(genomes: Floats, genes: Genes, step: Floats) -> Floats:
    """Move by whole steps, at least one, as far as the range goes; whoever stands at its end turns round."""
    start = np.rint(genomes)
    length = np.maximum(np.rint(np.abs(step)), 1)
    rises = np.where(step > 0, start < genes.high, start <= genes.low)
    return np.clip(start + np.where(rises, length, -length), genes.low, genes.high)


def _come_or_go(genome: Floats, genes: Genes, rng: Generator) -> Floats:
    """Double one grown part of a (n_genes,) genome beside itself, or drop one; see ``macro``."""
    if genes.count is None:
        return genome
    n_grown = int(genes.n_grown(genome[None])[0])
    may_double = 0 < n_grown < min(genes.n_parts, genes.high[genes.count])
    may_drop = n_grown > max(0, genes.low[genes.count])
    if not (may_double or may_drop):
        return genome

    part = int(rng.integers(n_grown))
    order = list(range(genes.n_parts))
    doubles = may_double and (not may_drop or rng.random() < 1 / 2)
    if doubles:
        order.insert(part, part)
        order.pop()
    else:
        order.insert(n_grown - 1, order.pop(part))

    changed = genome[None].copy()
    genes.parts(changed)[:] = genes.parts(genome[None])[:, order]
    changed[0, genes.count] = n_grown + (1 if doubles else -1)
    return changed[0]
