"""Plots of the genomes of a population: their diversity, and all genes of one generation."""

import math
from functools import partial
from itertools import groupby
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from walkerlab.analysis.distance import aligned_diversity
from walkerlab.ga.genes import Floats, Genes
from walkerlab.genome.features import BODY_FEATURES, SEGMENT_FEATURES, build_genes, is_expressed
from walkerlab.genome.genome import Genome
from walkerlab.settings.robot import Robot
from walkerlab.settings.values import pluralize
from walkerlab.view.plots.appearance import new_axes, styled_plot
from walkerlab.view.plots.groups import draw_groups, read_groups
from walkerlab.view.plots.style import (
    add_description,
    add_legend,
    annotate_no_data,
    count_plots,
    escape_label,
    format_generation_axis,
    integer_locator,
    marker_stride,
    next_run_style,
    require_quantity,
)
from walkerlab.view.plots.tables import describe_change, require_table

MAX_SAMPLE = 200  # maximum number of robots that represent a generation, evenly spaced in the table
DIVERSITY_LABEL = "genetic diversity"
ALIGNED_LABEL = "genetic diversity of aligned bodies"
GENES_TITLE = "The genes of a population"
VOID_COLOUR = "#A84300"  # colour of the line above the robots whose walks do not count
POINTS_PER_INCH = 72


@styled_plot
def diversity(records: Any, ax: Axes | None = None, *, label: str = "", aligned: bool = False) -> Axes:
    """Draw the genetic diversity of each generation: how much two robots typically differ in one gene.

    The difference in a gene is expressed as a fraction of the range of that gene in the gene table of the default
    limits, so that all runs can be compared. For a cyclic gene, it is the chord between two points on a circle, as a
    fraction of the diameter, so that 0.01 and 6.28 rad are close. The diversity is the root mean square over all pairs
    of robots and all genes: 0 if all robots are clones, about 0.4 (0.7 for cyclic genes) if genes are uniformly
    distributed. Genes without effect are included, because children inherit them and may express them. If a generation
    has more than 200 robots, 200 are compared, evenly spaced in the table.

    Args:
        records: Table of a run, or the run; a list of runs, a dict from names to runs or to lists of them, or an
            experiment. For several runs, the median over the runs and their middle half are drawn.
        ax: Axes to draw on; if None, a new figure is created. Each run on the same Axes has its own colour and marker.
        label: Name of the run in the legend.
        aligned: Whether to compare bodies segment by segment, as in ``wl.analysis.aligned_distances``: genes without
            an effect are left out, and a gene with an effect on only one of two robots counts fully.

    Returns:
        The Axes drawn on.
    """
    title = "Genetic diversity of each generation"
    quantity = ALIGNED_LABEL if aligned else DIVERSITY_LABEL
    compute = partial(diversity_by_generation, aligned=aligned)
    if (groups := read_groups(records)) is not None:
        axes = ax or new_axes()
        draw_groups(
            axes,
            groups,
            compute,
            title=title,
            what=f"{quantity}, as a fraction of the ranges of the genes,",
            quantity=quantity,
            label=label,
        )
        _format_diversity_axis(axes, quantity)
        return axes
    records = require_table(records, "genome")
    axes = ax or new_axes()
    require_quantity(axes, quantity)
    values = compute(records)
    colour, marker = next_run_style(axes, title)
    markers: dict[str, Any] = {"marker": marker, "ms": 4, "markevery": marker_stride(len(values))}
    axes.plot(values.index, values, lw=2, color=colour, **markers, label=escape_label(label))
    if values.empty:
        annotate_no_data(axes, "no robot has walked yet")
        text = "No robot has walked yet."
    else:
        name = f"{label}: {quantity}" if label else quantity.capitalize()
        definition = "how much two robots typically differ in one gene, as a fraction of that gene's range,"
        change = describe_change(values.round(3), "")
        text = f"{name} over {pluralize(len(values), 'generation')}: {definition} {change}."
    add_description(axes, title, text, quantity)
    _format_diversity_axis(axes, quantity)
    format_generation_axis(axes, len(values))
    if label:
        add_legend(axes, count_plots(axes, title))
    return axes


def _format_diversity_axis(axes: Axes, quantity: str) -> None:
    axes.set_ylabel(f"{quantity}: difference in one gene\n[fraction of the gene's range]")
    axes.set_ylim(0, max(axes.get_ylim()[1], 0.1))


