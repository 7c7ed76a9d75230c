"""Summary of an experiment: two tables and a text, for a notebook, a terminal and a report."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from walkerlab.settings.values import pluralize
from walkerlab.text.numbers import NO_VALUE, format_significant
from walkerlab.text.templates import Markup, render

Cells = list[list[str]]


@dataclass(frozen=True, eq=False)
class Summary:
    """Result of an experiment.

    Attributes:
        text: What the experiment has shown, in one or a few sentences.
        conditions: A row for each condition; see ``tabulate_conditions``.
        comparisons: A row for each pair; see ``tabulate_comparisons``.
        n_seeds: Number of seeds whose runs have all ended; only these are included.
        fitness: Name and unit of the fitness, as on an axis.
    """

    text: str
    conditions: pd.DataFrame
    comparisons: pd.DataFrame
    n_seeds: int
    fitness: str

    def __str__(self) -> str:
        """Return the text and the tables for a terminal."""
        parts = [self.text]
        parts += [_as_text(header, cells) for _, header, cells in self.tables() if cells]
        return "\n\n".join(parts)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return self.to_html()

    def to_html(self) -> Markup:
        """Return the text and the tables as an element of a page."""
        return render("experiment/summary.html", text=self.text, tables=self.tables())

    def tables(self) -> list[tuple[str, list[str], Cells]]:
        """Return caption, column names and cells of both tables."""
        return [
            (
                f"Best {self.fitness} of each run, over {pluralize(self.n_seeds, 'seed')}",
                [
                    "condition",
                    "median",
                    "95 % interval",
                    "counted walks",
                    "threshold",
                    "reached by",
                    "robots until then",
                ],
                condition_cells(self.conditions),
            ),
            (
                "Comparisons of the same seeds",
                [
                    *("pair", "difference of medians", "95 % interval", "seeds won", "A12", "95 % interval", "p"),
                    *("p, corrected", "detectable"),
                ],
                comparison_cells(self.comparisons),
            ),
        ]


def condition_cells(conditions: pd.DataFrame) -> Cells:
    """Return the cells of the table of conditions."""
    rows: list[Any] = list(conditions.itertuples())
    return [
        [
            str(row.condition),
            format_significant(row.best),
            _interval(row.best_low, row.best_high),
            f"{row.counted:.0%}",
            format_significant(row.threshold),
            f"{row.reached} of {row.runs}",
            f"{row.evaluations:.0f}" if np.isfinite(row.evaluations) else f"> {row.budget:.0f}",
        ]
        for row in rows
    ]


def comparison_cells(comparisons: pd.DataFrame) -> Cells:
    """Return the cells of the table of comparisons."""
    rows: list[Any] = list(comparisons.itertuples())
    return [
        [
            f"{row.a} − {row.b}",
            format_significant(row.difference),
            _interval(row.low, row.high),
            f"{row.a_better} : {row.b_better}",
            f"{row.a12:.2f}",
            f"{row.a12_low:.2f} to {row.a12_high:.2f}",
            _p_text(row.p),
            _p_text(row.p_corrected),
            "nothing" if row.detectable == np.inf else format_significant(row.detectable),
        ]
        for row in rows
    ]


def _interval(low: float, high: float) -> str:
    if np.isnan(low) or np.isnan(high):
        return NO_VALUE
    return f"{format_significant(low)} to {format_significant(high)}"


def _p_text(p: float) -> str:
    return "< 0.001" if p < 0.001 else f"{p:.3f}"


def _as_text(header: list[str], cells: Cells) -> str:
    """Return a table with aligned columns."""
    rows = [header, *cells]
    widths = [max(len(row[column]) for row in rows) for column in range(len(header))]
    lines = [
        "  ".join(cell.ljust(width) if column == 0 else cell.rjust(width) for column, (cell, width) in enumerate(pairs))
        for pairs in (list(zip(row, widths, strict=True)) for row in rows)
    ]
    return "\n".join(line.rstrip() for line in lines)
