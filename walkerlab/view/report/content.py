"""The text, numbers and tables of a report, as shown by its template."""

import re
from contextlib import suppress
from typing import Any

from walkerlab.genome.display import genome_html
from walkerlab.runfile.opening import RunFileError
from walkerlab.runfile.records import birth_rows
from walkerlab.settings.choices import Structure
from walkerlab.settings.glossary import glossary, glossary_rows
from walkerlab.settings.settings import Settings
from walkerlab.simulation.robustness import confirm
from walkerlab.text.numbers import format_significant, with_unit
from walkerlab.text.templates import Markup
from walkerlab.view import summary
from walkerlab.view.report.code import STEPS, as_python, user_functions
from walkerlab.view.report.pictures import Subject

Cells = list[list[object]]
"""Cells of each row of a table."""

GROUND_NAMES = {
    Structure.flat: "flat ground",
    Structure.incline: "a slope",
    Structure.stairs: "stairs",
    Structure.rough: "hills",
    Structure.gaps: "ground with trenches",
}


def report_values(run: Subject) -> dict[str, object]:
    """Return the variables of the template that describe a run; those that describe files are not included."""
    plain = run.settings.model_dump()
    algorithm = {row.name: row for row in glossary_rows(run.settings.algorithm)}
    return {
        "title": f"Walkers evolved on {_terrain_name(run.settings)}",
        "result": summary.describe_result(run.records, plain),
        "numbers": _headline_numbers(run),
        "champion_sentence": summary.describe_champion(run.records, plain),
        "population_size": algorithm["population_size"].value,
        "n_elites": algorithm["n_elites"].value,
        "steps": [[name, algorithm[name].value, algorithm[name].choice] for name in STEPS],
        "domains": [glossary(domain) for _, domain in run.settings],
        "fitness_unit": run.records.attrs.get("units", {}).get("fitness", ""),
        "generations": generation_cells(run),
        "verdicts": [[verdict, n, meaning] for verdict, n, meaning in summary.count_verdicts(run.records)],
        "genome": genome_html(run.champion.genome.values),
        "confirmation": _confirmation_table(run),
        "descent": descent_cells(run),
        "user_functions": user_functions(run.settings),
        "python": as_python(run.settings, run.records),
    }


def _terrain_name(settings: Settings) -> str:
    terrain = settings.terrain
    obstacles = f" with {re.split('[,:]', terrain.obstacle.about)[0]}" if terrain.obstacle else ""
    return f"{GROUND_NAMES[terrain.structure]} of {terrain.texture.name}{obstacles}"


def _headline_numbers(run: Subject) -> list[tuple[str, str]]:
    """Return the numbers at the top of the report, each with its meaning."""
    born = birth_rows(run.records)
    row: Any = born.loc[run.champion.individual]
    numbers: list[tuple[str, str]] = []
    if run.champion.verdict == "ok":
        relative_speed = format_significant(row.velocity / row.body_length)
        numbers += [
            (with_unit(row.distance, "m"), f"forward in {run.settings.simulation.duration:g} s"),
            (with_unit(row.velocity, "m/s"), f"over the last two thirds: {relative_speed} body lengths a second"),
        ]
    return [
        *numbers,
        (f"{len(born)}", "robots walked"),
        (f"{(born.verdict == 'ok').mean():.0%}", "of the walks count"),
    ]


def generation_cells(run: Subject) -> Cells:
    """Return number, best and median fitness, number of walks that count and number of robots of generations."""
    generations = summary.select_generations(int(run.records.generation.max()))
    return [
        [row.generation, best, median, row.counted, row.robots]
        for row, best, median in summary.format_generations(run.records, generations)
    ]


def descent_cells(run: Subject) -> Cells:
    """Return number, generation, fitness and operators of the champion's ancestors; one row counts omitted ones."""
    return [
        ["…", f"{n_skipped} more", "", ""] if n_skipped else [birth.individual, birth.born, fitness, birth.operators]
        for birth, fitness, n_skipped in summary.format_descent(run.records, run.champion.individual)
    ]


def _confirmation_table(run: Subject) -> Markup | None:
    """Return how much of the champion's fitness remains when it is simulated again; None if its fitness is unknown."""
    if run.champion.verdict != "ok":
        return None
    with suppress(RunFileError):  # a loaded run contains only the name of a user function
        return confirm(run.champion.genome, run.settings).table()
    return None
