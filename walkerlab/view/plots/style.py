"""How every picture looks, what it says to those who cannot see it, and how it is saved."""

import io
import math
import os
from collections.abc import Generator
from contextlib import contextmanager
from typing import Any, cast
from xml.sax.saxutils import escape

import matplotlib as mpl
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, ScalarFormatter
from matplotlib.transforms import Bbox

from walkerlab.runfile.records import COLUMNS as TABLE_COLUMNS
from walkerlab.system.files import file_path, replacing
from walkerlab.text.html import printable
from walkerlab.text.numbers import LARGEST, SMALLEST, significant
from walkerlab.view.plots.appearance import REAL_TEXT, OwnFigure, ink, own_look

RUNS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Colours of runs, in turn: those of Okabe and Ito that are dark enough for a line on white."""

MARKS = ("o", "s", "^", "D", "v", "P")
"""Marks of runs, in turn, which tell them apart in black and white."""

MOST_MARKS = 25  # on a line, however long
COLUMNS = 3  # of a key, at most, in which each of several runs has two lines
UNKNOWN_FITNESS = "fitness"  # the measure of a table that does not say what its fitness is
QUIET = 0.65  # strength of the ink of text that is not the first to be read


def literal(text: object) -> str:
    """Write a user's text as it stands: without formulas between $, and in the legend even if it begins with _."""
    said = printable(text, keep="\n").replace("$", r"\$")
    return f"\N{ZERO WIDTH SPACE}{said}" if said.startswith("_") else said


class _Description(Artist):
    """What a picture shows, in words; it lives and dies with what is drawn on its Axes."""

    def __init__(self, title: str, text: str, measure: str = "") -> None:
        super().__init__()
        self.title, self.text, self.measure = printable(title), printable(text), measure
        self.set_in_layout(False)

    def draw(self, renderer: object) -> None:
        """Words are heard, not seen."""

    def get_window_extent(self, renderer: object = None) -> Bbox:  # noqa: ARG002
        """Take no room."""
        return Bbox.null()


def describe(axes: Axes, title: str, text: str, measure: str = "") -> None:
    """Say in a sentence or two, with its figures, what has just been drawn on an Axes.

    Args:
        axes: on which it was drawn.
        title: what kind of picture it is.
        text: the sentences.
        measure: what the vertical axis measures, with its unit; "" if other measures may share the Axes.
    """
    axes.add_artist(_Description(title, text, measure))


def require_measure(axes: Axes, measure: str) -> None:
    """Check that nothing else is measured along the vertical axis of an Axes yet.

    Raises:
        ValueError: if something else is.
    """
    drawn = next((one.measure for one in _descriptions(axes) if one.measure and one.measure != measure), "")
    if not drawn:
        return
    unknown = ""
    if {drawn, measure} & {UNKNOWN_FITNESS}:
        unknown = (
            " A table does not say what its fitness is after read_csv or concat; if it is that of another run, give it "
            "the same attributes: table.attrs = run.records.attrs."
        )
    raise ValueError(
        f"these Axes show {drawn!r}, and cannot show {measure!r} as well: one axis cannot measure both. Draw it on "
        f"Axes of its own, as in: figure, (left, right) = plt.subplots(1, 2).{unknown}"
    )


def alt_text(axes: Axes) -> str:
    """Return what is drawn on an Axes in words, with its figures, for those who cannot see it.

    Args:
        axes: on which plots of walkerlab have drawn.

    Returns:
        A sentence or two for each plot, in the order drawn; "" if there is none.
    """
    return " ".join(one.text for one in _descriptions(axes))


def n_drawn(axes: Axes, title: str) -> int:
    """Count the plots of this title on an Axes, so that the next one can look different."""
    return sum(one.title == title for one in _descriptions(axes))


def next_look(axes: Axes, title: str, number: int | None = None) -> tuple[str, str]:
    """Return colour and mark of the next of several runs on an Axes, or of the one of this number."""
    run = n_drawn(axes, title) if number is None else number
    return RUNS[run % len(RUNS)], MARKS[run % len(MARKS)]


