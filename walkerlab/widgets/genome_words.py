"""The text form of a child's genome, word by word, with the origin and the change of each gene."""

import re
from typing import Any

from walkerlab.analysis.inheritance import Birth
from walkerlab.genome.text import format_text
from walkerlab.view.inheritance import cell_colour, mark_genes
from walkerlab.view.sketch.svg import hex_colour

LINE_STARTS = ("seg", "gait", "step")


def genome_lines(birth: Birth) -> list[list[dict[str, Any]]]:
    """Return the lines of the text form of a child's genome: a line for each segment and each step.

    Returns:
        The words of each line. A word that contains a gene has the name of the gene, its sign, its change, and the
        colour of its background; see ``GeneMark``.
    """
    marks = mark_genes(birth)
    values = birth.child.tolist()
    words = format_text(values).split()
    positions = format_text([index + 0.5 for index in range(len(values))]).split()  # shows which word is which gene
    lines: list[list[dict[str, Any]]] = [[]]
    for word, position in zip(words, positions, strict=True):
        if word == "|":
            lines.append([])
            continue
        found = re.fullmatch(r"[a-z]+=(\d+)\.5", position)
        if not found:
            lines[-1].append({"text": word})
            continue
        mark = marks[int(found[1])]
        lines[-1].append(
            {
                "text": word,
                "gene": mark.name,
                "sign": mark.sign,
                "change": mark.change,
                "colour": hex_colour(cell_colour(mark)) if mark.sign not in ("", "=", "new") else "",
                "faint": not mark.is_expressed,
                "repair": mark.by_repair,
            }
        )
    return lines
