"""A genome as HTML tables of its body and its gait, with the text form to copy."""

from typing import NamedTuple

from walkerlab.ga.genes import Floats
from walkerlab.genome.repair import BODY_FEATURES, SEGMENT_FEATURES
from walkerlab.genome.text import SWING_PARAMETERS, count_segments, format_text
from walkerlab.settings.choices import Feature
from walkerlab.settings.values import pluralize
from walkerlab.text.templates import Markup, render

BODY_COLUMNS = SEGMENT_FEATURES[:5]
GAIT_COLUMNS = SEGMENT_FEATURES[5:]
MAX_FIXED = 1e6  # larger numbers are written with an exponent


class Cell(NamedTuple):
    """Cell of a table.

    Attributes:
        text: Text.
        is_expressed: Whether the gene is expressed, apart from genes of segments that are not grown.
    """

    text: str
    is_expressed: bool = True


def genome_html(values: Floats) -> Markup:
    """Return tables of a genome's body and gait, with the names of the text form, and the text form itself.

    Unexpressed genes are faint: those of whole segments, and those of legs of segments without legs.

    Args:
        values: Gene values, shape (n_genes,).
    """
    n_segments = count_segments(values.size)
    wanted, frequency = values[: len(BODY_FEATURES)].tolist()
    rows_of_values = values[len(BODY_FEATURES) :].reshape(n_segments, -1).tolist()
    segments = [dict(zip(SEGMENT_FEATURES, row, strict=True)) for row in rows_of_values]
    is_grown = [i < wanted for i in range(n_segments)]

    def rows(features: tuple[Feature, ...]) -> list[list[Cell]]:
        return [
            [
                Cell(f"{i + 1}{'' if is_grown[i] else ' (not grown)'}"),
                *(_cell(feature, segment[feature], has_legs=segment[Feature.legs] != 0) for feature in features),
            ]
            for i, segment in enumerate(segments)
        ]

    size = pluralize(n_segments, "segment")
    all_grown = all(is_grown)
    return render(
        "genome/genome.html",
        body_size=size if all_grown else f"{sum(is_grown)} of {size} grown",
        body=rows(BODY_COLUMNS),
        frequency=_format_number(frequency),
        motions=list(SWING_PARAMETERS),
        gait=rows(GAIT_COLUMNS),
        row_classes=["" if grown else "faint" for grown in is_grown],
        all_grown=all_grown,
        text=format_text(values.tolist()),
    )


def _cell(feature: Feature, value: float, *, has_legs: bool) -> Cell:
    """Return the cell of one gene; genes of legs that the segment does not have are not expressed."""
    if feature == Feature.legs:
        return Cell("legs" if value else "nolegs")
    return Cell(_format_number(value), has_legs or feature in (Feature.length, Feature.mass))


def _format_number(value: float) -> str:
    return f"{value:.3f}" if abs(value) < MAX_FIXED else f"{value:.3g}"
