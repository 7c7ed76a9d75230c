"""Plot of the line of descent of a robot: the robots of the line, and the genes that changed at each step."""

import math
import textwrap
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from walkerlab.ga.genes import Genes
from walkerlab.genome.features import BODY_FEATURES, SEGMENT_FEATURES
from walkerlab.genome.genome import Genome
from walkerlab.settings.choices import Feature
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.view.painted_bodies import PartPaint, painted_parts
from walkerlab.view.pedigree import Step, changed_parts, describe_step, genes_of_text, trace_line
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.bodies import DEPTH_SHIFT, add_body
from walkerlab.view.plots.gene_notes import EXPLAINED_FEATURES, explain_genes
from walkerlab.view.plots.style import RUN_COLOURS, SECONDARY_STRENGTH, add_description, annotate_no_data, escape_label
from walkerlab.view.plots.tables import UNKNOWN_FITNESS, format_value, require_table, unit_of

TITLE = "Line of descent, with the genes that changed"
COLUMN_WIDTH = 6.4  # width of a column in inches, the unit of all positions below
ROW_HEIGHT = 0.365
MAX_ROWS_OF_SINGLE_COLUMN = 16
SINGLE_COLUMN_SCALE = 1.2  # a figure with a single column is larger, so that it can be read in a notebook
ROBOTS_PER_SCREEN = 40  # number of robots that fit on a screen of 1280 × 800 pixels
MAX_LINE_LENGTH = 64  # maximum length of a line of text, in characters
FONT_SIZE = 7.5  # points
CAPTION_LINE_HEIGHT = 0.165
LINE_LENGTH = 97  # of the caption, per column, in characters; wider lines would shrink the rest of the figure
CHANGED_COLOUR = (0.84, 0.37, 0.0)  # parts that differ from the row above, RGB
EQUAL_COLOUR = (0.82, 0.82, 0.82)
BAR_LEFT = 0.62
BAR_WIDTH = 0.8
BODY_LEFT = 1.5
BODY_WIDTH = 1.05
TEXT_LEFT = 2.66


@styled_plot
def pedigree(
    records: pd.DataFrame,
    ax: Axes | None = None,
    individual: int | None = None,
    settings: Settings | None = None,
    *,
    max_robots: int | None = None,
) -> Axes:
    """Draw the line of descent of a robot through its fitter parents, with the genes that changed at each step.

    The line begins at the top left; a long line continues in a second column. Each row shows the generation and number
    of a robot, its fitness as a bar and a number, its body, and the genes that differ from the robot before it: how
    many came from the other parent, how many have new values, and the largest of these changes. Branches that died
    out are not part of a line of descent. A robot without a visible difference from its parent is left out, so that
    generations without change form one step.

    Args:
        records: Table of a run, or the run.
        ax: Axes to draw on; if None, a new figure is created, whose height suits the number of robots.
        individual: Number of the robot; the champion if None.
        settings: Settings with the loads of the robots; no loads if None.
        max_robots: Maximum number of robots; if None, 40 for each 100 generations of the run, and at least 40.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table has no such individual.
    """
    table = require_table(records, "individual", "born", "parents", "fitness", "verdict", "genome")
    if table.empty:
        axes = ax or new_axes()
        annotate_no_data(axes, "no robot has walked yet")
        add_description(axes, TITLE, "No robot has walked yet.")
        axes.set_axis_off()
        return axes
    n_generations = int(table.generation.max()) + 1
    limit = max_robots or ROBOTS_PER_SCREEN * max(1, math.ceil(n_generations / 100))
    steps = trace_line(table, individual, limit)
    last = steps[-1]
    fitness_name = str(table.attrs.get("fitness", UNKNOWN_FITNESS))
    n_births = sum(step.n_births for step in steps)
    n_columns = 1 if len(steps) <= MAX_ROWS_OF_SINGLE_COLUMN else 2
    caption = _write_caption(
        steps, n_columns, last.individual, is_champion=individual is None, fitness_name=fitness_name
    )
    genes = explain_genes(_explained_features(steps))
    paragraphs = [escape_label(each) for each in (*caption, genes) if each]
    lines = "\n".join(textwrap.fill(each, LINE_LENGTH * n_columns) for each in paragraphs)
    n_rows = max(math.ceil(len(steps) / n_columns), 4)
    width = COLUMN_WIDTH * n_columns
    height = n_rows * ROW_HEIGHT + CAPTION_LINE_HEIGHT * (lines.count("\n") + 1)
    scale = SINGLE_COLUMN_SCALE if n_columns == 1 else 1.0
    axes = ax or new_axes(width * scale, height * scale)
    axes.set_xlim(0, width)
    axes.set_ylim(0, height)
    axes.set_aspect("equal", anchor="N")
    axes.set_axis_off()
    if ax is not None:
        window = axes.get_window_extent()
        scale = min(1.0, window.width / width / axes.figure.dpi, window.height / height / axes.figure.dpi)
    size = max(FONT_SIZE * scale, 2.0)
    _draw_rows(axes, steps, n_rows, settings, unit_of(table, "fitness"), size)

    axes.text(0, height, lines, va="top", fontsize=1.07 * size, linespacing=1.35)
    first = steps[0]
    unit = unit_of(table, "fitness")
    text = (
        f"Line of descent of robot {last.individual}, from robot {first.individual} of generation {first.born} "
        f"({_result(first, unit)}) to generation {last.born} ({_result(last, unit)}): {pluralize(n_births, 'birth')}, "
        f"{len(steps)} robots drawn."
    )
    add_description(axes, TITLE, text)
    return axes


