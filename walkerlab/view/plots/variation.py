"""Plot of what an operator does to a whole population: the values of each gene before and after it."""

from collections.abc import Iterable
from itertools import groupby
from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from walkerlab.analysis.inheritance import gene_widths, shortest_change
from walkerlab.ga.genes import Floats, Genes
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome, read_genomes
from walkerlab.settings.choices import Crossover, Mutation
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.captions import add_caption
from walkerlab.view.plots.gene_notes import EXPLAINED_FEATURES, explain_genes
from walkerlab.view.plots.operator_words import explain_operator
from walkerlab.view.plots.style import RUN_COLOURS, SECONDARY_STRENGTH, add_description

Genomes: TypeAlias = Iterable[Genome | str | ArrayLike]

TITLE = "A population before and after an operator"
BAR_OFFSET = 0.19  # distance of the two bars of a gene from the middle of its column
BEFORE_COLOUR = "#a6a6a6"


@styled_plot
def before_after(
    before: Genomes, after: Genomes, ax: Axes | None = None, settings: Settings | None = None, *, label: str = ""
) -> Axes:
    """Draw the values of each gene in a population before and after an operator.

    Each gene has two bars: grey with a hollow dot before, blue with a filled dot after. The thin bar spans all
    values, the thick bar spans their middle half, and the dot is the median, as positions in the range of the gene.
    Mutation lengthens bars, selection and weighted crossover shorten them, and a crossover that only exchanges genes
    leaves them almost the same.

    Args:
        before: Genomes of the population before the operator.
        after: Genomes after it; their number may differ.
        ax: Axes to draw on; if None, a new figure is created.
        settings: Settings with the limits of the robots; the defaults if None.
        label: Name of the operator in the title.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If there are no genomes, or their length does not match the limits.
    """
    robot = settings.robot if settings else Robot()
    genes = build_genes(robot)
    first, second = _read_table(before, genes), _read_table(after, genes)
    tables = [first, second]
    axes = ax or new_axes(12.0, 4.8)
    x = np.arange(len(genes))
    for table, offset, colour, face in zip(
        tables, (-BAR_OFFSET, BAR_OFFSET), (BEFORE_COLOUR, RUN_COLOURS[0]), ("white", RUN_COLOURS[0]), strict=True
    ):
        positions = (table - genes.low) / gene_widths(genes)
        low, lower, median, upper, high = (np.quantile(positions, share, axis=0) for share in (0, 0.25, 0.5, 0.75, 1))
        axes.vlines(x + offset, low, high, color=colour, lw=0.9)
        axes.vlines(x + offset, lower, upper, color=colour, lw=3.4)
        axes.plot(x + offset, median, "o", ms=3.2, mec=colour, mfc=face, mew=0.9)
    _label_genes(axes, genes)
    axes.set_xlim(-0.7, len(genes) - 0.3)
    axes.set_ylim(-0.03, 1.03)
    axes.set_yticks([0, 0.5, 1], ["minimum", "middle", "maximum"])
    axes.set_ylabel("position in the gene's range")
    axes.set_xlabel("gene (a number that describes body or gait)")
    axes.spines[["top", "right", "bottom"]].set_visible(False)
    spreads = [_mean_spread(table, genes) for table in tables]
    changed = _share_changed(first, second, genes)
    facts = [f"mean spread of a gene {spreads[0]:.1%} → {spreads[1]:.1%} of its range"]
    if changed is not None:
        facts.append(f"{changed:.1%} of all genes changed")
    entries = [
        Line2D([], [], color=BEFORE_COLOUR, lw=3.4, marker="o", mfc="white", label=f"before ({len(tables[0])} robots)"),
        Line2D([], [], color=RUN_COLOURS[0], lw=3.4, marker="o", label=f"after ({len(tables[1])} robots)"),
    ]
    axes.legend(handles=entries, frameon=False, loc="lower right", bbox_to_anchor=(1, 1.06), ncols=2, fontsize=8)
    title = f"{label}: " if label else ""
    axes.set_title(title + "; ".join(facts), loc="left", fontsize=9, pad=22)
    subject = f"the operator {label}" if label else "an operator"
    name = label.partition(" ")[0]
    clauses = [clause for kind in (Crossover, Mutation) if (clause := explain_operator(name, kind))]
    # "randomized" is the name of a crossover and of a mutation
    meaning = f" ({clauses[0]})" if len(clauses) == 1 else ""
    add_caption(
        axes,
        f"How {subject}{meaning} changed the genes of a population: the values of each gene before (grey) and after "
        "(blue), as positions between the smallest and the largest allowed value. Thin bar: all robots; thick bar: the "
        "middle half of them; dot: the median. Where the blue bar is longer, the robots became more different; the "
        f"spread is the standard deviation. {explain_genes(EXPLAINED_FEATURES)}",
    )
    add_description(axes, TITLE, f"{title}{'; '.join(facts)}. The spread is the standard deviation.")
    return axes


def _read_table(genomes: Genomes, genes: Genes) -> Floats:
    table = np.array([genome.values for genome in read_genomes(genomes)])
    if table.ndim != 2 or table.shape[1] != len(genes):
        got = f"{table.shape[1]} genes" if table.ndim == 2 else "no genome"
        raise ValueError(f"each genome must have {len(genes)} genes for these limits; got {got}")
    return table


def _mean_spread(table: Floats, genes: Genes) -> float:
    """Return the standard deviation of a gene as a share of its range, averaged over the genes."""
    centred = shortest_change(np.median(table, axis=0), table, genes)
    return float((centred.std(axis=0) / gene_widths(genes)).mean())


def _share_changed(before: Floats, after: Floats, genes: Genes) -> float | None:
    """Return the share of changed genes; None if the rows are not the same robots, as after crossover."""
    if before.shape != after.shape:
        return None
    is_changed = np.abs(shortest_change(before, after, genes)) > 1e-9
    share = float(is_changed.mean())
    return share if share < 1 / 2 else None


def _label_genes(axes: Axes, genes: Genes) -> None:
    """Write the name of each gene below its column, and the name of each segment above its group of columns."""
    names = [name.rpartition(".")[2].replace("_", " ") for name in genes.names]
    axes.set_xticks(range(len(genes)), names, rotation=90, fontsize=7)
    axes.tick_params(axis="x", length=0, pad=2)
    groups = [name.rpartition(".")[0].replace("seg", "segment ") or "body" for name in genes.names]
    start = 0
    colour = foreground_colour(axes, 0.2)
    for group, members in groupby(groups):
        n_columns = len(list(members))
        if start:
            axes.axvline(start - 0.5, color=colour, lw=1)
        axes.text(
            start + (n_columns - 1) / 2, 1.02, group, transform=axes.get_xaxis_transform(), ha="center", va="bottom",
            fontsize=8, color=foreground_colour(axes, SECONDARY_STRENGTH),
        )  # fmt: skip
        start += n_columns
