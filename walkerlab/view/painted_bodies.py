"""Bodies whose parts have the colours of the parents from which they come."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from walkerlab.analysis.inheritance import Birth
from walkerlab.ga.genes import Floats
from walkerlab.genome.features import BODY_FEATURES, LEG_LENGTH, SEGMENT_FEATURES, find_leg_sources
from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.view.inheritance import origin_colour, parent_colour
from walkerlab.world.geometry import surface_points
from walkerlab.world.scene import Scene, scene_of

FAR_LEG_BRIGHTNESS = 0.72


@dataclass(frozen=True)
class PartPaint:
    """Colours of a body: of the trunk and the legs of each segment.

    Attributes:
        colours: RGB colour, keyed by part: ``trunk1``, ``legs1``, ``trunk2`` and so on; other parts keep their colours.
        changed: Parts with a changed gene that has an effect, on their size or on their motion.
    """

    colours: Mapping[str, tuple[float, float, float]]
    changed: frozenset[str] = frozenset()


def paint_child(birth: Birth) -> PartPaint:
    """Return the colours of a child.

    Each trunk has the colour of the origin of its length, or of its mass if all parents have the same length; each pair
    of legs has that of the origin of its length, or of its force.
    """
    values = birth.child[np.newaxis]
    width = len(SEGMENT_FEATURES)
    leg_sources = find_leg_sources(birth.genes.parts(values))[0].tolist()
    colours: dict[str, tuple[float, float, float]] = {}
    changed: set[str] = set()
    origins = birth.origins
    is_changed = (birth.change != 0) & birth.is_expressed

    def paint(part: str, first: int, n_genes: int) -> None:
        """Paint a part whose size is described by the first two of its genes."""
        informative = first + 1 if origins[first] == "same" else first
        colours[part] = origin_colour(birth, informative)
        if is_changed[first : first + n_genes].any():
            changed.add(part)

    for segment in range(int(birth.genes.n_expressed(values)[0])):
        paint(f"trunk{segment + 1}", len(BODY_FEATURES) + segment * width, LEG_LENGTH)
        if leg_sources[segment] >= 0:
            first = len(BODY_FEATURES) + leg_sources[segment] * width + LEG_LENGTH
            paint(f"legs{segment + 1}", first, width - LEG_LENGTH)
    return PartPaint(colours, frozenset(changed))


def paint_parent(genome: Floats, parent: int) -> PartPaint:
    """Return the colours of a parent: its own in all parts."""
    n_parts = (len(genome) - len(BODY_FEATURES)) // len(SEGMENT_FEATURES)
    names = [f"{part}{segment + 1}" for segment in range(n_parts) for part in ("trunk", "legs")]
    return PartPaint(dict.fromkeys(names, parent_colour(parent)))


def plain_scene(genome: Genome, settings: Settings | None) -> Scene:
    """Compile a robot on level ground, with the loads of the settings; without loads if None."""
    return scene_of(genome, Settings() if settings is None else Settings(robot=settings.robot))


def painted_parts(
    genome: Genome, paint: PartPaint, settings: Settings | None = None
) -> tuple[list[tuple[Floats, Floats]], list[bool]]:
    """Return the parts of a robot in its rest pose on level ground, in the given colours.

    Args:
        genome: Genome within the limits.
        paint: Colours of its parts.
        settings: Settings with the loads of the robot; no loads if None.

    Returns:
        Points and colour of each part, as ``surface_points`` returns them, and whether a gene of the part was changed.
    """
    scene = plain_scene(genome, settings)
    model = scene.model
    is_changed = np.zeros(model.ngeom, dtype=np.bool_)
    for geom in np.flatnonzero(scene.is_robot_geom).tolist():
        name = str(model.geom(geom).name).rpartition("/")[2]
        bone = name.rstrip("0123456789")
        part = f"{'trunk' if bone == 'trunk' else 'legs'}{name.removeprefix(bone)}"
        if part in paint.colours:
            brightness = FAR_LEG_BRIGHTNESS if bone.startswith("left") else 1.0
            model.geom_rgba[geom, :3] = brightness * np.array(paint.colours[part])
        is_changed[geom] = part in paint.changed
    parts = surface_points(scene, scene.start)
    drawn = np.isin(model.body_rootid[model.geom_bodyid], scene.roots)
    marks: list[bool] = is_changed[drawn].tolist()
    return parts, marks + [False] * (len(parts) - len(marks))