@styled_plot
def genes(records: pd.DataFrame, ax: Axes | None = None, *, generation: int | None = None) -> Axes:
    """Draw all genes of a generation as a map: a row for each robot, the fittest at the top; a column for each gene.

    The colour is the position of a value within the range of the gene in the run, from the minimum (dark) to the
    maximum (bright) of the whole table. The range of a cyclic gene is the full turn, whose two ends are equal. From
    each of the other generations, at most 200 robots, evenly spaced in the table, contribute to the range. Genes that
    have no effect are hatched: the genes of unexpressed segments, and of legs that do not exist or that repeat others.
    If a column has a single colour, all robots have the same value.

    Args:
        records: Table of a run, or the run.
        ax: Axes to draw on; if None, a new figure is created whose width suits the number of genes.
        generation: Generation to draw; the last one if None.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If this generation is not in the table.
    """
    records = require_table(records, "individual", "fitness", "verdict", "genome")
    if records.empty:
        axes = ax or new_axes()
        annotate_no_data(axes, "no robot has walked yet")
        add_description(axes, GENES_TITLE, "No robot has walked yet.")
        return axes
    last = int(records.generation.max())
    drawn = last if generation is None else generation
    if not (records.generation == drawn).any():
        raise ValueError(
            f"generation {generation} is not in this table; the table contains generations "
            f"{records.generation.min()} to {last}"
        )
    records = records.loc[_select_sample(records) | (records.generation == drawn), :]
    rows = np.flatnonzero(records.generation == drawn)
    rows = rows[np.lexsort((records.individual.to_numpy()[rows], -records.fitness.to_numpy()[rows]))]
    values, table = _parse_genomes(records)
    positions = np.ma.masked_array(_relative_positions(values, table)[rows], ~is_expressed(values[rows]))

    axes = ax or new_axes(width=max(7.2, 1.8 + 0.14 * len(table)), height=4.8)
    axes.patch.set(facecolor="0.93", hatch="/////", edgecolor="0.6", linewidth=0)
    column_edges = np.arange(len(table) + 1) - 0.5
    row_edges = np.arange(len(rows) + 1) + 0.5
    mesh = axes.pcolormesh(column_edges, row_edges, positions, cmap="cividis", vmin=0, vmax=1, rasterized=True)
    axes.invert_yaxis()
    axes.yaxis.set_major_locator(integer_locator())
    axes.set_ylim(len(rows) + 0.5, 0.5)
    axes.set_ylabel("robots by rank (fittest at the top)")
    n_counted = int((records.verdict.to_numpy()[rows] == "ok").sum())
    if n_counted < len(rows):
        _mark_invalid_rows(axes, n_counted + 0.5)
    _label_columns(axes, table)
    bar = axes.figure.colorbar(mesh, ax=axes, pad=0.03, aspect=30, ticks=[0, 0.5, 1])
    bar.ax.set_yticklabels(["minimum\nin this run", "middle", "maximum\nin this run"], fontsize=8)
    bar.set_label("position in the gene's range; hatched: no effect", fontsize=8)
    bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]

    distances = _mean_square_distances(values[rows], values, table)
    most_similar = table.names[int(np.argmin(distances))]
    most_different = table.names[int(np.argmax(distances))]
    add_description(
        axes,
        GENES_TITLE,
        f"The {len(table)} genes of the {pluralize(len(rows), 'robot')} of generation {drawn}, with the fittest at "
        f"the top. {positions.mask.mean():.0%} of the genes have no effect. The robots differ least in "
        f"{_spell_gene(most_similar)} and most in {_spell_gene(most_different)}.",
    )
    return axes


def _mark_invalid_rows(axes: Axes, y: float) -> None:
    """Draw a line above the robots whose walks do not count, with a label beside the map."""
    axes.axhline(y, color="white", lw=2.5)
    axes.axhline(y, color=VOID_COLOUR, lw=1.5, ls="--")
    beside_axes = axes.get_yaxis_transform()
    axes.text(1.005, y, "does\nnot\ncount", transform=beside_axes, fontsize=6, va="top", color=VOID_COLOUR)


def _label_columns(axes: Axes, table: Genes) -> None:
    """Write the name of each gene below its column, and the name of each segment above its group of columns."""
    groups = [name.rpartition(".")[0].replace("seg", "segment ") or "body" for name in table.names]
    names = [name.rpartition(".")[2].replace("_", " ") for name in table.names]
    width = 0.85 * axes.get_window_extent().width / axes.figure.dpi * POINTS_PER_INCH  # the colour bar takes the rest
    font_size = float(np.clip(0.9 * width / len(table), 3.5, 8))
    axes.set_xticks(range(len(table)), names, rotation=90, fontsize=font_size)
    axes.tick_params(axis="x", length=0, pad=2)
    axes.tick_params(axis="y", labelsize=8)
    axes.spines[:].set_visible(False)
    start = 0
    for group, members in groupby(groups):
        n_columns = len(list(members))
        if start:
            axes.axvline(start - 0.5, color="white", lw=2.5)
        middle = start + (n_columns - 1) / 2
        axes.text(middle, 1.01, group, transform=axes.get_xaxis_transform(), ha="center", va="bottom", fontsize=8)
        start += n_columns


