"""A run in words: what it reached, how it got there, and whom its champion descends from."""

import math
from collections.abc import Collection, Mapping
from typing import Any, cast

import pandas as pd

from walkerlab.genome.phenotype import express
from walkerlab.runfile.records import Individual, births, champion, fitter_line
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import count, number_text
from walkerlab.simulation.fitness import UNITS
from walkerlab.simulation.validity import VERDICTS
from walkerlab.text.numbers import significant, significant_column, with_unit

ROWS = 12  # of a table by generation, however long the run
ANCESTORS = 8  # named in a line of descent, however long it is

Plain = Mapping[str, Mapping[str, Any]]
"""Settings as a run file holds them: by domain and field, functions of the user's own by name only."""


def opening(settings: Settings, n_cores: int, *, done: int = 0) -> str:
    """Say what is about to be evolved, of which some generations may be done already."""
    algorithm = settings.algorithm
    robots, generations = count(algorithm.population_size, "robot"), count(algorithm.generations, "generation")
    already = f" ({done} of them done)" if done else ""
    return f"{robots}, {generations}{already}, {count(n_cores, 'core')}. Ctrl-C stops early and keeps what is done."


def summary(records: pd.DataFrame, settings: Plain) -> str:
    """Say in a sentence what a run has reached, and from where."""
    if records.empty:
        return "No generation is done yet, so there is nothing to tell."
    generations, best = int(records.generation.nunique()), champion(records)
    start = int(records.generation.min())
    robots = count(int((records.generation == start).sum()), "robot")
    ran = f"{count(generations, 'generation')} of {robots}"
    if best.verdict != "ok":
        return f"{ran}; no walk counted, so there is no champion to speak of."
    first = records.fitness[(records.generation == start) & (records.verdict == "ok")]
    at_first = f"generation {start}" if start else "the random generation"
    began = f", from {_with_unit(first.max(), settings)} in {at_first}" if generations > 1 and len(first) else ""
    article = "an" if _fitness_name(settings).startswith(tuple("aeiou")) else "a"
    return (
        f"{ran}. The champion, robot {best.individual} of generation {best.generation}, reached "
        f"{article} {_fitness_name(settings)} of {_with_unit(best.fitness, settings)}{began}."
    )


