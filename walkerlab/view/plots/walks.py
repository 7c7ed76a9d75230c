"""Pictures of one walk."""

import numpy as np
from matplotlib.axes import Axes

from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import count
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.simulation.footfalls import find_footfalls, foot_names
from walkerlab.simulation.rollout import Rollout
from walkerlab.simulation.validity import VERDICTS
from walkerlab.view.plots.appearance import ink, new_axes, picture
from walkerlab.view.plots.style import (
    QUIET,
    RUNS,
    describe,
    key,
    label_values,
    literal,
    n_drawn,
    nothing,
    plain,
    require_measure,
    with_unit,
)
from walkerlab.world.scene import compile_scene

WAY = "way forward of the centre of mass [m]"
WINDOW = 10.0  # s of a walk that a gait diagram shows, so that single steps can be seen
DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)), (0, (6, 2, 1, 2)), (0, (1, 1)), (0, (8, 2, 2, 2, 2, 2)))
"""Lines of walks, in turn, which tell them apart in black and white."""


@picture
def distance_over_time(rollout: Rollout, ax: Axes | None = None, *, label: str = "") -> Axes:
    """Draw how far forward the centre of mass is, moment by moment; if the walk does not count, it is said.

    Args:
        rollout: of one walk; poses are not needed.
        ax: where to draw; a new figure if None. Several walks on one Axes get a colour and a dash each.
        label: the name of the walk, to tell several apart.

    Returns:
        The Axes drawn on.

    Raises:
        TypeError: if it is given something else than a walk.
    """
    if not isinstance(rollout, Rollout):  # pyright: ignore[reportUnnecessaryIsInstance]
        given = type(rollout).__name__
        raise TypeError(f"this picture is drawn from a walk: give wl.simulate(genome, settings); got a {given}")
    axes = ax or new_axes()
    title = "Way forward over time"
    require_measure(axes, WAY)
    run = n_drawn(axes, title)
    way = rollout.com[:, 0] - rollout.com[0, 0]
    finite = np.isfinite(way)
    why = "" if rollout.counts else f"does not count: {rollout.verdict}"
    said = f"{label} ({why})" if label and why else label or why
    colour = RUNS[run % len(RUNS)]
    axes.plot(
        rollout.time[finite], way[finite], lw=1.8, color=colour, ls=DASHES[run % len(DASHES)], label=literal(said)
    )
    if finite.any():
        end = int(np.flatnonzero(finite)[-1])
        axes.plot(rollout.time[end], way[end], marker="o" if rollout.counts else "X", ms=7, color=colour, clip_on=False)
        reached = f"{with_unit(float(way[end]), 'm')} forward after {with_unit(float(rollout.time[end]), 's')}"
    else:
        nothing(axes, "no number of this walk is finite")
        reached = "no number of it is finite"
    judged = "" if rollout.counts else f" It does not count: {rollout.verdict} ({rollout.reason})."
    describe(axes, title, f"{f'{label}: the' if label else 'The'} way of one walk: {reached}.{judged}", WAY)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(WAY)
    label_values(axes)
    axes.margins(x=0.01)
    plain(axes)
    key(axes, 3)
    return axes


@picture
def gait(genome: Genome | str, settings: Settings, ax: Axes | None = None) -> Axes:
    """Draw the gait of a robot after Hildebrand: a row for each foot, a bar while it is on the ground.

    At the right of each row stands its duty factor: the share of the whole walk that the foot is on the ground, or on
    what lies there. Of a long walk, the last ten seconds are shown.
    Of several starts, the poorest walk is drawn: the one that counted.

    Args:
        genome: a genome or its text.
        settings: of terrain, robot and simulation.
        ax: where to draw; a new figure if None.

    Returns:
        The Axes drawn on.

    Raises:
        GenomeError: if a text is no genome.
    """
    scene = compile_scene(genome, settings)
    rollout, names = poorest_walk(genome, settings), foot_names(scene)
    down = find_footfalls(scene, rollout.poses)
    axes = ax or new_axes(height=1.3 + 0.32 * len(names))
    duty = down.mean(axis=0)
    until = np.append(rollout.time[1:], rollout.time[-1])
    pairs = range(0, len(names), 2)
    for row in pairs[1::2]:  # each second pair is shaded, so that pairs can be told apart
        axes.axhspan(row - 0.5, row + 1.5, color=ink(axes, 0.07), lw=0)
    for row, on_ground in enumerate(down.T):
        edges = np.flatnonzero(np.diff(on_ground, prepend=False, append=False))
        start, end = rollout.time[edges[::2]], until[edges[1::2] - 1]
        bars = list(zip(start, end - start, strict=True))
        axes.broken_barh(bars, (row - 0.36, 0.72), fc=ink(axes), lw=0, gid=names[row])
    axes.set_yticks(range(len(names)), [_spoken(name) for name in names])
    axes.set_ylim(len(names) - 0.5, -0.5)
    last = float(rollout.time[-1])
    axes.set_xlim(max(0.0, last - WINDOW), last)
    axes.set_xlabel("time [s]")
    right = axes.secondary_yaxis("right")
    right.set_yticks(range(len(names)), [f"{share:.0%}" for share in duty])
    right.tick_params(length=0)
    right.spines["right"].set_visible(False)
    right.set_ylabel("time on the ground", fontsize=9, color=ink(axes, QUIET))
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    judged = "" if rollout.counts else f"this walk does not count: {rollout.verdict}"
    axes.set_title("a bar: the foot is on the ground" + (f"; {judged}" if judged else ""), loc="left", fontsize=9)
    shares = ", ".join(f"{name} {share:.0%}" for name, share in zip(names, duty, strict=True))
    void = f" It does not count: {VERDICTS.get(rollout.verdict, rollout.verdict)}" if judged else ""
    describe(
        axes,
        "Gait",
        f"When each of {count(len(names), 'foot').replace('foots', 'feet')} is on the ground in a walk of "
        f"{with_unit(last, 's')}. Share of the time on the ground: {shares}.{void}",
    )
    return axes


def _spoken(foot: str) -> str:
    side, _, number = foot.partition(" ")
    return f"segment {number}, {side}" if side == "left" else side
