"""Side view, to scale, of a world and of a robot at its start."""

import math
from collections.abc import Iterator
from xml.etree.ElementTree import Element

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.genome.genome import Genome
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.view.sketch.description import describe_world, unusual_forces
from walkerlab.view.sketch.grounds import draw_ground
from walkerlab.view.sketch.marks import draw_marks
from walkerlab.view.sketch.pieces import draw_obstacles, draw_pieces, draw_shadow
from walkerlab.view.sketch.projection import RAISED_VIEW
from walkerlab.view.sketch.sky import FORCE_ROW_HEIGHT, draw_force_arrows, draw_sky
from walkerlab.view.sketch.solids import draw_solids
from walkerlab.view.sketch.standing import standing_scene
from walkerlab.view.sketch.svg import TEXT_COLOUR, draw_path, draw_text, make_element, write_image
from walkerlab.view.sketch.window import DrawnItem, Window, back_to_front, ground_points
from walkerlab.world.assembly import ROPE_LENGTH
from walkerlab.world.entities.load import half_sledge_length
from walkerlab.world.geometry import surface_points
from walkerlab.world.heights import LANDING_LENGTH, ground_height

SCALE_HEIGHT = 22.0  # pixels below the picture, for the distance scale
TICK_SPACINGS = (0.1, 0.2, 0.5, 1, 2, 5, 10)  # m
MIN_TICK_SPACING = 90  # pixels
MARGIN_BEHIND = 0.25  # m of ground behind the robot or its sledge
MARGIN_ABOVE = 0.2  # m of picture above the robot
MIN_SECTION_HEIGHT = 0.3  # m; height of the ground's section at its lowest visible point
LENGTHS_AHEAD = 2.4  # visible distance ahead of the start, in lengths of the longest robot
NEAR_SHARE = 0.13  # distance of the ground's near edge from y = 0, as a share of the visible width
FAR_SHARE = 0.35  # distance of the ground's far edge from y = 0, as a share of the visible width

RobotParts = list[tuple[Floats, Floats]]


def draw_world(
    settings: Settings,
    genome: Genome | str | None = None,
    *,
    size: tuple[float, float] = (720, 300),
    width_m: float | None = None,
) -> str:
    """Draw the ground, its texture pieces and obstacles, gravity and wind, and a robot at its start.

    Args:
        settings: Settings with terrain and robot.
        genome: Genome or its text, repaired to the limits; if None, no robot is drawn.
        size: Width and height of the drawing [pixels].
        width_m: Visible width [m], or more if the robot needs it; if None, the width that the longest robot within
            the limits needs.

    Returns:
        The text of an SVG element with a description of the world.

    Raises:
        GenomeError: If ``genome`` is text but not a valid genome.
    """
    standing = None if genome is None else standing_scene(Genome.of(genome).within(settings.robot), settings)
    parts = surface_points(*standing) if standing else []
    window = _choose_window(settings, parts, (size[0], size[1] - SCALE_HEIGHT), width_m)
    terrain = settings.terrain
    items: list[DrawnItem] = [
        *draw_ground(terrain, window),
        *draw_pieces(terrain, window),
        *draw_obstacles(terrain, window),
        (window.y_range[1], _draw_start_line(settings, window)),
    ]
    if standing:
        shadows = make_element("g", *(draw_shadow(terrain, points, window) for points, _ in parts))
        marks = draw_marks(*standing, window.projection)
        robot = make_element("g", shadows, draw_solids(parts, window.projection), marks)
        items.append((min(float(points[:, 1].min()) for points, _ in parts), robot))
    picture_width, picture_height = window.size
    picture = make_element(
        "svg",
        draw_sky(terrain, window),
        *back_to_front(items),
        draw_force_arrows(terrain),
        width=picture_width,
        height=picture_height,
        aria_hidden="true",
    )
    label = describe_world(settings, standing[0].phenotype if standing else None)
    return write_image(size, label, picture, _draw_distance_scale(window), font_family="system-ui, sans-serif")


