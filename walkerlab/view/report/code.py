"""Python code that repeats a run."""

from functools import partial
from typing import Any

import pandas as pd

from walkerlab.genome.breeding import slot_entries
from walkerlab.runfile.records import GIVEN, INSERTED_BY_HAND, birth_rows
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import function_name
from walkerlab.text.escape import printable

STEPS = ("fitness", "selection", "crossover", "mutation")
"""Settings of the algorithm that may be functions."""

BUILT_IN_MODULES = ("walkerlab.simulation.fitness", "walkerlab.ga.")
"""Prefixes of the names of modules whose functions the code can import."""


def as_python(settings: Settings, records: pd.DataFrame | None = None) -> str:
    """Return the code that repeats a run; it names user functions, but does not define them.

    Args:
        settings: Settings of the run.
        records: Table of the run. If given, the code evolves as many generations as the table contains and inserts the
            same genomes by hand. If None, it evolves the number of generations in the settings.
    """
    inserted: dict[int, list[str]] = {}
    given: list[str] = []
    if records is not None and not records.empty:
        settings = settings.with_(generations=int(records.generation.max()) + 1)
        inserted_births: Any = birth_rows(records.loc[records.operators == INSERTED_BY_HAND, :])
        for row in inserted_births.itertuples():
            inserted.setdefault(int(row.born), []).append(str(row.genome))
        is_given: Any = records.operators.str.startswith(GIVEN) & (records.generation == 0)
        given = records.genome[is_given].map(str).tolist()
    assignment = f"settings = {settings.as_python()}"
    changed = {} if records is None else records.attrs.get("stages", {})
    stages = [
        f"# From generation {first} on, the run was resumed with {printable(changes)}; this code has the last settings."
        for first, changes in changed.items()
    ]
    imports = {
        f"from {module} import {name}" for module, name in _functions(settings) if module.startswith(BUILT_IN_MODULES)
    }
    if any(isinstance(step, partial) for step in _steps(settings)):
        imports.add("from functools import partial")
    if "np." in assignment:
        imports.add("import numpy as np")
    population = ["population = [", *(f"    {text!r}," for text in given), "]"] if given else []
    arguments = "settings, population=population" if given else "settings"
    evolution = _insertion_lines(inserted, arguments) if inserted else [f"run = wl.evolve({arguments})"]
    lines = ["import walkerlab as wl", "", *stages, assignment, *population, *evolution, "run"]
    return "\n".join([*sorted(imports), *lines])


def _insertion_lines(inserted: dict[int, list[str]], arguments: str) -> list[str]:
    """Return the lines of code that evolve a run and insert genomes.

    Args:
        inserted: Texts of the genomes, keyed by the generation into which they are inserted.
        arguments: Arguments of ``Evolution``.
    """
    genomes = (f"    {number}: [{', '.join(map(repr, texts))}]," for number, texts in inserted.items())
    return [
        "inserted = {",
        *genomes,
        "}",
        f"evolution = wl.Evolution({arguments})",
        "for generation in evolution:",
        "    for genome in inserted.get(generation.number + 1, []):",
        "        evolution.insert(genome)",
        "    print(f'generation {generation.number}: best fitness {generation.champion.fitness:.3g}')",
        "run = evolution.run",
    ]


def user_functions(settings: Settings) -> list[str]:
    """Return the names of the user functions in the settings."""
    return [printable(name) for module, name in _functions(settings) if not module.startswith(BUILT_IN_MODULES)]


def _functions(settings: Settings) -> list[tuple[str, str]]:
    """Return the module and the name of each function in the settings."""
    functions = (step.func if isinstance(step, partial) else step for step in _steps(settings))
    return [
        (str(getattr(function, "__module__", "")), function_name(function))
        for function in functions
        if callable(function)
    ]


def _steps(settings: Settings) -> list[Any]:
    return [step for name in STEPS for step in slot_entries(getattr(settings.algorithm, name))]
