"""Tidy table of a run: one row for each individual and generation.

This is the table that is stored in the run file, displayed and plotted.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Any, NamedTuple, Self, cast

import numpy as np
import pandas as pd
from pandas.api.types import is_numeric_dtype

from walkerlab.ga.population import NOT_COUNTED, Population
from walkerlab.genome.display import genome_html
from walkerlab.genome.genome import Genome
from walkerlab.settings.values import short_repr
from walkerlab.simulation.evaluation import Evaluation
from walkerlab.simulation.fitness import MAX_FITNESS
from walkerlab.simulation.validity import VERDICTS
from walkerlab.text.numbers import format_significant
from walkerlab.text.templates import render

RECORD_COLUMNS: dict[str, tuple[type, str, str]] = {
    "generation": (int, "", "0 is the initial random generation"),
    "individual": (int, "", "number of the robot, the same wherever it appears"),
    "born": (int, "generation", "generation in which it first walked; for an elite, an earlier one than the row's"),
    "parents": (str, "", "numbers of its parents, separated by spaces"),
    "operators": (str, "", "how it was made: selection > crossover > mutation, random, given, or by hand"),
    "fitness": (float, "", "higher is better; -inf if the walk does not count"),
    "verdict": (str, "", "ok, or why the walk does not count"),
    "reason": (str, "", "the figures behind the verdict"),
    "distance": (float, "m", "net forward travel of the centre of mass"),
    "velocity": (float, "m/s", "mean forward speed over the last two thirds of the walk"),
    "n_segments": (int, "", "body segments"),
    "n_legs": (int, "", "legs"),
    "weight": (float, "kg", "total mass of the robot"),
    "body_length": (float, "m", "from the front of the first segment to the end of the last"),
    "genome": (str, "", "the genome, as text"),
}
"""Each column: its type, unit and meaning."""
HAS_COPY_ON_WRITE = int(pd.__version__.partition(".")[0]) >= 3
RANDOM = "random"  # value in the column ``operators`` for a random genome of generation 0
INSERTED_BY_HAND = "by hand"  # for a genome inserted into a later generation
GIVEN = "given"  # for a genome given for generation 0, perhaps followed by the robot that it comes from


class EvaluationRow(NamedTuple):
    """Evaluation of a genome: the table's columns from ``fitness`` onward."""

    fitness: float
    verdict: str
    reason: str
    distance: float
    velocity: float
    n_segments: int
    n_legs: int
    weight: float
    body_length: float
    genome: str

    @classmethod
    def of(cls, evaluation: Evaluation, genome: str) -> Self:
        """Combine an evaluation with the text of its genome, which is slow to produce and is therefore passed in.

        Args:
            evaluation: Evaluation of the genome.
            genome: Text of the genome.
        """
        return cls._make((*_measurements(evaluation), genome))


_measurements = attrgetter(*EvaluationRow._fields[:-1])


def tabulate_generation(
    population: Population[EvaluationRow], operators: str, known_origins: Mapping[int, str] = {}
) -> pd.DataFrame:
    """Return a generation as a table.

    Args:
        population: Evaluated generation.
        operators: Names of the operators that produced the children of this generation.
        known_origins: Origins of the individuals that no operator produced: elites, and genomes given for generation 0.

    Returns:
        Table with a row for each individual, the columns of ``RECORD_COLUMNS``, and their units in ``.attrs``.
    """
    births = zip(population.parents, population.born.tolist(), strict=True)
    of_new = [operators if parents else INSERTED_BY_HAND if born else RANDOM for parents, born in births]
    columns = {
        "generation": population.generation,
        "individual": population.individuals,
        "born": population.born,
        "parents": [" ".join(map(str, parents)) for parents in population.parents],
        "operators": list(map(known_origins.get, population.individuals.tolist(), of_new)),
        **dict(zip(EvaluationRow._fields, zip(*population.evaluations, strict=True), strict=True)),
    }
    return tidy_table(pd.DataFrame(columns))


