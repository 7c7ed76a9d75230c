"""The family tree of a robot."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch
from matplotlib.path import Path

from walkerlab.runfile.records import champion, fitter_line, lineage, parent_numbers
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import count
from walkerlab.view.plots.appearance import ink, new_axes, picture
from walkerlab.view.plots.bodies import SLANT, Parts, add_body, at_rest
from walkerlab.view.plots.style import QUIET, RUNS, describe, literal, nothing, table_of, unit_of, with_unit
from walkerlab.world.geometry import skins

MOST = 16  # robots of a line of descent that are drawn without gaps
SOME = 12  # of them, if there are more
NEWEST = 4  # of them that follow on each other, down to the robot itself

BODY = 1.15  # inches that the longest body is wide
TEXT = 1.15  # inches beside a column of bodies
SIZE = 8.0  # points of that text, where a picture is as large as it wants to be
ROW = 1.35  # heights of the highest body from one row to the next
GUTTER = 0.6  # widths of the longest body between the columns
LOWEST = 0.42  # of its width, which a row is high at least, so that there is room for text


@dataclass(frozen=True, eq=False)
class _Node:
    """One robot of the tree: its birth, where its origin goes, how far it reaches [m], and what it looks like."""

    birth: Any
    origin: float
    left: float
    right: float
    bottom: float
    high: float
    parts: Parts

    @property
    def centre(self) -> float:
        return (self.left + self.right) / 2

    @property
    def top(self) -> float:
        return self.bottom + self.high

    @property
    def middle(self) -> float:
        return self.bottom + self.high / 2


@picture
def family_tree(
    records: pd.DataFrame, ax: Axes | None = None, individual: int | None = None, settings: Settings | None = None
) -> Axes:
    """Draw the line of descent of a robot through the fitter parent of each, with the other parents beside it.

    Time runs downward. A thick line joins the fitter parent to its child, a thin one the other parent; a dashed one
    stands for ancestors that are left out, and says how many: of a line of more than sixteen, the first, the last few,
    and some in between are drawn, twelve in all. Where a child has many parents, as after randomized crossover, the
    fittest two are drawn. All bodies are drawn to one scale. A parent that the table does not have ends the line there.

    Args:
        records: the tidy table of a run, or the run.
        ax: where to draw; a new figure, as long as the tree needs, if None.
        individual: whose tree; the champion's if None.
        settings: of which the loads are drawn; bodies without loads if None.

    Returns:
        The Axes drawn on.

    Raises:
        ValueError: if no such individual has walked.
    """
    records = table_of(records, "individual", "born", "parents", "operators", "fitness", "verdict", "reason", "genome")
    title = "Family tree"
    if records.empty:
        axes = ax or new_axes()
        nothing(axes, "no robot has walked yet")
        describe(axes, title, "No robot has walked yet.")
        axes.set_axis_off()
        return axes
    number = champion(records).individual if individual is None else individual
    births = lineage(records, number).set_index("individual", drop=False)
    line = fitter_line(births, number)[::-1]
    drawn = _sample(len(line))
    members = [line[place] for place in drawn]
    mates = _mates(births, line, drawn)
    scenes = {one: at_rest(births.genome[one], settings) for one in [*members, *mates.values()]}
    parts: dict[int, Parts] = {one: skins(scene, scene.start) for one, scene in scenes.items()}
    nodes, wide, high = _stand(births, members, mates, parts)

    text = TEXT / BODY * wide  # m, as all that follows
    gutter = (wide, (1 + GUTTER) * wide)
    left, right = -text, gutter[1] + wide + text
    bottom, top = -0.1 * high, max(node.top for node in nodes.values()) + 0.1 * high
    axes = ax or new_axes((right - left) / wide * BODY, (top - bottom) / wide * BODY + 0.35)
    room = axes.get_window_extent()
    scale = min(room.width / (right - left), room.height / (top - bottom)) / axes.figure.dpi  # inches for each m
    size = SIZE if ax is None else float(np.clip(SIZE * scale * wide / BODY, 3, SIZE))
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal", anchor="N")
    axes.set_axis_off()

    beside = -0.05 * wide, gutter[1] + 1.05 * wide
    lives = records[records.individual.isin(list(nodes))].groupby("individual").generation.max()
    unit = unit_of(records, "fitness")
    for one, node in nodes.items():
        add_body(axes, node.parts, at=(node.origin, node.bottom), slant=SLANT, gid=f"robot-{one}")
        _label(axes, node, int(lives[one]), unit, size, is_member=one in members, x=beside[one not in members])
    fitter = dict(pairwise(line))
    for child, node in nodes.items():
        for parent in parent_numbers(births.parents[child]):
            if parent in nodes and fitter.get(parent) == child:
                _descend(axes, nodes[parent], node)
            elif parent in nodes:
                _join(axes, nodes[parent], node, gutter, is_beside=mates.get(child) == parent)
    for older, younger in pairwise(drawn):
        if younger - older > 1:
            _skip(axes, nodes[line[older]], nodes[line[younger]], younger - older - 1, size)

    name = str(records.attrs.get("fitness", "fitness"))
    story = f"Descent of robot {number}: the fitter parents (thick), the others (thin), and the {name} of each;"
    left_out = f"{len(line) - len(drawn)} of {len(line)} in the line left out, " if len(line) > len(drawn) else ""
    shown = f"{left_out}{len(nodes)} of a family of {len(births)} drawn"
    first = int(records.generation.min())
    why = f"the table begins with generation {first}" if first else f"the table lacks the parents of robot {line[0]}"
    begins = f"; {why}" if parent_numbers(births.parents[line[0]]) else ""
    said = literal(f"{story}\n{shown}{begins}")
    axes.set_title(said, loc="left", fontsize=0.9 * size, color=ink(axes, QUIET))
    describe(axes, title, _in_words(births, line, len(nodes), unit, begins))
    return axes


def _in_words(births: pd.DataFrame, line: list[int], n_drawn: int, unit: str, begins: str) -> str:
    first, last = births.loc[line[0]], births.loc[line[-1]]
    n_parents = len(parent_numbers(last.parents))
    return (
        f"Family tree of robot {last.individual}, born in generation {last.born} with "
        f"{count(n_parents, 'parent') if n_parents else 'no parents'}: {_judged(last, unit)}. Its line of "
        f"descent through the fitter parent has {count(len(line), 'robot')} and begins with robot {first.individual} "
        f"of generation {first.born}: {_judged(first, unit)}{begins}. It has "
        f"{count(len(births) - 1, 'ancestor')} in all; {n_drawn - 1} of them are drawn."
    )


# ---------------------------------------------------------------------------------------------------- who is drawn


def _sample(n: int) -> list[int]:
    """Choose which of n robots in a line are drawn: all of a short line; both ends of a long one, and some between."""
    if n <= MOST:
        return list(range(n))
    newest = range(n - NEWEST, n)
    return [*np.linspace(0, n - NEWEST, SOME - NEWEST, endpoint=False).round().astype(int).tolist(), *newest]


def _mates(births: pd.DataFrame, line: list[int], drawn: list[int]) -> dict[int, int]:
    """Find the fittest other parent of each robot that is drawn, but for those that stand in the line themselves.

    Returns:
        child: other parent; each other parent once, beside its first child.
    """
    found: dict[int, int] = {}
    members = {line[place] for place in drawn}
    for place in drawn[1:]:
        others = [one for one in parent_numbers(births.parents[line[place]]) if one in births.index]
        others = [one for one in others if one != line[place - 1]]
        if others:
            fittest = max(others, key=lambda parent: float(births.fitness[parent]))
            if fittest not in members and fittest not in found.values():
                found[line[place]] = fittest
    return found


# --------------------------------------------------------------------------------------------------- how it is drawn


def _extent(parts: Parts) -> tuple[float, float, float]:
    """Return left, right and top of a body as drawn [m]; it stands at 0."""
    points = np.concatenate([points for points, _ in parts])
    x = points[:, 0] + SLANT * points[:, 1]
    return float(x.min()), float(x.max()), float(points[:, 2].max())


def _stand(
    births: pd.DataFrame, members: list[int], mates: dict[int, int], parts: dict[int, Parts]
) -> tuple[dict[int, _Node], float, float]:
    """Put the line in one column, oldest on top, and each other parent in another, a little above its child.

    Returns:
        The nodes, and the width and height [m] of the largest body.
    """
    extents = {one: _extent(body) for one, body in parts.items()}
    wide = max(right - left for left, right, _ in extents.values())
    high = max(*(top for _, _, top in extents.values()), LOWEST * wide)
    nodes: dict[int, _Node] = {}

    def stand(one: int, column: float, row: float) -> None:
        left, right, top = extents[one]
        x = column * wide + (wide - right + left) / 2
        nodes[one] = _Node(births.loc[one], x - left, x, x + right - left, ROW * high * row, top, parts[one])

    for row, one in enumerate(reversed(members)):
        stand(one, 0.0, row)
        if one in mates:
            stand(mates[one], 1.0 + GUTTER, row + 0.5)
    return nodes, wide, high


def _label(axes: Axes, node: _Node, last: int, unit: str, size: float, *, is_member: bool, x: float) -> None:
    """Write beside a body how fit it is, who it is, and when it lived: an elite, for more than one generation."""
    born = int(node.birth.born)
    lived = f"generation {born}" if last == born else f"generations {born}–{last}"
    side, weight = ("right", "bold") if is_member else ("left", "normal")
    axes.text(x, node.middle, literal(_fitness(node.birth, unit)), ha=side, va="bottom", fontsize=size, weight=weight)
    who = f"robot {node.birth.individual}\n{lived}"
    axes.text(x, node.middle, who, ha=side, va="top", fontsize=0.87 * size, color=ink(axes, QUIET), linespacing=1.15)


def _descend(axes: Axes, parent: _Node, child: _Node) -> None:
    """Draw the thick line from the fitter parent, straight down."""
    path = Path([(child.centre, parent.bottom), (child.centre, child.top)])
    _arrow(axes, path, parent, child, lw=2.2, color=RUNS[0], mutation_scale=11)


def _join(axes: Axes, parent: _Node, child: _Node, gutter: tuple[float, float], *, is_beside: bool) -> None:
    """Draw the thin line from another parent, through the gutter; paler, if that one does not stand beside it."""
    start, end = (node.right if node.right <= gutter[0] else node.left for node in (parent, child))
    in_one_column = (start <= gutter[0]) == (end <= gutter[0])
    share = 0.5 if not in_one_column else 0.75 if start <= gutter[0] else 0.25
    way = gutter[0] + share * (gutter[1] - gutter[0])
    leave, arrive = parent.bottom + 0.3 * parent.high, child.bottom + 0.75 * child.high
    points = [(start, leave), (way, leave), (way, arrive), (end, arrive)]
    path = Path(points, [Path.MOVETO, Path.CURVE4, Path.CURVE4, Path.CURVE4])
    look: dict[str, Any] = {"lw": 1.2, "color": ink(axes, 0.7)} if is_beside else {"lw": 0.8, "color": ink(axes, 0.4)}
    _arrow(axes, path, parent, child, mutation_scale=7, **look)


def _arrow(axes: Axes, path: Path, parent: _Node, child: _Node, **look: Any) -> None:
    gid = f"robot-{parent.birth.individual}-to-robot-{child.birth.individual}"
    axes.add_patch(FancyArrowPatch(path=path, arrowstyle="-|>", shrinkA=0, shrinkB=0, zorder=0.5, gid=gid, **look))


def _skip(axes: Axes, older: _Node, younger: _Node, n: int, size: float) -> None:
    """Draw the dashed line that stands for ancestors that are left out, and say how many."""
    x, y = younger.centre, (younger.top + older.bottom) / 2
    axes.plot([x, x], [older.bottom, younger.top], ls=(0, (2, 1.5)), lw=2.2, color=RUNS[0], zorder=0.5)
    axes.text(x, y, f"   {n} left out", va="center", fontsize=0.87 * size, color=ink(axes, QUIET))


def _judged(birth: Any, unit: str) -> str:
    """Say how fit a robot is, in a sentence."""
    is_void = birth.verdict != "ok"
    return f"its walk does not count ({birth.verdict})" if is_void else f"fitness {_fitness(birth, unit)}"


def _fitness(birth: Any, unit: str) -> str:
    return with_unit(float(birth.fitness), unit) if birth.verdict == "ok" else str(birth.verdict)
