"""Elements that all plots share: styles of runs, axes, legends, alternative texts, and saving to files."""

import io
import math
import os
from collections.abc import Generator
from contextlib import contextmanager
from typing import Any, cast
from xml.sax.saxutils import escape

import matplotlib as mpl
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, ScalarFormatter
from matplotlib.transforms import Bbox

from walkerlab.system.files import file_path, replace_atomically
from walkerlab.text.escape import printable
from walkerlab.text.numbers import MAX_FIXED_POWER, MIN_FIXED_POWER
from walkerlab.view.plots.appearance import REPRODUCIBLE_TEXT, StyledFigure, foreground_colour, walkerlab_style
from walkerlab.view.plots.tables import UNKNOWN_FITNESS

RUN_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Colours of successive runs: the colours of Okabe and Ito that are dark enough for a line on white."""

RUN_MARKERS = ("o", "s", "^", "D", "v", "P")
"""Markers of successive runs, which distinguish them in black and white."""

MAX_MARKERS = 25  # maximum number of markers on one line
MAX_LEGEND_COLUMNS = 3  # maximum number of columns of a legend with several runs
SECONDARY_STRENGTH = 0.65  # strength of the foreground colour of secondary text


def escape_label(text: object) -> str:
    """Escape text from the user, so that matplotlib shows it unchanged.

    Otherwise, text between $ is a formula, and a legend omits a label that begins with an underscore.
    """
    escaped = printable(text, keep="\n").replace("$", r"\$")
    return f"\N{ZERO WIDTH SPACE}{escaped}" if escaped.startswith("_") else escaped


class _Description(Artist):
    """Title and alternative text of one plot on an Axes; invisible, and removed when the Axes is cleared.

    Attributes:
        title: Title of the kind of plot.
        text: Alternative text.
        quantity: Quantity on the vertical axis, with its unit; "" if the Axes can show other quantities as well.
    """

    def __init__(self, title: str, text: str, quantity: str = "") -> None:
        super().__init__()
        self.title = printable(title)
        self.text = printable(text)
        self.quantity = printable(quantity)
        self.set_in_layout(False)

    def draw(self, renderer: object) -> None:
        """Draw nothing."""

    def get_window_extent(self, renderer: object = None) -> Bbox:  # noqa: ARG002
        """Return an empty box."""
        return Bbox.null()


def add_description(axes: Axes, title: str, text: str, quantity: str = "") -> None:
    """Attach the alternative text of a plot to the Axes on which it was drawn.

    Args:
        axes: Axes with the plot.
        title: Title of the kind of plot.
        text: One or two sentences with the main numbers of the plot.
        quantity: Quantity on the vertical axis, with its unit; "" if the Axes can show other quantities as well.
    """
    axes.add_artist(_Description(title, text, quantity))


def require_quantity(axes: Axes, quantity: str) -> None:
    """Check that the vertical axis of an Axes is unused or shows a given quantity.

    Raises:
        ValueError: If it shows another quantity.
    """
    quantities = [plot.quantity for plot in _alt_texts(axes)]
    other = next((shown for shown in quantities if shown and shown != quantity), "")
    if not other:
        return
    hint = ""
    if UNKNOWN_FITNESS in (other, quantity):
        hint = (
            " A table from read_csv or concat does not name its fitness function; if it is the same as "
            "for another run, copy the attributes: table.attrs = run.records.attrs."
        )
    raise ValueError(
        f"these Axes show {other!r} and cannot also show {quantity!r}: a vertical axis has one quantity. Draw it on "
        f"separate Axes, as in: figure, (left, right) = plt.subplots(1, 2).{hint}"
    )


def alt_text(axes: Axes) -> str:
    """Return the alternative text of the plots on an Axes: what they show, with the main numbers.

    Args:
        axes: Axes with plots of walkerlab.

    Returns:
        One or two sentences for each plot, in the order drawn; "" if there is no plot.
    """
    return " ".join(plot.text for plot in _alt_texts(axes))


def count_plots(axes: Axes, title: str) -> int:
    """Return the number of plots with a given title on an Axes."""
    return sum(plot.title == title for plot in _alt_texts(axes))


def next_run_style(axes: Axes, title: str, number: int | None = None) -> tuple[str, str]:
    """Return the colour and the marker of a run.

    Args:
        axes: Axes to draw on.
        title: Title of the kind of plot.
        number: Number of the style; if None, the number of the next plot with this title on the Axes.
    """
    run = count_plots(axes, title) if number is None else number
    return RUN_COLOURS[run % len(RUN_COLOURS)], RUN_MARKERS[run % len(RUN_MARKERS)]


def marker_stride(n_points: int) -> int | None:
    """Return the interval between the marked points of a line, for at most ``MAX_MARKERS`` markers."""
    return math.ceil(n_points / MAX_MARKERS) or None


def _alt_texts(axes: Axes) -> list[_Description]:
    return [child for child in axes.get_children() if isinstance(child, _Description)]


def save(axes: Axes, *paths: str | os.PathLike[str]) -> None:
    """Save the figure of an Axes with its alternative text; SVG and PDF files contain text as text.

    Args:
        axes: Any Axes of the figure.
        *paths: Files to write; the suffix selects the format: ``.svg``, ``.pdf``, ``.png``, or another format of
            matplotlib.
    """
    figure = cast(Figure, axes.get_figure(root=True))
    plots = [plot for each in figure.axes for plot in _alt_texts(each)]
    title = "; ".join(dict.fromkeys(plot.title for plot in plots))
    text = " ".join(plot.text for plot in plots)
    metadata: dict[str, dict[str, str | None]] = {
        ".svg": {"Title": title, "Description": text, "Date": None},
        ".pdf": {"Title": title, "Subject": text, "CreationDate": None},
        ".png": {"Title": title, "Description": text},
    }
    is_to_scale = all(each.get_aspect() != "auto" for each in figure.axes)
    crop = "tight" if is_to_scale else None  # a drawing to scale may leave much of its figure empty
    style = walkerlab_style() if isinstance(figure, StyledFigure) else mpl.rc_context(REPRODUCIBLE_TEXT)
    with style, _fixed_layout(figure):
        for path in [file_path(each) for each in paths]:
            if not path.suffix:
                path = path.with_name(f"{path.name}.png")  # as matplotlib does
            suffix = path.suffix.lower()
            file_metadata: Any = metadata.get(suffix)
            buffer = io.BytesIO()
            figure.savefig(buffer, format=suffix[1:], dpi=150, metadata=file_metadata, bbox_inches=crop)
            content = buffer.getvalue()
            if suffix == ".svg":
                content = _add_svg_description(content.decode("utf-8"), text).encode("utf-8")
            with replace_atomically(path) as temporary:
                temporary.write_bytes(content)


@contextmanager
def _fixed_layout(figure: Figure) -> Generator[None]:
    """Compute the layout of a figure once, for all formats in which it is saved within the block."""
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


def _add_svg_description(svg: str, text: str) -> str:
    """Add the elements that screen readers use to an SVG file; matplotlib writes only RDF metadata."""
    return svg.replace("<svg ", '<svg role="img" ', 1).replace("</title>", f"</title>\n <desc>{escape(text)}</desc>", 1)


class _ValueFormatter(ScalarFormatter):
    """Formatter of plain numbers; very large and very small ones have a common power of ten, clear of the legend."""

    def __init__(self) -> None:
        super().__init__(useOffset=False)
        self.set_powerlimits((MIN_FIXED_POWER - 1, MAX_FIXED_POWER))

    def set_axis(self, axis: Any) -> None:
        """Set the axis to format, and place its power of ten beside it."""
        super().set_axis(axis)
        text = axis.get_offset_text()
        is_right = text.get_position()[0] > 0.5  # as with twinx
        text.set(x=1.01 if is_right else -0.01, ha="left" if is_right else "right")


def format_value_axis(axes: Axes) -> None:
    """Format the tick labels of the vertical axis for numbers of any size."""
    if not isinstance(axes.yaxis.get_major_formatter(), _ValueFormatter):
        axes.yaxis.set_major_formatter(_ValueFormatter())


def format_generation_axis(axes: Axes, n_generations: int) -> None:
    """Set label, ticks and limits of a horizontal axis of generations, and style the Axes."""
    axes.set_xlabel("generation")
    axes.xaxis.set_major_locator(integer_locator())
    if n_generations == 1:
        axes.set_xlim(-1, 1)
    else:
        axes.margins(x=0.01)
    style_axes(axes)


def integer_locator() -> MaxNLocator:
    """Return a locator that places ticks at round whole numbers."""
    return MaxNLocator(integer=True, min_n_ticks=1, steps=[1, 2, 5, 10])


def style_axes(axes: Axes) -> None:
    """Hide the upper and right spines, and show pale horizontal grid lines."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", lw=0.5, alpha=0.4)
    axes.set_axisbelow(True)


def n_legend_columns(n_runs: int) -> int:
    """Return the number of columns of a legend in which each run has two entries, which stay in one column."""
    return math.ceil(n_runs / math.ceil(n_runs / MAX_LEGEND_COLUMNS))


def add_legend(axes: Axes, n_columns: int) -> None:
    """Add a legend above the Axes, where it covers no data."""
    if axes.get_legend_handles_labels()[1]:
        axes.legend(
            frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=n_columns, borderaxespad=0.2, fontsize=9
        )


def annotate_no_data(axes: Axes, reason: str) -> None:
    """Write on an empty Axes why it shows no data."""
    colour = foreground_colour(axes, SECONDARY_STRENGTH)
    axes.text(0.5, 0.5, reason, transform=axes.transAxes, ha="center", va="center", color=colour)
