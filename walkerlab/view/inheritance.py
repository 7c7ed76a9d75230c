"""How the origin of a gene is shown: a letter and a colour for each parent, in tables and text."""

from dataclasses import dataclass

import numpy as np

from walkerlab.analysis.inheritance import Birth, gene_widths, parent_letter
from walkerlab.analysis.tracing import NO_SOURCE
from walkerlab.ga.genes import Genes
from walkerlab.genome.features import gene_words
from walkerlab.genome.text import FEATURE_WORDS
from walkerlab.settings.choices import Feature
from walkerlab.text.numbers import format_significant

PARENT_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9")
"""Colours of the first parents (Okabe and Ito); the first two differ in lightness, too."""
OTHER_COLOUR = "#8c8c8c"
"""Colour of all other parents."""
SAME_COLOUR = "#d9d9d9"
"""Colour of genes that are equal in all parents."""
NEW_COLOUR = "#ffffff"
"""Colour of genes that come from no parent."""
CELL_STRENGTH = 0.42  # share of the colour in the background of a gene; the rest is white
UNEXPRESSED_STRENGTH = 0.2
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
        letters: Sign for a small cell: the letters of a blend without its shares, and the letter of a single parent.
        title: Name, origin and change in words.
        before: Value of the parent; "" if there is none.
        change: Signed change of the value by crossover, mutation and repair, or the word that it replaces; "" if there
            is none.
        by_repair: Whether repair made most of the change.
        size: Change as a share of the gene's range.
        colour: Colour of its origin, shape (3,), from 0 to 1.
        is_expressed: Whether it has an effect on the child.
    """

    name: str
    value: str
    sign: str
    letters: str
    title: str
    before: str
    change: str
    by_repair: bool
    size: float
    colour: tuple[float, float, float]
    is_expressed: bool

    @property
    def is_coloured(self) -> bool:
        """Whether the gene has the colour of its origin in a table or text."""
        return self.sign not in ("", SAME_SIGN, NEW_SIGN)


def mark_genes(birth: Birth) -> list[GeneMark]:
    """Return the mark of each gene of a child, n_genes in all."""
    changes = birth.change.tolist()
    sizes = (birth.change / gene_widths(birth.genes)).tolist()
    by_repair = (np.abs(birth.repair) > np.abs(birth.mutation + birth.crossover)).tolist()
    expressed = birth.is_expressed.tolist()
    marks: list[GeneMark] = []
    for j, name in enumerate(birth.genes.names):
        sign = _origin_sign(birth, j)
        change = _format_change(birth, j, changes[j])
        marks.append(
            GeneMark(
                name=name,
                value=format_gene(birth.genes, j, birth.child[j]),
                sign=sign,
                letters=_origin_letters(birth, j),
                title=_gene_title(name, sign, change),
                before=format_gene(birth.genes, j, _source_value(birth, j)) if change else "",
                change=change,
                by_repair=by_repair[j] and changes[j] != 0,
                size=sizes[j],
                colour=origin_colour(birth, j),
                is_expressed=expressed[j],
            )
        )
    return marks


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
    """Return the background of a gene in a table or text: pale enough for black text."""
    return pale_colour(mark) if mark.is_coloured else (1.0, 1.0, 1.0)


def pale_colour(mark: GeneMark) -> tuple[float, float, float]:
    """Return the colour of the origin of a gene, pale enough for black text."""
    strength = CELL_STRENGTH if mark.is_expressed else UNEXPRESSED_STRENGTH
    red, green, blue = (1 - strength * (1 - np.array(mark.colour))).tolist()
    return red, green, blue


def format_gene(genes: Genes, j: int, value: float) -> str:
    """Return the value of a gene as text: a number with three decimals at most, or the word of the text form."""
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
        case "parent" if len(birth.parents) == 1:
            segment = _source_segment(birth, j)
            return f"from {segment}" if segment else ""
        case "blend":
            named = [f"{parent_letter(i)} {share:.0%}" for i, share in _blended_shares(birth, j).items()]
            return " ".join(named[:2]) + (" …" if len(named) > 2 else "")
        case _:
            return _origin_letters(birth, j)


def _origin_letters(birth: Birth, j: int) -> str:
    match birth.origins[j]:
        case "parent":
            return f"{parent_letter(int(birth.sources.parent[j]))}{_source_segment(birth, j)}"
        case "same":
            return SAME_SIGN
        case "blend":
            letters = list(map(parent_letter, _blended_shares(birth, j)))
            return "".join(letters) if len(letters) <= 2 else f"{letters[0]}…"
        case _:
            return NEW_SIGN


def _source_segment(birth: Birth, j: int) -> str:
    """Return the number of the segment from which a gene was moved; "" if it was not."""
    if not birth.is_moved[j]:
        return ""
    return birth.genes.names[birth.sources.gene[j]].partition(".")[0].removeprefix("seg")


def _source_value(birth: Birth, j: int) -> float:
    """Return the value of the parent from which a gene comes; if there is none, the gene's value before mutation."""
    parent, gene = birth.sources.parent[j], birth.sources.gene[j]
    return float(birth.inherited[j] if parent == NO_SOURCE else birth.parents[parent, gene])


