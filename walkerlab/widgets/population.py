"""The robots of one generation, as pictures or as a table; one of them can be selected."""

import math
import threading

import pandas as pd
import traitlets

from walkerlab.evolution.run import Run
from walkerlab.runfile.records import join
from walkerlab.settings.settings import Settings
from walkerlab.text.html import Html, table, tag
from walkerlab.view import sketch
from walkerlab.view.plots.tables import require_table
from walkerlab.view.snapshots import image
from walkerlab.widgets.component import Part, script, style
from walkerlab.widgets.listing import COLUMNS, DRAWN, order, roster

SIZE = (100, 56)  # pixels of a picture
IN_SNAPSHOT = 12  # robots at most in the static picture
ROOM = 0.15  # m beside the longest robot, for its feet
STEP = (
    0.2  # m, to which the longest robot's length is rounded up, so that the scale stays when a child is a little longer
)


class Population(Part):
    """The robots of one generation: a strip of pictures to one scale, or a table; sorted, and one of them selected.

    Only those pictures are drawn that are in sight: a page on which nobody looks at it costs nothing.

    Attributes:
        selected: the number of the selected robot, -1 if none is; a click or a key sets it, and so can you.
        sort: the column by which they are sorted: fitness, individual, distance, velocity, n_legs, n_segments,
            weight, body_length or verdict.
        as_table: whether they are shown as a table.
    """

    title = "population"
    _esm = script("population")
    _css = style("population")
    selected = traitlets.Int(-1).tag(sync=True)
    sort = traitlets.Enum(list(COLUMNS), "fitness").tag(sync=True)
    as_table = traitlets.Bool(False).tag(sync=True)
    sorts = traitlets.List().tag(sync=True)
    roster = traitlets.Dict().tag(sync=True)
    pictures = traitlets.Dict().tag(sync=True)
    sight = traitlets.List(traitlets.Int(), [0, 0]).tag(sync=True)

    def __init__(self, records: pd.DataFrame | Run | None = None, settings: Settings | None = None) -> None:
        """Show a generation.

        Args:
            records: a tidy table or a run, of which the last generation is shown; nothing yet if None.
            settings: of its run, for the loads that the robots carry and drag.
        """
        super().__init__(sorts=[{"key": key, "words": column.first} for key, column in COLUMNS.items()])
        self._lock = threading.RLock()
        self._settings, self._shown = settings, join([])
        self.observe(self._list, "sort")
        self.observe(self._draw, "sight")
        if records is not None:
            self.show(records, settings)

    def show(self, records: pd.DataFrame | Run, settings: Settings | None = None) -> None:
        """Show a generation; who was selected stays so if it lives on.

        Args:
            records: a tidy table or a run, of which the last generation is shown.
            settings: as for a new one; those known already if None.
        """
        table = require_table(records)
        with self._lock, self.hold_sync():
            self._settings = settings or getattr(records, "settings", None) or self._settings
            self._shown = table.loc[table.generation == table.generation.max()]
            if self.selected not in self._shown.individual.tolist():
                self.selected = -1
            self._list()

    def _list(self, _: object = None) -> None:
        """Tell the browser who is there, together with the pictures that it sees first."""
        with self._lock, self.hold_sync():
            self._shown = order(self._shown, self.sort)
            self._draw()
            self.roster = roster(self._shown) if len(self._shown) else {}

    def _draw(self, _: object = None) -> None:
        """Draw those in sight; what was drawn lately is remembered where it is drawn."""
        with self._lock:
            first, last = self.sight if len(self.sight) == 2 else (0, 0)
            self.pictures = self._drawn(max(first, 0), min(last, DRAWN))

    def _drawn(self, first: int, last: int) -> dict[str, str]:
        """Draw some of the robots, counted in the order in which they are listed."""
        seen = self._shown.iloc[first:last]
        span = STEP * math.ceil(self._shown.body_length.max() / STEP) + ROOM if len(seen) else 0.0
        robot = self._settings.robot if self._settings else None
        return {
            str(number): sketch.draw_robot(gene, robot, size=SIZE, span=span)
            for number, gene in zip(seen.individual, seen.genome, strict=True)
        }

    def snapshot(self) -> Html:
        """Write the first robots as static HTML: their pictures, or a table of them."""
        with self._lock:
            listed, pictures = self.roster, {} if self.as_table else self._drawn(0, IN_SNAPSHOT)
        if not listed:
            return tag("p", "No generation was done yet.")
        rows, n = listed["rows"][:IN_SNAPSHOT], len(self._shown)
        some = f" The first {len(rows)} of {n:,} are shown, {COLUMNS[self.sort].first}." if n > len(rows) else ""
        caption = f"{listed['title']}.{some}"
        if self.as_table:
            columns = [f"{column['title']} {column['unit']}".strip() for column in listed["columns"]]
            cells = ([f"{row['sign']} {row['individual']}".strip(), *row["cells"][1:]] for row in rows)
            return table(caption, columns, cells, numbers=range(1, len(columns) - 1))
        figures = (
            tag(
                "figure",
                image(pictures[str(row["individual"])], alt=row["says"]),
                tag("figcaption", f"{row['sign']} {row['worth']}".strip()),
                style="display: inline-block; margin: 4px; text-align: center",
            )
            for row in rows
        )
        return tag("div", tag("p", caption), *figures)
