"""Drawings of the walks of one entry as points on a line, to see at a glance whether its result depends on luck."""

import math
from collections.abc import Iterator, Sequence
from xml.etree.ElementTree import Element

from walkerlab.tournament.scores import Round, Standing
from walkerlab.view.sketch.svg import make_element, write_image

STRIP_SIZE = (190, 26)  # pixels
MARGIN = 7  # pixels left of zero and right of the largest value
RADIUS = 4  # pixels
ROUND_SHIFT = 2.5  # pixels between the points of two rounds, which may be equal
LINE_COLOUR, OTHER_COLOUR, EXACT_COLOUR, SCORE_COLOUR, FAULT_COLOUR = (
    "#c9ced3",
    "#0072b2",
    "#1c2126",
    "#d55e00",
    "#a12f00",
)


def largest_result(standings: Sequence[Standing]) -> float:
    """Return the highest fitness of any walk of a league, at least a small positive number; the end of every line."""
    results = (result for standing in standings for one in standing.rounds for result in _results(one))
    return max([1e-3, *(result for result in results if math.isfinite(result))])


def draw_strip(standing: Standing, largest: float, unit: str) -> str:
    """Draw the walks of an entry: a point for each other start, a ring for the exact start, a bar for the score.

    Walks that do not count are crosses at zero; negative results are at zero, too, because they score 0.

    Args:
        standing: The entry.
        largest: Value at the right end of the line.
        unit: Unit of the values.

    Returns:
        The text of an SVG element.
    """
    width, height = STRIP_SIZE
    middle = height / 2

    def place(value: float) -> float:
        return MARGIN + (width - 2 * MARGIN) * min(max(value, 0.0), largest) / largest

    line = make_element(
        "path", d=f"M{MARGIN},{middle}H{width - MARGIN}M{MARGIN},4V{height - 4}", stroke=LINE_COLOUR, stroke_width=1.5
    )
    marks: list[Element] = []
    for number, one in enumerate(standing.rounds):
        y = middle + ROUND_SHIFT * (number - (len(standing.rounds) - 1) / 2)
        marks += [_draw_result(place(result), y, result, OTHER_COLOUR) for result in one.confirmation.nudged]
        marks.append(_draw_result(place(one.evaluation.fitness), y, one.evaluation.fitness, "none"))
    x = place(standing.score)
    score = make_element("path", d=f"M{x:.1f},2V{height - 2}", stroke=SCORE_COLOUR, stroke_width=2.5)
    return write_image(STRIP_SIZE, _describe(standing, unit), line, *marks, score, fill="none")


def _draw_result(x: float, y: float, result: float, fill: str) -> Element:
    """Draw the point, the ring or the cross of one walk."""
    if not math.isfinite(result):
        cross = f"M{x - 3:.1f},{y - 3:.1f}l6,6m0,-6l-6,6"
        return make_element("path", d=cross, stroke=FAULT_COLOUR, stroke_width=1.6)
    stroke = EXACT_COLOUR if fill == "none" else "#fff"
    return make_element(
        "circle", cx=f"{x:.1f}", cy=f"{y:.1f}", r=RADIUS, fill=fill, fill_opacity=0.8, stroke=stroke, stroke_width=1.2
    )


def _results(one: Round) -> Iterator[float]:
    """Yield the fitness of each walk of a round; -inf for those that do not count."""
    yield from one.confirmation.nudged
    yield one.evaluation.fitness


def _describe(standing: Standing, unit: str) -> str:
    """Describe the walks in words, for screen readers."""
    rounds = [
        f"{_format(one.evaluation.fitness)} from the exact start, {', '.join(map(_format, one.confirmation.nudged))} "
        "from other starts"
        for one in standing.rounds
    ]
    return f"Walks [{unit}]: {'; next round: '.join(rounds)}" if unit else f"Walks: {'; next round: '.join(rounds)}"


def _format(result: float) -> str:
    return f"{result:.2f}" if math.isfinite(result) else "not counted"
