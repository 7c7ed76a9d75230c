"""Side views of parents and children, coloured by the parent from which each part comes."""

import numpy as np

from walkerlab.analysis.inheritance import Birth
from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.view.painted_bodies import PartPaint, paint_child, paint_parent, painted_parts, plain_scene
from walkerlab.view.sketch.marks import draw_marks
from walkerlab.view.sketch.projection import SIDE_VIEW, Projection
from walkerlab.view.sketch.solids import draw_solids
from walkerlab.view.sketch.svg import TEXT_COLOUR, draw_path, write_image
from walkerlab.world.geometry import ROPE_POINTS, convex_outline

MARGIN = 0.05  # margin of a drawing, as a share of its width
CHANGED_WIDTH = 0.01  # width of the outline of a changed part, as a share of the drawing's width
MIN_CHANGED_WIDTH = 1.3  # pixels; other edges are about half as wide


def draw_birth(
    birth: Birth, settings: Settings | None = None, *, n_parents: int = 2, size: tuple[float, float] = (240, 130)
) -> list[str]:
    """Draw parents and child at the same scale; each part has the colour of the parent from which its length comes.

    Args:
        birth: Birth to draw.
        settings: Settings with the loads of the robots; no loads if None.
        n_parents: Maximum number of parents that are drawn.
        size: Width and height of each drawing [pixels].

    Returns:
        SVG of each parent, and of the child.
    """
    paints: list[tuple[Genome, PartPaint, str]] = [
        (Genome(values), paint_parent(values, i), birth.names[i]) for i, values in enumerate(birth.parents[:n_parents])
    ]
    paints.append((birth.genome, paint_child(birth), birth.name))
    bodies = [painted_parts(genome, paint, settings) for genome, paint, _ in paints]
    corners = [np.concatenate([points @ SIDE_VIEW for points, _ in parts]) for parts, _ in bodies]
    width, height = size
    widest = max(float(np.ptp(points[:, 0])) for points in corners)
    highest = max(float(np.ptp(points[:, 1])) for points in corners)
    margin = MARGIN * width
    scale = min((width - 2 * margin) / widest, (height - 2 * margin) / highest)
    ground = height - margin
    outline = max(CHANGED_WIDTH * width, MIN_CHANGED_WIDTH)
    drawings: list[str] = []
    for (parts, changed), points, (genome, _, name) in zip(bodies, corners, paints, strict=True):
        middle = float(points[:, 0].min() + points[:, 0].max()) / 2
        bottom = float(points[:, 1].min())
        projection = Projection(SIDE_VIEW, scale, np.array([width / 2 - scale * middle, ground + scale * bottom]))
        outlines = [
            convex_outline(projection.project(one))
            for (one, _), is_changed in zip(parts, changed, strict=True)
            if is_changed and len(one) != ROPE_POINTS
        ]
        scene = plain_scene(genome, settings)
        line = np.array([(margin / 2, ground), (width - margin / 2, ground)])
        drawings.append(
            write_image(
                size,
                f"Side view of {name}, coloured by parent.",
                draw_path([line], closed=False, fill="none", stroke=TEXT_COLOUR, stroke_opacity=0.5),
                draw_solids(parts, projection),
                draw_path(outlines, fill="none", stroke=TEXT_COLOUR, stroke_width=outline),
                draw_marks(scene, scene.start, projection),
            )
        )
    return drawings
