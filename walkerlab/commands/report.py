"""A run in words: what it reached, how it got there, and whom its champion descends from."""

from collections.abc import Iterator, Mapping
from typing import Any, cast

import numpy as np
import pandas as pd

from walkerlab.fitness import UNITS
from walkerlab.records import champion, parent_numbers
from walkerlab.rollout import VERDICTS
from walkerlab.settings import Settings

ROWS = 12  # of a table by generation, however long the run
ANCESTORS = 8  # named in a line of descent, however long it is

Plain = Mapping[str, Mapping[str, Any]]
"""Settings as a run file holds them: by domain and field, functions of the user's own by name only."""


def champion_story(records: pd.DataFrame, settings: Plain) -> str:
    """Tell what the champion can do, and what it looks like."""
    best = champion(records)
    row: Any = _births(records).loc[best.individual]
    if best.verdict != "ok":
        return f"No walk counted, so there is no champion to speak of. Why: {best.verdict}. {VERDICTS[best.verdict]}"
    return (
        f"Your champion is robot {best.individual}, born in generation {best.generation}.\n"
        f"It went {row.distance:.2f} m forward in {settings['simulation']['duration']:g} s, and once under way it made "
        f"{row.velocity:.2f} m/s: {row.velocity / row.body_length:.1f} body lengths a second.\n"
        f"Its fitness ({_fitness_name(settings)}) is {_with_unit(best.fitness, settings)}.\n"
        f"Its body has {_count(row.n_segments, 'segment')} and {row.n_legs} legs, weighs {row.weight:.1f} kg "
        f"and is {row.body_length:.2f} m long."
    )


def changed_settings(settings: Plain) -> str:
    """List the settings that differ from the defaults."""
    plain = Settings().model_dump()
    changed = [
        f"  {domain.capitalize()}.{field} = {_words(value)}  (default {_words(plain[domain][field])})"
        for domain, fields in settings.items()
        for field, value in fields.items()
        if field not in plain.get(domain, {}) or value != plain[domain][field]
    ]
    return "\n".join(["Settings that differ from the defaults:", *changed] if changed else ["All settings: default."])


def by_generation(records: pd.DataFrame) -> str:
    """Tabulate best, median and number of counted walks; of a long run, evenly spaced generations."""
    numbers = records.generation.unique()
    shown = numbers[np.unique(np.linspace(0, len(numbers) - 1, ROWS).round().astype(int))]
    lines = ["generation      best    median   counted"]
    for number, table in records[records.generation.isin(shown)].groupby("generation"):
        counted = table.fitness[table.verdict == "ok"]
        lines.append(f"{number:10} {counted.max():9.3f} {counted.median():9.3f}  {len(counted):4} of {len(table)}")
    return "\n".join(lines)


def verdict_counts(records: pd.DataFrame) -> str:
    """Count the verdicts, each walk once."""
    counts = _births(records).verdict.value_counts()
    return "\n".join(
        ["Verdicts:", *(f"  {count:6}  {verdict}: {VERDICTS[str(verdict)]}" for verdict, count in counts.items())]
    )


def descent(records: pd.DataFrame, individual: int) -> str:
    """Name an individual, its fitter parent, that one's fitter parent and so on, back to a random robot."""
    line = list(_fitter_line(records, individual))
    shown = line if len(line) <= ANCESTORS else [*line[: ANCESTORS - 2], None, line[-1]]
    skipped = f"       … and {len(line) - ANCESTORS + 1} more before them …"
    rows = [
        skipped if one is None else f"{one.Index:7} {one.born:10} {one.fitness:9.3f}  {one.operators}" for one in shown
    ]
    return "\n".join(
        ["Its line of descent, through the fitter parent of each:", "  robot generation   fitness  made by", *rows]
    )


def _fitter_line(records: pd.DataFrame, individual: int) -> Iterator[Any]:
    births: Any = _births(records).itertuples()
    rows: dict[int, Any] = {row.Index: row for row in births}
    yield rows[individual]
    while parents := parent_numbers(str(rows[individual].parents)):
        individual = max(parents, key=lambda parent: float(rows[parent].fitness))
        yield rows[individual]


def _births(records: pd.DataFrame) -> pd.DataFrame:
    """One row for each individual: that of its first walk."""
    return records[records.generation == records.born].set_index("individual")


def _fitness_name(settings: Plain) -> str:
    return _words(settings["algorithm"]["fitness"])


def _with_unit(fitness: float, settings: Plain) -> str:
    units = {kind.name: unit for kind, unit in UNITS.items()}
    return f"{fitness:.3f} {units.get(_fitness_name(settings), '')}".rstrip()


def _count(n: int, thing: str) -> str:
    return f"{n} {thing}{'' if n == 1 else 's'}"


def _words(value: Any) -> str:
    match value:
        case {"function": str(address), "with": dict(bound)}:
            numbers = ", ".join(f"{name}={number}" for name, number in cast(dict[str, Any], bound).items())
            home, _, name = address.rpartition(".")
            own = "" if home.startswith("walkerlab.") else " (a function of your own)"
            return f"{name}({numbers}){own}" if numbers else f"{name}{own}"
        case list():
            return ", ".join(map(_words, cast(list[Any], value)))
        case float():
            return f"{value:g}"
        case _:
            return str(value)
