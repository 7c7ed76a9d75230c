"""A genome as HTML tables of its body and its gait, with the text form to copy."""

from collections.abc import Iterator

from walkerlab.ga.genes import Floats
from walkerlab.genome.repair import BODY_FEATURES, SEGMENT_FEATURES
from walkerlab.genome.text import SWING_PARAMETERS, count_segments, format_text
from walkerlab.settings.choices import Feature
from walkerlab.settings.values import pluralize
from walkerlab.text.html import Html, code, details, join, table, tag

BODY_COLUMNS = SEGMENT_FEATURES[:5]
GAIT_COLUMNS = SEGMENT_FEATURES[5:]
MAX_FIXED = 1e6  # larger numbers are written with an exponent


def genome_html(values: Floats) -> Html:
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
    row_classes = ["" if grown else "faint" for grown in is_grown]

    def rows(features: tuple[Feature, ...]) -> Iterator[list[object]]:
        for i, segment in enumerate(segments):
            has_legs = segment[Feature.legs] != 0
            cells = (_cell(feature, segment[feature], has_legs=has_legs) for feature in features)
            yield [f"{i + 1}{'' if is_grown[i] else ' (not grown)'}", *cells]

    n_grown = sum(is_grown)
    size = pluralize(n_segments, "segment")
    body = table(
        f"Body: {f'{n_grown} of {size} grown' if n_grown < n_segments else size}",
        ["seg", "length [m]", "mass [kg]", "legs", "length [m]", "force [N·m]"],
        rows(BODY_COLUMNS),
        numbers=(1, 2, 4, 5),
        classes=row_classes,
    )
    gait = table(
        f"Gait: frequency {_format_number(frequency)} Hz; angles in rad",
        ["step", *SWING_PARAMETERS, *SWING_PARAMETERS, "stride"],
        rows(GAIT_COLUMNS),
        groups=[("", 1), ("hip", 3), ("knee", 3), ("", 1)],
        numbers=range(1, 8),
        classes=row_classes,
    )
    note = tag("p", "Segments that are not grown are inherited and mutated too.", class_="faint")
    text = details("Genome as text, to copy and edit", code(format_text(values.tolist())))
    return join(tag("div", body, gait, class_="beside"), note if n_grown < n_segments else "", text)


def _cell(feature: Feature, value: float, *, has_legs: bool) -> object:
    """Return the cell of one gene; faint if the gene is one of legs that the segment does not have."""
    if feature == Feature.legs:
        return "legs" if value else "nolegs"
    text = _format_number(value)
    return text if has_legs or feature in (Feature.length, Feature.mass) else tag("span", text, class_="faint")


def _format_number(value: float) -> str:
    return f"{value:.3f}" if abs(value) < MAX_FIXED else f"{value:.3g}"
