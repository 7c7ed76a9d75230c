"""What is over the ground, as it is drawn: the sky of that gravity, and arrows for pull and wind, with words."""

import math

import numpy as np

from walkerlab.entities.scenery import SKIES, Sky
from walkerlab.genes import Floats
from walkerlab.markup import Html, tag
from walkerlab.settings import Terrain
from walkerlab.sketch.lens import RAISED
from walkerlab.sketch.pen import blend, dashes, hue, scattered, shape, text
from walkerlab.sketch.stage import Stage
from walkerlab.sketch.words import forces

BANDS = 30  # of the sky, from the zenith to the horizon
STARS = 70
LABEL = 34  # pixels that an arrow and its words are high
ARROW = 22.0  # pixels that an arrow is long at most
STRONG = {"gravity": 10.0, "wind": 12.0}  # m/s², m/s: where an arrow has its full length
DARK = 0.2  # brightness of a sky on which words are light


def sky(terrain: Terrain, stage: Stage) -> Html:
    """Draw the sky: of the moon, of Mars, of the earth or of Jupiter, as strong as the pull is."""
    over, (wide, high) = _sky(terrain), stage.size
    edges = np.round(np.linspace(0, high, BANDS + 1)).astype(int).tolist()
    shares = np.clip(np.linspace(0, 1.3, BANDS), 0, 1) ** 0.8
    bands = [
        tag("rect", y=top, width=wide, height=bottom - top, fill=hue(blend(over.zenith, over.horizon, share)))
        for top, bottom, share in zip(edges[:-1], edges[1:], shares.tolist(), strict=True)
    ]
    number = np.arange(STARS if over.stars else 0)
    spots = np.stack([scattered(number, 0) * wide, scattered(number, 1) * high], axis=1)
    stars = dashes(spots, 0.1, stroke="#fff", stroke_width=1.6, stroke_opacity=0.8)
    return tag("g", *bands, stars, shape_rendering="crispEdges")


def arrows(terrain: Terrain) -> Html:
    """Draw an arrow for each force that is not as on the earth on a calm day, with words beside it."""
    ink = "#fff" if max(_sky(terrain).zenith) < DARK else "#1a1a1a"
    drawn: list[Html] = []
    for row, (kind, vector, words) in enumerate(forces(terrain)):
        middle, strength = np.array([26.0, 24.0 + LABEL * row]), math.hypot(*vector)
        drawn.append(tag("circle", cx=26, cy=f"{middle[1]:g}", r=15, fill="#fff", fill_opacity=0.9))
        if strength:
            seen = np.array(vector) @ RAISED * (1, -1)
            way = seen / max(float(np.linalg.norm(seen)), 1e-9)
            drawn.append(_arrow(middle, ARROW / 2 * min(1.0, math.sqrt(strength / STRONG[kind])) * way, way))
        drawn.append(text(words, 48, middle[1] + 4.5, font_size=13, fill=ink))
    return tag("g", *drawn)


def _arrow(middle: Floats, reach: Floats, way: Floats) -> Html:
    tip, across = middle + reach, np.array([-way[1], way[0]])
    head = np.stack([tip, tip - 8 * way + 4.5 * across, tip - 8 * way - 4.5 * across])
    shaft = shape([np.stack([middle - reach, tip - 4 * way])], closed=False, stroke="#b34700", stroke_width=2.4)
    return tag("g", shaft, shape([head], fill="#b34700"))


def _sky(terrain: Terrain) -> Sky:
    return next(sky for most, sky in SKIES.items() if math.hypot(*terrain.gravity) <= most)
