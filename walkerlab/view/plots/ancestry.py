"""Plot of the family tree of a robot."""

from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from walkerlab.runfile.records import find_champion, fitter_line, parent_numbers, select_lineage
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.bodies import DEPTH_SHIFT, BodyParts, add_body, resting_scene, standing_parts
from walkerlab.view.plots.style import SECONDARY_STRENGTH, add_description, annotate_no_data, escape_label
from walkerlab.view.plots.tables import UNKNOWN_FITNESS, require_table, unit_of
from walkerlab.view.plots.tree_nodes import (
    COLUMN_GAP,
    add_label,
    draw_fitter_parent,
    draw_omission,
    draw_other_parent,
    format_fitness,
    place_nodes,
)

MAX_COMPLETE_LINE = 16  # maximum number of robots in a line of descent that is drawn without gaps
N_DRAWN_OF_LONG_LINE = 12  # number of robots drawn of a longer line
N_LATEST = 4  # number of these at the lower end of the line, which are drawn without gaps

BODY_WIDTH = 1.15  # inches, width of the longest body
TEXT_WIDTH = 1.15  # inches beside a column of bodies
FONT_SIZE = 8.0  # points, text size in a figure of unrestricted size
MIN_FONT_SIZE = 3.0  # points
TITLE = "Family tree"


@styled_plot
def family_tree(
    records: pd.DataFrame, ax: Axes | None = None, individual: int | None = None, settings: Settings | None = None
) -> Axes:
    """Draw the line of descent of a robot through the fitter parents, with the other parents beside it.

    Time runs downward. A thick line joins the fitter parent to its child, a thin line the other parent. A line of more
    than sixteen robots is drawn in part: the first, the last few, and some in between, twelve in all; a dashed line
    replaces the omitted ancestors and gives their number. If a child has many parents, as after randomized crossover,
    the two fittest are drawn. All bodies have the same scale. The tree ends at parents that the table does not contain.

    Args:
        records: Table of a run, or the run.
        ax: Axes to draw on; if None, a new figure is created whose height suits the tree.
        individual: Number of the robot; the champion if None.
        settings: Settings whose loads are drawn; no loads if None.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: If the table has no such individual.
    """
    columns = ("individual", "born", "parents", "operators", "fitness", "verdict", "reason", "genome")
    records = require_table(records, *columns)
    if records.empty:
        axes = ax or new_axes()
        annotate_no_data(axes, "no robot has walked yet")
        add_description(axes, TITLE, "No robot has walked yet.")
        axes.set_axis_off()
        return axes
    number = find_champion(records).individual if individual is None else individual
    births = select_lineage(records, number).set_index("individual", drop=False)
    line = fitter_line(births, number)[::-1]
    drawn = _choose_drawn(len(line))
    members = [line[i] for i in drawn]
    other_parents = _find_other_parents(births, line, drawn)
    scenes = {one: resting_scene(births.genome[one], settings) for one in [*members, *other_parents.values()]}
    parts: dict[int, BodyParts] = {one: standing_parts(scene) for one, scene in scenes.items()}
    nodes, body_width, body_height = place_nodes(births, members, other_parents, parts)

    text_width = TEXT_WIDTH / BODY_WIDTH * body_width
    gap = (body_width, (1 + COLUMN_GAP) * body_width)
    left = -text_width
    right = gap[1] + body_width + text_width
    bottom = -0.1 * body_height
    top = max(node.top for node in nodes.values()) + 0.1 * body_height
    scale = BODY_WIDTH / body_width  # inches per metre
    axes = ax or new_axes((right - left) * scale, (top - bottom) * scale + 0.35)
    font_size = FONT_SIZE
    if ax is not None:
        window = axes.get_window_extent()
        given_scale = min(window.width / (right - left), window.height / (top - bottom)) / axes.figure.dpi
        font_size = float(np.clip(FONT_SIZE * given_scale / scale, MIN_FONT_SIZE, FONT_SIZE))
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal", anchor="N")
    axes.set_axis_off()

    member_text_x = -0.05 * body_width
    other_text_x = gap[1] + 1.05 * body_width
    last_generations = records[records.individual.isin(list(nodes))].groupby("individual").generation.max()
    unit = unit_of(records, "fitness")
    for one, node in nodes.items():
        add_body(axes, node.parts, at=(node.origin, node.bottom), slant=DEPTH_SHIFT, gid=f"robot-{one}")
        is_member = one in members
        x = member_text_x if is_member else other_text_x
        add_label(axes, node, int(last_generations[one]), unit, font_size, is_member=is_member, x=x)
    child_in_line = dict(pairwise(line))
    for child, node in nodes.items():
        for parent in parent_numbers(births.parents[child]):
            if parent in nodes and child_in_line.get(parent) == child:
                draw_fitter_parent(axes, nodes[parent], node)
            elif parent in nodes:
                draw_other_parent(axes, nodes[parent], node, gap, is_beside=other_parents.get(child) == parent)
    for older, younger in pairwise(drawn):
        if younger - older > 1:
            draw_omission(axes, nodes[line[older]], nodes[line[younger]], younger - older - 1, font_size)

    fitness_name = str(records.attrs.get("fitness", UNKNOWN_FITNESS))
    n_omitted = len(line) - len(drawn)
    omitted = f"{n_omitted} of {len(line)} in the line omitted, " if n_omitted else ""
    first = int(records.generation.min())
    reason = f"the table begins with generation {first}" if first else f"the table lacks the parents of robot {line[0]}"
    end = f"; {reason}" if parent_numbers(births.parents[line[0]]) else ""
    legend = f"Descent of robot {number} with the {fitness_name} of each; thick: fitter parent, thin: other parent"
    title = escape_label(f"{legend}\n{omitted}{len(nodes)} of {len(births)} robots of the family drawn{end}")
    title_colour = foreground_colour(axes, SECONDARY_STRENGTH)
    axes.set_title(title, loc="left", fontsize=0.9 * font_size, color=title_colour)
    add_description(axes, TITLE, _write_alt_text(births, line, len(nodes), unit, end))
    return axes


