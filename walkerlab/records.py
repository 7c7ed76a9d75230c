"""The tidy table: a row for each individual and generation. What is written, shown and plotted is this table."""

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pandas as pd

from walkerlab.evaluation import Evaluation
from walkerlab.ga.loop import Population
from walkerlab.genome import Genome, in_words
from walkerlab.judge import VERDICTS
from walkerlab.markup import facts, shown

COLUMNS: dict[str, tuple[type, str, str]] = {
    "generation": (int, "", "0 is the random one"),
    "individual": (int, "", "number of the robot, the same wherever it appears"),
    "born": (int, "generation", "generation in which it first walked; an elite is older than its generation"),
    "parents": (str, "", "numbers of its parents, joined by blanks"),
    "operators": (str, "", "what made it: selection > crossover > mutation, random, or by hand"),
    "fitness": (float, "", "higher is better; -inf if the walk does not count"),
    "verdict": (str, "", "ok, or why the walk does not count"),
    "reason": (str, "", "the figures behind the verdict"),
    "distance": (float, "m", "net forward travel of the centre of mass"),
    "velocity": (float, "m/s", "mean forward speed over the last two thirds of the walk"),
    "n_segments": (int, "", "body segments"),
    "n_legs": (int, "", "legs"),
    "weight": (float, "kg", "the whole mass"),
    "body_length": (float, "m", "front of the first to end of the last segment"),
    "genome": (str, "", "the gene, as text"),
}
"""Each column: its type, unit and meaning."""

BY_HAND = "by hand"  # what made a robot that somebody put into a generation

MEASURED = ("fitness", "verdict", "reason", "distance", "velocity", "n_segments", "n_legs", "weight", "body_length")


def tabulate(population: Population[Evaluation], operators: str) -> pd.DataFrame:
    """Write a generation as a table.

    Args:
        population: evaluated.
        operators: what made those that were born in this generation.

    Returns:
        A row for each individual, with the columns of ``COLUMNS`` and their units in ``.attrs``.
    """
    rows = [
        {
            "generation": population.generation,
            "individual": individual,
            "born": born,
            "parents": " ".join(map(str, parents)),
            "operators": operators if parents else BY_HAND if born else "random",
            **{name: getattr(evaluation, name) for name in MEASURED},
            "genome": str(evaluation.genome),
        }
        for individual, born, parents, evaluation in zip(
            population.individuals, population.born, population.parents, population.evaluations, strict=True
        )
    ]
    return tidy(pd.DataFrame(rows))


def tidy(table: pd.DataFrame) -> pd.DataFrame:
    """Give a table the columns, types and units of ``COLUMNS``."""
    table = table.reindex(columns=list(COLUMNS)).astype({name: kind for name, (kind, *_) in COLUMNS.items()})
    table.attrs = {"units": {name: unit for name, (_, unit, _) in COLUMNS.items() if unit}}
    return table


def name_fitness(table: pd.DataFrame, name: str, unit: str) -> None:
    """Write on a table what its fitness is, for the axes of plots."""
    table.attrs["fitness"] = name
    table.attrs["units"] = {**table.attrs.get("units", {}), "fitness": unit}


def join(tables: list[pd.DataFrame]) -> pd.DataFrame:
    """Lay generations under each other."""
    return tidy(pd.concat(tables, ignore_index=True)) if tables else tidy(pd.DataFrame(columns=list(COLUMNS)))


def last_population(records: pd.DataFrame) -> Population[Evaluation]:
    """Read the last generation back out of the table, ready to breed: the inverse of ``tabulate``."""
    last = records[records.generation == records.generation.max()]
    measured = zip(*(last[name].tolist() for name in MEASURED), strict=True)
    evaluations = [
        Evaluation(genome=Genome.parse(text), **dict(zip(MEASURED, row, strict=True)))
        for text, row in zip(last.genome, measured, strict=True)
    ]
    return Population(
        generation=int(last.generation.iloc[0]),
        genomes=np.array([evaluation.genome.values for evaluation in evaluations]),
        individuals=last.individual.to_numpy(dtype=np.intp).copy(),
        born=last.born.to_numpy(dtype=np.intp).copy(),
        parents=tuple(parent_numbers(parents) for parents in last.parents),
        evaluations=evaluations,
        n_born=int(records.individual.max()) + 1,
    )


