"""Plot of a birth gene by gene: parents, child, and a table of its genes coloured by their origin."""

import textwrap
from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Rectangle

from walkerlab.analysis.inheritance import Birth, parent_letter
from walkerlab.genome.features import BODY_FEATURES, SEGMENT_FEATURES
from walkerlab.genome.genome import Genome
from walkerlab.settings.choices import Crossover, Mutation
from walkerlab.settings.settings import Settings
from walkerlab.view.inheritance import GeneMark, cell_colour, describe_birth, mark_genes, parent_colour
from walkerlab.view.painted_bodies import PartPaint, paint_child, paint_parent, painted_parts
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.bodies import DEPTH_SHIFT, BodyParts, add_body
from walkerlab.view.plots.gene_notes import GENE_NOTES, STRIDE_ANGLE
from walkerlab.view.plots.operator_words import explain_operator
from walkerlab.view.plots.style import SECONDARY_STRENGTH, add_description, escape_label
from walkerlab.world.geometry import ROPE_POINTS, convex_outline

TITLE = "One birth, gene by gene"
WIDTH = 12.0  # width of the figure in inches, the unit of all positions below
LABEL_WIDTH = 0.95
CELL_WIDTH = (WIDTH - LABEL_WIDTH) / len(SEGMENT_FEATURES)
CELL_HEIGHT = 0.46
BODY_HEIGHT = 1.75  # height of the drawings of the bodies
BODY_SCALE = 3.0  # maximum scale of the bodies, in inches per metre
MAX_BODIES = 3  # maximum number of parents that are drawn
HEADING_HEIGHT = 0.8
CAPTION_LINE_HEIGHT = 0.155
LINE_LENGTH = 160  # of the caption, in characters; the layout shrinks all else if a line is wider than the figure
CROSSOVERS_OF_COUPLES = {"paired", "weighted", "one_point", "uniform"}
GROUPS = ("trunk",) * 4 + ("legs",) * 2 + ("hip",) * 3 + ("knee",) * 3 + ("left/right",)
"""Heading above the name of each feature of a segment."""
NOTE_SIZE = 0.72  # size of the note on a gene, as a fraction of that of other text
NOTE_LENGTH = 16  # maximum number of characters in a line of a note
FONT_SIZE = 8.5  # points, in a figure of full size
TEXT_COLOUR = "#1a1a1a"
FAINT_TEXT_COLOUR = "#6b6b6b"


