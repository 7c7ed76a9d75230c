"""Pictures of what a population inherits: how varied it is, and every gene of every robot."""

import math
from itertools import groupby
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats, Genes
from walkerlab.genome.genome import Genome
from walkerlab.genome.repair import PART, WHOLE, genes_of
from walkerlab.settings.choices import Feature
from walkerlab.settings.robot import Robot
from walkerlab.settings.values import count
from walkerlab.view.plots.appearance import new_axes, picture
from walkerlab.view.plots.style import (
    course,
    describe,
    key,
    literal,
    n_drawn,
    next_look,
    nothing,
    over_generations,
    require_measure,
    round_steps,
    some,
    table_of,
)

READ = 200  # robots of a generation, evenly spread over it, whose genes stand for those of a larger one
DIVERSITY = "genetic diversity"
OF_ANY_BODY = (Feature.length, Feature.mass, Feature.legs)  # a grown segment's genes that it needs no legs for


@picture
def diversity(records: pd.DataFrame, ax: Axes | None = None, *, label: str = "") -> Axes:
    """Draw how different the genomes of each generation are: the typical distance of two robots in a gene.

    The distance of two robots in a gene is a share of that gene's range in the run, from the least to the greatest
    value in the whole table; in a cyclic gene, it is the chord between two points on a circle, as a share of the
    diameter, so that 0.01 and 6.28 rad are neighbours. Drawn is the root of the mean square over all pairs of robots
    and all genes that vary in the run: 0 if all are clones, some 0.4 (0.7 in cyclic genes) if genes are drawn evenly.
    Genes that a robot has not grown count as well: it hands them on, and its children may grow them. Of a generation
    of more than 200 robots, 200 are looked at, evenly spread over it.

    Args:
        records: the tidy table of a run, or the run.
        ax: where to draw; a new figure if None. Several runs on one Axes get a colour and a mark each; each is
            measured by its own ranges.
        label: the name of the line, to tell several runs apart.

    Returns:
        The Axes drawn on.
    """
    records = table_of(records, "genome")
    axes = ax or new_axes()
    title = "Genetic diversity of each generation"
    require_measure(axes, DIVERSITY)
    found = pd.Series(_diversity(records), dtype=np.float64)
    colour, mark = next_look(axes, title)
    line: dict[str, Any] = {"lw": 2, "color": colour, "marker": mark, "ms": 4, "markevery": some(len(found))}
    axes.plot(found.index, found, **line, label=literal(label))
    if found.empty:
        nothing(axes, "no robot has walked yet")
        describe(axes, title, "No robot has walked yet.", DIVERSITY)
    else:
        said = "the typical distance of two robots in a gene, as a share of its range in the run,"
        how = f"{label}: genetic" if label else "Genetic"
        over = f"over {count(len(found), 'generation')}"
        describe(axes, title, f"{how} diversity {over}: {said} {course(found.round(3), '')}.", DIVERSITY)
    axes.set_ylabel("genetic diversity: distance of two robots\n[share of a gene's range in the run]")
    axes.set_ylim(0, max(axes.get_ylim()[1], 0.1))
    over_generations(axes, len(found))
    if label:
        key(axes, n_drawn(axes, title))
    return axes


