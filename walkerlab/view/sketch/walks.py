"""Side view of a whole walk as an animated SVG, without OpenGL or scripts; it moves even if shown as an image.

Each part of the robot is a line whose ends move; the world moves behind the robot. The animation repeats.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.settings.terrain import Terrain
from walkerlab.simulation.rollout import Rollout
from walkerlab.text.numbers import with_unit
from walkerlab.view.sketch.description import describe_robot
from walkerlab.view.sketch.grounds import draw_ground
from walkerlab.view.sketch.pieces import draw_obstacles, draw_pieces
from walkerlab.view.sketch.sky import draw_force_arrows, draw_sky
from walkerlab.view.sketch.svg import draw_path, draw_text, hex_colour, make_element, write_image
from walkerlab.view.sketch.window import DrawnItem, Window, back_to_front, ground_points
from walkerlab.world.geometry import valid_poses
from walkerlab.world.heights import ground_height
from walkerlab.world.limbs import Limb, limb_tracks
from walkerlab.world.scene import Scene

FRAMES_PER_SECOND = 25
LENGTHS_IN_VIEW = 2.6  # visible width, in lengths of the body
MIN_WIDTH = 2.0  # m, smallest visible width
CAMERA_SMOOTHING = 0.6  # s over which the position of the camera is averaged
MAX_DISTANCE = 60.0  # m; the camera does not follow a robot that is thrown farther
NEAR_SHARE = 0.14  # distance of the ground's near edge from y = 0, as a share of the visible width
FAR_SHARE = 0.3  # distance of the ground's far edge from y = 0, as a share of the visible width
SECTION_HEIGHT = 0.16  # height of the ground's section below the robot, as a share of the visible width
EDGE_WIDTH = 1.4  # pixels; total width of the dark edges on both sides of a part
REDUCED_MOTION = "@media (prefers-reduced-motion: reduce) { .moving { display: none } .still { display: inline } }"


def draw_walk(scene: Scene, walk: Rollout, *, size: tuple[float, float] = (640, 288), moves: bool = True) -> str:
    """Draw a walk from the side; the camera follows the robot.

    A robot that turns is drawn as if it walked straight ahead. Loose obstacles are drawn where they lie at the start.

    Args:
        scene: Compiled scene of the walk.
        walk: Rollout with its poses.
        size: Width and height of the drawing [pixels].
        moves: Whether the drawing is animated; otherwise, it shows the middle of the walk.

    Returns:
        The text of an SVG element with a description of the walk.
    """
    poses = valid_poses(scene, walk.poses)
    time = walk.time[: len(poses)]
    com = np.nan_to_num(walk.com[: len(poses)]).clip(-MAX_DISTANCE, MAX_DISTANCE)
    frames = _frame_indices(time)
    if not moves:
        frames = frames[[len(frames) // 2]]
    terrain = scene.settings.terrain
    window = _choose_window(terrain, size, walk.phenotype.body_length, com)
    n_averaged = max(1, min(len(time), round(CAMERA_SMOOTHING * len(time) / max(1e-9, float(time[-1])))))
    camera = _camera_offsets(terrain, window, size[0], com, n_averaged)[frames]
    sideways = _moving_average(com[:, 1], n_averaged)[frames]
    limbs = [_shift_sideways(limb, -sideways) for limb in limb_tracks(scene, poses[frames])]
    limbs.sort(key=lambda limb: -float(limb.ends[0, :, 1].mean()))
    seconds = float(time[-1])
    view = replace(window, size=size, width_m=window.width_m * size[0] / window.size[0])
    label = (
        f"Side view of a walk of {with_unit(walk.distance, 'm')} in {with_unit(float(walk.time[-1]), 's')}: "
        f"{describe_robot(walk.phenotype)}."
    )
    still = _draw_moment(terrain, window, camera[:1], [_first_pose(limb) for limb in limbs], seconds)
    content = [draw_sky(terrain, view)]
    if len(frames) > 1:
        content.append(make_element("style", text=f".still {{ display: none }} {REDUCED_MOTION}"))
        content.append(make_element("g", _draw_moment(terrain, window, camera, limbs, seconds), class_="moving"))
        content.append(make_element("g", still, class_="still"))
    else:
        content.append(still)
    return write_image(size, label, *content, draw_force_arrows(terrain), font_family="system-ui, sans-serif")


def _frame_indices(time: Floats) -> Any:
    """Return the indices of the poses that are drawn, ``FRAMES_PER_SECOND`` or a little less."""
    step = max(1, round(len(time) / max(1.0, float(time[-1]) * FRAMES_PER_SECOND)))
    return np.arange(0, len(time), step)


def _shift_sideways(limb: Limb, shift: Floats) -> Limb:
    return replace(limb, ends=limb.ends + shift[:, np.newaxis, np.newaxis] * (0.0, 1.0, 0.0))


def _first_pose(limb: Limb) -> Limb:
    return replace(limb, ends=limb.ends[:1])


def _choose_window(terrain: Terrain, size: tuple[float, float], body_length: float, com: Floats) -> Window:
    """Return the window of all ground that the camera passes, at the scale of the drawing."""
    width_m = max(MIN_WIDTH, LENGTHS_IN_VIEW * body_length)
    scale = size[0] / width_m
    left = float(com[:, 0].min()) - width_m
    total = float(com[:, 0].max()) + width_m - left
    bottom = float(ground_height(terrain, np.array([com[0, 0]]))[0]) - SECTION_HEIGHT * width_m
    return Window((total * scale, size[1]), left, total, bottom, (-NEAR_SHARE * width_m, FAR_SHARE * width_m))


def _camera_offsets(terrain: Terrain, window: Window, width: float, com: Floats, n_averaged: int) -> Floats:
    """Return the translation of the world that keeps the robot in the middle [pixels], shape (n, 2)."""
    x = _moving_average(com[:, 0], n_averaged)
    level = _moving_average(ground_height(terrain, x), n_averaged)
    scale = window.projection.scale
    return np.stack([width / 2 - (x - window.left) * scale, (level - level[0]) * scale], axis=1)


def _moving_average(values: Floats, n: int) -> Floats:
    padded = np.concatenate([np.full(n // 2, values[0]), values, np.full(n - 1 - n // 2, values[-1])])
    return np.convolve(padded, np.full(n, 1 / n), mode="valid")


def _draw_moment(terrain: Terrain, window: Window, camera: Floats, limbs: list[Limb], seconds: float) -> Element:
    """Draw the world with the robot, animated if there are several frames.

    Args:
        terrain: Terrain of the walk.
        window: Visible part of the world.
        camera: Translation of the world in each frame [pixels], shape (n, 2).
        limbs: Parts of the robot in each frame, the most distant first.
        seconds: Duration of the animation [s].
    """
    animate = partial(_animate, seconds=seconds)
    names = (f"limb{len(camera)}-{number}" for number in range(len(limbs)))
    robot = make_element(
        "g", *(_draw_limb(limb, window, animate, name) for limb, name in zip(limbs, names, strict=True))
    )
    items: list[DrawnItem] = [
        *draw_ground(terrain, window),
        *draw_pieces(terrain, window),
        *draw_obstacles(terrain, window),
        *_draw_marks(terrain, window),
        (float(limbs[-1].ends[0, :, 1].mean()), robot),
    ]
    translations = [f"{x:.1f} {y:.1f}" for x, y in camera.tolist()]
    world = make_element("g", *back_to_front(items), transform=f"translate({translations[0]})")
    if len(camera) > 1:
        world.append(animate("transform", translations, name="animateTransform", type="translate"))
    return world


def _draw_limb(limb: Limb, window: Window, animate: Any, name: str) -> Element:
    """Draw a part of the robot: a line with a dark edge, animated if there are several frames."""
    lines = [
        f"M{x:.0f} {y:.0f}L{end_x:.0f} {end_y:.0f}"
        for (x, y), (end_x, end_y) in (10 * window.projection.project(limb.ends)).tolist()
    ]
    width = 2 * limb.radius * window.projection.scale
    line = make_element("path", id=name, d=lines[0])
    if len(lines) > 1:
        line.append(animate("d", lines))
    strokes = [("#1a1a1a", width + EDGE_WIDTH), (hex_colour(limb.colour), width)]
    drawn = [
        make_element("use", href=f"#{name}", stroke=stroke, stroke_width=f"{10 * stroke_width:.0f}")
        for stroke, stroke_width in strokes
    ]
    ends = "round" if limb.has_round_ends else "butt"
    return make_element("g", make_element("defs", line), *drawn, stroke_linecap=ends, transform="scale(0.1)")


def _animate(attribute: str, values: list[str], seconds: float, name: str = "animate", **attributes: str) -> Element:
    """Return an animation that shows each value of an attribute for the same time, and repeats indefinitely."""
    return make_element(
        name,
        attributeName=attribute,
        values=";".join(values),
        dur=f"{seconds:g}s",
        calcMode="discrete",
        repeatCount="indefinite",
        **attributes,
    )


def _draw_marks(terrain: Terrain, window: Window) -> Iterator[DrawnItem]:
    """Draw a line across the ground at each whole metre, and its distance in front of the ground's section."""
    near = window.y_range[0]
    start, end = window.left, window.left + window.width_m
    for metre in np.arange(np.ceil(start), np.floor(end) + 1).tolist():
        ends = window.projection.project(ground_points(terrain, np.full(2, metre), np.array(window.y_range)))
        yield (
            window.y_range[1],
            draw_path([ends], closed=False, stroke="#fff", stroke_width=3 if metre == 0 else 1, stroke_opacity=0.8),
        )
        x, y = ends[0].tolist()
        label = "start" if metre == 0 else f"{metre:g} m".replace("-", "−")
        style = {"text_anchor": "middle", "fill": "#fff", "font_size": 15}
        outline = {"stroke": "#6b6b66", "stroke_width": 3, "paint_order": "stroke", "stroke_linejoin": "round"}
        yield near, draw_text(label, x, y + 19, **style, **outline)