def _choose_window(settings: Settings, parts: RobotParts, size: tuple[float, float], width_m: float | None) -> Window:
    """Choose a window with the whole robot, a stretch ahead of it and, if possible, the lowest visible ground.

    Args:
        settings: Settings with terrain and robot.
        parts: Points and colour of each part of the robot, as returned by ``surface_points``; empty without a robot.
        size: Width and height of the picture [pixels].
        width_m: Visible width [m], as in ``draw_world``.
    """
    terrain = settings.terrain
    robot = settings.robot
    width_px, height_px = size
    corners = np.concatenate([np.zeros((1, 2)), *(points @ RAISED_VIEW for points, _ in parts)])
    robot_left, robot_bottom = corners.min(axis=0).tolist()
    robot_top = float(corners[:, 1].max())
    behind = MARGIN_BEHIND + robot.body_length[1] + _sledge_reach(robot)
    width = width_m or _round_up_to_half(behind + max(LANDING_LENGTH + 1.5, LENGTHS_AHEAD * robot.body_length[1]))
    width = max(
        width,
        _round_up_to_half(1.3 * (MARGIN_BEHIND - robot_left)),
        _round_up_to_half((robot_top - robot_bottom + MARGIN_ABOVE + MIN_SECTION_HEIGHT) * width_px / height_px),
    )
    left = -max(MARGIN_BEHIND - robot_left, min(behind, 0.6 * width))
    near = -NEAR_SHARE * width
    scale = width_px / width
    section_height = MIN_SECTION_HEIGHT - RAISED_VIEW[1, 1] * near
    lowest_ground = float(np.min(ground_height(terrain, np.linspace(left, left + width, 200), near)))
    margin_above = max(MARGIN_ABOVE, FORCE_ROW_HEIGHT * len(list(unusual_forces(terrain))) / scale)
    bottom = max(lowest_ground - section_height, robot_top + margin_above - height_px / scale)
    bottom = min(bottom, robot_bottom - section_height)
    return Window(size, left, width, bottom, (near, FAR_SHARE * width))


def _round_up_to_half(length: float) -> float:
    """Round up to a multiple of 0.5 m, so that the scale rarely changes while a slider moves."""
    return math.ceil(2 * length - 1e-9) / 2


def _sledge_reach(robot: Robot) -> float:
    """Return the largest distance [m] from a robot to the far end of its sledge; 0 without a sledge."""
    if not robot.drag_weight:
        return 0.0
    return ROPE_LENGTH + robot.leg_length_range[1] + 2 * half_sledge_length(robot.drag_weight)


def _draw_start_line(settings: Settings, window: Window) -> Element:
    """Draw the line from which walked distances are measured, as a white line with a dark outline."""
    ends = window.projection.project(ground_points(settings.terrain, np.zeros(2), np.array(window.y_range)))
    return make_element(
        "g",
        draw_path([ends], closed=False, stroke="#000", stroke_width=5, stroke_opacity=0.25),
        draw_path([ends], closed=False, stroke="#fff", stroke_width=2.5),
    )


def _draw_distance_scale(window: Window) -> Element:
    """Draw ticks with distances in metres below the picture, along the near edge of the ground."""

    def ticks() -> Iterator[Element]:
        scale = window.projection.scale
        step = next((step for step in TICK_SPACINGS if step * scale >= MIN_TICK_SPACING), 100)
        first, last = np.ceil(window.left / step), np.floor((window.left + window.width_m) / step)
        width_px, top = window.size
        for number in np.arange(first, last + 1).tolist():
            x = (number * step - window.left) * scale
            tick = np.array([(x, top), (x, top + 5)])
            yield draw_path([tick], closed=False, stroke=TEXT_COLOUR, stroke_opacity=0.6)
            label = "start" if number == 0 else f"{number * step:g} m".replace("-", "−")
            if 14 < x < width_px - 14:
                yield draw_text(
                    label, x, top + 18, text_anchor="middle", fill=TEXT_COLOUR, fill_opacity=0.8, font_size=12
                )

    return make_element("g", *ticks())