@picture
def genes(records: pd.DataFrame, ax: Axes | None = None, *, generation: int | None = None) -> Axes:
    """Draw all genes of one population as a map: a row for each robot, the fittest on top; a column for each gene.

    The colour is the place of a value within the gene's range in the run, from the least (dark) to the greatest
    (bright) in the whole table; a cyclic gene's range is the whole turn, of which both ends are the same. Of each other
    generation of more than 200 robots, the range is that of 200, evenly spread over it. What a robot has not grown is
    hatched: whole segments, and the legs of segments without. Where a column is of one colour, the robots agree.

    Args:
        records: the tidy table of a run, or the run.
        ax: where to draw; a new figure, as wide as the genes need, if None.
        generation: whose genes; the last one's if None.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: if there is no such generation.
    """
    records = table_of(records, "individual", "fitness", "verdict", "genome")
    if records.empty:
        axes = ax or new_axes()
        nothing(axes, "no robot has walked yet")
        describe(axes, "The genes of a population", "No robot has walked yet.")
        return axes
    last = int(records.generation.max())
    shown = last if generation is None else generation
    if not (records.generation == shown).any():
        raise ValueError(f"generation {generation} is not in this table; it has {records.generation.min()} to {last}")
    records = records.loc[_evenly_spread(records) | (records.generation == shown), :]
    rows = np.flatnonzero(records.generation == shown)
    order = np.lexsort((records.individual.to_numpy()[rows], -records.fitness.to_numpy()[rows]))
    rows = rows[order]
    values, table = _read(records)
    places = np.ma.masked_array(_places(values, table)[rows], ~_expressed(values[rows], table))

    axes = ax or new_axes(width=max(7.2, 1.8 + 0.14 * len(table)), height=4.8)
    axes.patch.set(facecolor="0.93", hatch="/////", edgecolor="0.6", linewidth=0)
    edges = np.arange(len(table) + 1) - 0.5, np.arange(len(rows) + 1) + 0.5
    picture = axes.pcolormesh(*edges, places, cmap="cividis", vmin=0, vmax=1, rasterized=True)
    axes.invert_yaxis()
    axes.yaxis.set_major_locator(round_steps())
    axes.set_ylim(len(rows) + 0.5, 0.5)
    axes.set_ylabel("robots by rank, the fittest on top")
    n_counted = int((records.verdict.to_numpy()[rows] == "ok").sum())
    if n_counted < len(rows):
        axes.axhline(n_counted + 0.5, color="white", lw=2.5)
        axes.axhline(n_counted + 0.5, color="#A84300", lw=1.5, ls="--")
        beside, colour = axes.get_yaxis_transform(), "#A84300"
        axes.text(1.005, n_counted + 0.5, "does\nnot\ncount", transform=beside, fontsize=6, va="top", color=colour)
    _name_columns(axes, table)
    bar = axes.figure.colorbar(picture, ax=axes, pad=0.03, aspect=30, ticks=[0, 0.5, 1])
    bar.ax.set_yticklabels(["least\nin this run", "halfway", "greatest\nin this run"], fontsize=8)
    bar.set_label("place within the gene's range; hatched: not grown", fontsize=8)
    bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]

    spread = _spread(values[rows], values, table)
    close = table.names[int(np.argmin(spread))]
    far = table.names[int(np.argmax(spread))]
    describe(
        axes,
        "The genes of a population",
        f"The {len(table)} genes of the {count(len(rows), 'robot')} of generation {shown}, the fittest on top: "
        f"{places.mask.mean():.0%} of them are not grown. They agree most in {_spoken(close)}, and differ most in "
        f"{_spoken(far)}.",
    )
    return axes


def _name_columns(axes: Axes, table: Genes) -> None:
    """Write each gene's name below its column, and what it belongs to above its group."""
    heads = [name.rpartition(".")[0].replace("seg", "segment ") or "body" for name in table.names]
    tails = [name.rpartition(".")[2].replace("_", " ") for name in table.names]
    across = axes.get_window_extent().width / axes.figure.dpi * 72 * 0.85  # points; a colour bar takes the rest
    size = float(np.clip(0.9 * across / len(table), 3.5, 8))
    axes.set_xticks(range(len(table)), tails, rotation=90, fontsize=size)
    axes.tick_params(axis="x", length=0, pad=2)
    axes.tick_params(axis="y", labelsize=8)
    axes.spines[:].set_visible(False)
    start = 0
    for head, members in groupby(heads):
        width = len(list(members))
        if start:
            axes.axvline(start - 0.5, color="white", lw=2.5)
        middle = start + (width - 1) / 2
        axes.text(middle, 1.01, head, transform=axes.get_xaxis_transform(), ha="center", va="bottom", fontsize=8)
        start += width


