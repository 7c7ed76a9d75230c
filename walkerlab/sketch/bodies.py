"""A robot from the side in its pose of rest: small enough for a strip of sixty, quick enough to follow a slider."""

from functools import lru_cache

import numpy as np

from walkerlab.genome import Genome
from walkerlab.markup import Html
from walkerlab.scene import scene_of
from walkerlab.settings import Robot, Settings
from walkerlab.shapes import skins
from walkerlab.sketch.lens import LEVEL, Lens
from walkerlab.sketch.pen import INK, drawing, shape
from walkerlab.sketch.solids import figure
from walkerlab.sketch.words import measures

MARGIN = 0.06  # of the width of a drawing, left empty all round
KEPT = 512  # drawings that are remembered


def body(
    genome: Genome | str,
    robot: Robot | None = None,
    *,
    size: tuple[float, float] = (110, 80),
    span: float | None = None,
) -> Html:
    """Draw a robot from the side, standing on a line; it walks to the right.

    The legs of its right side, which are nearer, are light; those of its left side are dark.

    Args:
        genome: a genome or its text.
        robot: the limits that it is brought within, with the pack that it carries; as it is, without one, if None.
        size: of the drawing, in pixels.
        span: how many m the drawing is wide, so that several robots are drawn to one scale; as large as it can be if
            None, or if the robot would not fit.

    Returns:
        An SVG element, with the robot's measures in words.

    Raises:
        GenomeError: if a text is no genome.
    """
    return _body(Genome.of(genome), robot, size, span)


@lru_cache(maxsize=KEPT)
def _body(genome: Genome, robot: Robot | None, size: tuple[float, float], span: float | None) -> Html:
    own, alone = genome.within(robot) if robot else genome, Settings(robot=robot or Robot()).with_(drag_weight=0.0)
    scene = scene_of(own, alone)
    parts = skins(scene, scene.start)
    corners = np.concatenate([points @ LEVEL for points, _ in parts])
    (left, foot), (right, top) = corners.min(axis=0), corners.max(axis=0)
    wide, high = size
    inner = (1 - 2 * MARGIN) * wide
    scale = min(inner / (right - left), (high - 2 * MARGIN * wide) / (top - foot), wide / span if span else np.inf)
    floor = high - MARGIN * wide
    place = np.array([(wide - scale * (left + right)) / 2, floor + scale * foot])
    line = np.array([(MARGIN / 2 * wide, floor), ((1 - MARGIN / 2) * wide, floor)])
    return drawing(
        size,
        f"A robot: {measures(scene.phenotype)}.",
        shape([line], closed=False, fill="none", stroke=INK, stroke_opacity=0.5),
        figure(parts, Lens(LEVEL, scale, place)),
    )