def parent_numbers(parents: object) -> tuple[int, ...]:
    """Read a cell of the ``parents`` column: text, or the number or NaN that ``read_csv`` makes of it."""
    if isinstance(parents, str):
        return tuple(map(int, parents.split()))
    return () if pd.isna(cast(Any, parents)) else (int(cast(Any, parents)),)


def births(records: pd.DataFrame) -> pd.DataFrame:
    """Return the first row of each individual that a table has, by its number; an elite's others are left out."""
    first = records.sort_values("generation", kind="stable").drop_duplicates("individual")
    parents = [" ".join(map(str, parent_numbers(cell))) for cell in first.parents]
    reason = first.reason.astype(object).where(first.reason.notna(), "")
    return first.assign(parents=parents, reason=reason).set_index("individual", drop=False)


def fitter_line(born: pd.DataFrame, individual: int) -> list[int]:
    """Name an individual, its fitter parent, that one's and so on, as far back as a table of ``births`` goes.

    Parents have lower numbers than their children; in a table that says otherwise the line ends there.
    """
    parents, fitness = born.parents.to_dict(), born.fitness.to_dict()
    line = [individual]
    while known := [one for one in parent_numbers(parents[line[-1]]) if one in parents and one < line[-1]]:
        line.append(max(known, key=lambda one: float(fitness[one])))
    return line


@dataclass(frozen=True)
class Individual:
    """One robot of a run.

    Attributes:
        individual: its number in the run.
        genome: its genome.
        fitness: higher is better; ``-inf`` if its walk does not count.
        verdict: ``ok``, or why it does not count.
        reason: the figures behind the verdict, in words.
        generation: in which it was born.
        parents: their numbers; none in generation 0.
    """

    individual: int
    genome: Genome
    fitness: float
    verdict: str
    reason: str
    generation: int
    parents: tuple[int, ...]

    def _repr_html_(self) -> str:
        meaning = VERDICTS.get(self.verdict, "")
        known = (
            ("fitness", f"{self.fitness:.3f}" if self.verdict == "ok" else "none, for its walk does not count"),
            ("verdict", f"{self.verdict}: {meaning}{f' That is, {self.reason}.' if self.reason else ''}"),
            ("generation", f"{self.generation}, in which it was born"),
            ("parents", ", ".join(map(str, self.parents)) or "none: it was drawn by chance"),
        )
        return shown(facts(f"Robot {self.individual}", known), in_words(self.genome))


def champion(records: pd.DataFrame) -> Individual:
    """Return the fittest of a table; among equals, the one that was born first.

    Raises:
        ValueError: if the table is empty.
    """
    if records.empty:
        raise ValueError("no robot has walked yet, so there is no champion")
    row = records.sort_values(["fitness", "individual"], ascending=[False, True], kind="stable").iloc[0]
    return Individual(
        individual=int(row.individual),
        genome=Genome.parse(row.genome),
        fitness=float(row.fitness),
        verdict=row.verdict,
        reason="" if pd.isna(row.reason) else row.reason,
        generation=int(row.born),
        parents=parent_numbers(row.parents),
    )


def lineage(records: pd.DataFrame, individual: int) -> pd.DataFrame:
    """Return the rows of an individual and all its ancestors, youngest first, each at its birth.

    A parent that the table does not have ends the line there.

    Raises:
        ValueError: if no such individual has walked.
    """
    born = births(records)
    if individual not in born.index:
        low, high = born.index.min(), born.index.max()
        raise ValueError(f"individual {individual} is not in this run; its numbers go from {low} to {high}")
    parents = {one: parent_numbers(cell) for one, cell in born.parents.items()}
    waiting, found = [individual], {individual}
    while waiting:
        fresh = {one for one in parents[waiting.pop()] if one in parents} - found
        found |= fresh
        waiting += fresh
    return tidy(born.loc[sorted(found, reverse=True)].reset_index(drop=True))
