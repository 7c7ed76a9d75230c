"""Plots of one walk: its distance over time, and its gait."""

import numpy as np
from matplotlib.axes import Axes

from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.simulation.footfalls import find_footfalls, foot_names
from walkerlab.simulation.rollout import Rollout
from walkerlab.simulation.validity import VERDICTS
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.bodies import add_body, add_eye, resting_scene
from walkerlab.view.plots.style import (
    RUN_COLOURS,
    SECONDARY_STRENGTH,
    add_description,
    add_legend,
    annotate_no_data,
    count_plots,
    escape_label,
    format_value_axis,
    require_quantity,
    style_axes,
)
from walkerlab.view.plots.tables import format_value
from walkerlab.view.sketch.marks import segment_tops
from walkerlab.view.sketch.projection import DEPTH_SHIFT
from walkerlab.view.sketch.standing import standing_pose
from walkerlab.world.entities.walker import LEG_COLOURS
from walkerlab.world.geometry import surface_points
from walkerlab.world.scene import Scene, compile_scene

DISTANCE_LABEL = "distance of the centre of mass [m]"
MAX_GAIT_SECONDS = 10.0  # maximum duration in a gait diagram, so that single steps remain visible
LINE_STYLES = ("-", (0, (6, 2)), (0, (2, 1.5)), (0, (6, 2, 1, 2)), (0, (1, 1)), (0, (8, 2, 2, 2, 2, 2)))
"""Line styles of successive walks, which distinguish them in black and white."""
N_LEGEND_COLUMNS = 3
BODY_ROWS = 2.4  # height of the small drawing of the robot in a gait diagram, in rows
SMALL_BODY_WIDTH = 0.42  # maximum width of the drawing, as a share of the width of the diagram


@styled_plot
def distance_over_time(rollout: Rollout, ax: Axes | None = None, *, label: str = "") -> Axes:
    """Draw the forward distance of the centre of mass over time, with the verdict if the walk does not count.

    Args:
        rollout: Rollout of one walk; its poses are not required.
        ax: Axes to draw on; if None, a new figure is created. Each walk on the same Axes has its own colour and dashes.
        label: Name of the walk in the legend.

    Returns:
        The Axes drawn on.

    Raises:
        TypeError: If ``rollout`` is not a Rollout.
    """
    if not isinstance(rollout, Rollout):  # pyright: ignore[reportUnnecessaryIsInstance]
        given = type(rollout).__name__
        raise TypeError(f"this plot needs a walk, as returned by wl.simulate(genome, settings); got a {given}")
    axes = ax or new_axes()
    title = "Distance over time"
    require_quantity(axes, DISTANCE_LABEL)
    number = count_plots(axes, title)
    distance = rollout.com[:, 0] - rollout.com[0, 0]
    is_finite = np.isfinite(distance)
    problem = "" if rollout.counts else f"does not count: {rollout.verdict}"
    legend = f"{label} ({problem})" if label and problem else label or problem
    colour = RUN_COLOURS[number % len(RUN_COLOURS)]
    line_style = LINE_STYLES[number % len(LINE_STYLES)]
    time = rollout.time[is_finite]
    axes.plot(time, distance[is_finite], lw=1.8, color=colour, ls=line_style, label=escape_label(legend))
    if is_finite.any():
        last = int(np.flatnonzero(is_finite)[-1])
        marker = "o" if rollout.counts else "X"
        axes.plot(rollout.time[last], distance[last], marker=marker, ms=7, color=colour, clip_on=False)
        after = format_value(float(rollout.time[last]), "s")
        result = f"{format_value(float(distance[last]), 'm')} forward after {after}"
    else:
        annotate_no_data(axes, "this walk has no finite numbers")
        result = "it has no finite numbers"
    verdict = "" if rollout.counts else f" The walk does not count: {rollout.verdict} ({rollout.reason})."
    subject = f"{label}: distance" if label else "Distance"
    add_description(axes, title, f"{subject} of one walk over time: {result}.{verdict}", DISTANCE_LABEL)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(DISTANCE_LABEL)
    format_value_axis(axes)
    axes.margins(x=0.01)
    style_axes(axes)
    add_legend(axes, N_LEGEND_COLUMNS)
    return axes