def tidy_table(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table with the columns, types and units of ``RECORD_COLUMNS``."""
    kinds = {name: kind for name, (kind, *_) in RECORD_COLUMNS.items()}
    table = table.reindex(columns=list(kinds)).astype(kinds)
    table.attrs = {"units": {name: unit for name, (_, unit, _) in RECORD_COLUMNS.items() if unit}}
    return table


def check_table(table: pd.DataFrame) -> pd.DataFrame:
    """Check that an untrusted table could have been written by a run, and return it.

    An unknown verdict is an error even if a newer walkerlab wrote it, because its meaning is unknown.

    Raises:
        ValueError: If a column contains a value that walkerlab never writes.
    """
    numbers = table[["generation", "individual", "born"]]
    wrong = {
        "individual": (numbers < 0).any(axis=1)
        | (table.individual > _MAX_INDIVIDUAL)
        | (table.born > table.generation),
        "fitness": ~(table.fitness.abs() < MAX_FITNESS) & (table.fitness != NOT_COUNTED),
        "parents": ~table.parents.str.fullmatch(r"(\d{1,10}( \d{1,10})*)?", flags=re.ASCII),
        **{name: table[name].str.contains(_CONTROL_CHARACTERS) for name in ("operators", "reason", "genome")},
    }
    for name, rows in wrong.items():
        if rows.any():
            raise ValueError(
                f"the column {name} contains a value that walkerlab never writes; the file was probably edited"
            )
    if unknown := sorted(set(table.verdict) - VERDICTS.keys()):
        raise ValueError(
            f"the column verdict contains {short_repr(unknown[0])}; the known verdicts are {', '.join(VERDICTS)}. "
            "If a newer version of walkerlab wrote the file, update your installation: pip install --upgrade walkerlab"
        )
    return table


_MAX_INDIVIDUAL = 10**9  # ten times the number of robots that the settings allow
_CONTROL_CHARACTERS = "[\x00-\x08\x0b-\x1f\x7f-\x9f]"  # could control the terminal in which the table is printed


def name_fitness(table: pd.DataFrame, name: str, unit: str) -> None:
    """Set the name and unit of the fitness in a table's ``.attrs``, for the axes of plots."""
    table.attrs["fitness"] = name
    table.attrs["units"] = {**table.attrs.get("units", {}), "fitness": unit}


def concatenate_tables(tables: list[pd.DataFrame]) -> pd.DataFrame:
    """Concatenate the tables of generations."""
    return (
        tidy_table(pd.concat(tables, ignore_index=True))
        if tables
        else tidy_table(pd.DataFrame(columns=list(RECORD_COLUMNS)))
    )


def copy_table(table: pd.DataFrame) -> pd.DataFrame:
    """Return an independent copy of a table; cells are copied only when they are changed, if pandas supports this."""
    return table.copy(deep=not HAS_COPY_ON_WRITE)


def last_population(records: pd.DataFrame) -> Population[EvaluationRow]:
    """Rebuild the last generation from a table, ready to breed: the inverse of ``tabulate_generation``."""
    last = records[records.generation == records.generation.max()]
    walked = [EvaluationRow(*row) for row in zip(*(last[name].tolist() for name in EvaluationRow._fields), strict=True)]
    return Population(
        generation=int(last.generation.iloc[0]),
        genomes=np.array([Genome.parse(one.genome).values for one in walked]),
        individuals=last.individual.to_numpy(dtype=np.intp).copy(),
        born=last.born.to_numpy(dtype=np.intp).copy(),
        parents=tuple(parent_numbers(parents) for parents in last.parents),
        evaluations=walked,
        n_born=int(records.individual.max()) + 1,
    )


def parent_numbers(parents: object) -> tuple[int, ...]:
    """Read a cell of the ``parents`` column: text, or the number or NaN that ``read_csv`` turns it into."""
    if isinstance(parents, str):
        return tuple(map(int, parents.split()))
    return () if pd.isna(cast(Any, parents)) else (int(cast(Any, parents)),)


def birth_rows(records: pd.DataFrame) -> pd.DataFrame:
    """Return the first row of each individual, indexed by its number; later rows of elites are left out."""
    in_order = records.generation.is_monotonic_increasing
    ordered = records if in_order else records.sort_values("generation", kind="stable")
    first = ordered.drop_duplicates("individual").set_index("individual", drop=False)
    if first.reason.hasnans or first.parents.hasnans or is_numeric_dtype(first.parents):  # as read_csv leaves them
        parents = [" ".join(map(str, parent_numbers(cell))) for cell in first.parents]
        return first.assign(parents=parents, reason=first.reason.astype(object).where(first.reason.notna(), ""))
    return first


def fitter_line(born: pd.DataFrame, individual: int) -> list[int]:
    """Return the numbers of an individual and its ancestors along the line of fitter parents, youngest first.

    The line stops before a parent that is not in the table, or whose number is not lower than its child's.

    Args:
        born: Table from ``birth_rows``.
        individual: Number of the individual.
    """
    parents = born.parents.to_dict()
    fitness = born.fitness.to_dict()
    line = [individual]
    while known := [number for number in parent_numbers(parents[line[-1]]) if number in parents and number < line[-1]]:
        line.append(max(known, key=lambda number: float(fitness[number])))
    return line


@dataclass(frozen=True)
class Individual:
    """One robot of a run.

    Attributes:
        individual: Number of the robot in the run.
        genome: Genome of the robot.
        fitness: Fitness; higher is better, ``-inf`` if the walk does not count.
        verdict: ``ok``, or why the walk does not count.
        reason: Figures behind the verdict, as text.
        generation: Generation in which it was born.
        parents: Numbers of the parents; empty in generation 0.
    """

    individual: int
    genome: Genome
    fitness: float
    verdict: str
    reason: str
    generation: int
    parents: tuple[int, ...]

    def _repr_html_(self) -> str:
        return render(
            "runfile/individual.html",
            number=self.individual,
            fitness=format_significant(self.fitness) if self.verdict == "ok" else "",
            verdict=self.verdict,
            meaning=VERDICTS.get(self.verdict, ""),
            reason=self.reason,
            generation=self.generation,
            parents=self.parents,
            genome=genome_html(self.genome.values),
        )


def find_champion(records: pd.DataFrame) -> Individual:
    """Return the fittest robot of a table; if several have the same fitness, the first-born.

    Raises:
        ValueError: If the table is empty.
    """
    if records.empty:
        raise ValueError("no robot has walked yet, so there is no champion")
    since = records.attrs.get("rated_since", 0)  # earlier ratings come from another fitness function
    current = records.loc[records.generation >= since, :]
    records = records if current.empty else current
    fitness = records.fitness.fillna(-np.inf)
    fittest: Any = records[fitness == fitness.max()]
    row = fittest.sort_values("individual", kind="stable").iloc[0]
    return Individual(
        individual=int(row.individual),
        genome=Genome.parse(row.genome),
        fitness=float(row.fitness),
        verdict=row.verdict,
        reason="" if pd.isna(row.reason) else row.reason,
        generation=int(row.born),
        parents=parent_numbers(row.parents),
    )


def select_lineage(records: pd.DataFrame, individual: int) -> pd.DataFrame:
    """Return the first row of an individual and of each of its ancestors, youngest first.

    Ancestors that are not in the table are left out.

    Args:
        records: Tidy table.
        individual: Number of the individual.

    Raises:
        ValueError: If the individual is not in the table.
    """
    born = birth_rows(records)
    if individual not in born.index:
        low, high = born.index.min(), born.index.max()
        raise ValueError(f"individual {individual} is not in this run; its individuals are numbered {low} to {high}")
    parents = born.parents.to_dict()
    found = {individual}
    waiting = [individual]
    while waiting:
        new = {number for number in parent_numbers(parents[waiting.pop()]) if number in parents} - found
        found |= new
        waiting += new
    return tidy_table(born.loc[sorted(found, reverse=True)].reset_index(drop=True))