def _write_alt_text(births: pd.DataFrame, line: list[int], n_drawn: int, unit: str, end: str) -> str:
    """Write the alternative text.

    Args:
        births: Births of the robot and all its ancestors.
        line: Line of descent, oldest first.
        n_drawn: Number of robots drawn.
        unit: Unit of the fitness.
        end: Clause that says why the line does not reach generation 0, or "".
    """
    first = births.loc[line[0]]
    last = births.loc[line[-1]]
    n_parents = len(parent_numbers(last.parents))
    return (
        f"Family tree of robot {last.individual}, born in generation {last.born} with "
        f"{pluralize(n_parents, 'parent') if n_parents else 'no parents'}: {_describe_result(last, unit)}. Its line of "
        f"descent through the fitter parent has {pluralize(len(line), 'robot')} and begins with robot "
        f"{first.individual} "
        f"of generation {first.born}: {_describe_result(first, unit)}{end}. It has "
        f"{pluralize(len(births) - 1, 'ancestor')} in total; {n_drawn - 1} of them are drawn."
    )


def _describe_result(birth: Any, unit: str) -> str:
    """Describe the fitness of a robot, or why it has none, as a clause."""
    if birth.verdict != "ok":
        return f"its walk does not count ({birth.verdict})"
    return f"fitness {format_fitness(birth, unit)}"


def _choose_drawn(n: int) -> list[int]:
    """Choose which robots of a line of descent with n robots to draw: all of a short line, both ends of a long one.

    Returns:
        Indices into the line, in ascending order.
    """
    if n <= MAX_COMPLETE_LINE:
        return list(range(n))
    n_earlier = N_DRAWN_OF_LONG_LINE - N_LATEST
    latest = range(n - N_LATEST, n)
    return [*np.linspace(0, n - N_LATEST, n_earlier, endpoint=False).round().astype(int).tolist(), *latest]


def _find_other_parents(births: pd.DataFrame, line: list[int], drawn: list[int]) -> dict[int, int]:
    """Find the fittest other parent of each drawn robot, unless it belongs to the drawn line itself.

    Returns:
        The other parents, keyed by child; each parent occurs once, with its first child.
    """
    other_parents: dict[int, int] = {}
    members = {line[i] for i in drawn}
    for i in drawn[1:]:
        parents = [one for one in parent_numbers(births.parents[line[i]]) if one in births.index]
        candidates = [one for one in parents if one != line[i - 1]]
        if candidates:
            fittest = max(candidates, key=lambda parent: float(births.fitness[parent]))
            if fittest not in members and fittest not in other_parents.values():
                other_parents[line[i]] = fittest
    return other_parents
