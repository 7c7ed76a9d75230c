"""Pictures of a robot, drawn without GL."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from scipy.spatial import ConvexHull

from walkerlab.genome import Genome
from walkerlab.ground import height
from walkerlab.judge import UNSTABLE
from walkerlab.plots.style import new_axes
from walkerlab.rollout import walk
from walkerlab.scene import compile_scene
from walkerlab.settings import Settings
from walkerlab.shapes import skins

NEAR = 1.0  # m to either side of a robot, from which on what lies about is not drawn with it
ROPE = 2  # points of what is drawn as a line


def stride(genome: Genome | str, settings: Settings, ax: Axes | None = None) -> Axes:
    """Draw a robot from the side, to scale, caught up to four times on its way, ever darker; needs no GL.

    Args:
        genome: a genome or its text.
        settings: of terrain, robot and simulation.
        ax: where to draw; a new figure if None.

    Returns:
        The Axes drawn on.
    """
    axes = ax or new_axes()
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
        parts = skins(scene, poses[moment])
        if moment == moments[-1]:
            there = com[moment, 1]
            loose = skins(scene, poses[moment], loose=True)
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