def _spell_gene(name: str) -> str:
    """Spell out the name of a gene: ``hip phase of segment 2``."""
    segment, _, gene = name.rpartition(".")
    return f"{gene.replace('_', ' ')}{f' of segment {segment[3:]}' if segment else ''}"


# ------------------------------------------------------------------------------------------------------ computation


def _select_sample(records: pd.DataFrame) -> pd.Series:
    """Return a mask of at most ``MAX_SAMPLE`` evenly spaced rows of each generation."""
    grouped: Any = records.groupby("generation").generation
    position = grouped.cumcount()
    size = grouped.transform("size").clip(lower=MAX_SAMPLE)
    return position * MAX_SAMPLE // size != (position - 1) * MAX_SAMPLE // size


def _parse_genomes(records: pd.DataFrame) -> tuple[Floats, Genes]:
    """Parse the genomes of a table; each text is parsed only once, because elites appear in several generations.

    Returns:
        The genes of each row, shape (n, n_genes), and the names and kinds of the genes; the ranges are the defaults
        rather than the ranges of the run.

    Raises:
        ValueError: If the genomes differ in length (within one run they never do).
    """
    codes, texts = pd.factorize(records.genome)
    parsed = [Genome.parse(text).values for text in texts]
    if len({len(values) for values in parsed}) > 1:
        raise ValueError("the genomes in this table differ in length; plot one run at a time")
    values = np.array(parsed)
    n_parts = (values.shape[1] - len(BODY_FEATURES)) // len(SEGMENT_FEATURES)
    return values[codes], build_genes(Robot(segments=(1, n_parts), legs=(2, 2 * n_parts)))


def _relative_positions(values: Floats, table: Genes) -> Floats:
    """Return the position of each value between the minimum (0) and the maximum (1) of its gene, shape (n, n_genes).

    The range of a cyclic gene is the full turn. A gene that does not vary has the position 0.5.
    """
    low = np.where(table.is_cyclic, table.low, values.min(axis=0))
    high = np.where(table.is_cyclic, table.high, values.max(axis=0))
    span = high - low
    return np.where(span > 0, (values - low) / np.where(span > 0, span, 1), 0.5)


def _mean_square_distances(sample: Floats, ends: Floats, table: Genes) -> Floats:
    """Return the mean square distance in each gene over all pairs of a sample, as a fraction of the gene's range.

    It is computed without enumerating the pairs: for numbers it is twice the variance; for points on a circle of
    diameter 1 it is (1 - r²) / 2 · n / (n - 1), where r is the length of the mean of the unit vectors.

    Args:
        sample: Genomes to compare, shape (n, n_genes).
        ends: Genomes whose minimum and maximum are the range of each gene, shape (m, n_genes).
        table: Names and kinds of the genes.

    Returns:
        The distances, shape (n_genes,).
    """
    n = len(sample)
    if n < 2:
        return np.zeros(len(table))
    low, high = np.where(table.is_cyclic, [table.low, table.high], [ends.min(axis=0), ends.max(axis=0)])
    span = np.where(high > low, high - low, 1)
    mean = np.exp(2j * math.pi * (sample - low) / span).mean(axis=0)
    chords = np.maximum(0.0, 1 - np.abs(mean) ** 2) / 2 * n / (n - 1)
    return np.where(table.is_cyclic, chords, 2 * ((sample - low) / span).var(axis=0, ddof=1))


def diversity_by_generation(records: pd.DataFrame, *, aligned: bool = False) -> pd.Series:
    """Return the diversity of each generation, indexed by generation; see ``diversity``."""
    diversities: dict[int, float] = {}
    if not records.empty:
        records = records.loc[_select_sample(records), :]
        values, table = _parse_genomes(records)
        generations = records.generation.to_numpy()
        for generation in np.unique(generations).tolist():
            sample = values[generations == generation]
            if aligned:
                diversities[generation] = aligned_diversity(sample)
                continue
            distances = _mean_square_distances(sample, np.stack([table.low, table.high]), table)
            diversities[generation] = math.sqrt(distances.mean())
    return pd.Series(diversities, dtype=np.float64).rename_axis("generation")
