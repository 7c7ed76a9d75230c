"""Pictures of a robot, drawn without GL."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from walkerlab.ga.genes import Floats
from walkerlab.genome.genome import Genome
from walkerlab.genome.phenotype import Phenotype
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import count
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.view.plots.appearance import ink, new_axes, picture
from walkerlab.view.plots.style import QUIET, describe, with_unit
from walkerlab.world.geometry import ROPE_POINTS, outline, skins, valid_poses
from walkerlab.world.heights import height
from walkerlab.world.scene import Scene, compile_scene, scene_of

MARGIN = 0.2  # m of ground that is seen before and behind all that stands on it
MOST, APART = 5, 1.3  # times at most that a robot is drawn on its way; body lengths between two of them at least
SHORT = 0.05  # m, for which there is no arrow
NEAR = 1.0  # m to either side of a robot, from which on what lies about is not drawn with it
SLANT = 0.35  # by which what is farther away is drawn farther right, or its far legs could not be seen

Parts = Sequence[tuple[Floats, Floats]]
"""As ``skins`` lays them out: (k, 3) points each, and their colour."""


@picture
def body(genome: Genome | str, ax: Axes | None = None, settings: Settings | None = None) -> Axes:
    """Draw a robot from the side in its pose of rest, to scale, with its measures; it walks to the right.

    The legs of its right side, which are nearer, are light; those of its left side are dark.

    Args:
        genome: a genome or its text.
        ax: where to draw; a new figure if None.
        settings: of which the limits are held and the loads are drawn; the robot as it is, without loads, if None.

    Returns:
        The Axes drawn on.

    Raises:
        GenomeError: if a text is no genome.
    """
    axes = ax or new_axes(4.2, 2.8)
    scene = at_rest(genome, settings)
    left, right, _, top = add_body(axes, skins(scene, scene.start), slant=SLANT)
    wide = right - left
    axes.plot([left - 0.05 * wide, right + 0.05 * wide], [0, 0], color=ink(axes, 0.5), lw=1)
    bar = _round_length(wide / 3)
    below = -0.06 * wide
    axes.plot([left, left + bar], [below, below], color=ink(axes), lw=2.5, solid_capstyle="butt")
    axes.text(left + bar + 0.02 * wide, below, f"{bar:g} m", va="center", fontsize=8)
    axes.set_xlim(left - 0.06 * wide, right + 0.06 * wide)
    axes.set_ylim(below - 0.05 * wide, top + 0.03 * wide)
    axes.set_aspect("equal")
    axes.set_axis_off()
    said = measures(scene.phenotype)
    axes.set_title(said, fontsize=9)
    describe(axes, "A robot", f"A robot from the side, in its pose of rest: {said}.")
    return axes


@picture
def stride(genome: Genome | str, settings: Settings, ax: Axes | None = None) -> Axes:
    """Draw a robot from the side, to scale, at the start, on its way and at the end, ever darker; needs no GL.

    An arrow shows how far its centre of mass has come. What lies about is drawn as it lies at the end.
    Of several starts, the poorest walk is drawn: the one that counted. If its numbers ran away, it ends before that.

    Args:
        genome: a genome or its text.
        settings: of terrain, robot and simulation.
        ax: where to draw; a new figure if None.

    Returns:
        The Axes drawn on.
    """
    axes = ax or new_axes()
    scene = compile_scene(genome, settings)
    rollout = poorest_walk(genome, settings)
    poses = valid_poses(scene, rollout.poses)
    time, com = rollout.time[: len(poses)], np.nan_to_num(rollout.com[: len(poses)])
    way, length = float(com[-1, 0] - com[0, 0]), rollout.phenotype.body_length
    n_caught = min(len(time), 2 + int(np.clip(abs(way) / (APART * length) - 1, 0, MOST - 2)))
    moments = np.linspace(0, len(time) - 1, n_caught).astype(int)
    caught = [skins(scene, pose) for pose in poses[moments]]
    along = np.concatenate([skin[:, 0] for parts in caught for skin, _ in parts])
    x = np.linspace(along.min() - MARGIN, along.max() + MARGIN, 400)
    caught[-1] += [
        one
        for one in skins(scene, poses[-1], loose=True)
        if abs(one[0][:, 1].mean() - com[-1, 1]) < NEAR and x[0] < one[0][:, 0].mean() < x[-1]
    ]
    shades = np.linspace(0.25, 1.0, n_caught).tolist() if n_caught > 1 else [1.0]
    top = max(add_body(axes, parts, strength=shade)[3] for shade, parts in zip(shades, caught, strict=True))
    ground = height(settings.terrain, x)
    axes.fill_between(x, ground, ground.min() - 0.08, color=ink(axes, 0.2), lw=0)
    axes.set_xlim(x[0], x[-1])
    axes.set_aspect("equal")
    axes.set_xlabel("way forward [m]")
    axes.set_ylabel("height [m]")
    axes.spines[["top", "right"]].set_visible(False)
    came, after = with_unit(way, "m"), with_unit(float(time[-1]), "s")
    axes.set_ylim(ground.min() - 0.08, top + 0.02 * np.ptp(x))
    if abs(way) > SHORT:
        level = axes.get_ylim()[1]
        axes.set_ylim(top=level + 0.03 * np.ptp(x))
        _measure(axes, com[0, 0], com[-1, 0], level, f"{came} in {after}")
    when = f"caught {count(n_caught, 'time')}; after {after} it is {came} ahead" if n_caught > 1 else "at its start"
    judged = "" if rollout.counts else f" The walk does not count: {rollout.verdict}."
    describe(axes, "A robot on its way", f"A robot from the side, {when}: {measures(scene.phenotype)}.{judged}")
    return axes


def _measure(axes: Axes, start: float, end: float, level: float, words: str) -> None:
    """Draw an arrow from one place along the way to another, with words on it."""
    look: dict[str, Any] = {
        "arrowstyle": "|-|,widthA=0.25,widthB=0",
        "lw": 0.8,
        "color": ink(axes, QUIET),
        "shrinkA": 0,
        "shrinkB": 0,
    }
    for style in (look, look | {"arrowstyle": "-|>"}):
        axes.annotate("", (end, level), (start, level), arrowprops=style)
    above: dict[str, Any] = {"ha": "center", "va": "bottom", "fontsize": 8, "color": ink(axes, QUIET)}
    axes.annotate(words, ((start + end) / 2, level), (0, 2), textcoords="offset points", **above)


def measures(robot: Phenotype) -> str:
    """Say what a robot is made of: segments, legs, weight and length."""
    return (
        f"{count(len(robot.segments), 'segment')}, {count(robot.n_legs, 'leg')}, {with_unit(robot.weight, 'kg')}, "
        f"{with_unit(robot.body_length, 'm')} long"
    )


def at_rest(genome: Genome | str, settings: Settings | None = None) -> Scene:
    """Build a robot on bare, level ground, with the loads of the settings; its pose of rest is ``Scene.start``."""
    if settings is None:
        return scene_of(Genome.of(genome), Settings())
    return compile_scene(genome, Settings(robot=require_settings(settings).robot))


def add_body(
    axes: Axes,
    parts: Parts,
    at: tuple[float, float] = (0.0, 0.0),
    scale: float = 1.0,
    strength: float = 1.0,
    slant: float = 0.0,
    gid: str | None = None,
) -> tuple[float, float, float, float]:
    """Add a body from the side to an Axes, and nothing else.

    Args:
        axes: of equal aspect, or the body is bent.
        parts: as ``skins`` lays them out.
        at: where its origin goes, in data coordinates.
        scale: data units per metre.
        strength: 1 for its own colours; towards 0 they fade into the ground.
        slant: m to the right for each m to the left of it, that is, away from who looks.
        gid: its id in SVG.

    Returns:
        Where it begins and ends: left, right, bottom and top, in data coordinates.
    """
    ordered = sorted(parts, key=lambda part: -part[0][:, 1].mean())  # the far side first
    view = np.array([(1.0, 0.0), (slant, 0.0), (0.0, 1.0)])
    outlines = [outline(points @ view) * scale + at for points, _ in ordered]
    ground = np.array(ink(axes, 0))
    fills = [ground + strength * (colour[:3] - ground) for _, colour in ordered]
    is_rope = [len(points) == ROPE_POINTS for points, _ in ordered]
    edge = ink(axes, strength)
    edges = [fill if rope else edge for fill, rope in zip(fills, is_rope, strict=True)]
    widths = [1.0 if rope else 0.4 for rope in is_rope]
    axes.add_collection(PolyCollection(outlines, facecolors=fills, edgecolors=edges, linewidths=widths, gid=gid))
    corners = np.concatenate(outlines)
    (left, bottom), (right, top) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return left, right, bottom, top


def _round_length(about: float) -> float:
    """Return a round length [m] of at most about so much: 1, 2 or 5 of some power of ten."""
    power = 10.0 ** math.floor(math.log10(about))
    return max(step * power for step in (1, 2, 5) if step * power <= about)
