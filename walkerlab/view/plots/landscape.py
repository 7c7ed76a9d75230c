"""Plot of a slice of the fitness landscape: a curve along one gene, or a map of two genes."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from walkerlab.settings.choices import Feature
from walkerlab.settings.values import pluralize
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.captions import add_caption
from walkerlab.view.plots.gene_notes import GENE_NOTES, PLAIN_FEATURES, STRIDE_ANGLE, STRIDE_FEATURES
from walkerlab.view.plots.style import RUN_COLOURS, SECONDARY_STRENGTH, add_description, escape_label, style_axes
from walkerlab.view.plots.tables import UNKNOWN_FITNESS, axis_label, format_value

TITLE = "A slice of the fitness landscape"
CENTRE_COLOUR = "#D55E00"


@styled_plot
def landscape(table: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw a slice of the fitness landscape around a genome.

    With one gene, the fitness is a curve with a dot for each walk; with two genes, it is a map on which brighter cells
    are fitter. A star marks the genome itself. Crosses mark walks that do not count. Small rings (small triangles on a
    map) mark walks in which repair changed genes, so that the robot is not exactly on the slice.

    Args:
        table: Table from ``wl.analysis.landscape``.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table is not from ``wl.analysis.landscape``.
    """
    names = list(table.attrs.get("genes", ()))
    if len(names) not in (1, 2) or not {*names, "fitness", "is_centre"} <= set(table.columns):
        raise ValueError("this plot needs the table of wl.analysis.landscape, with its attributes")
    axes = ax or new_axes(*((7.2, 4.0) if len(names) == 1 else (7.2, 5.6)))
    units = table.attrs["units"]
    fitness = axis_label(str(table.attrs.get("fitness", UNKNOWN_FITNESS)), units.get("fitness", ""))
    labels = [_label_gene(name, units.get(name, "")) for name in names]
    (_draw_curve if len(names) == 1 else _draw_map)(axes, table, names, labels, fitness)
    add_description(axes, TITLE, _describe(table, names, units))
    add_caption(axes, _explain(table, names))
    return axes


def spell(gene: str) -> str:
    """Return the name of a gene in words: ``leg length of segment 1``."""
    segment, _, feature = gene.rpartition(".")
    return feature.replace("_", " ") + (f" of segment {segment.removeprefix('seg')}" if segment else "")


def _label_gene(gene: str, unit: str) -> str:
    """Return the label of the axis of a gene: its name with the unit and, below, what it describes if unclear."""
    feature = Feature[gene.rpartition(".")[2]]
    label = axis_label(spell(gene), unit)
    if feature in PLAIN_FEATURES:
        return label
    angle = f"\n({STRIDE_ANGLE})" if feature in STRIDE_FEATURES else ""
    return f"{label}\n{GENE_NOTES[feature]}{angle}"


def _draw_curve(axes: Axes, table: pd.DataFrame, names: list[str], labels: list[str], fitness: str) -> None:
    walks: Any = table[~table.is_centre]
    centre: Any = table[table.is_centre].iloc[0]
    counts = (walks.verdict == "ok").to_numpy()
    x = walks[names[0]].to_numpy()
    y = walks.fitness.to_numpy()
    is_on_slice = walks.n_repaired.to_numpy() == 0
    axes.plot(x, np.where(counts, y, np.nan), color=RUN_COLOURS[0], lw=1.5)
    axes.plot(x[counts & is_on_slice], y[counts & is_on_slice], "o", ms=4, color=RUN_COLOURS[0], label="a walk")
    if (counts & ~is_on_slice).any():
        axes.plot(
            x[counts & ~is_on_slice], y[counts & ~is_on_slice], "o", ms=5, mfc="white", mec=RUN_COLOURS[0],
            label="a walk; repair changed genes",
        )  # fmt: skip
    if (~counts).any():
        axes.plot(
            x[~counts], np.full(int((~counts).sum()), 0.02), "x", ms=5,
            color=foreground_colour(axes, SECONDARY_STRENGTH),
            transform=axes.get_xaxis_transform(), label="the walk does not count",
        )  # fmt: skip
    if centre.verdict == "ok":
        axes.plot(
            centre[names[0]], centre.fitness, "*", ms=14, color=CENTRE_COLOUR, mec="white", label="the robot itself"
        )
    axes.set_xlabel(labels[0])
    axes.set_ylabel(escape_label(fitness))
    style_axes(axes)
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=2, fontsize=8.5, borderaxespad=0.2)


