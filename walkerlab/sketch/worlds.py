"""A world and a robot at its start, from the side and to scale."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from walkerlab.assembly import ROPE_LENGTH
from walkerlab.entities.load import half_sledge_length
from walkerlab.genes import Floats
from walkerlab.genome import Genome
from walkerlab.ground import LANDING, height
from walkerlab.markup import Html, tag
from walkerlab.scene import Scene, scene_of
from walkerlab.settings import Robot, Settings
from walkerlab.shapes import skins
from walkerlab.sketch.air import LABEL, arrows, sky
from walkerlab.sketch.grounds import ground
from walkerlab.sketch.lens import RAISED
from walkerlab.sketch.pen import INK, drawing, shape, text
from walkerlab.sketch.solids import figure
from walkerlab.sketch.stage import Item, Stage, in_order, surface
from walkerlab.sketch.strewn import obstacles, pieces, shadow
from walkerlab.sketch.words import forces, in_words

RULER = 22.0  # pixels under the picture, for the marks of the metres
MARGIN = 0.25  # m kept free behind what stands at the start
OVER = 0.2  # m kept free over a robot
CUT = 0.3  # m of the ground that is seen cut, at least
AHEAD = 2.4  # lengths of the longest robot that are seen ahead of it
NEAR, FAR = 0.13, 0.35  # of the width of a picture, to which the ground reaches on this side of the way and beyond

Parts = list[tuple[Floats, Floats]]


def world(
    settings: Settings,
    genome: Genome | str | None = None,
    *,
    size: tuple[float, float] = (720, 300),
    width_m: float | None = None,
) -> Html:
    """Draw the ground, what lies on it and what pulls and pushes over it; and a robot at its start.

    Args:
        settings: of terrain and robot.
        genome: a genome or its text, brought within the limits; nobody is there if None.
        size: of the drawing, in pixels.
        width_m: how many m it shows, or more if the robot asks for it; if None, as many as the longest that the limits
            allow would ask for.

    Returns:
        An SVG element, which says in words what is seen.

    Raises:
        GenomeError: if a text is no genome.
    """
    scene = None if genome is None else _scene(Genome.of(genome), settings)
    parts = skins(scene, scene.start) if scene else []
    stage = _stage(settings, parts, (size[0], size[1] - RULER), width_m)
    terrain = settings.terrain
    items: list[Item] = [*ground(terrain, stage), *pieces(terrain, stage), *obstacles(terrain, stage)]
    items.append((stage.sides[1], _line(settings, stage)))
    if parts:
        shadows = tag("g", *(shadow(terrain, points, stage) for points, _ in parts))
        robot = tag("g", shadows, figure(parts, stage.lens))
        items.append((min(float(points[:, 1].min()) for points, _ in parts), robot))
    wide, high = stage.size
    seen = tag(
        "svg", sky(terrain, stage), *in_order(items), arrows(terrain), width=wide, height=high, aria_hidden="true"
    )
    look = {"font_family": "system-ui, sans-serif"}
    return drawing(size, in_words(settings, scene and scene.phenotype), seen, _ruler(stage), **look)


def _scene(genome: Genome, settings: Settings) -> Scene:
    """Build a robot for this world, on its bare ground: what lies about would take long to compile."""
    bare = scene_of(genome.within(settings.robot), Settings(robot=settings.robot))
    return replace(bare, settings=settings)


def _stage(settings: Settings, parts: Parts, size: tuple[float, float], width_m: float | None) -> Stage:
    """Choose what is seen: all of the robot; ahead of it as much as fits; the ground, if it can be."""
    terrain, robot, (wide, high) = settings.terrain, settings.robot, size
    seen = np.concatenate([np.zeros((1, 2)), *(points @ RAISED for points, _ in parts)])
    (left, foot), (_, top) = seen.min(axis=0).tolist(), seen.max(axis=0).tolist()
    behind = MARGIN + robot.body_length[1] + _sledge(robot)
    width = width_m or _halves(behind + max(LANDING + 1.5, AHEAD * robot.body_length[1]))
    width = max(width, _halves(1.3 * (MARGIN - left)), _halves((top - foot + OVER + CUT) * wide / high))
    start = -max(MARGIN - left, min(behind, 0.6 * width))
    near, scale = -NEAR * width, wide / width
    cut = CUT - RAISED[1, 1] * near
    lowest = float(np.min(height(terrain, np.linspace(start, start + width, 200), near))) - cut
    above = max(OVER, LABEL * len(list(forces(terrain))) / scale)
    bottom = min(max(lowest, top + above - high / scale), foot - cut)
    return Stage(size, start, width, bottom, (near, FAR * width))


def _halves(length: float) -> float:
    """Round up to halves of a metre, so that the scale changes seldom while a slider moves."""
    return math.ceil(2 * length - 1e-9) / 2


def _sledge(robot: Robot) -> float:
    """Return how far behind a robot its sledge ends at most, in m; 0 without one."""
    if not robot.drag_weight:
        return 0.0
    return ROPE_LENGTH + 1.2 * robot.segment_length[1] + 2 * half_sledge_length(robot.drag_weight)


def _line(settings: Settings, stage: Stage) -> Html:
    """Draw the line across the way from which what is walked is measured."""
    y = np.array(stage.sides)
    ends = stage.lens.at(surface(settings.terrain, np.zeros(2), y))
    looks = ({"stroke": "#000", "stroke_width": 5, "stroke_opacity": 0.25}, {"stroke": "#fff", "stroke_width": 2.5})
    return tag("g", *(shape([ends], closed=False, **look) for look in looks))


def _ruler(stage: Stage) -> Html:
    """Draw marks of the metres along the near edge, under the picture."""

    def marks() -> Iterator[Html]:
        step = next((step for step in (0.1, 0.2, 0.5, 1, 2, 5, 10) if step * stage.lens.scale >= 90), 100)
        first, last = np.ceil(stage.start / step), np.floor((stage.start + stage.width) / step)
        for number in np.arange(first, last + 1).tolist():
            x = (number * step - stage.start) * stage.lens.scale
            top = stage.size[1]
            yield shape([np.array([(x, top), (x, top + 5)])], closed=False, stroke=INK, stroke_opacity=0.6)
            words = "start" if number == 0 else f"{number * step:g} m".replace("-", "−")
            if 14 < x < stage.size[0] - 14:
                yield text(words, x, top + 18, text_anchor="middle", fill=INK, fill_opacity=0.8, font_size=12)

    return tag("g", *marks())
