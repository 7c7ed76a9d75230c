"""Marks on the drawing of a robot: an eye at the front of segment 1, and the numbers of the segments."""

from collections.abc import Iterator
from xml.etree.ElementTree import Element

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.view.sketch.projection import Projection
from walkerlab.view.sketch.svg import draw_text, make_element
from walkerlab.world.geometry import body_placements, rotate
from walkerlab.world.scene import ORIENTATION, POSITION, Scene

EYE_POSITION = np.array([-0.75, -0.6, 0.35])  # from the front of segment 1, as multiples of its radius
EYE_RADIUS = 0.3  # as a share of the radius of segment 1
PUPIL_RADIUS = 0.55  # as a share of the radius of the eye
MIN_EYE_RADIUS = 1.5  # pixels
NUMBER_SIZE = 1.4  # font size as a multiple of the radius of the thinnest segment
MIN_NUMBERED_RADIUS = 5.5  # pixels; robots with a thinner segment have no numbers
MAX_NUMBER_SIZE = 15.0  # pixels
INK = "#1a1a1a"


def draw_marks(scene: Scene, pose: Floats, projection: Projection) -> Element:
    """Draw the marks on a robot.

    Args:
        scene: Compiled scene.
        pose: Pose of the scene, shape (nq,).
        projection: Projection of the drawing.
    """
    eye, eye_radius = eye_circle(scene, pose)
    radius = max(eye_radius * projection.scale, MIN_EYE_RADIUS)
    x, y = projection.project(eye)
    circles = [
        make_element("circle", cx=f"{x:.1f}", cy=f"{y:.1f}", r=f"{share * radius:.1f}", fill=fill)
        for share, fill in ((1.0, "#fff"), (PUPIL_RADIUS, INK))
    ]
    return make_element("g", *circles, *_draw_numbers(scene, pose, projection), class_="marks")


def eye_circle(scene: Scene, pose: Floats) -> tuple[Floats, float]:
    """Return the centre [m], shape (3,), and the radius [m] of the eye of a robot in a pose."""
    front, orientation = _segment_placement(scene, pose, 1)
    trunk_radius = _trunk_radius(scene, 1)
    return front + rotate(orientation[np.newaxis], trunk_radius * EYE_POSITION)[0], EYE_RADIUS * trunk_radius


def _draw_numbers(scene: Scene, pose: Floats, projection: Projection) -> Iterator[Element]:
    """Draw the number of each segment at its rear end, where its legs rarely cover it; none if too small."""
    segments = scene.phenotype.segments
    radii = [_trunk_radius(scene, number) for number in range(1, len(segments) + 1)]
    smallest = min(radii) * projection.scale
    if smallest < MIN_NUMBERED_RADIUS:
        return
    size = min(NUMBER_SIZE * smallest, MAX_NUMBER_SIZE)
    for number, (segment, radius) in enumerate(zip(segments, radii, strict=True), start=1):
        front, orientation = _segment_placement(scene, pose, number)
        place = front + rotate(orientation[np.newaxis], np.array([radius - segment.length, 0.0, 0.0]))[0]
        x, y = projection.project(place)
        style = {"text_anchor": "middle", "font_size": f"{size:.1f}", "font_family": "system-ui, sans-serif"}
        yield draw_text(str(number), x, y + 0.36 * size, fill=INK, font_weight=600, **style)


def segment_tops(scene: Scene, pose: Floats) -> Floats:
    """Return x and z [m] of the point above the middle of each segment, on its back, shape (n_segments, 2)."""
    points = []
    for number, segment in enumerate(scene.phenotype.segments, start=1):
        front, orientation = _segment_placement(scene, pose, number)
        back = np.array([-segment.length / 2, 0.0, _trunk_radius(scene, number)])
        points.append((front + rotate(orientation[np.newaxis], back)[0])[[0, 2]])
    return np.array(points)


def _segment_placement(scene: Scene, pose: Floats, number: int) -> tuple[Floats, Floats]:
    """Return the front [m], shape (3,), and the orientation (unit quaternion) of a segment, counted from 1."""
    body = int(scene.model.geom(f"walker/trunk{number}").bodyid[0])
    placed = body_placements(scene, pose[np.newaxis])[0, body]
    return placed[POSITION], placed[ORIENTATION]


def _trunk_radius(scene: Scene, number: int) -> float:
    return float(scene.model.geom(f"walker/trunk{number}").size[0])
