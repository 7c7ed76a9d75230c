"""Which parent gave each gene of a robot, and which genes mutation changed, for the card of the robot."""

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.colors import to_rgb

from walkerlab.ga.genes import Floats, Indices
from walkerlab.genome.features import BODY_FEATURES, LEG_FEATURES, SEGMENT_FEATURES, is_expressed
from walkerlab.genome.genome import Genome
from walkerlab.settings.robot import Robot
from walkerlab.text.numbers import format_significant
from walkerlab.view import sketch
from walkerlab.view.plots.style import RUN_COLOURS
from walkerlab.view.sketch.bodies import RGB
from walkerlab.view.snapshots import svg_image_html
from walkerlab.widgets.gene_controls import describe_genes

NEW = -1
"""Origin of a gene whose value no parent has: mutation, a blend or repair has changed it."""
SHARED = -2
"""Origin of a gene that has the same value in all parents and in the child."""

UNUSED = -3
"""Instead of the origin of a gene that has no effect."""

LETTERS = "ABCD"
MAX_COLOURED_PARENTS = len(LETTERS)
SHARED_COLOUR = "#999999"
NEW_COLOUR = "#ffd23f"
MAX_CHANGES = 6  # maximum number of changed genes that are listed
SAME = 5e-4  # smaller differences come from rounding to the grid
PICTURE_SIZE = (96, 58)  # pixels


@dataclass(frozen=True)
class GeneChange:
    """A gene whose value no parent has.

    Attributes:
        name: Name of the gene, such as "segment 1, hip phase".
        before: Value of the closest parent, with its letter.
        after: Value of the child, with unit.
        difference: Signed difference.
    """

    name: str
    before: str
    after: str
    difference: str


def find_origins(child: Floats, parents: Floats) -> Indices:
    """Return the origin of each gene: the index of the first parent with the same value, ``SHARED`` or ``NEW``.

    This compares values only: a gene may have come from another place of the parent's genome.

    Args:
        child: Gene values, shape (n_genes,).
        parents: Gene values of the parents, shape (n_parents, n_genes).

    Returns:
        Origins, shape (n_genes,).
    """
    is_same = np.abs(parents - child) < SAME
    origins = np.where(is_same.any(axis=0), np.argmax(is_same, axis=0), NEW)
    return np.where(is_same.all(axis=0) & (len(parents) > 1), SHARED, origins)


def describe_origins(births: pd.DataFrame, individual: int) -> dict[str, Any]:
    """Describe what a robot has from its parents, as arguments of the template ``origins.html``.

    Args:
        births: Table of births, as ``birth_rows`` returns it.
        individual: Number of the robot.

    Returns:
        ``parents`` and ``child`` with picture and caption, ``groups`` of genes, ``changes`` and ``n_more``; empty if
        the parents are not in the table or have other limits.
    """
    row: Any = births.loc[individual]
    numbers = [int(number) for number in dict.fromkeys(row.parents.split())][:MAX_COLOURED_PARENTS]
    if not numbers or not set(numbers) <= set(births.index):
        return {}
    genomes = [Genome.parse(births.genome[number]) for number in numbers]
    child = Genome.parse(row.genome)
    if any(genome.n_parts != child.n_parts for genome in genomes):
        return {}
    parents = np.stack([genome.values for genome in genomes])
    origins = find_origins(child.values, parents)
    used = is_expressed(child.values[np.newaxis])[0]
    n_parts = child.n_parts
    genes = describe_genes(Robot(segments=(1, n_parts), legs=(2, 2 * n_parts)))
    counts = Counter(origins[used].tolist())
    from_parents = [f"{counts[i]} from {LETTERS[i]}" for i in range(len(numbers)) if counts[i]]
    shared = [f"{counts[SHARED]} the same in all"] if counts[SHARED] else []
    new = [f"{counts[NEW]} new"] if counts[NEW] else []
    changed = _list_changes(child.values, parents, genes, np.flatnonzero(used & (origins == NEW)))
    return {
        "parents": [
            {
                "picture": _draw(genome, np.full(child.values.size, index)),
                "caption": f"{LETTERS[index]}: robot {number}",
            }
            for index, (number, genome) in enumerate(zip(numbers, genomes, strict=True))
        ],
        "child": {
            "picture": _draw(child, np.where(used, origins, UNUSED)),
            "caption": f"robot {individual}",
        },
        "summary": "Genes with an effect: " + ", ".join(from_parents + shared + new) + ".",
        "groups": _list_genes(genes, origins, used),
        "changes": changed[:MAX_CHANGES],
        "n_more": max(0, len(changed) - MAX_CHANGES),
    }