def _blended_shares(birth: Birth, j: int) -> dict[int, float]:
    shares: list[float] = birth.sources.shares[:, j].tolist()
    return {parent: share for parent, share in enumerate(shares) if abs(share) >= 0.005}


def _gene_title(name: str, sign: str, change: str) -> str:
    origins = {"": "", SAME_SIGN: "equal in all parents", NEW_SIGN: "from no parent"}
    origin = origins.get(sign, f"from {sign.removeprefix('from ')}")
    changed = change if change.startswith("was") else f"changed by {change}" if change else ""
    return ", ".join(filter(None, (*gene_words(name), origin, changed)))


def _rgb(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return red, green, blue


def describe_birth(birth: Birth) -> str:
    """Describe a birth in a sentence with the numbers of genes of each origin, and of changed genes."""
    n_changed = int((birth.change != 0).sum())
    n_visible = int(((birth.change != 0) & birth.is_expressed).sum())
    effect = f", {n_visible} of them with an effect on the robot" if n_changed else ""
    inferred = "" if birth.is_exact else " This was inferred from the genomes, because the birth could not be repeated."
    return f"Of the {len(birth.genes)} genes, {count_origins(birth)}{effect}.{inferred}"


def count_origins(birth: Birth, *, expressed_only: bool = False) -> str:
    """Return the numbers of genes of each origin and of changed genes as part of a sentence.

    Args:
        birth: Birth to describe.
        expressed_only: Whether to leave out genes without an effect on the child.
    """
    counted = np.flatnonzero(birth.is_expressed | (not expressed_only)).tolist()
    origins = {j: birth.origins[j] for j in counted}
    parts: list[str] = []
    for parent, name in enumerate(birth.names):
        n = sum(one == "parent" and birth.sources.parent[j] == parent for j, one in origins.items())
        if n and len(birth.names) > 1:
            parts.append(f"{n} come from {parent_letter(parent)} ({name})")
    for origin, text in (
        ("same", "are equal in all parents"),
        ("blend", "are blends of the parents"),
        ("new", "are new"),
    ):
        if n := list(origins.values()).count(origin):
            parts.append(f"{n} {text}")
    n_changed = int((birth.change[counted] != 0).sum())
    parts[4:] = [f"{len(parts) - 4} other origins"] if len(parts) > 4 else []
    changed = f"{n_changed or 'none'} {'has a' if n_changed == 1 else 'have'} new value{'s' * (n_changed != 1)}"
    origins_in_words = f"{', '.join(parts[:-1])} and {parts[-1]}" if parts[1:] else "".join(parts)
    return "; ".join(filter(None, (origins_in_words, changed)))
