"""The sky, whose colours depend on gravity, and labelled arrows for gravity and wind."""

import math
from xml.etree.ElementTree import Element

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.settings.terrain import Terrain
from walkerlab.view.sketch.description import unusual_forces
from walkerlab.view.sketch.projection import RAISED_VIEW
from walkerlab.view.sketch.svg import blend, draw_dashes, draw_path, draw_text, hex_colour, make_element, pseudo_random
from walkerlab.view.sketch.window import Window
from walkerlab.world.entities.scenery import find_sky

N_SKY_BANDS = 30  # number of bands from the zenith to the horizon
N_STARS = 70
FORCE_ROW_HEIGHT = 34  # pixels for an arrow and its label
MAX_ARROW_LENGTH = 22.0  # pixels
FULL_ARROW_STRENGTH = {"gravity": 10.0, "wind": 12.0}  # m/s², m/s; strengths from which arrows have their full length
DARK_SKY_BRIGHTNESS = 0.2  # brightness below which labels are white


def draw_sky(terrain: Terrain, window: Window) -> Element:
    """Draw the sky of the moon, Mars, the earth or Jupiter, depending on the strength of gravity."""
    sky = find_sky(terrain)
    width, height = window.size
    edges = np.round(np.linspace(0, height, N_SKY_BANDS + 1)).astype(int).tolist()
    shares = np.clip(np.linspace(0, 1.3, N_SKY_BANDS), 0, 1) ** 0.8
    bands = [
        make_element(
            "rect", y=top, width=width, height=bottom - top, fill=hex_colour(blend(sky.zenith, sky.horizon, share))
        )
        for top, bottom, share in zip(edges[:-1], edges[1:], shares.tolist(), strict=True)
    ]
    indices = np.arange(N_STARS if sky.stars else 0)
    positions = np.stack([pseudo_random(indices, 0) * width, pseudo_random(indices, 1) * height], axis=1)
    stars = draw_dashes(positions, 0.1, stroke="#fff", stroke_width=1.6, stroke_opacity=0.8)
    return make_element("g", *bands, stars, shape_rendering="crispEdges")


def draw_force_arrows(terrain: Terrain) -> Element:
    """Draw a labelled arrow for each force that differs from that on the earth on a calm day."""
    text_colour = "#fff" if max(find_sky(terrain).zenith) < DARK_SKY_BRIGHTNESS else "#1a1a1a"
    drawn: list[Element] = []
    for row, force in enumerate(unusual_forces(terrain)):
        centre = np.array([26.0, 24.0 + FORCE_ROW_HEIGHT * row])
        strength = math.hypot(*force.vector)
        drawn.append(make_element("circle", cx=26, cy=f"{centre[1]:g}", r=15, fill="#fff", fill_opacity=0.9))
        if strength:
            projected = np.array(force.vector) @ RAISED_VIEW * (1, -1)
            direction = projected / max(float(np.linalg.norm(projected)), 1e-9)
            relative_length = min(1.0, math.sqrt(strength / FULL_ARROW_STRENGTH[force.kind]))
            drawn.append(_draw_arrow(centre, MAX_ARROW_LENGTH * relative_length, direction))
        drawn.append(draw_text(force.description, 48, centre[1] + 4.5, font_size=13, fill=text_colour))
    return make_element("g", *drawn)


def _draw_arrow(centre: Floats, length: float, direction: Floats) -> Element:
    """Draw an arrow about its centre; all in pixels, with a unit vector as direction."""
    half = length / 2 * direction
    tip = centre + half
    across = np.array([-direction[1], direction[0]])
    head = np.stack([tip, tip - 8 * direction + 4.5 * across, tip - 8 * direction - 4.5 * across])
    shaft = np.stack([centre - half, tip - 4 * direction])
    return make_element(
        "g",
        draw_path([shaft], closed=False, stroke="#b34700", stroke_width=2.4),
        draw_path([head], fill="#b34700"),
    )