def _list_genes(genes: list[dict[str, Any]], origins: Indices, used: Any) -> list[tuple[str, list[dict[str, str]]]]:
    """Return the genes with an effect by group, each with a letter, the class of its colour and a title."""
    groups: dict[str, list[dict[str, str]]] = {}
    words = {NEW: ("new", "✱", "new"), SHARED: ("same", "·", "the same in all parents")}
    for gene, origin, is_used in zip(genes, origins.tolist(), used, strict=True):
        if not is_used:
            continue
        kind, sign, source = words.get(origin) or (f"p{origin}", LETTERS[origin], f"from {LETTERS[origin]}")
        cell = {"kind": kind, "sign": sign, "title": f"{gene['label']}: {source}"}
        groups.setdefault(gene["group"], []).append(cell)
    return list(groups.items())


def _list_changes(child: Floats, parents: Floats, genes: list[dict[str, Any]], changed: Indices) -> list[GeneChange]:
    """Return the new genes, those that changed most in relation to their range first."""
    found: list[tuple[float, GeneChange]] = []
    for index in changed.tolist():
        gene = genes[index]
        span = gene["high"] - gene["low"] or 1.0
        differences = child[index] - parents[:, index]
        if gene["kind"] == "cyclic":
            differences = (differences + span / 2) % span - span / 2
        closest = int(np.argmin(np.abs(differences)))
        difference = float(differences[closest])
        letter = f" ({LETTERS[closest]})" if len(parents) > 1 else ""
        change = GeneChange(
            f"{gene['group']}, {gene['label']}",
            f"{format_significant(float(parents[closest, index]))}{letter}",
            f"{format_significant(float(child[index]))} {gene['unit']}".strip(),
            f"{difference:+.3g}".replace("-", "\N{MINUS SIGN}"),
        )
        found.append((abs(difference) / span, change))
    return [change for _, change in sorted(found, key=lambda pair: -pair[0])]


def _draw(genome: Genome, origins: Indices) -> Any:
    """Draw a robot, each trunk and pair of legs in the colour of the parent from which most of its genes come.

    Legs that repeat others have the colour of those in front.
    """
    is_leg_gene = np.array([feature in LEG_FEATURES for feature in SEGMENT_FEATURES])
    colours: list[tuple[RGB, RGB]] = []
    for part in origins[len(BODY_FEATURES) :].reshape(genome.n_parts, -1):
        repeats = bool(colours) and (part[is_leg_gene] == UNUSED).all()
        colours.append((_colour(part[~is_leg_gene]), colours[-1][1] if repeats else _colour(part[is_leg_gene])))
    return svg_image_html(sketch.draw_robot(genome, size=PICTURE_SIZE, colours=colours))


def _colour(origins: Indices) -> RGB:
    """Return the colour of the most frequent origin, apart from genes that all parents share."""
    counted = Counter(origins[(origins != SHARED) & (origins != UNUSED)].tolist()).most_common(1)
    if not counted:
        return to_rgb(SHARED_COLOUR)
    origin = counted[0][0]
    return to_rgb(NEW_COLOUR if origin == NEW else RUN_COLOURS[origin])
