"""Side views of a robot, drawn to scale with matplotlib; they do not require OpenGL."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Circle

from walkerlab.ga.genes import Floats
from walkerlab.genome.genome import Genome
from walkerlab.genome.phenotype import Phenotype
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.view.plots.appearance import foreground_colour, new_axes, styled_plot
from walkerlab.view.plots.style import SECONDARY_STRENGTH, add_description
from walkerlab.view.plots.tables import format_value
from walkerlab.view.sketch.marks import PUPIL_RADIUS, eye_circle
from walkerlab.view.sketch.projection import DEPTH_SHIFT
from walkerlab.view.sketch.standing import standing_pose
from walkerlab.world.geometry import ROPE_POINTS, convex_outline, surface_points, valid_poses
from walkerlab.world.heights import ground_height
from walkerlab.world.scene import Scene, compile_scene, scene_of

GROUND_MARGIN = 0.2  # m of ground drawn before and behind the bodies
GROUND_DEPTH = 0.08  # m of ground drawn below its lowest point
MAX_BODIES = 5  # maximum number of times that a robot is drawn along its walk
MIN_SPACING = 1.3  # body lengths between two drawings
MIN_ARROW = 0.05  # m; a shorter distance has no arrow
MAX_SIDE_DISTANCE = 1.0  # m; loose obstacles within this distance to either side of the robot are drawn

BodyParts = Sequence[tuple[Floats, Floats]]
"""Bodies, legs and loads as ``surface_points`` returns them: points [m], shape (k, 3), and RGBA colour of each."""


@styled_plot
def body(genome: Genome | str, ax: Axes | None = None, settings: Settings | None = None) -> Axes:
    """Draw a side view of a robot, to scale, in the pose in which its walk begins, with its dimensions.

    The robot faces right. The legs on its right side, which is nearer, are light; those on its left side are dark. An
    eye marks segment 1.

    Args:
        genome: Genome, or its text.
        ax: Axes to draw on; if None, a new figure is created.
        settings: Settings with the robot limits and the loads to draw; no limits or loads if None.

    Returns:
        The Axes drawn on.

    Raises:
        GenomeError: If the text is not a valid genome.
    """
    axes = ax or new_axes(4.2, 2.8)
    scene = resting_scene(genome, settings)
    left, right, _, top = add_body(axes, standing_parts(scene), slant=DEPTH_SHIFT)
    add_eye(axes, scene, standing_pose(scene.genome, scene.settings), slant=DEPTH_SHIFT)
    width = right - left
    ground_ends = [left - 0.05 * width, right + 0.05 * width]
    axes.plot(ground_ends, [0, 0], color=foreground_colour(axes, 0.5), lw=1)
    bar_length = _round_down(width / 3)
    bar_end = left + bar_length
    bar_y = -0.06 * width
    axes.plot([left, bar_end], [bar_y, bar_y], color=foreground_colour(axes), lw=2.5, solid_capstyle="butt")
    axes.text(bar_end + 0.02 * width, bar_y, f"{bar_length:g} m", va="center", fontsize=8)
    axes.set_xlim(left - 0.06 * width, right + 0.06 * width)
    axes.set_ylim(bar_y - 0.05 * width, top + 0.03 * width)
    axes.set_aspect("equal")
    axes.set_axis_off()
    dimensions = describe_body(scene.phenotype)
    axes.set_title(dimensions, fontsize=9)
    add_description(axes, "A robot", f"Side view of a robot as it stands when its walk begins: {dimensions}.")
    return axes


@styled_plot
def stride(genome: Genome | str, settings: Settings, ax: Axes | None = None) -> Axes:
    """Draw a robot from the side, to scale, at successive moments of its walk, from pale to dark.

    An arrow shows the distance travelled by the centre of mass. Loose obstacles are drawn where they are at the end. If
    there are several starts, the walk with the lowest fitness is drawn, because that is the one that counts. If the
    simulation becomes unstable, the drawing ends with the last valid pose. OpenGL is not required.

    Args:
        genome: Genome, or its text.
        settings: Complete settings.
        ax: Axes to draw on; if None, a new figure is created.

    Returns:
        The Axes drawn on.
    """
    axes = ax or new_axes()
    scene = compile_scene(genome, settings)
    rollout = poorest_walk(genome, settings)
    poses = valid_poses(scene, rollout.poses)
    time = rollout.time[: len(poses)]
    com = np.nan_to_num(rollout.com[: len(poses)])
    distance = float(com[-1, 0] - com[0, 0])
    n_intervals = abs(distance) / (MIN_SPACING * rollout.phenotype.body_length)
    n_bodies = min(len(time), 2 + int(np.clip(n_intervals - 1, 0, MAX_BODIES - 2)))
    moments = np.linspace(0, len(time) - 1, n_bodies).astype(int)
    bodies = [surface_points(scene, pose) for pose in poses[moments]]
    points_x = np.concatenate([points[:, 0] for parts in bodies for points, _ in parts])
    x = np.linspace(points_x.min() - GROUND_MARGIN, points_x.max() + GROUND_MARGIN, 400)
    bodies[-1] += _visible_obstacles(scene, poses[-1], (x[0], x[-1]), com[-1, 1])
    strengths = np.linspace(0.25, 1.0, n_bodies).tolist() if n_bodies > 1 else [1.0]
    top = -math.inf
    for strength, parts, moment in zip(strengths, bodies, moments, strict=True):
        at = (-DEPTH_SHIFT * float(com[moment, 1]), 0.0)  # only the depth of parts relative to the body is drawn
        top = max(top, add_body(axes, parts, at=at, strength=strength, slant=DEPTH_SHIFT)[3])
        add_eye(axes, scene, poses[moment], at=at, strength=strength, slant=DEPTH_SHIFT)
    ground = ground_height(settings.terrain, x)
    bottom = ground.min() - GROUND_DEPTH
    axes.fill_between(x, ground, bottom, color=foreground_colour(axes, 0.2), lw=0)
    axes.set_xlim(x[0], x[-1])
    axes.set_aspect("equal")
    axes.set_xlabel("distance forward [m]")
    axes.set_ylabel("height [m]")
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_ylim(bottom, top + 0.02 * np.ptp(x))
    reached = format_value(distance, "m")
    duration = format_value(float(time[-1]), "s")
    if abs(distance) > MIN_ARROW:
        level = axes.get_ylim()[1]
        axes.set_ylim(top=level + 0.03 * np.ptp(x))
        _add_distance_arrow(axes, com[0, 0], com[-1, 0], level, f"{reached} in {duration}")
    when = f"at {n_bodies} moments of its walk; after {duration} it has moved {reached} forward"
    if n_bodies == 1:
        when = "at the start of its walk"
    verdict = "" if rollout.counts else f" The walk does not count: {rollout.verdict}."
    text = f"Side view of a robot ({describe_body(scene.phenotype)}) {when}.{verdict}"
    add_description(axes, "A robot during its walk", text)
    return axes


def _visible_obstacles(scene: Scene, pose: Floats, ends: tuple[float, float], y: float) -> list[tuple[Floats, Floats]]:
    """Return the loose obstacles close to the robot.

    Args:
        scene: Compiled scene.
        pose: Pose of the scene, shape (nq,).
        ends: Horizontal limits of the drawing [m].
        y: Lateral position of the robot [m].
    """
    obstacles = surface_points(scene, pose, loose=True)
    centres = [points.mean(axis=0) for points, _ in obstacles]
    return [
        obstacle
        for obstacle, (centre_x, centre_y, _) in zip(obstacles, centres, strict=True)
        if abs(centre_y - y) < MAX_SIDE_DISTANCE and ends[0] < centre_x < ends[1]
    ]


def _add_distance_arrow(axes: Axes, start: float, end: float, level: float, label: str) -> None:
    """Draw a labelled arrow between two positions along the horizontal axis.

    Args:
        axes: Axes to draw on.
        start: Start of the arrow [m].
        end: Tip of the arrow [m].
        level: Height of the arrow [m].
        label: Text above the arrow.
    """
    colour = foreground_colour(axes, SECONDARY_STRENGTH)
    line: dict[str, Any] = {"lw": 0.8, "color": colour, "shrinkA": 0, "shrinkB": 0}
    for arrow_style in ("|-|,widthA=0.25,widthB=0", "-|>"):
        axes.annotate("", (end, level), (start, level), arrowprops=line | {"arrowstyle": arrow_style})
    text: dict[str, Any] = {"ha": "center", "va": "bottom", "fontsize": 8, "color": colour}
    axes.annotate(label, ((start + end) / 2, level), (0, 2), textcoords="offset points", **text)


def describe_body(robot: Phenotype) -> str:
    """Describe a robot by its numbers of segments and legs, its weight and its length."""
    return (
        f"{pluralize(len(robot.segments), 'segment')}, {pluralize(robot.n_legs, 'leg')}, "
        f"{format_value(robot.weight, 'kg')}, "
        f"{format_value(robot.body_length, 'm')} long"
    )


def resting_scene(genome: Genome | str, settings: Settings | None = None) -> Scene:
    """Compile a robot and the loads of the settings on bare, level ground; see ``standing_parts``."""
    if settings is None:
        return scene_of(Genome.of(genome), Settings())
    return compile_scene(genome, Settings(robot=require_settings(settings).robot))


def standing_parts(scene: Scene) -> list[tuple[Floats, Floats]]:
    """Return the parts of a robot and its loads in its starting pose, in the format of ``surface_points``."""
    return surface_points(scene, standing_pose(scene.genome, scene.settings))


def add_eye(
    axes: Axes,
    scene: Scene,
    pose: Floats,
    at: tuple[float, float] = (0.0, 0.0),
    strength: float = 1.0,
    slant: float = 0.0,
) -> None:
    """Mark the front of segment 1 of a robot with an eye; for ``at``, ``strength`` and ``slant`` see ``add_body``."""
    centre, radius = eye_circle(scene, pose)
    place = centre @ _side_view(slant) + at
    background = np.array(foreground_colour(axes, 0))
    white, ink = (background + strength * (shade - background) for shade in (1.0, 0.1))
    for size, colour in ((radius, white), (PUPIL_RADIUS * radius, ink)):
        axes.add_patch(Circle((place[0], place[1]), size, fc=colour.tolist(), lw=0))


def add_body(
    axes: Axes,
    parts: BodyParts,
    at: tuple[float, float] = (0.0, 0.0),
    scale: float = 1.0,
    strength: float = 1.0,
    slant: float = 0.0,
    gid: str | None = None,
) -> tuple[float, float, float, float]:
    """Add the side view of a body to an Axes, without changing limits or labels.

    Args:
        axes: Axes of equal aspect.
        parts: Parts of the body, as ``surface_points`` returns them.
        at: Position of the origin of the body, in data coordinates.
        scale: Data units per metre.
        strength: 1 for the colours of the parts; towards 0 they fade into the background.
        slant: Shift to the right for each metre of depth.
        gid: Id of the body in SVG files.

    Returns:
        The left, right, bottom and top of the body, in data coordinates.
    """
    far_first = sorted(parts, key=lambda part: -part[0][:, 1].mean())
    outlines = [convex_outline(points @ _side_view(slant)) * scale + at for points, _ in far_first]
    background = np.array(foreground_colour(axes, 0))
    fills = [background + strength * (colour[:3] - background) for _, colour in far_first]
    is_rope = [len(points) == ROPE_POINTS for points, _ in far_first]
    edge = foreground_colour(axes, strength)
    edges = [fill if rope else edge for fill, rope in zip(fills, is_rope, strict=True)]
    widths = [1.0 if rope else 0.4 for rope in is_rope]
    axes.add_collection(PolyCollection(outlines, facecolors=fills, edgecolors=edges, linewidths=widths, gid=gid))
    corners = np.concatenate(outlines)
    left, bottom = corners.min(axis=0).tolist()
    right, top = corners.max(axis=0).tolist()
    return left, right, bottom, top


def _side_view(slant: float) -> Floats:
    """Return the projection from x, y and z to right and up, shape (3, 2); for ``slant`` see ``add_body``."""
    return np.array([(1.0, 0.0), (slant, 0.0), (0.0, 1.0)])


def _round_down(length: float) -> float:
    """Round a length [m] down to 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(step * power for step in (1, 2, 5) if step * power <= length)
