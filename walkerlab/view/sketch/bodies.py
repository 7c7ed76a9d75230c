"""Side view of a robot as it stands: compact enough for a grid of sixty, fast enough to follow a slider."""

from functools import lru_cache

import numpy as np

from walkerlab.genome.genome import Genome
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.view.sketch.description import describe_robot
from walkerlab.view.sketch.marks import draw_marks
from walkerlab.view.sketch.projection import SIDE_VIEW, Projection
from walkerlab.view.sketch.solids import draw_solids
from walkerlab.view.sketch.standing import standing_scene
from walkerlab.view.sketch.svg import draw_path, draw_text, write_image
from walkerlab.world.geometry import surface_points

GROUND_COLOUR = "#888888"  # visible on light and dark pages
BODY_MARGIN = 0.06  # margin on all sides, as a share of the drawing's width
MAX_CACHED_DRAWINGS = 512
CAPTION_HEIGHT = 26  # pixels
CAPTION_STYLE = {"font_size": 19, "font_family": "system-ui, sans-serif", "fill": "#333333"}


def draw_robot(
    genome: Genome | str,
    robot: Robot | None = None,
    *,
    size: tuple[float, float] = (110, 80),
    span: float | None = None,
    caption: str = "",
) -> str:
    """Draw a side view of a robot that stands on level ground and faces right.

    The robot is drawn in the pose in which its walk begins, after settling; simulating it takes about 8 ms. A robot
    that topples over while settling is drawn lying down. The legs on its right side, which is nearer, are light; those
    on its left side are dark. An eye marks the front of segment 1; large drawings also have the numbers of the
    segments.

    Args:
        genome: Genome or its text.
        robot: Limits to which the genome is repaired, and the pack to draw; if None, the genome is drawn unrepaired
            and without a pack.
        size: Width and height of the drawing [pixels].
        span: Width of the drawing [m], to draw several robots to the same scale; if None, or if the robot does not
            fit, the robot fills the drawing.
        caption: Text in the upper left corner, above the robot.

    Returns:
        The text of an SVG element with a description of the robot.

    Raises:
        GenomeError: If ``genome`` is text but not a valid genome.
    """
    return _draw_robot(Genome.of(genome), robot, size, span, caption)


@lru_cache(maxsize=MAX_CACHED_DRAWINGS)
def _draw_robot(
    genome: Genome,
    robot: Robot | None,
    size: tuple[float, float],
    span: float | None,
    caption: str,
) -> str:
    repaired = genome.within(robot) if robot else genome
    without_sledge = Settings(robot=robot or Robot()).with_(drag_weight=0.0)
    scene, pose = standing_scene(repaired, without_sledge)
    parts = surface_points(scene, pose)
    corners = np.concatenate([points @ SIDE_VIEW for points, _ in parts])
    left, bottom = corners.min(axis=0)
    right, top = corners.max(axis=0)
    width, height = size
    margin = BODY_MARGIN * width
    free_width = (1 - 2 * BODY_MARGIN) * width
    free_height = height - 2 * margin - (CAPTION_HEIGHT if caption else 0)
    scale = min(free_width / (right - left), free_height / (top - bottom), width / span if span else np.inf)
    ground = height - margin
    origin = np.array([(width - scale * (left + right)) / 2, ground + scale * bottom])
    ground_line = np.array([(margin / 2, ground), (width - margin / 2, ground)])
    projection = Projection(SIDE_VIEW, scale, origin)
    return write_image(
        size,
        f"A robot: {describe_robot(scene.phenotype)}.",
        draw_path([ground_line], closed=False, fill="none", stroke=GROUND_COLOUR),
        draw_solids(parts, projection),
        draw_marks(scene, pose, projection),
        *([draw_text(caption, 12, CAPTION_HEIGHT, **CAPTION_STYLE)] if caption else []),
    )
