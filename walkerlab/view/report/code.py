"""The code that repeats a run."""

from functools import partial
from typing import Any

import pandas as pd

from walkerlab.breeding import in_turn
from walkerlab.runfile.records import BY_HAND, births
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import function_name
from walkerlab.text.html import printable

STEPS = ("fitness", "selection", "crossover", "mutation")
OURS = ("walkerlab.fitness", "walkerlab.ga.")


def as_python(settings: Settings, records: pd.DataFrame | None = None) -> str:
    """Write the code that repeats a run; a user's own functions are named, and not defined.

    Args:
        settings: of the run.
        records: its table; with it, the code makes as many generations as there are, and puts into them whatever was
            put in by hand. Without, it makes as many as the settings say.
    """
    by_hand = dict[int, list[str]]()
    if records is not None and not records.empty:
        settings = settings.with_(generations=int(records.generation.max()) + 1)
        born: Any = births(records.loc[records.operators == BY_HAND, :])
        for row in born.itertuples():
            by_hand.setdefault(int(row.born), []).append(str(row.genome))
    imports = {f"from {home} import {name}" for home, name in _functions(settings) if home.startswith(OURS)}
    imports |= {"from functools import partial"} if any(isinstance(one, partial) for one in _slots(settings)) else set()
    evolved = ["run = wl.evolve(settings)"] if not by_hand else _evolved_with(by_hand)
    made = [f"settings = {settings.as_python()}", *evolved]
    imports |= {"import numpy as np"} if "np." in made[0] else set()
    return "\n".join([*sorted(imports), "import walkerlab as wl", "", *made])


def _evolved_with(by_hand: dict[int, list[str]]) -> list[str]:
    """Write the lines that put genomes into the generations of a run, by their numbers."""
    genomes = (f"    {number}: [{', '.join(map(repr, texts))}]," for number, texts in by_hand.items())
    return [
        "by_hand = {",
        *genomes,
        "}",
        "evolution = wl.Evolution(settings)",
        "for generation in evolution:",
        "    for genome in by_hand.get(generation.number + 1, []):",
        "        evolution.insert(genome)",
        "run = evolution.run",
    ]


def own_functions(settings: Settings) -> list[str]:
    """Name the functions of settings that are somebody's own."""
    return [printable(name) for home, name in _functions(settings) if not home.startswith(OURS)]


def _functions(settings: Settings) -> list[tuple[str, str]]:
    """Name the functions in the slots, each with the module that it is from."""
    inside = (one.func if isinstance(one, partial) else one for one in _slots(settings))
    return [(str(getattr(one, "__module__", "")), function_name(one)) for one in inside if callable(one)]


def _slots(settings: Settings) -> list[Any]:
    return [one for slot in STEPS for one in in_turn(getattr(settings.algorithm, slot))]