def _spoken(name: str) -> str:
    head, _, tail = name.rpartition(".")
    return f"{tail.replace('_', ' ')}{f' of segment {head[3:]}' if head else ''}"


# ------------------------------------------------------------------------------------------------------ the numbers


def _evenly_spread(records: pd.DataFrame) -> pd.Series:
    """Choose at most ``READ`` rows of each generation: all of them, or every so many."""
    grouped: Any = records.groupby("generation").generation
    place, size = grouped.cumcount(), grouped.transform("size").clip(lower=READ)
    return place * READ // size != (place - 1) * READ // size


def _read(records: pd.DataFrame) -> tuple[Floats, Genes]:
    """Read the genomes of a table, each text once, for elites come again and again.

    Returns:
        (n, n_genes) values, a row for each of the table's; and their names and kinds: the ranges are not the run's.

    Raises:
        ValueError: if the genomes are not all of one length, as those of one run are.
    """
    codes, texts = pd.factorize(records.genome)
    found = [Genome.parse(text).values for text in texts]
    if len({len(values) for values in found}) > 1:
        raise ValueError("the genomes of this table differ in length; draw the table of one run at a time")
    values = np.array(found)
    n_parts = (values.shape[1] - len(WHOLE)) // len(PART)
    return values[codes], genes_of(Robot(segments=(1, n_parts)))


def _places(values: Floats, table: Genes) -> Floats:
    """Return where each of (n, n_genes) values lies between the least and the greatest of its gene, 0 to 1.

    A cyclic gene's lie on the whole turn; a gene that does not vary is in the middle.
    """
    low = np.where(table.is_cyclic, table.low, values.min(axis=0))
    high = np.where(table.is_cyclic, table.high, values.max(axis=0))
    span = high - low
    return np.where(span > 0, (values - low) / np.where(span > 0, span, 1), 0.5)


def _spread(some: Floats, values: Floats, table: Genes) -> Floats:
    """Return the mean square distance of two of some robots in each gene, (n_genes,), as a share of its range.

    Over all pairs without laying out any: of numbers it is twice their variance; of points on a circle of diameter 1,
    half of what their mean lacks to the rim, by its square.
    """
    n = len(some)
    if n < 2:
        return np.zeros(len(table))
    places = _places(
        np.concatenate([some, values.min(axis=0, keepdims=True), values.max(axis=0, keepdims=True)]), table
    )[:n]
    mean = np.exp(2j * math.pi * places).mean(axis=0)
    chords = np.maximum(0.0, 1 - np.abs(mean) ** 2) / 2 * n / (n - 1)
    return np.where(table.is_cyclic, chords, 2 * places.var(axis=0, ddof=1))


def _diversity(records: pd.DataFrame) -> dict[int, float]:
    """Return the diversity of each generation."""
    if records.empty:
        return {}
    records = records.loc[_evenly_spread(records), :]
    values, table = _read(records)
    ends = np.stack([values.min(axis=0), values.max(axis=0)])
    vary = ends[1] > ends[0]
    number = records.generation.to_numpy()
    found: dict[int, float] = {}
    for generation in np.unique(number).tolist():
        spread = _spread(values[number == generation], ends, table)[vary]
        found[generation] = math.sqrt(spread.mean()) if vary.any() else 0.0
    return found


def _expressed(values: Floats, table: Genes) -> NDArray[np.bool_]:
    """Say of (n, n_genes) genes which are grown: those of segments that are there, and of legs that these have."""
    grown = np.arange(table.n_parts) < table.n_grown(values)[:, np.newaxis]
    legged = table.parts(values)[:, :, PART.index(Feature.legs)] > 0
    of_any = np.array([feature in OF_ANY_BODY for feature in PART])
    parts = grown[:, :, np.newaxis] & (of_any | legged[:, :, np.newaxis])
    whole = np.ones((len(values), table.n_whole), dtype=np.bool_)
    return np.concatenate([whole, parts.reshape(len(values), -1)], axis=1)