@styled_plot
def gait(genome: Genome | str, settings: Settings, ax: Axes | None = None) -> Axes:
    """Draw the gait diagram of a robot after Hildebrand: a row for each foot, a bar while it is on the ground.

    A small drawing of the robot above the rows has the numbers of the segments. Bars have the colours of the legs: dark
    for left, light for right. The number at the right of each row is the duty factor: the share of the whole walk
    during which the foot is on the ground or on an obstacle. A long walk is limited to its last ten seconds. If there
    are several starts, the walk with the lowest fitness is drawn, because that is the one that counts.

    Args:
        genome: Genome, or its text.
        settings: Complete settings.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.

    Raises:
        GenomeError: If the text is not a valid genome.
    """
    scene = compile_scene(genome, settings)
    rollout = poorest_walk(genome, settings)
    names = foot_names(scene)
    footfalls = find_footfalls(scene, rollout.poses)
    duty_factors = footfalls.mean(axis=0)
    sample_ends = np.append(rollout.time[1:], rollout.time[-1])
    axes = ax or new_axes(height=1.3 + 0.32 * (len(names) + BODY_ROWS))
    for row in range(2, len(names), 4):  # every second pair of legs is shaded
        axes.axhspan(row - 0.5, row + 1.5, color=foreground_colour(axes, 0.07), lw=0)
    for row, on_ground in enumerate(footfalls.T):
        edges = np.flatnonzero(np.diff(on_ground, prepend=False, append=False))
        start = rollout.time[edges[::2]]
        end = sample_ends[edges[1::2] - 1]
        bars = list(zip(start, end - start, strict=True))
        fill = LEG_COLOURS[names[row].partition(" ")[0]]
        axes.broken_barh(bars, (row - 0.36, 0.72), fc=fill, ec=foreground_colour(axes), lw=0.5, gid=names[row])
    axes.set_yticks(range(len(names)), [_row_label(name) for name in names])
    axes.set_ylim(len(names) - 0.5, -0.5 - BODY_ROWS)
    duration = float(rollout.time[-1])
    axes.set_xlim(max(0.0, duration - MAX_GAIT_SECONDS), duration)
    axes.set_xlabel("time [s]")
    right = axes.secondary_yaxis("right")
    right.set_yticks(range(len(names)), [f"{share:.0%}" for share in duty_factors])
    right.tick_params(length=0)
    right.spines["right"].set_visible(False)
    right.set_ylabel("time on the ground", fontsize=9, color=foreground_colour(axes, SECONDARY_STRENGTH))
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    _add_small_body(axes, scene, len(names))
    problem = "" if rollout.counts else f"; this walk does not count: {rollout.verdict}"
    axes.set_title(f"bars: foot on the ground{problem}", loc="left", fontsize=9)
    shares = ", ".join(f"{name} {share:.0%}" for name, share in zip(names, duty_factors, strict=True))
    meaning = VERDICTS.get(rollout.verdict, rollout.verdict)
    verdict = "" if rollout.counts else f" The walk does not count: {meaning}"
    add_description(
        axes,
        "Gait",
        f"Gait diagram of {pluralize(len(names), 'foot').replace('foots', 'feet')} in a walk of "
        f"{format_value(duration, 's')}. Share of the time on the ground: {shares}.{verdict}",
    )
    return axes


def _add_small_body(axes: Axes, scene: Scene, n_rows: int) -> None:
    """Draw the robot above the rows of its feet, with the numbers of its segments."""
    height = BODY_ROWS / (n_rows + BODY_ROWS)
    inset = axes.inset_axes((0.0, 1 - 0.95 * height, SMALL_BODY_WIDTH, 0.9 * height))
    inset.set_axis_off()
    inset.set_aspect("equal", anchor="SW")
    robot = resting_scene(scene.genome, Settings(robot=scene.settings.robot.model_copy(update={"drag_weight": 0.0})))
    pose = standing_pose(robot.genome, robot.settings)
    left, right, bottom, top = add_body(inset, surface_points(robot, pose), slant=DEPTH_SHIFT)
    add_eye(inset, robot, pose, slant=DEPTH_SHIFT)
    for number, (x, z) in enumerate(segment_tops(robot, pose), start=1):
        inset.annotate(str(number), (x, z), (0, 1), textcoords="offset points", ha="center", va="bottom", fontsize=8)
    inset.set_xlim(left, right)
    inset.set_ylim(bottom, top + 0.35 * (top - bottom))
    place = (right + 0.08 * (right - left), (bottom + top) / 2)
    colour = foreground_colour(axes, SECONDARY_STRENGTH)
    inset.annotate(
        "left legs dark,\nright legs light", place, va="center", fontsize=8, color=colour, annotation_clip=False
    )


def _row_label(foot: str) -> str:
    """Return the label of a row: the segment and the side of the foot."""
    side, _, number = foot.partition(" ")
    return f"segment {number}, {side}"
