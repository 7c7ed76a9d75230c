"""The picture that comes before a replay: a robot in its stride, or the finish of a race."""

import io
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from walkerlab.settings.settings import Settings
from walkerlab.text.numbers import with_unit
from walkerlab.view.plots.appearance import paper, walkerlab_style
from walkerlab.view.plots.bodies import add_body, stride
from walkerlab.view.plots.style import escape_label
from walkerlab.view.replay.animation import Walk
from walkerlab.view.replay.meshes import tint
from walkerlab.world.geometry import skins, valid_poses

ROWS = 8  # walks of a race that are drawn, the farthest on top
WIDTH = 7.2  # inches


def poster(walks: Sequence[Walk], settings: Settings) -> bytes:
    """Draw what a replay is about, as PNG."""
    axes = paper(WIDTH, WIDTH)
    with walkerlab_style():
        if len(walks) == 1:
            stride(walks[0].scene.genome, settings, axes)
        else:
            _finish(axes, walks)
        file = io.BytesIO()
        figure = axes.get_figure(root=True)
        assert figure
        figure.savefig(file, format="png", dpi=100, bbox_inches="tight")
    return file.getvalue()


def _finish(axes: Axes, walks: Sequence[Walk]) -> None:
    """Draw every racer where it is at the end, in a row of its own, the farthest on top."""
    ranked = sorted(walks, key=lambda walk: -np.nan_to_num(walk.rollout.distance, nan=-np.inf))[:ROWS]
    floor, levels, words = 0.0, list[float](), list[str]()
    for walk in ranked:
        parts = skins(walk.scene, valid_poses(walk.scene, walk.rollout.poses)[-1])
        low, high = (float(end([end(skin[:, 2]) for skin, _ in parts])) for end in (min, max))
        floor -= 1.25 * (high - low)
        painted = [(skin, tint(colour, walk.colour)) if walk.colour else (skin, colour) for skin, colour in parts]
        right = add_body(axes, painted, at=(0.0, floor - low))[1]
        axes.plot([0, max(right, 0.0)], [floor, floor], lw=1, color=walk.colour, zorder=0)
        judged = "" if walk.rollout.counts else f"\ndoes not count: {walk.rollout.verdict}"
        levels.append(floor + (high - low) / 2)
        words.append(f"{escape_label(walk.label)}\n{with_unit(walk.rollout.distance, 'm')}{judged}")
    axes.axvline(0, lw=1, ls=":", color="0.4")
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_yticks(levels, words)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("way forward [m]")
    axes.spines[["top", "right", "left"]].set_visible(False)
