"""Pictures: of the tidy table, and of a robot. Each draws on the Axes that it is given, and has no logic of its own."""

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator
from scipy.spatial import ConvexHull

from walkerlab.genome import Genome
from walkerlab.ground import height
from walkerlab.judge import UNSTABLE
from walkerlab.rollout import walk
from walkerlab.scene import compile_scene
from walkerlab.settings import Settings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RUNS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Colours of runs, in turn: those of Okabe and Ito that are dark enough for a line on white."""

NEAR = 1.0  # m to either side of a robot, from which on what lies about is not drawn with it
ROPE = 2  # points of what is drawn as a line

QUARTILES = np.array([0.25, 0.5, 0.75])


def fitness_curve(records: pd.DataFrame, ax: Axes | None = None, *, label: str = "") -> Axes:
    """Draw the best (solid), the median (dashed) and the middle half of each generation's fitness.

    Walks that do not count are left out of the middle, and can't be the best.

    Args:
        records: the tidy table of a run.
        ax: where to draw; a new figure if None. Several runs on one Axes get a colour each.
        label: told before the lines' names, to tell several runs apart.

    Returns:
        The Axes drawn on.
    """
    axes = ax or _new_axes()
    counted = records[records.verdict == "ok"].groupby("generation").fitness
    middle = counted.quantile(QUARTILES).unstack().reindex(columns=QUARTILES)
    best = counted.max()
    name = f"{label}: " if label else ""
    colour = RUNS[len(axes.lines) // 2 % len(RUNS)]
    axes.plot(best.index, best, lw=2.2, color=colour, label=f"{name}best", marker="o", markersize=3)
    axes.plot(middle.index, middle[0.5], lw=1.4, ls="--", color=colour, label=f"{name}median", marker=".")
    half = "" if label else "middle half"
    axes.fill_between(middle.index, middle[0.25], middle[0.75], color=colour, alpha=0.15, lw=0, label=half)
    if best.empty:
        axes.text(0.5, 0.5, "no walk counted", transform=axes.transAxes, ha="center")
    unit = records.attrs.get("units", {}).get("fitness", "")
    axes.set_xlabel("generation")
    axes.set_ylabel(f"{records.attrs.get('fitness', 'fitness')}{f' [{unit}]' if unit else ''}")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.margins(x=0.01)
    columns = len(axes.lines) // 2 if label else 3  # a column for each of several runs
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=columns, borderaxespad=0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", lw=0.5, alpha=0.4)
    return axes


def stride(genome: Genome | str, settings: Settings, ax: Axes | None = None) -> Axes:
    """Draw a robot from the side, to scale, caught up to four times on its way, ever darker; needs no GL.

    Args:
        genome: a genome or its text.
        settings: of terrain, robot and simulation.
        ax: where to draw; a new figure if None.

    Returns:
        The Axes drawn on.
    """
    axes = ax or _new_axes()
    scene = compile_scene(genome, settings)
    rollout = walk(scene)
    time, com, load, poses = rollout.time, rollout.com, rollout.load, rollout.poses
    if rollout.verdict == UNSTABLE:  # of which the start alone is worth looking at
        time, load, poses = time[:1], load[:0], scene.start[np.newaxis]
        com = poses[:, :3]
    bodies = np.abs(com[:, 0] - com[0, 0]) / (1.25 * rollout.phenotype.body_length)
    count = int(np.clip(bodies[-1], 0, 3)) + 1  # as many as do not stand in each other's way
    last = int(np.argmax(bodies >= min(bodies[-1], count - 1)))
    moments = np.searchsorted(time, np.linspace(0, time[last], count))
    near = np.append(com[moments, 0], load[moments, 0] if load.size else [])
    x = np.linspace(near.min() - 0.8, near.max() + 0.8, 400)
    for shade, moment in zip(np.linspace(0.25, 1.0, len(moments)) if count > 1 else [1.0], moments, strict=True):
        parts = scene.skins(poses[moment])
        if moment == moments[-1]:
            there = com[moment, 1]
            loose = scene.skins(poses[moment], loose=True)
            parts += [one for one in loose if abs(one[0][:, 1].mean() - there) < NEAR and x[0] < one[0][0, 0] < x[-1]]
        for skin, colour in sorted(parts, key=lambda part: -part[0][:, 1].mean()):  # the far side first
            side = skin[:, [0, 2]]
            if len(side) == ROPE:
                axes.plot(*side.T, color=colour, alpha=shade, lw=1)
            else:
                hull = side[ConvexHull(side).vertices]
                axes.add_patch(Polygon(hull, fc=colour, alpha=shade, ec="k", lw=0.3))
    ground = height(settings.terrain, x)
    axes.fill_between(x, ground, ground.min() - 0.08, color="0.8", lw=0)
    axes.set_xlim(x[0], x[-1])
    axes.set_aspect("equal")
    axes.set_xlabel("way forward [m]")
    axes.set_ylabel("height [m]")
    axes.spines[["top", "right"]].set_visible(False)
    return axes


def save(axes: Axes, *paths: str) -> None:
    """Save the figure of an Axes; text stays text in SVG, so that it can be searched and edited."""
    import matplotlib as mpl

    figure: Figure = axes.figure  # type: ignore[assignment]
    with mpl.rc_context({"svg.fonttype": "none"}):
        for path in paths:
            figure.savefig(path, dpi=150)


def _new_axes() -> Axes:
    """Open a figure that a notebook shows below its cell."""
    from matplotlib import pyplot

    return pyplot.figure(figsize=(7.2, 4.0), layout="constrained").add_subplot()
