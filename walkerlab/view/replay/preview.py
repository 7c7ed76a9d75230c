"""The preview image of a replay: one robot during its walk, or the result of a race."""

import io
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from walkerlab.settings.settings import Settings
from walkerlab.text.numbers import with_unit
from walkerlab.view.plots.appearance import offscreen_axes, walkerlab_style
from walkerlab.view.plots.bodies import BodyParts, add_body, stride
from walkerlab.view.plots.style import escape_label
from walkerlab.view.replay.animation import Walk
from walkerlab.view.replay.meshes import race_colour
from walkerlab.world.geometry import surface_points, valid_poses

MAX_RACERS = 8  # maximum number of racers drawn, the farthest at the top
PREVIEW_WIDTH = 7.2  # inches
PREVIEW_DPI = 100  # dots per inch
ROW_SPACING = 1.25  # distance between the rows of a race, as a multiple of the robot's height
AXES_SIZE = 0.75 * PREVIEW_WIDTH  # inches, of the larger side of the axes
LABEL_HEIGHT = 0.6  # inches, of three lines of text


def draw_preview(walks: Sequence[Walk], settings: Settings) -> bytes:
    """Draw the preview image of a replay as PNG."""
    axes = offscreen_axes(PREVIEW_WIDTH, PREVIEW_WIDTH)
    with walkerlab_style():
        if len(walks) == 1:
            stride(walks[0].scene.genome, settings, axes)
        else:
            _draw_race_result(axes, walks)
        file = io.BytesIO()
        figure = axes.get_figure(root=True)
        assert figure
        figure.savefig(file, format="png", dpi=PREVIEW_DPI, bbox_inches="tight")
    return file.getvalue()


def _draw_race_result(axes: Axes, walks: Sequence[Walk]) -> None:
    """Draw the racers at the end of their walks, one row each, the farthest at the top."""
    ranked = sorted(walks, key=lambda walk: -np.nan_to_num(walk.rollout.distance, nan=-np.inf))[:MAX_RACERS]
    bodies = [surface_points(walk.scene, valid_poses(walk.scene, walk.rollout.poses)[-1]) for walk in ranked]
    floor = 0.0
    tick_positions: list[float] = []
    tick_labels: list[str] = []
    for walk, parts, row in zip(ranked, bodies, _row_heights(bodies), strict=True):
        colour = walk.colour
        bottom = min(float(skin[:, 2].min()) for skin, _ in parts)
        floor -= row
        tinted = [(skin, race_colour(natural, colour)) for skin, natural in parts] if colour else parts
        right = add_body(axes, tinted, at=(0.0, floor - bottom))[1]
        axes.plot([0, max(right, 0.0)], [floor, floor], lw=1, color=colour, zorder=0)
        verdict = "" if walk.rollout.counts else f"\ndoes not count: {walk.rollout.verdict}"
        tick_positions.append(floor + row / 2)
        tick_labels.append(f"{escape_label(walk.label)}\n{with_unit(walk.rollout.distance, 'm')}{verdict}")
    axes.axvline(0, lw=1, ls=":", color="0.4")
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_yticks(tick_positions, tick_labels)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("distance forward [m]")
    axes.spines[["top", "right", "left"]].set_visible(False)


def _row_heights(bodies: Sequence[BodyParts]) -> list[float]:
    """Return the height of each row of a race [m]: enough for the body, and for the label at the scale that results."""
    points = [np.concatenate([skin for skin, _ in parts]) for parts in bodies]
    rows = [ROW_SPACING * float(np.ptp(of_body[:, 2])) for of_body in points]
    x = np.append(np.concatenate(points)[:, 0], 0.0)
    scale = float(np.ptp(x)) / AXES_SIZE  # m per inch
    for _ in range(MAX_RACERS):  # higher rows reduce the scale, which makes the labels higher in metres
        scale = max(scale, sum(rows) / AXES_SIZE)
        rows = [max(row, LABEL_HEIGHT * scale) for row in rows]
    return rows
