"""The robots of one generation, as pictures or as a table; one of them can be selected."""

import math
import threading

import pandas as pd
import traitlets

from walkerlab.evolution.run import Run
from walkerlab.runfile.records import concatenate_tables
from walkerlab.settings.settings import Settings
from walkerlab.text.templates import Markup, render
from walkerlab.view import sketch
from walkerlab.view.plots.tables import require_table
from walkerlab.view.snapshots import svg_image_html
from walkerlab.widgets.component import Component, load_script, load_style
from walkerlab.widgets.listing import MAX_DRAWN, SORT_COLUMNS, describe_generation, sort_robots

PICTURE_SIZE = (100, 56)  # pixels of a picture
MAX_IN_SNAPSHOT = 12  # maximum number of robots in the static picture
PICTURE_MARGIN = 0.15  # m of picture beyond the longest robot, for its feet
LENGTH_STEP = 0.2  # m; the longest body is rounded up to a multiple, so that slightly longer children keep the scale


class Population(Component):
    """The robots of one generation: pictures on one scale, or a table; sorted, with one robot selected.

    Only visible pictures are drawn.

    Attributes:
        selected: Number of the selected robot; -1 if no robot is selected.
        sort: Column by which the robots are sorted: fitness, individual, distance, velocity, n_legs, n_segments,
            weight, body_length or verdict.
        as_table: Whether the robots are shown as a table.
        hint: Text beside the title, such as what a click on a robot does.
    """

    title = "population"
    _esm = load_script("population")
    _css = load_style("population")
    selected = traitlets.Int(-1).tag(sync=True)
    sort = traitlets.Enum(list(SORT_COLUMNS), "fitness").tag(sync=True)
    as_table = traitlets.Bool(False).tag(sync=True)
    hint = traitlets.Unicode("").tag(sync=True)
    sort_options = traitlets.List().tag(sync=True)
    generation = traitlets.Dict().tag(sync=True)
    pictures = traitlets.Dict().tag(sync=True)
    visible = traitlets.List(traitlets.Int(), [0, 0]).tag(sync=True)  # start and exclusive end of the visible pictures

    def __init__(self, records: pd.DataFrame | Run | None = None, settings: Settings | None = None) -> None:
        """Create the widget.

        Args:
            records: Table of a run, or a run; its last generation is shown. Empty if None.
            settings: Settings of the run, for the loads that the robots carry and drag.
        """
        super().__init__(sort_options=[{"key": key, "order": column.order} for key, column in SORT_COLUMNS.items()])
        self._lock = threading.RLock()
        self._settings = settings
        self._shown = concatenate_tables([])
        self.observe(self._list_robots, "sort")
        self.observe(self._draw_pictures, "visible")
        if records is not None:
            self.show(records, settings)

    def show(self, records: pd.DataFrame | Run, settings: Settings | None = None) -> None:
        """Show another generation; the selected robot stays selected if it is still present.

        Args:
            records: Table of a run, or a run; its last generation is shown.
            settings: Settings of the run; if None, the settings of ``records``, or else the previous ones.
        """
        table = require_table(records)
        with self._lock, self.hold_sync():
            self._settings = settings or getattr(records, "settings", None) or self._settings
            self._shown = table.loc[table.generation == table.generation.max()]
            if self.selected not in self._shown.individual.tolist():
                self.selected = -1
            self._list_robots()

    def _list_robots(self, _: object = None) -> None:
        """Sort the robots, and send their descriptions together with the visible pictures."""
        with self._lock, self.hold_sync():
            self._shown = sort_robots(self._shown, self.sort)
            self._draw_pictures()
            self.generation = describe_generation(self._shown) if len(self._shown) else {}

    def _draw_pictures(self, _: object = None) -> None:
        """Draw the visible robots; ``sketch`` caches recent pictures."""
        with self._lock:
            first, end = self.visible if len(self.visible) == 2 else (0, 0)
            self.pictures = self._draw_range(max(first, 0), min(end, MAX_DRAWN))

    def _draw_range(self, first: int, end: int) -> dict[str, str]:
        """Draw a range of the sorted robots; return their pictures as SVG, keyed by number."""
        drawn = self._shown.iloc[first:end]
        span = 0.0
        if len(drawn):
            span = LENGTH_STEP * math.ceil(self._shown.body_length.max() / LENGTH_STEP) + PICTURE_MARGIN
        robot = self._settings.robot if self._settings else None
        return {
            str(number): sketch.draw_robot(genome, robot, size=PICTURE_SIZE, span=span)
            for number, genome in zip(drawn.individual, drawn.genome, strict=True)
        }

    def snapshot(self) -> Markup:
        """Return the first robots as static HTML: their pictures, or a table of them."""
        with self._lock:
            generation = self.generation
            pictures = {} if self.as_table else self._draw_range(0, MAX_IN_SNAPSHOT)
        rows = generation["rows"][:MAX_IN_SNAPSHOT] if generation else []
        n = len(self._shown)
        note = f" The first {len(rows)} of {n:,} are shown, {SORT_COLUMNS[self.sort].order}." if n > len(rows) else ""
        columns = generation["columns"] if generation and self.as_table else []
        return render(
            "widgets/population.html",
            caption=f"{generation['title']}.{note}" if generation else "",
            columns=[f"{column['title']} {column['unit']}".strip() for column in columns],
            rows=[[f"{row['sign']} {row['individual']}".strip(), *row["cells"][1:]] for row in rows],
            figures=[
                (
                    svg_image_html(pictures[str(row["individual"])], alt=row["description"]),
                    " ".join(filter(None, (row["sign"], row["rank"], row["label"]))),
                )
                for row in ([] if self.as_table else rows)
            ],
        )