@styled_plot
def birth(birth: Birth, ax: Axes | None = None, settings: Settings | None = None) -> Axes:
    """Draw a birth gene by gene: the parents, the child, and a table of its genes coloured by their origin.

    Each cell is a gene of the child. Its letter and colour name the parent from which it comes; a number after the
    letter is the segment of the parent from which the gene was moved. Changed genes have a bold frame and show the
    amount of the change in the unit of the gene; the frame is dashed if the change was made by repair. Genes without an
    effect on the child are hatched. In the drawings, the trunk and the legs of each segment have the colour of the
    parent from which their size comes, and changed parts have a bold outline.

    Args:
        birth: Birth, as returned by ``wl.analysis.mate``, ``wl.analysis.mutate`` or ``wl.explain_birth``.
        ax: Axes to draw on; if None, a new figure is created.
        settings: Settings with the loads of the robots; no loads if None.

    Returns:
        The Axes drawn on.
    """
    n_parts = birth.genes.n_parts
    caption = _caption(birth)
    top = CAPTION_LINE_HEIGHT * (caption.count("\n") + 1.5) + n_parts * CELL_HEIGHT + HEADING_HEIGHT
    ground = top + CELL_HEIGHT + 0.25
    height = ground + BODY_HEIGHT + 0.1
    axes = ax or new_axes(WIDTH, height)
    axes.set_xlim(0, WIDTH)
    axes.set_ylim(0, height)
    axes.set_aspect("equal", anchor="N")
    axes.set_axis_off()
    window = axes.get_window_extent()
    size = FONT_SIZE
    if ax is not None:
        size = float(np.clip(size * min(window.width / WIDTH, window.height / height) / axes.figure.dpi, 2.5, size))
    _draw_bodies(axes, birth, settings, ground, size)
    marks = mark_genes(birth)
    secondary = foreground_colour(axes, SECONDARY_STRENGTH)
    label: dict[str, Any] = {"va": "center", "fontsize": size}
    axes.text(0, top + CELL_HEIGHT / 2, "whole body", **label)
    for i, mark in enumerate(marks[: len(BODY_FEATURES)]):
        x = LABEL_WIDTH + (2 * i + 1) * CELL_WIDTH
        unit = birth.genes.units[i]
        name = f"{mark.name} [{unit}]" if unit else mark.name
        note = textwrap.fill(GENE_NOTES[BODY_FEATURES[i]], NOTE_LENGTH)
        right: dict[str, Any] = {"ha": "right", "fontsize": NOTE_SIZE * size, "linespacing": 1.05}
        axes.text(x - 0.06, top + 0.66 * CELL_HEIGHT, name, ha="right", va="bottom", fontsize=0.8 * size)
        axes.text(x - 0.06, top + 0.64 * CELL_HEIGHT, note, va="top", color=secondary, **right)
        _draw_cell(axes, mark, x, top, size)
    _draw_headings(axes, birth, top - HEADING_HEIGHT, size)
    n_expressed = int(birth.genes.n_expressed(birth.child[np.newaxis])[0])
    of_parts = iter(marks[len(BODY_FEATURES) :])
    for part in range(n_parts):
        y = top - HEADING_HEIGHT - (part + 1) * CELL_HEIGHT
        name = f"segment {part + 1}" + ("" if part < n_expressed else "\n(not expressed)")
        axes.text(0, y + CELL_HEIGHT / 2, name, linespacing=1.0, **label)
        for column in range(len(SEGMENT_FEATURES)):
            _draw_cell(axes, next(of_parts), LABEL_WIDTH + column * CELL_WIDTH, y, size)
    colour = foreground_colour(axes, 0.8)
    axes.text(0, 0, escape_label(caption), va="bottom", fontsize=size, linespacing=1.3, color=colour)
    add_description(axes, TITLE, describe_birth(birth))
    return axes


def _caption(birth: Birth) -> str:
    """Explain what the plot shows, and the signs, colours and frames that it contains."""
    origins = birth.origins
    has_parents = len(birth.parents) > 1
    shown = (
        f"How {birth.name} was made from {'its parents' if has_parents else birth.names[0]}: the table has the child's "
        "genes, the numbers that describe its body and gait, in one row for each segment; segment 1 is the front, on "
        "the right."
    )
    # Both kinds have an operator "randomized": with several parents, the first operator is a crossover.
    first = (Crossover, Mutation) if has_parents else (Mutation, Crossover)
    known = [
        (name, explain_operator(name, *(first if i == 0 else (Mutation, Crossover))))
        for i, name in enumerate(birth.operators)
    ]
    clauses = [(name, clause) for name, clause in known if clause]
    steps = [f"Then {name}: {clause}." if i else f"First {name}: {clause}." for i, (name, clause) in enumerate(clauses)]
    if not has_parents and birth.operators and birth.operators[0] in CROSSOVERS_OF_COUPLES:
        steps.insert(0, f"Both parents were {birth.names[0]}, which was drawn twice.")
    is_changed = birth.change != 0
    entries = {
        "letter and colour of a cell: parent from which the gene comes": has_parents,
        "colour of a part in the drawing: parent of its length (or of its mass or force, if the lengths are equal)": (
            has_parents
        ),
        "white with = , or grey in the drawing: equal in all parents": "same" in origins,
        "number: segment of the parent from which the gene was moved": birth.is_moved.any(),
        "percentages: share of each parent": "blend" in origins,
        "new: not from a parent": "new" in origins,
        "bold frame: changed, by the bold number in the gene's unit": is_changed.any(),
        "bold outline: part with such a gene": (is_changed & birth.is_expressed).any(),
        "dashed frame: changed by repair, which keeps robots within their limits": (
            birth.is_repaired & is_changed
        ).any(),
        "hatched: no effect, for example because the segment copies the legs in front (repeat)": not (
            birth.is_expressed.all()
        ),
        f"lag, phase, stride: {STRIDE_ANGLE}": True,
        "origins inferred from the genomes": not birth.is_exact,
    }
    key = "; ".join(entry for entry, is_shown in entries.items() if is_shown)
    return "\n".join(textwrap.fill(line, LINE_LENGTH) for line in (" ".join([shown, *steps]), f"Key – {key}."))


