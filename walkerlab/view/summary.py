"""Text summaries of a run: its result, its champion, its generations, and a line of descent."""

import math
from collections.abc import Collection, Mapping
from typing import Any, cast

import pandas as pd

from walkerlab.genome.phenotype import express
from walkerlab.runfile.records import Individual, birth_rows, find_champion, fitter_line
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import number_text, pluralize
from walkerlab.simulation.fitness import FITNESS_UNITS
from walkerlab.simulation.validity import VERDICTS
from walkerlab.text.numbers import format_significant, format_significant_column, with_unit

MAX_GENERATION_ROWS = 12  # maximum number of rows in the table of generations
MAX_ANCESTOR_ROWS = 8  # maximum number of rows in a line of descent

PlainSettings = Mapping[str, Mapping[str, Any]]
"""Settings as a run file stores them, keyed by domain and field; user functions are given by module and name."""


def describe_start(settings: Settings, n_cores: int, *, done: int = 0) -> str:
    """Describe the evolution that is about to start or resume.

    Args:
        settings: Complete settings of the run.
        n_cores: Number of cores that it uses.
        done: Number of generations that are already completed.
    """
    algorithm = settings.algorithm
    robots = pluralize(algorithm.population_size, "robot")
    generations = pluralize(algorithm.generations, "generation")
    completed = f" ({done} completed)" if done else ""
    return (
        f"{robots}, {generations}{completed}, {pluralize(n_cores, 'core')}. Ctrl-C stops early and saves the "
        "generations that are complete."
    )


def describe_result(records: pd.DataFrame, settings: PlainSettings) -> str:
    """Describe the best fitness of a run and of the first generation with the present settings in a sentence."""
    if records.empty:
        return "No generation is complete yet."
    n_generations = int(records.generation.nunique())
    best = find_champion(records)
    start = max(int(records.generation.min()), int(records.attrs.get("rated_since", 0)))
    robots = pluralize(int((records.generation == start).sum()), "robot")
    size = f"{pluralize(n_generations, 'generation')} of {robots}"
    if best.verdict != "ok":
        return f"{size}; no walk counted, so there is no champion."
    first = records.fitness[(records.generation == start) & (records.verdict == "ok")]
    first_generation = f"generation {start}" if start else "the random generation"
    change = ""
    if n_generations > 1 and len(first):
        change = f", from {_format_fitness(first.max(), settings)} in {first_generation}"
    article = "an" if _fitness_name(settings).startswith(tuple("aeiou")) else "a"
    return (
        f"{size}. The champion, robot {best.individual} of generation {best.generation}, reached "
        f"{article} {_fitness_name(settings)} of {_format_fitness(best.fitness, settings)}{change}."
    )


def describe_champion(records: pd.DataFrame, settings: PlainSettings) -> str:
    """Describe the walk and the body of the champion."""
    best = find_champion(records)
    row: Any = birth_rows(records).loc[best.individual]
    if best.verdict != "ok":
        return (
            f"No walk counted, so there is no champion. The verdict on robot {best.individual} is {best.verdict}. "
            f"{_verdict_meaning(best.verdict)}\nDetails: {best.reason}."
        )
    return (
        f"The champion is robot {best.individual}, born in generation {best.generation}.\n"
        f"It moved {with_unit(row.distance, 'm')} forward in {settings['simulation']['duration']:g} s. Over the last "
        f"two thirds of the walk, its velocity was {with_unit(row.velocity, 'm/s')}, or "
        f"{format_significant(row.velocity / row.body_length)} body lengths per second.\n"
        f"Its fitness ({_fitness_name(settings)}) is {_format_fitness(best.fitness, settings)}.\n"
        f"Its body has {pluralize(row.n_segments, 'segment')} and {row.n_legs} legs, weighs "
        f"{with_unit(row.weight, 'kg')} and is {with_unit(row.body_length, 'm')} long."
    )


def list_changed_settings(settings: PlainSettings) -> str:
    """List the settings that differ from their defaults, one per line."""
    defaults = Settings().model_dump()
    changed = [
        f"  {domain.capitalize()}.{field} = {_format_setting(value)}  "
        f"(default {_format_setting(defaults[domain][field])})"
        for domain, fields in settings.items()
        for field, value in fields.items()
        if field not in defaults.get(domain, {}) or value != defaults[domain][field]
    ]
    if not changed:
        return "All settings have their default values."
    return "\n".join(["Settings that differ from the defaults:", *changed])


def describe_genome(individual: Individual) -> str:
    """Return the text of a genome, and state which of its segments are not expressed."""
    n_expressed = len(express(individual.genome).segments)
    first = "first" if n_expressed == 1 else f"first {n_expressed}"
    not_expressed = f" (segments beyond the {first} are not expressed, but are inherited)"
    return f"Its genome{not_expressed if individual.genome.n_parts > n_expressed else ''}:\n{individual.genome}"


def tabulate_generations(records: pd.DataFrame, settings: PlainSettings) -> str:
    """Return a table of the best and median fitness and the number of walks that count, for selected generations."""
    name = _fitness_name(settings)
    unit = _fitness_unit(settings)
    best_header, median_header = (f"{word} [{unit}]" if unit else word for word in ("best", "median"))
    selected = select_generations(int(records.generation.max()))
    lines = [
        f"Fitness ({name}) of the robots whose walks count, and their number:",
        f"generation {best_header:>10} {median_header:>12}    counted",
    ]
    rows = (
        f"{row.generation:10} {best:>10} {median:>12}  {row.counted:4} of {row.robots}"
        for row, best, median in format_generations(records, selected)
    )
    return "\n".join([*lines, *rows])