def some(points: int) -> int | None:
    """Say how often a line of so many points is marked, so that it is not crowded."""
    return math.ceil(points / MOST_MARKS) or None


def _descriptions(axes: Axes) -> list[_Description]:
    return [child for child in axes.get_children() if isinstance(child, _Description)]


def save(axes: Axes, *paths: str | os.PathLike[str]) -> None:
    """Save the figure of an Axes with its description; in SVG and PDF, text stays text.

    Args:
        axes: any one of the figure.
        *paths: to be written; the endings say as what: ``.svg``, ``.pdf``, ``.png``, or another that matplotlib knows.
    """
    figure = cast(Figure, axes.get_figure(root=True))
    found = [one for each in figure.axes for one in _descriptions(each)]
    title = "; ".join(dict.fromkeys(one.title for one in found))
    text = " ".join(one.text for one in found)
    metadata: dict[str, dict[str, str | None]] = {
        ".svg": {"Title": title, "Description": text, "Date": None},
        ".pdf": {"Title": title, "Subject": text, "CreationDate": None},
        ".png": {"Title": title, "Description": text},
    }
    to_scale = all(each.get_aspect() != "auto" for each in figure.axes)
    crop = "tight" if to_scale else None  # a drawing to scale may leave much of its figure empty
    look = own_look() if isinstance(figure, OwnFigure) else mpl.rc_context(REAL_TEXT)
    with look, _laid_out(figure):
        for path in [file_path(each) for each in paths]:
            if not path.suffix:
                path = path.with_name(f"{path.name}.png")  # as matplotlib does
            suffix = path.suffix.lower()
            told: Any = metadata.get(suffix)
            drawn = io.BytesIO()
            figure.savefig(drawn, format=suffix[1:], dpi=150, metadata=told, bbox_inches=crop)
            written = drawn.getvalue()
            if suffix == ".svg":
                written = _heard(written.decode("utf-8"), text).encode("utf-8")
            with replacing(path) as part:
                part.write_bytes(written)


@contextmanager
def _laid_out(figure: Figure) -> Generator[None]:
    """Lay a figure out once for all that it is saved as."""
    engine = figure.get_layout_engine()
    if engine is None:
        yield
        return
    engine.execute(figure)
    figure.set_layout_engine("none")
    try:
        yield
    finally:
        figure.set_layout_engine(engine)


def _heard(svg: str, text: str) -> str:
    """Write the description where screen readers look for it: matplotlib writes it where catalogues do."""
    return svg.replace("<svg ", '<svg role="img" ', 1).replace("</title>", f"</title>\n <desc>{escape(text)}</desc>", 1)


class _TickLabels(ScalarFormatter):
    """Plain numbers; of very large and very small ones, a common power of ten, beside the axis and off the legend."""

    def __init__(self) -> None:
        super().__init__(useOffset=False)
        self.set_powerlimits((SMALLEST - 1, LARGEST))

    def set_axis(self, axis: Any) -> None:
        """Format the ticks of an axis, and place its power of ten."""
        super().set_axis(axis)
        text = axis.get_offset_text()
        is_right = text.get_position()[0] > 0.5  # as of twinx
        text.set(x=1.01 if is_right else -0.01, ha="left" if is_right else "right")


def label_values(axes: Axes) -> None:
    """Label the vertical axis with numbers of any size."""
    if not isinstance(axes.yaxis.get_major_formatter(), _TickLabels):
        axes.yaxis.set_major_formatter(_TickLabels())


def over_generations(axes: Axes, n_generations: int) -> None:
    """Give an Axes the generations along its foot, and a quiet look."""
    axes.set_xlabel("generation")
    axes.xaxis.set_major_locator(round_steps())
    if n_generations == 1:
        axes.set_xlim(-1, 1)
    else:
        axes.margins(x=0.01)
    plain(axes)


