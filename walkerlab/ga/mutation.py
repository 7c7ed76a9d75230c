"""Mutation operators: ``mutate(genomes, genes, *, rng)`` changes a few genes within their ranges.

A value of a real-valued gene that would leave its range is reflected at the boundary; a cyclic gene wraps around. A
count changes by one or more whole steps; at an end of its range it moves inward. A gene selected for mutation therefore
always changes, unless its range is a single value.
"""

import numpy as np
from numpy.random import Generator

from walkerlab.ga.genes import Floats, Genes
from walkerlab.ga.ranges import reflect, wrap

MIN_STEP_REFERENCE = 0.1
"""Lower bound on the magnitude by which a relative step is scaled, as a fraction of the gene's range.

It allows a gene whose value is zero to change.
"""

FAVORED_RATE_FACTOR = 10.0
"""Ratio of the favoured feature's mutation rate to the rate of the other genes."""

MICRO_STEP_FACTOR = 0.2
"""Ratio of a step of ``micro`` to one of ``randomized``."""

PART_RATE_FACTOR = 5.0
"""Probability that ``macro`` duplicates or drops a part of a genome, as a multiple of the mutation rate of a gene."""


def randomized(genomes: Floats, genes: Genes, *, rate: float = 0.04, scale: float = 0.1, rng: Generator) -> Floats:
    """Change each gene with the same probability, by an amount relative to its value.

    Args:
        genomes: Genomes, shape (n, n_genes).
        genes: Gene table.
        rate: Probability that a gene changes, 0 to 1.
        scale: Standard deviation of a step, relative to the value (or to a tenth of the range, if larger).
        rng: Random number generator.

    Returns:
        Mutated genomes, shape (n, n_genes).

    Raises:
        ValueError: If ``rate`` is not between 0 and 1.
    """
    return _apply_steps(genomes, genes, _relative_step(genomes, genes, scale, rng), rate=rate, rng=rng)


def favored(
    genomes: Floats,
    genes: Genes,
    *,
    favored: str = "leg_length",
    rate: float = 0.04,
    scale: float = 0.1,
    rng: Generator,
) -> Floats:
    """Change genes as ``randomized`` does, but one feature at ``FAVORED_RATE_FACTOR`` times the rate.

    Args:
        genomes: Genomes, shape (n, n_genes).
        genes: Gene table.
        favored: Name of a single gene, or of a feature that every part has.
        rate: Probability that any other gene changes, 0 to 1.
        scale: Standard deviation of a step, relative to the value (or to a tenth of the range, if larger).
        rng: Random number generator.

    Returns:
        Mutated genomes, shape (n, n_genes).

    Raises:
        ValueError: If there is no gene named ``favored``, or ``rate`` is not between 0 and 1.
    """
    rates = np.full(len(genes), rate)
    rates[genes.find(favored)] = min(1.0, FAVORED_RATE_FACTOR * rate)
    return _apply_steps(genomes, genes, _relative_step(genomes, genes, scale, rng), rate=rates, rng=rng)


def micro(genomes: Floats, genes: Genes, *, rate: float = 0.04, scale: float = 0.1, rng: Generator) -> Floats:
    """Change genes as ``randomized`` does, by steps a fifth as large; counts, which have no small steps, do not change.

    Args:
        genomes: Genomes, shape (n, n_genes).
        genes: Gene table.
        rate: Probability that a gene that is not a count changes, 0 to 1.
        scale: Standard deviation of a step of ``randomized``; steps here are a fifth as large.
        rng: Random number generator.

    Returns:
        Mutated genomes, shape (n, n_genes).

    Raises:
        ValueError: If ``rate`` is not between 0 and 1.
    """
    rates = np.where(genes.is_count, 0.0, rate)
    return _apply_steps(
        genomes, genes, _relative_step(genomes, genes, MICRO_STEP_FACTOR * scale, rng), rate=rates, rng=rng
    )


