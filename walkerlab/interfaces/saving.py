"""Save the evaluations of any optimiser as a run."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from walkerlab.evolution.rerating import function_facts
from walkerlab.evolution.run import Run
from walkerlab.evolution.stored_functions import check_storable
from walkerlab.runfile import paths
from walkerlab.runfile.archive import Archive
from walkerlab.runfile.history import Founder, History
from walkerlab.runfile.records import EvaluationRow, tidy_table
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import short_repr

MIN_GENERATION = Settings().algorithm.declared()["population_size"].low  # type: ignore[union-attr]
MAX_NAME = 80  # characters of the name of an optimiser


def save_evaluations(
    evaluated: Sequence[EvaluationRow],
    settings: Settings,
    path: str | Path | None,
    optimiser: str,
    size: int,
    founders: tuple[Founder, ...] = (),
) -> Run:
    """Divide evaluations into generations of the same size, and save them as a run.

    Args:
        evaluated: Evaluations in their order.
        settings: Settings of the evaluations.
        path: Run file to create; if None, the run is only in memory.
        optimiser: Name of the optimiser.
        size: Number of robots of a generation.
        founders: Genome with the values of frozen genes, if there is one.

    Raises:
        RunFileError: If ``path`` exists already or cannot be created.
        SettingsError: If the settings cannot be stored in a run file.
        ValueError: If there are too few evaluations, or the name cannot be stored.
    """
    if len(evaluated) < MIN_GENERATION:
        raise ValueError(f"{len(evaluated)} robots were evaluated; a run requires at least {MIN_GENERATION}")
    if not MIN_GENERATION <= size <= len(evaluated):
        raise ValueError(
            f"generation is {size}; it must be from {MIN_GENERATION} to {len(evaluated)}, the number of evaluations"
        )
    if not optimiser.isprintable() or not 0 < len(optimiser) <= MAX_NAME:
        raise ValueError(f"optimiser is {short_repr(optimiser)}; it must be a name of at most {MAX_NAME} characters")
    tables = _divide(evaluated, optimiser, size)
    n_elites = min(settings.algorithm.n_elites, size - 1)
    stored = settings.with_(population_size=size, generations=len(tables), n_elites=n_elites)
    return save_generations(tables, stored, path, founders)


def save_generations(
    tables: Sequence[pd.DataFrame], settings: Settings, path: str | Path | None, founders: tuple[Founder, ...]
) -> Run:
    """Save the tables of generations as a run; arguments and errors as for ``save_evaluations``."""
    if path is not None:
        check_storable(settings)
        path = paths.new_path(path)
        archive = Archive.create(settings.model_dump(), path, History(founders))
        for table in tables:
            archive.add(table, function_facts(settings))
    joined = tidy_table(pd.concat(tables, ignore_index=True))
    return Run(settings, joined, path, founders=founders)


def _divide(evaluated: Sequence[EvaluationRow], optimiser: str, size: int) -> list[pd.DataFrame]:
    """Return the table of each generation; the best earlier robots complete the last one."""
    columns: dict[str, Any] = dict(zip(EvaluationRow._fields, zip(*evaluated, strict=True), strict=True))
    table = pd.DataFrame(columns)
    numbers = np.arange(len(table))
    table["generation"] = table["born"] = numbers // size
    table["individual"] = numbers
    table["parents"] = ""
    table["operators"] = optimiser
    n_missing = -len(table) % size
    last = int(table.generation.iloc[-1])
    earlier = table.loc[table.generation < last]
    elites = earlier.sort_values("fitness", ascending=False, kind="stable").head(n_missing).assign(generation=last)
    return [
        tidy_table(pd.concat([elites, rows]) if number == last else rows)
        for number, rows in table.groupby("generation")
    ]