def round_steps() -> MaxNLocator:
    """Place ticks at whole and round numbers."""
    return MaxNLocator(integer=True, min_n_ticks=1, steps=[1, 2, 5, 10])


def plain(axes: Axes) -> None:
    """Leave out the lines that carry nothing, and help the eye across."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", lw=0.5, alpha=0.4)
    axes.set_axisbelow(True)


def columns_of(n_runs: int) -> int:
    """Return into how many columns the lines of several runs go, so that no run's are parted."""
    return math.ceil(n_runs / math.ceil(n_runs / COLUMNS))


def key(axes: Axes, columns: int) -> None:
    """Explain the lines above the Axes, where they are in the way of nothing."""
    if axes.get_legend_handles_labels()[1]:
        axes.legend(
            frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=columns, borderaxespad=0.2, fontsize=9
        )


def nothing(axes: Axes, why: str) -> None:
    """Say why there is nothing to be seen."""
    axes.text(0.5, 0.5, why, transform=axes.transAxes, ha="center", va="center", color=ink(axes, QUIET))


def table_of(records: Any, *columns: str) -> pd.DataFrame:
    """Take a tidy table, or the run that it belongs to.

    Args:
        records: The table or the run.
        *columns: Columns that the picture needs, besides ``generation``.

    Raises:
        TypeError: if it is neither.
        ValueError: If the table lacks a column, or holds several runs.
    """
    table = getattr(records, "records", records)
    if not isinstance(table, pd.DataFrame):
        raise TypeError(
            f"this picture is drawn from the table of a run: give run.records; got a {type(records).__name__}"
        )
    if missing := [name for name in ("generation", *columns) if name not in table]:
        raise ValueError(
            f"the table has no column {' and no column '.join(map(repr, missing))}, which this picture needs; it has "
            f"{', '.join(map(str, table.columns)) or 'none'}. The whole table of a run is run.records."
        )
    if "individual" in table and (repeated := table.duplicated(["generation", "individual"])).any():
        row = table.loc[repeated, :].iloc[0]
        raise ValueError(
            f"this table has robot {row.individual} of generation {row.generation} more than once, so it holds several "
            "runs. Draw one run at a time; curves can share Axes, as in: for seed, run in enumerate(runs): "
            'wl.plots.fitness_curve(run.records, ax, label=f"seed {seed}")'
        )
    return table


def unit_of(records: pd.DataFrame, column: str) -> str:
    """Return the unit of a column, "" if it has none; a table read from a CSV file has lost that of its fitness."""
    usual = TABLE_COLUMNS[column][1] if column in TABLE_COLUMNS else ""
    return str(records.attrs.get("units", {}).get(column, usual))


def fitness_measure(records: pd.DataFrame) -> str:
    """Return what the fitness of a table measures, with its unit in brackets."""
    return with_brackets(str(records.attrs.get("fitness", UNKNOWN_FITNESS)), unit_of(records, "fitness"))


def with_brackets(name: str, unit: str) -> str:
    """Return the label of an axis: ``distance [m]``."""
    return f"{name} [{unit}]" if unit else name


def with_unit(value: float, unit: str) -> str:
    """Write a measured number of a picture: three significant figures without needless zeros, and a true minus sign."""
    digits, _, power = significant(value).partition("e")
    if "." in digits:
        digits = digits.rstrip("0").rstrip(".")
    number = f"{digits}e{power}" if power else digits
    return f"{number.replace('-', '−')}{f' {unit}' if unit else ''}"


def course(values: pd.Series, unit: str) -> str:
    """Say from where to where a line goes."""
    first, last = with_unit(float(values.iloc[0]), unit), with_unit(float(values.iloc[-1]), unit)
    if first == last:
        return f"stays at {first}" if values.nunique() == 1 else f"begins and ends at {first}"
    return f"{'rises' if values.iloc[-1] > values.iloc[0] else 'falls'} from {first} to {last}"
