"""Which parent gave each gene of a robot, and which genes changed, for the card of the robot."""

from dataclasses import dataclass, replace
from typing import Any

import pandas as pd

from walkerlab.analysis.comparison import compare_with_parents
from walkerlab.analysis.inheritance import parent_letter
from walkerlab.genome.features import gene_words
from walkerlab.genome.genome import Genome
from walkerlab.runfile.records import parent_numbers
from walkerlab.settings.robot import Robot
from walkerlab.view.inheritance import GeneMark, count_origins, mark_genes, pale_colour, parent_colour
from walkerlab.view.sketch.births import draw_birth
from walkerlab.view.sketch.svg import hex_colour
from walkerlab.view.snapshots import svg_image_html

MAX_DRAWN_PARENTS = 4
MAX_CHANGES = 6  # maximum number of changed genes that are listed
PICTURE_SIZE = (96, 58)  # pixels


@dataclass(frozen=True)
class GeneChange:
    """A gene whose value differs from that of the parent from which it comes.

    Attributes:
        name: Name of the gene, such as "segment 1, hip phase".
        before: Value of the parent, with its letter.
        after: Value of the child, with unit.
        difference: Signed difference; "" if the values are words.
    """

    name: str
    before: str
    after: str
    difference: str


def describe_origins(births: pd.DataFrame, individual: int) -> dict[str, Any]:
    """Describe what a robot inherited from each parent, as arguments of the template ``origins.html``.

    The genomes are compared with each other, which is quick; the operators are not run again.

    Args:
        births: Table of births, as ``birth_rows`` returns it.
        individual: Number of the robot.

    Returns:
        ``parents`` and ``child`` with picture and caption, ``summary``, ``groups`` of genes, ``changes`` and
        ``n_more``; empty if the parents are not in the table or have other limits.
    """
    row: Any = births.loc[individual]
    numbers = list(dict.fromkeys(parent_numbers(row.parents)))
    if not numbers or not set(numbers) <= set(births.index):
        return {}
    child = Genome.parse(row.genome)
    parents = [Genome.parse(births.genome[number]) for number in numbers]
    if any(parent.n_parts != child.n_parts for parent in parents):
        return {}
    robot = Robot(segments=(1, child.n_parts), legs=(2, 2 * child.n_parts))
    birth = compare_with_parents(child, parents, robot, [f"robot {number}" for number in numbers])
    birth = replace(birth, name=f"robot {individual}")
    *pictures, child_picture = draw_birth(birth, n_parents=MAX_DRAWN_PARENTS, size=PICTURE_SIZE)
    expressed = [
        (mark, unit) for mark, unit in zip(mark_genes(birth), birth.genes.units, strict=True) if mark.is_expressed
    ]
    changed = sorted((pair for pair in expressed if pair[0].change), key=lambda pair: -abs(pair[0].size))
    counted = f"Of the {len(expressed)} genes with an effect, {count_origins(birth, expressed_only=True)}."
    return {
        "parents": [
            {
                "picture": svg_image_html(picture),
                "caption": f"{parent_letter(i)}: {birth.names[i]}",
                "colour": hex_colour(parent_colour(i)),
            }
            for i, picture in enumerate(pictures)
        ],
        "child": {"picture": svg_image_html(child_picture), "caption": birth.name},
        "summary": counted,
        "groups": _group_genes([mark for mark, _ in expressed]),
        "changes": [_describe_change(mark, unit, len(numbers)) for mark, unit in changed[:MAX_CHANGES]],
        "n_more": max(0, len(changed) - MAX_CHANGES),
    }


def _group_genes(marks: list[GeneMark]) -> list[tuple[str, list[dict[str, Any]]]]:
    """Return the genes grouped by part of the robot, each with the letter and the colour of its parent, and a title."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for mark in marks:
        cell = {
            "sign": mark.letters,
            "colour": hex_colour(pale_colour(mark)),
            "is_changed": bool(mark.change),
            "title": mark.title,
        }
        groups.setdefault(gene_words(mark.name)[0], []).append(cell)
    return list(groups.items())


def _describe_change(mark: GeneMark, unit: str, n_parents: int) -> GeneChange:
    return GeneChange(
        ", ".join(gene_words(mark.name)),
        f"{mark.before} ({mark.letters})" if n_parents > 1 else mark.before,
        mark.value if mark.before.isalpha() else f"{mark.value} {unit}".strip(),
        "" if mark.before.isalpha() else mark.change,
    )