def format_generations(records: pd.DataFrame, selected: Collection[int]) -> list[tuple[Any, str, str]]:
    """Return rows of ``generation_statistics`` with their best and median fitness as aligned text.

    Args:
        records: Table of a run.
        selected: Numbers of the generations.
    """
    statistics = generation_statistics(records)
    statistics = statistics.loc[statistics.generation.isin(selected), :]
    n = len(statistics)
    texts = format_significant_column([*statistics["best"], *statistics["median"]])
    return list(zip(statistics.itertuples(), texts[:n], texts[n:], strict=True))


def generation_statistics(records: pd.DataFrame) -> pd.DataFrame:
    """Return best and quartiles of the fitness, and the number of walks that count, with a row for each generation."""
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


def select_generations(last: int) -> list[int]:
    """Select at most ``MAX_GENERATION_ROWS`` generations: from 0 in steps of 1, 2, 5, 10, 20 …, and the last."""
    steps = (step * 10**power for power in range(9) for step in (1, 2, 5))
    selections = ([*range(0, last, step), last] for step in steps)
    return next(selection for selection in selections if len(selection) <= MAX_GENERATION_ROWS)


def tabulate_verdicts(records: pd.DataFrame) -> str:
    """Return a table of the verdicts; the walk of an elite is counted once, although the table repeats it."""
    n_robots = len(birth_rows(records))
    elites = ", where elites occur once in each generation" if n_robots < len(records) else ""
    title = f"Verdicts of {pluralize(n_robots, 'robot')} ({pluralize(len(records), 'row')} in the table{elites}):"
    return "\n".join([title, *(f"  {n:6}  {verdict}: {meaning}" for verdict, n, meaning in count_verdicts(records))])


def count_verdicts(records: pd.DataFrame) -> list[tuple[str, int, str]]:
    """Return each verdict that occurs, its number of walks, and its meaning, in descending order of the number."""
    counts = birth_rows(records).verdict.value_counts()
    return [(str(verdict), int(n), _verdict_meaning(str(verdict))) for verdict, n in counts.items()]


def _verdict_meaning(verdict: str) -> str:
    return VERDICTS.get(verdict, "This verdict is not known to this version of walkerlab.")


def tabulate_descent(records: pd.DataFrame, individual: int) -> str:
    """Return a table of an individual, its fitter parent, that parent's fitter parent, and so on."""
    rows = [
        f"       … and {n_omitted} more ancestors …"
        if n_omitted
        else f"{row.individual:7} {row.born:10} {fitness:>9}  {row.operators}"
        for row, fitness, n_omitted in format_descent(records, individual)
    ]
    title = "Its line of descent, through the fitter parent of each:"
    return "\n".join([title, "  robot generation   fitness  made by selection > crossover > mutation", *rows])


def select_descent(records: pd.DataFrame, individual: int) -> list[tuple[Any, int]]:
    """Return the line of descent of an individual through the fitter parents; only both ends of a long line.

    Returns:
        Pairs, youngest first: the row of a birth and 0, or None and the number of ancestors omitted there.
    """
    born: Any = birth_rows(records)
    line: list[Any] = list(born.loc[fitter_line(born, individual)].itertuples())
    if len(line) <= MAX_ANCESTOR_ROWS:
        return [(row, 0) for row in line]
    youngest = [(row, 0) for row in line[: MAX_ANCESTOR_ROWS - 2]]
    return [*youngest, (None, len(line) - MAX_ANCESTOR_ROWS + 1), (line[-1], 0)]


def format_descent(records: pd.DataFrame, individual: int) -> list[tuple[Any, str, int]]:
    """Return the pairs of ``select_descent``, each with the fitness as aligned text.

    Returns:
        Triples: the row of a birth, its fitness, or its verdict if the walk does not count, and 0; or None, an unused
        string, and the number of ancestors omitted there.
    """
    line = select_descent(records, individual)
    texts = format_significant_column(math.nan if n_omitted else row.fitness for row, n_omitted in line)
    return [
        (row, fitness if n_omitted or row.verdict == "ok" else str(row.verdict), n_omitted)
        for (row, n_omitted), fitness in zip(line, texts, strict=True)
    ]


def _fitness_name(settings: PlainSettings) -> str:
    return _format_setting(settings["algorithm"]["fitness"])


def _format_fitness(fitness: float, settings: PlainSettings) -> str:
    return with_unit(fitness, _fitness_unit(settings))


def _fitness_unit(settings: PlainSettings) -> str:
    """Return the unit of the fitness; "" for a user function."""
    return {kind.name: unit for kind, unit in FITNESS_UNITS.items()}.get(_fitness_name(settings), "")


def _format_setting(value: Any) -> str:
    """Return a setting as text; a function is represented by its name and arguments."""
    match value:
        case {"function": str(address), "with": dict(arguments)}:
            named = ", ".join(f"{name}={number}" for name, number in cast(dict[str, Any], arguments).items())
            module, _, name = address.rpartition(".")
            origin = "" if module.startswith("walkerlab.") else " (your function)"
            return f"{name}({named}){origin}" if named else f"{name}{origin}"
        case list():
            return ", ".join(map(_format_setting, cast(list[Any], value)))
        case float():
            return number_text(value)
        case _:
            return str(value)
