"""The text form of a child's genome, word by word, with the origin and the change of each gene."""

import re
from typing import Any

from walkerlab.analysis.inheritance import Birth
from walkerlab.genome.text import format_text
from walkerlab.view.inheritance import cell_colour, mark_genes
from walkerlab.view.sketch.svg import hex_colour


def genome_lines(birth: Birth) -> list[list[dict[str, Any]]]:
    """Return the lines of the text form of a child's genome: a line for each segment and each step.

    Returns:
        The words of each line. A word has the name of its gene, a title, the sign, the change, and the colour of the
        background; see ``GeneMark``. For a word without a gene, these are empty.
    """
    marks = mark_genes(birth)
    values = birth.child.tolist()
    words = format_text(values).split()
    positions = format_text([index + 0.5 for index in range(len(values))]).split()  # the gene of each word
    lines: list[list[dict[str, Any]]] = [[]]
    for word, position in zip(words, positions, strict=True):
        if word == "|":
            lines.append([])
            continue
        found = re.fullmatch(r"[a-z]+=(\d+)\.5", position)
        if not found:
            lines[-1].append({"text": word, "gene": "", "sign": "", "change": ""})
            continue
        mark = marks[int(found[1])]
        lines[-1].append(
            {
                "text": word,
                "gene": mark.name,
                "title": mark.title,
                "sign": mark.sign,
                "change": mark.change,
                "colour": hex_colour(cell_colour(mark)) if mark.is_coloured else "",
                "faint": not mark.is_expressed,
                "repair": mark.by_repair,
            }
        )
    return lines
