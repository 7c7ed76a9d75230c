"""A genome as HTML tables of its body and its gait, with the text form to copy."""

from collections.abc import Iterator

from walkerlab.ga.genes import Floats
from walkerlab.genome.features import BODY_FEATURES, LEG_FEATURES, SEGMENT_FEATURES, TRUNK_FEATURES, is_expressed
from walkerlab.genome.text import FEATURE_WORDS, SWING_PARAMETERS, count_segments, format_text
from walkerlab.settings.choices import Feature
from walkerlab.settings.values import pluralize
from walkerlab.text.html import Html, code, details, join, table, tag

BODY_COLUMNS = (*TRUNK_FEATURES, *LEG_FEATURES[:2])
GAIT_COLUMNS = LEG_FEATURES[2:]
MAX_FIXED = 1e6  # larger numbers are written with an exponent


def genome_html(values: Floats) -> Html:
    """Return tables of a genome's body and gait, with the names of the text form, and the text form itself.

    Genes without effect are faint; see ``is_expressed``.

    Args:
        values: Gene values, shape (n_genes,).
    """
    n_segments = count_segments(values.size)
    wanted, frequency, lag, duty = values[: len(BODY_FEATURES)].tolist()
    rows_of_values = values[len(BODY_FEATURES) :].reshape(n_segments, -1).tolist()
    segments: list[dict[Feature, float]] = [dict(zip(SEGMENT_FEATURES, row, strict=True)) for row in rows_of_values]
    expressed = is_expressed(values[None])[0, len(BODY_FEATURES) :].reshape(n_segments, -1).tolist()
    is_grown = [i < wanted for i in range(n_segments)]
    row_classes = ["" if grown else "faint" for grown in is_grown]

    def rows(features: tuple[Feature, ...]) -> Iterator[list[object]]:
        for i, segment in enumerate(segments):
            has_effect: dict[Feature, bool] = dict(zip(SEGMENT_FEATURES, expressed[i], strict=True))
            cells = (_cell(feature, segment[feature], has_effect=has_effect[feature]) for feature in features)
            yield [f"{i + 1}{'' if is_grown[i] else ' (not grown)'}", *cells]

    n_grown = sum(is_grown)
    size = pluralize(n_segments, "segment")
    body = table(
        f"Body: {f'{n_grown} of {size} grown' if n_grown < n_segments else size}",
        ["seg", "length [m]", "mass [kg]", "legs", "step", "length [m]", "force [N·m]"],
        rows(BODY_COLUMNS),
        numbers=(1, 2, 5, 6),
        classes=row_classes,
    )
    gait = table(
        f"Gait: frequency {_format_number(frequency)} Hz, lag {_format_number(lag)} rad from segment to segment, "
        f"duty {_format_number(duty)}; angles in rad",
        ["step", *SWING_PARAMETERS, *SWING_PARAMETERS, "stride"],
        rows(GAIT_COLUMNS),
        groups=[("", 1), ("hip", 3), ("knee", 3), ("", 1)],
        numbers=range(1, 8),
        classes=row_classes,
    )
    note = tag("p", "Segments that are not grown are inherited and mutated too.", class_="faint")
    text = details("Genome as text, to copy and edit", code(format_text(values.tolist())))
    return join(tag("div", body, gait, class_="beside"), note if n_grown < n_segments else "", text)


def _cell(feature: Feature, value: float, *, has_effect: bool) -> object:
    """Return the cell of one gene; faint if the gene has no effect."""
    words = FEATURE_WORDS.get(feature)
    text = words[int(value != 0)] if words else _format_number(value)
    return text if has_effect else tag("span", text, class_="faint")


def _format_number(value: float) -> str:
    return f"{value:.3f}" if abs(value) < MAX_FIXED else f"{value:.3g}"
