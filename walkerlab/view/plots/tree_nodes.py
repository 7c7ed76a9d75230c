"""Robots of a family tree: where they are placed, and how they are labelled and joined."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch
from matplotlib.path import Path

from walkerlab.view.plots.appearance import foreground_colour
from walkerlab.view.plots.bodies import DEPTH_SHIFT, BodyParts
from walkerlab.view.plots.style import RUN_COLOURS, SECONDARY_STRENGTH, escape_label
from walkerlab.view.plots.tables import format_value

ROW_HEIGHT = 1.35  # as a multiple of the height of the highest body
COLUMN_GAP = 0.6  # as a share of the width of the longest body
MIN_BODY_HEIGHT = 0.42  # as a share of the width of the longest body; leaves enough height for the text


@dataclass(frozen=True, eq=False)
class TreeNode:
    """One robot of the drawn tree.

    Attributes:
        birth: Row of the table with its birth.
        origin: Horizontal position of the origin of its body [m].
        left: Left end of its body [m].
        right: Right end of its body [m].
        bottom: Lower end of its body [m].
        height: Height of its body [m].
        parts: Parts of its body.
    """

    birth: Any
    origin: float
    left: float
    right: float
    bottom: float
    height: float
    parts: BodyParts

    @property
    def centre(self) -> float:
        """Horizontal position of the centre of the body [m]."""
        return (self.left + self.right) / 2

    @property
    def top(self) -> float:
        """Upper end of the body [m]."""
        return self.bottom + self.height

    @property
    def middle(self) -> float:
        """Vertical position of the centre of the body [m]."""
        return self.bottom + self.height / 2


# ------------------------------------------------------------------------------------------------------------ drawing


def _measure_extent(parts: BodyParts) -> tuple[float, float, float]:
    """Return left, right and top of a body as drawn [m], relative to its origin on the ground."""
    points = np.concatenate([points for points, _ in parts])
    x = points[:, 0] + DEPTH_SHIFT * points[:, 1]
    return float(x.min()), float(x.max()), float(points[:, 2].max())


def place_nodes(
    births: pd.DataFrame, members: list[int], other_parents: dict[int, int], parts: dict[int, BodyParts]
) -> tuple[dict[int, TreeNode], float, float]:
    """Place the line of descent in one column, oldest on top, and the other parents in a second column.

    Each of the other parents is half a row above its child.

    Returns:
        The nodes, and width and height [m] of the largest body.
    """
    extents = {one: _measure_extent(body) for one, body in parts.items()}
    max_width = max(right - left for left, right, _ in extents.values())
    max_height = max(*(top for _, _, top in extents.values()), MIN_BODY_HEIGHT * max_width)
    row_height = ROW_HEIGHT * max_height
    nodes: dict[int, TreeNode] = {}

    def place_node(one: int, column_x: float, row: float) -> None:
        left, right, top = extents[one]
        width = right - left
        x = column_x + (max_width - width) / 2
        nodes[one] = TreeNode(births.loc[one], x - left, x, x + width, row_height * row, top, parts[one])

    for row, one in enumerate(reversed(members)):
        place_node(one, 0.0, row)
        if one in other_parents:
            place_node(other_parents[one], (1.0 + COLUMN_GAP) * max_width, row + 0.5)
    return nodes, max_width, max_height


def add_label(axes: Axes, node: TreeNode, last: int, unit: str, size: float, *, is_member: bool, x: float) -> None:
    """Write fitness, number and generations beside a body.

    Args:
        axes: Axes to draw on.
        node: Robot to label.
        last: Last generation in which it lives; later than its birth for an elite.
        unit: Unit of the fitness.
        size: Font size [points].
        is_member: Whether it belongs to the line of descent.
        x: Position of the text [m].
    """
    born = int(node.birth.born)
    generations = f"generation {born}" if last == born else f"generations {born}–{last}"
    side = "right" if is_member else "left"
    weight = "bold" if is_member else "normal"
    fitness = escape_label(format_fitness(node.birth, unit))
    axes.text(x, node.middle, fitness, ha=side, va="bottom", fontsize=size, weight=weight)
    identity = f"robot {node.birth.individual}\n{generations}"
    colour = foreground_colour(axes, SECONDARY_STRENGTH)
    axes.text(x, node.middle, identity, ha=side, va="top", fontsize=0.87 * size, color=colour, linespacing=1.15)


def draw_fitter_parent(axes: Axes, parent: TreeNode, child: TreeNode) -> None:
    """Draw the thick, vertical arrow from the fitter parent to its child."""
    path = Path([(child.centre, parent.bottom), (child.centre, child.top)])
    _add_arrow(axes, path, parent, child, lw=2.2, color=RUN_COLOURS[0], mutation_scale=11)


def draw_other_parent(
    axes: Axes, parent: TreeNode, child: TreeNode, gap: tuple[float, float], *, is_beside: bool
) -> None:
    """Draw the thin, curved arrow from another parent through the gap between the columns.

    Args:
        axes: Axes to draw on.
        parent: Start of the arrow.
        child: End of the arrow.
        gap: Left and right end of the gap [m].
        is_beside: Whether the parent is placed beside this child; the arrow is paler otherwise.
    """
    parent_is_left = parent.right <= gap[0]
    child_is_left = child.right <= gap[0]
    start = parent.right if parent_is_left else parent.left
    end = child.right if child_is_left else child.left
    turn = 0.5 * (gap[0] + gap[1])  # where the arrow runs vertically
    if parent_is_left and child_is_left:
        turn = 0.25 * gap[0] + 0.75 * gap[1]
    elif not parent_is_left and not child_is_left:
        turn = 0.75 * gap[0] + 0.25 * gap[1]
    start_y = parent.bottom + 0.3 * parent.height
    end_y = child.bottom + 0.75 * child.height
    points = [(start, start_y), (turn, start_y), (turn, end_y), (end, end_y)]
    path = Path(points, [Path.MOVETO, Path.CURVE4, Path.CURVE4, Path.CURVE4])
    width = 1.2 if is_beside else 0.8
    colour = foreground_colour(axes, 0.7 if is_beside else 0.4)
    _add_arrow(axes, path, parent, child, mutation_scale=7, lw=width, color=colour)


def _add_arrow(axes: Axes, path: Path, parent: TreeNode, child: TreeNode, **style: Any) -> None:
    gid = f"robot-{parent.birth.individual}-to-robot-{child.birth.individual}"
    axes.add_patch(FancyArrowPatch(path=path, arrowstyle="-|>", shrinkA=0, shrinkB=0, zorder=0.5, gid=gid, **style))


def draw_omission(axes: Axes, older: TreeNode, younger: TreeNode, n: int, size: float) -> None:
    """Draw a dashed line in place of n omitted ancestors, with their number; size is the font size [points]."""
    x = younger.centre
    y = (younger.top + older.bottom) / 2
    axes.plot([x, x], [older.bottom, younger.top], ls=(0, (2, 1.5)), lw=2.2, color=RUN_COLOURS[0], zorder=0.5)
    colour = foreground_colour(axes, SECONDARY_STRENGTH)
    axes.text(x, y, f"   {n} omitted", va="center", fontsize=0.87 * size, color=colour)


def format_fitness(birth: Any, unit: str) -> str:
    """Return the fitness with its unit, or the verdict of a walk that does not count."""
    return format_value(float(birth.fitness), unit) if birth.verdict == "ok" else str(birth.verdict)
