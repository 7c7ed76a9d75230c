"""A genome as HTML tables of its body and its gait, with the text form to copy."""

from typing import NamedTuple

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.genome.features import BODY_FEATURES, LEG_FEATURES, SEGMENT_FEATURES, TRUNK_FEATURES, is_expressed
from walkerlab.genome.text import FEATURE_WORDS, SWING_PARAMETERS, count_segments, format_text
from walkerlab.settings.choices import Feature
from walkerlab.settings.values import pluralize
from walkerlab.text.templates import Markup, render

BODY_COLUMNS = (*TRUNK_FEATURES, *LEG_FEATURES[:2])
GAIT_COLUMNS = LEG_FEATURES[2:]
MAX_FIXED = 1e6  # larger numbers are written with an exponent


class Cell(NamedTuple):
    """Cell of a table.

    Attributes:
        text: Text in the cell.
        is_expressed: Whether the gene is expressed; see ``is_expressed``.
    """

    text: str
    is_expressed: bool = True


def genome_html(values: Floats) -> Markup:
    """Return tables of a genome's body and gait, with the names of the text form, and the text form itself.

    Genes without effect are faint; see ``is_expressed``.

    Args:
        values: Gene values, shape (n_genes,).
    """
    n_segments = count_segments(values.size)
    wanted, frequency, lag, duty = values[: len(BODY_FEATURES)].tolist()
    rows_of_values = values[len(BODY_FEATURES) :].reshape(n_segments, -1).tolist()
    segments: list[dict[Feature, float]] = [dict(zip(SEGMENT_FEATURES, row, strict=True)) for row in rows_of_values]
    expressed = is_expressed(values[np.newaxis])[0, len(BODY_FEATURES) :].reshape(n_segments, -1).tolist()
    is_segment_expressed = [i < round(wanted) for i in range(n_segments)]

    def rows(features: tuple[Feature, ...]) -> list[list[Cell]]:
        return [
            [
                Cell(f"{i + 1}{'' if is_segment_expressed[i] else ' (not expressed)'}"),
                *(
                    Cell(_format_gene(feature, segment[feature]), expressed[i][SEGMENT_FEATURES.index(feature)])
                    for feature in features
                ),
            ]
            for i, segment in enumerate(segments)
        ]

    size = pluralize(n_segments, "segment")
    repeat = SEGMENT_FEATURES.index(Feature.repeat)
    return render(
        "genome/genome.html",
        body_size=size if all(is_segment_expressed) else f"{sum(is_segment_expressed)} of {size} expressed",
        body=rows(BODY_COLUMNS),
        summary=(
            f"Frequency {_format_number(frequency)} Hz, lag {_format_number(lag)} rad for each segment, "
            f"duty {_format_number(duty)}"
        ),
        motions=list(SWING_PARAMETERS),
        gait=rows(GAIT_COLUMNS),
        row_classes=["" if is_shown else "faint" for is_shown in is_segment_expressed],
        has_repeats=any(
            is_used[repeat] and segment[Feature.repeat] for is_used, segment in zip(expressed, segments, strict=True)
        ),
        has_unexpressed=not np.all(expressed),
        text=format_text(values.tolist()),
    )


def _format_gene(feature: Feature, value: float) -> str:
    words = FEATURE_WORDS.get(feature)
    return words[int(value != 0)] if words else _format_number(value)


def _format_number(value: float) -> str:
    return f"{value:.3f}" if abs(value) < MAX_FIXED else f"{value:.3g}"