def _draw_map(axes: Axes, table: pd.DataFrame, names: list[str], labels: list[str], fitness: str) -> None:
    walks: Any = table[~table.is_centre]
    centre: Any = table[table.is_centre].iloc[0]
    x, y = (np.unique(walks[name].to_numpy()) for name in names)
    values = walks.fitness.where(walks.verdict == "ok").to_numpy().reshape(len(x), len(y)).T
    mesh = axes.pcolormesh(x, y, np.ma.masked_invalid(values), cmap="cividis", shading="nearest", rasterized=True)
    bar = axes.figure.colorbar(mesh, ax=axes, pad=0.02)
    bar.set_label(escape_label(fitness))
    bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]
    axes.set_facecolor("white")
    for wanted, marker, label in (
        (walks.verdict != "ok", "x", "the walk does not count"),
        ((walks.verdict == "ok") & (walks.n_repaired > 0), "^", "repair changed genes"),
    ):
        if wanted.any():
            colour = "0.45" if marker == "x" else "white"
            axes.plot(
                walks[names[0]][wanted], walks[names[1]][wanted], marker, ms=3.5, color=colour,
                mec=colour if marker == "x" else "0.2", mew=0.9 if marker == "x" else 0.4, ls="", label=label,
            )  # fmt: skip
    axes.plot(
        centre[names[0]], centre[names[1]], "*", ms=16, color=CENTRE_COLOUR, mec="white", mew=1.2, ls="",
        label="the robot itself",
    )  # fmt: skip
    axes.set_xlabel(labels[0])
    axes.set_ylabel(labels[1])
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=3, fontsize=8.5, borderaxespad=0.2)


def _explain(table: pd.DataFrame, names: list[str]) -> str:
    """Explain how to read the plot."""
    varied = " and ".join(map(spell, names))
    fitness = str(table.attrs.get("fitness", UNKNOWN_FITNESS))
    settings = table.attrs.get("settings")
    seconds = f" of {settings.simulation.duration:g} s" if settings else ""
    n_walks = int((~table.is_centre).sum())
    each, better = ("dot", "higher") if len(names) == 1 else ("cell", "brighter (yellow)")
    backward = " (below 0: backward)" if fitness == "distance" else ""
    return (
        f"The {fitness} that one robot would reach if its {varied} had other values and all its other genes stayed as "
        f"they are. Each {each} is one of {n_walks} such walks{seconds}: the {better}, the better{backward}. The star "
        "is the robot itself."
    )


def _describe(table: pd.DataFrame, names: list[str], units: dict[str, str]) -> str:
    """Describe the best walk of a slice in one or two sentences."""
    counted = table[table.verdict == "ok"]
    varied = " and ".join(map(spell, names))
    if counted.empty:
        return f"Fitness of {len(table) - 1} walks in which only {varied} varies; no walk counts."
    best: Any = counted.loc[counted.fitness.idxmax()]
    centre: Any = table[table.is_centre].iloc[0]
    place = " and ".join(f"{spell(name)} {format_value(float(best[name]), units.get(name, ''))}" for name in names)
    own = format_value(float(centre.fitness), units.get("fitness", "")) if centre.verdict == "ok" else centre.verdict
    n_void = len(table) - len(counted)
    return (
        f"Fitness of {len(table) - 1} walks in which only {varied} varies, around a genome with the result {own}. The "
        f"best walk, {format_value(float(best.fitness), units.get('fitness', ''))}, has {place}; "
        f"{pluralize(n_void, 'walk')} {'does' if n_void == 1 else 'do'} not count."
    )