def macro(genomes: Floats, genes: Genes, *, rate: float = 0.04, scale: float = 0.1, rng: Generator) -> Floats:
    """Give some genes new values drawn from their whole range, and duplicate or drop whole parts.

    With a probability of ``PART_RATE_FACTOR`` times the rate, one expressed part of a genome, drawn uniformly, is
    duplicated next to itself (the last unexpressed part is lost) or dropped (it becomes the first unexpressed part);
    the count changes accordingly, within its range. A copy can then evolve independently
    (gene duplication: Ohno 1970).

    Args:
        genomes: Genomes, shape (n, n_genes).
        genes: Gene table.
        rate: Probability that a gene receives a new random value, 0 to 1; a count that draws its old value again
            changes by one.
        scale: Unused, because the drawn value does not depend on the old one.
        rng: Random number generator.

    Returns:
        Mutated genomes, shape (n, n_genes).

    Raises:
        ValueError: If ``rate`` is not between 0 and 1.
    """
    extra = genes.is_count.astype(float)  # half a step at each end makes all whole numbers equally probable
    drawn = genes.low - extra / 2 + (genes.high - genes.low + extra) * rng.random(genomes.shape)
    changed = _apply_steps(genomes, genes, drawn - genomes, rate=rate, rng=rng)
    for i in np.flatnonzero(rng.random(len(genomes)) < PART_RATE_FACTOR * rate):
        changed[i] = _duplicate_or_drop_part(changed[i], genes, rng)
    return changed


def gaussian(genomes: Floats, genes: Genes, *, rate: float = 0.04, scale: float = 0.1, rng: Generator) -> Floats:
    """Change each gene with the same probability, by an amount relative to its range.

    Args:
        genomes: Genomes, shape (n, n_genes).
        genes: Gene table.
        rate: Probability that a gene changes, 0 to 1.
        scale: Standard deviation of a step, relative to the range.
        rng: Random number generator.

    Returns:
        Mutated genomes, shape (n, n_genes).

    Raises:
        ValueError: If ``rate`` is not between 0 and 1.
    """
    step = scale * (genes.high - genes.low) * rng.standard_normal(genomes.shape)
    return _apply_steps(genomes, genes, step, rate=rate, rng=rng)


def _relative_step(genomes: Floats, genes: Genes, scale: float, rng: Generator) -> Floats:
    reference = np.maximum(np.abs(genomes), MIN_STEP_REFERENCE * (genes.high - genes.low))
    return scale * reference * rng.standard_normal(genomes.shape)


def _apply_steps(genomes: Floats, genes: Genes, step: Floats, *, rate: float | Floats, rng: Generator) -> Floats:
    """Add each gene's step with probability ``rate``, and bring the result into its range."""
    if not np.all((np.asarray(rate) >= 0) & (np.asarray(rate) <= 1)):
        raise ValueError(
            f"rate is {np.max(rate)}; it must be between 0 and 1. It is the probability that a gene changes."
        )
    is_mutated = rng.random(genomes.shape) < rate
    moved = np.where(
        genes.is_cyclic,
        wrap(genomes + step, genes.low, genes.high),
        reflect(genomes + step, genes.low, genes.high),
    )
    moved = np.where(genes.is_count, _add_whole_steps(genomes, genes, step), moved)
    return np.where(is_mutated, moved, genomes)


def _add_whole_steps(genomes: Floats, genes: Genes, step: Floats) -> Floats:
    """Add steps rounded to whole numbers, at least one, but stay within the range; at an end, step inward."""
    start = np.rint(genomes)
    length = np.maximum(np.rint(np.abs(step)), 1)
    rises = np.where(step > 0, start < genes.high, start <= genes.low)
    return np.clip(start + np.where(rises, length, -length), genes.low, genes.high)


def _duplicate_or_drop_part(genome: Floats, genes: Genes, rng: Generator) -> Floats:
    """Duplicate one expressed part of a genome, shape (n_genes,), next to itself, or drop one; see ``macro``."""
    if genes.count is None:
        return genome
    n_expressed = int(genes.n_expressed(genome[None])[0])
    can_duplicate = 0 < n_expressed < min(genes.n_parts, genes.high[genes.count])
    can_drop = n_expressed > max(0, genes.low[genes.count])
    if not (can_duplicate or can_drop):
        return genome

    part = int(rng.integers(n_expressed))
    order = list(range(genes.n_parts))
    duplicates = can_duplicate and (not can_drop or rng.random() < 1 / 2)
    if duplicates:
        order.insert(part, part)
        order.pop()
    else:
        order.insert(n_expressed - 1, order.pop(part))

    changed = genome[None].copy()
    genes.parts(changed)[:] = genes.parts(genome[None])[:, order]
    changed[0, genes.count] = n_expressed + (1 if duplicates else -1)
    return changed[0]