def _write_caption(
    steps: list[Step], n_columns: int, robot: int, is_champion: bool, fitness_name: str
) -> tuple[str, ...]:
    """Return the paragraphs of the caption: the rows, the drawings, and the text of a row."""
    n_births = sum(step.n_births for step in steps)
    champion = ", the fittest of all" if is_champion else ""
    order = " Read down the left column, then down the right one." if n_columns == 2 else ""
    left_out = n_births + 1 - len(steps)
    shown = (
        f" {left_out} of {pluralize(n_births, 'birth')} made no great difference and are not shown." if left_out else ""
    )
    return (
        f"The ancestors of robot {robot}{champion}. Each row is a robot, and the row above it is its parent; of two "
        f"parents, the one with the larger {fitness_name}. A robot can survive for several generations (gen), so that "
        f"some generations have no row.{order}{shown}",
        f"Bar: {fitness_name}. Orange: a trunk or legs that are new, or differ in size, mass or force from the row "
        "above. Robots look to the right, where segment 1 (seg1) is; legs can repeat the pair in front, and then "
        "change with it.",
        "Text: number of genes from the other parent, and number of genes that mutated; below it, these genes with "
        "old value → new value. The first one changed by the largest part of its allowed range. Genes without an "
        "effect on parent and child, for example of a segment that both do not have, are not counted.",
    )


def _draw_rows(axes: Axes, steps: list[Step], n_rows: int, settings: Settings | None, unit: str, size: float) -> None:
    genes = genes_of_text(steps[0].genome)
    bodies = [
        painted_parts(Genome.parse(step.genome), _paint(changed_parts(step, genes), genes), settings) for step in steps
    ]
    corners = [np.concatenate([points for points, _ in parts]) for parts, _ in bodies]
    across = [points[:, 0] + DEPTH_SHIFT * points[:, 1] for points in corners]
    widest = max(float(np.ptp(x)) for x in across)
    highest = max(float(points[:, 2].max()) for points in corners)
    scale = min(BODY_WIDTH / widest, 0.92 * ROW_HEIGHT / highest)
    finite = [step.fitness for step in steps if np.isfinite(step.fitness)]
    longest = max([*finite, 1e-12])
    secondary = foreground_colour(axes, SECONDARY_STRENGTH)
    small: dict[str, Any] = {"fontsize": 0.9 * size, "color": secondary}
    for i, (step, (parts, _), x) in enumerate(zip(steps, bodies, across, strict=True)):
        column, row = divmod(i, n_rows)
        left = column * COLUMN_WIDTH
        bottom = (n_rows - row - 1) * ROW_HEIGHT
        middle = bottom + ROW_HEIGHT / 2
        if row % 2 == 0:
            stripe = Rectangle(
                (left, bottom), COLUMN_WIDTH - 0.1, ROW_HEIGHT, color=foreground_colour(axes, 0.045), lw=0
            )
            axes.add_patch(stripe)
        axes.text(left + 0.04, middle, f"gen {step.born}", va="bottom", fontsize=size, weight="bold")
        axes.text(left + 0.04, middle - 0.01, f"robot {step.individual}", va="top", **small)
        share = max(0.0, step.fitness / longest) if np.isfinite(step.fitness) else 0.0
        bar = Rectangle((left + BAR_LEFT, bottom + 0.06), BAR_WIDTH * share, 0.1, color=RUN_COLOURS[0], lw=0)
        axes.add_patch(bar)
        axes.text(left + BAR_LEFT, bottom + 0.17, escape_label(_result(step, unit)), va="bottom", fontsize=size)
        origin = (left + BODY_LEFT + BODY_WIDTH / 2 - scale * float(x.max() + x.min()) / 2, bottom + 0.015)
        add_body(axes, parts, at=origin, scale=scale, slant=DEPTH_SHIFT, gid=f"robot-{step.individual}")
        first, second = describe_step(step, genes, MAX_LINE_LENGTH)
        axes.text(left + TEXT_LEFT, middle + 0.01, escape_label(second or first), va="top", fontsize=size)
        if second:
            axes.text(left + TEXT_LEFT, middle + 0.015, escape_label(first), va="bottom", **small)


def _explained_features(steps: list[Step]) -> list[Feature]:
    """Return the features in the text of the steps whose names do not explain themselves."""
    genes = genes_of_text(steps[0].genome)
    text = " ".join(describe_step(step, genes, MAX_LINE_LENGTH)[1] for step in steps)
    return [each for each in EXPLAINED_FEATURES if each.name.replace("_", " ") in text]


def _paint(changed: frozenset[str], genes: Genes) -> PartPaint:
    """Return the colours of a body of which some parts changed."""
    n_parts = (len(genes) - len(BODY_FEATURES)) // len(SEGMENT_FEATURES)
    parts = [f"{part}{i + 1}" for i in range(n_parts) for part in ("trunk", "legs")]
    return PartPaint({part: CHANGED_COLOUR if part in changed else EQUAL_COLOUR for part in parts}, changed)


def _result(step: Step, unit: str) -> str:
    return format_value(step.fitness, unit) if step.verdict == "ok" else step.verdict
