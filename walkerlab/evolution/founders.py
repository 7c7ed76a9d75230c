"""Genomes that users give for generation 0, and the origin of each."""

from collections.abc import Iterable
from typing import Any, TypeAlias, cast

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from walkerlab.evolution.run import Run
from walkerlab.ga.genes import Floats
from walkerlab.genome.features import build_genes
from walkerlab.genome.frozen import frozen_features, repair_frozen
from walkerlab.genome.genome import Genome, HasGenome, read_genomes
from walkerlab.genome.repair import repair
from walkerlab.runfile.history import Founder
from walkerlab.runfile.records import GIVEN
from walkerlab.settings.model import SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import code_text
from walkerlab.text.escape import printable

FirstPopulation: TypeAlias = Run | pd.DataFrame | Iterable[Genome | str | ArrayLike | HasGenome | Founder]
"""Genomes, strings, arrays or individuals; or a run or its table, whose last generation is used, best first."""


def read_founders(
    given: FirstPopulation | None, settings: Settings, argument: str = "population=[genome]"
) -> tuple[Founder, ...]:
    """Return the genomes given for generation 0, within the limits.

    Args:
        given: Genomes, a run or a table; if None, no genomes are returned.
        settings: Settings of the new run.
        argument: How to give a genome, for the error message.

    Raises:
        GenomeError: If a string is not a valid genome.
        ValueError: If a genome is not valid, there are no genomes or too many, or genes are frozen but no genome is
            given.
        TypeError: If ``given`` is something other than genomes, a run or a table.
    """
    size = settings.algorithm.population_size
    founders = [] if given is None else _read(given, size)
    if given is not None and not founders:
        raise ValueError("population is empty; pass at least one genome, or leave it out for a random first generation")
    if len(founders) > size:
        raise ValueError(
            f"population has {len(founders)} genomes; Algorithm.population_size is {size}. Pass fewer, or raise it: "
            f"settings.with_(population_size={len(founders)})"
        )
    if frozen_features(settings.algorithm.frozen) and not founders:
        raise SettingsError(
            f"Algorithm.frozen is {code_text(settings.algorithm.frozen)}, but there is no genome whose values the "
            f"frozen genes keep. Pass one: {argument}"
        )
    return tuple(
        Founder(str(Genome.parse(founder.genome).within(settings.robot)), founder.origin) for founder in founders
    )


def fit_genomes(genomes: Floats, settings: Settings, founders: tuple[Founder, ...]) -> Floats:
    """Return (n, n_genes) genomes within the limits, with the frozen genes of the first founder."""
    features = frozen_features(settings.algorithm.frozen)
    if not features:
        return repair(genomes, settings.robot)
    reference = Genome.parse(founders[0].genome).values
    return repair_frozen(genomes, settings.robot, features, reference)


def place_founders(genomes: Floats, settings: Settings, founders: tuple[Founder, ...]) -> Floats:
    """Return the genomes of generation 0: the founders, then random ones.

    Args:
        genomes: Random genomes, shape (n, n_genes).
        settings: Settings of the run.
        founders: Genomes given for generation 0.
    """
    if not founders:
        return genomes
    given = np.array([Genome.parse(founder.genome).values for founder in founders])
    assert given.shape[1] == len(build_genes(settings.robot))
    return fit_genomes(np.concatenate([given, genomes[len(given) :]]), settings, founders)


def _read(given: Any, size: int) -> list[Founder]:
    """Return genomes with their origins, not yet within the limits."""
    if isinstance(given, Run):
        name = f" of {printable(given.path.name)}" if given.path else ""
        return _read_table(given.records, size, name)
    if isinstance(given, pd.DataFrame):
        return _read_table(given, size, "")
    if isinstance(given, tuple) and all(isinstance(item, Founder) for item in cast(tuple[Any, ...], given)):
        return list(cast(tuple[Founder, ...], given))
    genomes = read_genomes(given)
    numbers = [getattr(item, "individual", None) for item in cast(Iterable[Any], given)]
    return [
        Founder(str(genome), GIVEN if number is None else f"{GIVEN}: robot {int(number)}")
        for genome, number in zip(genomes, numbers, strict=True)
    ]


def _read_table(table: pd.DataFrame, size: int, of_run: str) -> list[Founder]:
    """Return the robots of the last generation of a table, best first, at most as many as a generation has.

    Raises:
        ValueError: If the table is not the table of a run.
    """
    required = {"generation", "individual", "fitness", "genome"}
    if missing := sorted(required - set(table.columns)):
        raise ValueError(f"population is a table without the column {missing[0]}; pass the table of a run: run.records")
    last = table.loc[table.generation == table.generation.max(), :]
    best: Any = last.sort_values("fitness", ascending=False, kind="stable").head(size)
    return [Founder(str(row.genome), f"{GIVEN}: robot {int(row.individual)}{of_run}") for row in best.itertuples()]
