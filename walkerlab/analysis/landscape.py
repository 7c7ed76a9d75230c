"""Slices of the fitness landscape: the fitness of a genome in which one or two genes vary and all others are fixed."""

from collections.abc import Sequence
from concurrent.futures import Executor

import numpy as np
import pandas as pd

from walkerlab.analysis.inheritance import ROUNDING_TOLERANCE, shortest_change
from walkerlab.analysis.mating import AnyGenome
from walkerlab.ga.genes import Floats, Genes
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome
from walkerlab.genome.repair import GRID_DECIMALS, repair
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.simulation.evaluation import evaluate
from walkerlab.simulation.fitness import name_and_unit

MAX_VALUES_PER_GENE = 100


def landscape(
    genome: AnyGenome,
    settings: Settings | None = None,
    genes: str | Sequence[str] = ("frequency",),
    n: int = 20,
    executor: Executor | None = None,
    *,
    span: float = 1.0,
) -> pd.DataFrame:
    """Measure the fitness around a genome along one gene, or on a grid of two genes.

    All other genes keep their values. If repair must change genes to keep the robot within its limits, the column
    ``n_repaired`` counts them, and the robot is not exactly on the slice.

    Args:
        genome: Genome in the centre: a genome, its text, its values, or an individual.
        settings: Settings of the world, the limits and the fitness; the defaults if None.
        genes: Name of a gene, such as ``frequency`` or ``seg1.leg_length``; or the names of two genes.
        n: Number of values of each gene; for a count, at most the number of values in its range.
        executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        span: Fraction of the gene's range to cover, around the value of the genome; 1 for the whole range.

    Returns:
        Table with a row for each walk: a column with the value of each gene, ``fitness``, ``verdict``, ``distance`` in
        m, ``n_repaired``, ``is_centre`` for the walk of the genome itself, and ``genome`` as text. ``.attrs`` contains
        the genes, their units, the name and unit of the fitness, and the settings.

    Raises:
        ValueError: If ``genes`` does not name one gene or two different genes, or ``n`` or ``span`` is out of range.
    """
    settings = Settings() if settings is None else require_settings(settings)
    table = build_genes(settings.robot)
    names = [genes] if isinstance(genes, str) else list(genes)
    if len(names) not in (1, 2) or len(set(names)) != len(names):
        raise ValueError(f"genes must be the name of one gene or the names of two different genes; got {names}")
    if unknown := [name for name in names if name not in table.names]:
        raise ValueError(f"there is no gene {unknown[0]!r}; the genes are {', '.join(table.names)}")
    if not 2 <= n <= MAX_VALUES_PER_GENE:
        raise ValueError(
            f"n is {n}; it must be between 2 and {MAX_VALUES_PER_GENE}. It is the number of values of each gene."
        )
    if not 0 < span <= 1:
        raise ValueError(f"span is {span}; it must be above 0 and at most 1. It is a fraction of the gene's range.")
    centre = Genome.of(genome).within(settings.robot).values
    indices = [table.names.index(name) for name in names]
    axes = [_gene_values(table, j, centre[j], n, span) for j in indices]
    grid = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    wanted = np.concatenate([centre[indices][np.newaxis], grid])
    genomes = np.repeat(centre[np.newaxis], len(wanted), axis=0)
    genomes[:, indices] = wanted
    repaired = repair(genomes, settings.robot)
    walks = evaluate(repaired, settings, executor)
    is_changed = np.abs(shortest_change(genomes, repaired, table)) > ROUNDING_TOLERANCE
    columns = {
        **{name: wanted[:, position] for position, name in enumerate(names)},
        "fitness": [walk.fitness for walk in walks],
        "verdict": [walk.verdict for walk in walks],
        "distance": [walk.distance for walk in walks],
        "n_repaired": is_changed.sum(axis=1),
        "is_centre": np.arange(len(wanted)) == 0,
        "genome": [str(walk.genome) for walk in walks],
    }
    result = pd.DataFrame(columns)
    fitness, unit = name_and_unit(settings.algorithm.fitness)
    units = {name: table.units[j] for name, j in zip(names, indices, strict=True)}
    result.attrs = {"genes": names, "units": {**units, "fitness": unit, "distance": "m"}, "fitness": fitness}
    result.attrs["settings"] = settings
    return result


def _gene_values(genes: Genes, j: int, centre: float, n: int, span: float) -> Floats:
    """Return the values of a gene in ascending order: evenly spaced, rounded as by repair, and whole for a count."""
    low, high = float(genes.low[j]), float(genes.high[j])
    width = span * (high - low)
    start = min(max(low, centre - width / 2), high - width)
    if genes.is_count[j]:
        whole = np.arange(np.ceil(start), np.floor(start + width) + 1)
        return whole if len(whole) <= n else np.unique(np.rint(np.linspace(start, start + width, n)))
    values = np.linspace(start, start + width, n, endpoint=not (genes.is_cyclic[j] and span == 1))
    return np.unique(np.clip(np.round(values, GRID_DECIMALS), low, high))