def _draw_headings(axes: Axes, birth: Birth, y: float, size: float) -> None:
    """Write the names of the features of a segment, with their units, above the columns."""
    colour = foreground_colour(axes, SECONDARY_STRENGTH)
    first = len(BODY_FEATURES)
    for column, feature in enumerate(SEGMENT_FEATURES):
        words = feature.name.removeprefix("leg_").removeprefix("hip_").removeprefix("knee_")
        unit = birth.genes.units[first + column]
        name = f"{words} [{unit}]" if unit not in ("", "pair") else words
        x = LABEL_WIDTH + (column + 0.5) * CELL_WIDTH
        note = textwrap.fill(GENE_NOTES[feature], NOTE_LENGTH)
        centred: dict[str, Any] = {"ha": "center", "linespacing": 1.05}
        axes.text(x, y + 0.41, name, va="bottom", fontsize=0.8 * size, **centred)
        axes.text(x, y + 0.39, note, va="top", fontsize=NOTE_SIZE * size, color=colour, **centred)
    column = 0
    for group, members in groupby(GROUPS):
        n_columns = len(list(members))
        left = LABEL_WIDTH + column * CELL_WIDTH + 0.04
        right = LABEL_WIDTH + (column + n_columns) * CELL_WIDTH - 0.04
        axes.plot([left, right], [y + 0.57, y + 0.57], color=colour, lw=0.6)
        axes.text((left + right) / 2, y + 0.59, group, ha="center", va="bottom", fontsize=0.9 * size)
        column += n_columns


def _draw_cell(axes: Axes, mark: GeneMark, x: float, y: float, size: float) -> None:
    """Draw the cell of one gene with its lower left corner at (x, y): background, sign, value and change."""
    gap = 0.02
    box = (x + gap, y + gap), CELL_WIDTH - 2 * gap, CELL_HEIGHT - 2 * gap
    text_colour = TEXT_COLOUR if mark.is_expressed else FAINT_TEXT_COLOUR
    axes.add_patch(Rectangle(*box, facecolor=cell_colour(mark), edgecolor="#b5b5b5", lw=0.5, gid=f"gene-{mark.name}"))
    if not mark.is_expressed:
        axes.add_patch(Rectangle(*box, facecolor="none", edgecolor="#c4c4c4", hatch="///", lw=0))
    if mark.change:
        style = "--" if mark.by_repair else "-"
        axes.add_patch(Rectangle(*box, facecolor="none", edgecolor=TEXT_COLOUR, lw=1.8, ls=style))
    axes.text(x + 0.06, y + CELL_HEIGHT - 0.05, mark.sign, va="top", fontsize=0.8 * size, color=text_colour)
    middle = y + 0.3 * CELL_HEIGHT
    axes.text(x + CELL_WIDTH - 0.06, middle, mark.value, ha="right", va="center", fontsize=size, color=text_colour)
    if mark.change:
        axes.text(
            x + CELL_WIDTH - 0.06, y + CELL_HEIGHT - 0.05, mark.change, ha="right", va="top", fontsize=0.85 * size,
            weight="bold", color=TEXT_COLOUR, bbox={"facecolor": cell_colour(mark), "edgecolor": "none", "pad": 0.4},
        )  # fmt: skip


