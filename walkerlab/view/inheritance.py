"""Show the origin of genes: a letter and a colour for each parent, in tables, texts and drawings."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from walkerlab.analysis.inheritance import Birth, gene_widths, parent_letter
from walkerlab.ga.genes import Floats, Genes
from walkerlab.genome.features import BODY_FEATURES, LEG_LENGTH, SEGMENT_FEATURES, find_leg_sources
from walkerlab.genome.genome import Genome
from walkerlab.genome.text import FEATURE_WORDS
from walkerlab.settings.choices import Feature
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.text.numbers import format_significant
from walkerlab.world.geometry import surface_points
from walkerlab.world.scene import scene_of

PARENT_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9")
"""Colours of the first parents (Okabe and Ito); the first two differ in lightness, too."""
OTHER_COLOUR = "#8c8c8c"
"""Colour of further parents."""
SAME_COLOUR = "#d9d9d9"
"""Colour of genes that are equal in all parents."""
NEW_COLOUR = "#ffffff"
"""Colour of genes that do not come from a parent."""
CELL_STRENGTH = 0.42  # share of the colour in the background of a gene; the rest is white
UNEXPRESSED_STRENGTH = 0.2
FAR_LEG_BRIGHTNESS = 0.72
SAME_SIGN = "="
NEW_SIGN = "new"


@dataclass(frozen=True)
class GeneMark:
    """How one gene of a child is shown.

    Attributes:
        name: Name of the gene.
        value: Value of the child.
        sign: Letter of its parent, ``=`` if it is equal in all parents, the shares of a blend, or ``new``; "" if there
            is only one parent. A number is the segment of the parent from which the gene was moved.
        change: Signed change of the value by crossover, mutation and repair, or ``was`` and the previous word; "" if
            there is none.
        by_repair: Whether repair made most of the change.
        size: Change as a share of the gene's range.
        colour: Colour of its origin, shape (3,), from 0 to 1.
        is_expressed: Whether it has an effect on the child.
    """

    name: str
    value: str
    sign: str
    change: str
    by_repair: bool
    size: float
    colour: tuple[float, float, float]
    is_expressed: bool


def mark_genes(birth: Birth) -> list[GeneMark]:
    """Return the mark of each gene of a child, length n_genes."""
    changes = birth.change.tolist()
    sizes = (birth.change / gene_widths(birth.genes)).tolist()
    by_repair = (np.abs(birth.repair) > np.abs(birth.mutation + birth.crossover)).tolist()
    expressed = birth.is_expressed.tolist()
    return [
        GeneMark(
            name=name,
            value=format_gene(birth.genes, j, birth.child[j]),
            sign=_origin_sign(birth, j),
            change=_format_change(birth, j, changes[j]),
            by_repair=by_repair[j] and changes[j] != 0,
            size=sizes[j],
            colour=origin_colour(birth, j),
            is_expressed=expressed[j],
        )
        for j, name in enumerate(birth.genes.names)
    ]


def parent_colour(parent: int) -> tuple[float, float, float]:
    """Return the colour of a parent by its position, as RGB from 0 to 1."""
    return _rgb(PARENT_COLOURS[parent] if parent < len(PARENT_COLOURS) else OTHER_COLOUR)


def origin_colour(birth: Birth, j: int) -> tuple[float, float, float]:
    """Return the colour of the origin of a gene; a blend has a mixed colour."""
    match birth.origins[j]:
        case "parent":
            return parent_colour(int(birth.sources.parent[j]))
        case "blend":
            shares = np.clip(birth.sources.shares[:, j], 0, 1)
            colours = np.array([parent_colour(parent) for parent in range(len(shares))])
            red, green, blue = (shares @ colours / max(float(shares.sum()), 1e-9)).tolist()
            return red, green, blue
        case "same":
            return _rgb(SAME_COLOUR)
        case _:
            return _rgb(NEW_COLOUR)


def cell_colour(mark: GeneMark) -> tuple[float, float, float]:
    """Return the background colour of a gene in a table or text, pale enough for black text."""
    if mark.sign in ("", SAME_SIGN, NEW_SIGN):
        return 1.0, 1.0, 1.0
    strength = CELL_STRENGTH if mark.is_expressed else UNEXPRESSED_STRENGTH
    red, green, blue = (1 - strength * (1 - np.array(mark.colour))).tolist()
    return red, green, blue


def format_gene(genes: Genes, j: int, value: float) -> str:
    """Return the value of a gene as text: a number with at most three decimals, or the word in the text of a genome."""
    words = FEATURE_WORDS.get(Feature[genes.names[j].rpartition(".")[2]])
    if words and value in (0, 1):
        return words[int(value)]
    return _trim(f"{value:.3f}") if abs(value) < 1e6 else format_significant(value)


def _format_change(birth: Birth, j: int, change: float) -> str:
    if change == 0:
        return ""
    before = format_gene(birth.genes, j, birth.child[j] - change)
    if before.isalpha():
        return f"was {before}"
    if birth.genes.is_count[j]:
        return f"{change:+g}".replace("-", "−")
    return f"{'+' if change > 0 else '−'}{_trim(f'{abs(change):.3f}')}"


def _trim(number: str) -> str:
    trimmed = number.rstrip("0").rstrip(".")
    return "0" if trimmed in ("-0", "") else trimmed.replace("-", "−")


def _origin_sign(birth: Birth, j: int) -> str:
    match birth.origins[j]:
        case "parent":
            letter = parent_letter(int(birth.sources.parent[j])) if len(birth.parents) > 1 else ""
            if not birth.is_moved[j]:
                return letter
            segment = birth.genes.names[birth.sources.gene[j]].partition(".")[0].removeprefix("seg")
            return f"{letter}{segment}" if letter else f"from {segment}"
        case "same":
            return SAME_SIGN
        case "blend":
            shares = birth.sources.shares[:, j]
            named = [
                f"{parent_letter(i)} {share:.0%}" for i, share in enumerate(shares.tolist()) if abs(share) >= 0.005
            ]
            return " ".join(named[:2]) + (" …" if len(named) > 2 else "")
        case _:
            return NEW_SIGN


def _rgb(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return red, green, blue


# ----------------------------------------------------------------------------------------------------------- bodies


@dataclass(frozen=True)
class PartPaint:
    """Colours of the trunk and the legs of each segment of a body.

    Attributes:
        colours: RGB colour by part: ``trunk1``, ``legs1``, ``trunk2`` and so on; other parts keep their colours.
        changed: Parts with a changed gene, for example one of size or of motion.
    """

    colours: Mapping[str, tuple[float, float, float]]
    changed: frozenset[str] = frozenset()


def paint_child(birth: Birth) -> PartPaint:
    """Return the colours of a child.

    A trunk has the colour of the origin of its length, or of its mass if all parents have the same length. A pair of
    legs has the colour of the origin of its length, or of its force if all parents have the same length.
    """
    values = birth.child[np.newaxis]
    width = len(SEGMENT_FEATURES)
    leg_sources = find_leg_sources(birth.genes.parts(values))[0].tolist()
    colours: dict[str, tuple[float, float, float]] = {}
    changed: set[str] = set()
    origins = birth.origins
    is_changed = birth.change != 0

    def paint(part: str, first: int, n_genes: int) -> None:
        """Paint a part whose size is described by the first two of its genes."""
        informative = first + 1 if origins[first] == "same" else first
        colours[part] = origin_colour(birth, informative)
        if is_changed[first : first + n_genes].any():
            changed.add(part)

    for segment in range(int(birth.genes.n_grown(values)[0])):
        paint(f"trunk{segment + 1}", len(BODY_FEATURES) + segment * width, LEG_LENGTH)
        if leg_sources[segment] >= 0:
            first = len(BODY_FEATURES) + leg_sources[segment] * width + LEG_LENGTH
            paint(f"legs{segment + 1}", first, width - LEG_LENGTH)
    return PartPaint(colours, frozenset(changed))


def paint_parent(genome: Floats, parent: int) -> PartPaint:
    """Return the colours of a parent: the same colour for all parts."""
    n_parts = (len(genome) - len(BODY_FEATURES)) // len(SEGMENT_FEATURES)
    names = [f"{part}{segment + 1}" for segment in range(n_parts) for part in ("trunk", "legs")]
    return PartPaint(dict.fromkeys(names, parent_colour(parent)))


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
    scene = scene_of(genome, Settings() if settings is None else Settings(robot=settings.robot))
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


def describe_birth(birth: Birth) -> str:
    """Describe a birth in one or two sentences: how many genes have each origin, and how many were changed."""
    origins: list[str] = list(birth.origins)
    parts: list[str] = []
    for parent, name in enumerate(birth.names):
        n = sum(one == "parent" and birth.sources.parent[j] == parent for j, one in enumerate(origins))
        if n and len(birth.names) > 1:
            parts.append(f"{n} come from {parent_letter(parent)} ({name})")
    for origin, text in (
        ("same", "are equal in all parents"),
        ("blend", "are blends of the parents"),
        ("new", "are new"),
    ):
        if n := origins.count(origin):
            parts.append(f"{n} {text}")
    n_changed = int((birth.change != 0).sum())
    n_visible = int(((birth.change != 0) & birth.is_expressed).sum())
    parts[4:] = [f"the others have {pluralize(len(parts) - 4, 'further origin')}"] if len(parts) > 4 else []
    parts.append(f"{n_changed or 'none'} {'was' if n_changed == 1 else 'were'} changed")
    effect = f", {n_visible} of them with an effect on the robot" if n_changed else ""
    listed = f"{', '.join(parts[:-1])} and {parts[-1]}" if parts[1:] else parts[0]
    inferred = "" if birth.is_exact else " Origins are inferred from the genomes, as the birth could not be repeated."
    return f"Of the {len(origins)} genes, {listed}{effect}.{inferred}"