def champion_story(records: pd.DataFrame, settings: Plain) -> str:
    """Tell what the champion can do, and what it looks like."""
    best = champion(records)
    row: Any = births(records).loc[best.individual]
    if best.verdict != "ok":
        return (
            f"No walk counted, so there is no champion to speak of. The verdict on robot {best.individual} is "
            f"{best.verdict}. {_meaning(best.verdict)}\nThat is, {best.reason}."
        )
    return (
        f"The champion is robot {best.individual}, born in generation {best.generation}.\n"
        f"It went {with_unit(row.distance, 'm')} forward in {settings['simulation']['duration']:g} s. Over the last "
        f"two thirds of the walk it made {with_unit(row.velocity, 'm/s')}: "
        f"{significant(row.velocity / row.body_length)} body lengths a second.\n"
        f"Its fitness ({_fitness_name(settings)}) is {_with_unit(best.fitness, settings)}.\n"
        f"Its body has {count(row.n_segments, 'segment')} and {row.n_legs} legs, weighs "
        f"{with_unit(row.weight, 'kg')} and is {with_unit(row.body_length, 'm')} long."
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


def gene(individual: Individual) -> str:
    """Give a gene as text, and say what of it is carried only."""
    n_grown = len(express(individual.genome).segments)
    first = "first" if n_grown == 1 else f"first {n_grown}"
    carried = f" (segments beyond the {first} are not grown: inherited all the same)"
    return f"Its gene{carried if individual.genome.n_parts > n_grown else ''}:\n{individual.genome}"


def by_generation(records: pd.DataFrame, settings: Plain) -> str:
    """Tabulate best, median and number of counted walks; of a long run, every 5th generation or so, and the last."""
    name, unit = _fitness_name(settings), _unit(settings)
    best, median = (f"{word} [{unit}]" if unit else word for word in ("best", "median"))
    shown = round_steps(int(records.generation.max()))
    lines = [
        f"Fitness ({name}) of the robots whose walks count, and how many these are:",
        f"generation {best:>10} {median:>12}    counted",
    ]
    rows = (
        f"{row.generation:10} {best:>10} {median:>12}  {row.counted:4} of {row.robots}"
        for row, best, median in best_and_median(records, shown)
    )
    return "\n".join([*lines, *rows])


def best_and_median(records: pd.DataFrame, shown: Collection[int]) -> list[tuple[Any, str, str]]:
    """Return the rows of ``generations`` with these numbers, each with its best and its median as text that aligns."""
    table = generations(records)
    table = table.loc[table.generation.isin(shown), :]
    texts = significant_column([*table["best"], *table["median"]])
    return list(zip(table.itertuples(), texts[: len(table)], texts[len(table) :], strict=True))


def generations(records: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each generation: best and quartiles of the fitness of the walks that count, and their number."""
    counted = records[records.verdict == "ok"].groupby("generation").fitness
    sizes = records.groupby("generation").size()
    columns = {
        "best": counted.max(),
        "upper_quartile": counted.quantile(0.75),
        "median": counted.median(),
        "lower_quartile": counted.quantile(0.25),
        "counted": counted.size().reindex(sizes.index, fill_value=0),
        "robots": sizes,
    }
    return pd.DataFrame(columns, index=sizes.index).rename_axis("generation").reset_index()


def round_steps(last: int) -> list[int]:
    """Count from 0 in steps of 1, 2, 5, 10, 20 … to a last generation, which is always shown, in ``ROWS`` at most."""
    steps = (step * 10**power for power in range(9) for step in (1, 2, 5))
    return next(shown for step in steps if len(shown := [*range(0, last, step), last]) <= ROWS)


def verdict_counts(records: pd.DataFrame) -> str:
    """Count the verdicts, each walk once: an elite is in the table again, but walked when it was born."""
    n_robots = len(births(records))
    elites = ", where elites stand once for each generation" if n_robots < len(records) else ""
    title = f"Verdicts of {count(n_robots, 'robot')} ({count(len(records), 'row')} in the table{elites}):"
    return "\n".join([title, *(f"  {n:6}  {verdict}: {meaning}" for verdict, n, meaning in verdicts(records))])


def verdicts(records: pd.DataFrame) -> list[tuple[str, int, str]]:
    """Return each verdict that there was, how many walks got it, and what it means; the commonest first."""
    counts = births(records).verdict.value_counts()
    return [(str(one), int(n), _meaning(str(one))) for one, n in counts.items()]


def _meaning(verdict: str) -> str:
    return VERDICTS.get(verdict, "No verdict of ours.")


def descent(records: pd.DataFrame, individual: int) -> str:
    """Name an individual, its fitter parent, that one's fitter parent and so on, back to a random robot."""
    rows = [
        f"       … and {skipped} more before them …"
        if skipped
        else f"{one.individual:7} {one.born:10} {fitness:>9}  {one.operators}"
        for one, fitness, skipped in line_of_descent(records, individual)
    ]
    title = "Its line of descent, through the fitter parent of each:"
    return "\n".join([title, "  robot generation   fitness  made by selection > crossover > mutation", *rows])


def ancestors(records: pd.DataFrame, individual: int) -> list[tuple[Any, int]]:
    """Return the births of an individual, its fitter parent, that one's and so on; of a long line, both its ends.

    Returns:
        Rows of the table with the number 0, and in the place of those that are passed over, None with theirs.
    """
    born: Any = births(records)
    line: list[Any] = list(born.loc[fitter_line(born, individual)].itertuples())
    if len(line) <= ANCESTORS:
        return [(one, 0) for one in line]
    return [*((one, 0) for one in line[: ANCESTORS - 2]), (None, len(line) - ANCESTORS + 1), (line[-1], 0)]


def line_of_descent(records: pd.DataFrame, individual: int) -> list[tuple[Any, str, int]]:
    """Return what ``ancestors`` does, each with its fitness as text that aligns; the verdict if its walk is void."""
    line = ancestors(records, individual)
    texts = significant_column(math.nan if skipped else one.fitness for one, skipped in line)
    return [
        (one, fitness if skipped or one.verdict == "ok" else str(one.verdict), skipped)
        for (one, skipped), fitness in zip(line, texts, strict=True)
    ]


def _fitness_name(settings: Plain) -> str:
    return _words(settings["algorithm"]["fitness"])


def _with_unit(fitness: float, settings: Plain) -> str:
    return with_unit(fitness, _unit(settings))


def _unit(settings: Plain) -> str:
    """Return the unit of the fitness; none for a function of the user's own."""
    return {kind.name: unit for kind, unit in UNITS.items()}.get(_fitness_name(settings), "")


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
            return number_text(value)
        case _:
            return str(value)