def _draw_bodies(axes: Axes, birth: Birth, settings: Settings | None, ground: float, size: float) -> None:
    """Draw the parents, an arrow, and the child, all at the same scale."""
    n_drawn = min(len(birth.parents), MAX_BODIES)
    genomes = [Genome(values) for values in birth.parents[:n_drawn]] + [birth.genome]
    paints: list[PartPaint] = [paint_parent(values, i) for i, values in enumerate(birth.parents[:n_drawn])]
    paints.append(paint_child(birth))
    names = [_parent_title(birth, i) for i in range(n_drawn)]
    if len(birth.parents) > n_drawn:
        names[-1] += f"   (and {len(birth.parents) - n_drawn} more parents)"
    bodies = [painted_parts(genome, paint, settings) for genome, paint in zip(genomes, paints, strict=True)]
    corners = [np.concatenate([points for points, _ in parts]) for parts, _ in bodies]
    across = [points[:, 0] + DEPTH_SHIFT * points[:, 1] for points in corners]
    widest = max(float(np.ptp(x)) for x in across)
    highest = max(float(points[:, 2].max()) for points in corners)
    slot = WIDTH / len(bodies)
    scale = min(BODY_SCALE, 0.76 * slot / widest, (BODY_HEIGHT - 0.4) / highest)
    for i, ((parts, changed), x) in enumerate(zip(bodies, across, strict=True)):
        origin = (slot * (i + 0.5) - scale * float(x.max() + x.min()) / 2, ground)
        add_body(axes, parts, at=origin, scale=scale, slant=DEPTH_SHIFT)
        outline_changed(axes, parts, changed, at=origin, scale=scale)
        middle = slot * (i + 0.5)
        axes.plot([middle - 0.42 * slot, middle + 0.42 * slot], [ground, ground], color="0.6", lw=0.8)
        is_child = i == n_drawn
        name = birth.name if is_child else names[i]
        colour = TEXT_COLOUR if is_child else tuple(0.75 * np.array(parent_colour(i)))
        axes.text(middle, ground + BODY_HEIGHT + 0.05, escape_label(name), ha="center", va="top", fontsize=1.15 * size,
                  weight="bold", color=colour)  # fmt: skip
    operators = "\n".join(birth.operators)
    axes.text(slot * n_drawn, ground + 0.62, operators, ha="center", va="bottom", fontsize=size, linespacing=1.1)
    arrow = {"arrowstyle": "-|>", "lw": 1.6, "color": foreground_colour(axes, SECONDARY_STRENGTH)}
    axes.annotate("", (slot * n_drawn + 0.3, ground + 0.5), (slot * n_drawn - 0.3, ground + 0.5), arrowprops=arrow)


def outline_changed(
    axes: Axes, parts: BodyParts, changed: Sequence[bool], *, at: tuple[float, float], scale: float, width: float = 2.0
) -> None:
    """Draw a bold outline around the changed parts of a body.

    Args:
        axes: Axes with the body.
        parts: Parts of the body.
        changed: Whether each part was changed.
        at: Position of the origin of the body, in data coordinates.
        scale: Data units per metre.
        width: Width of the outline [points].
    """
    view = np.array([(1.0, 0.0), (DEPTH_SHIFT, 0.0), (0.0, 1.0)])
    outlines = [
        convex_outline(points @ view) * scale + at
        for (points, _), is_changed in zip(parts, changed, strict=True)
        if is_changed and len(points) != ROPE_POINTS
    ]
    axes.add_collection(PolyCollection(outlines, facecolors="none", edgecolors=TEXT_COLOUR, linewidths=width))


def _parent_title(birth: Birth, parent: int) -> str:
    """Return the letter and the name of a parent; its name if it is the only one."""
    name = birth.names[parent]
    return name if len(birth.names) == 1 else f"{parent_letter(parent)}: {name}"
