"""Snapshots of widgets: static pictures for places without the live widget (nbconvert, GitHub, a reopened notebook).

A widget is displayed as two outputs: its live view, and its snapshot, which a style sheet hides while the view is live.
The snapshot is a separate output because front ends rebuild a view when its output is updated: if one output held
both, each update would close menus and lose the focus.
"""

import re
import threading
import time
from html import unescape
from pathlib import Path
from typing import Any

from walkerlab.text.html import data_url
from walkerlab.text.templates import Markup, render

QUIET_TIME = 1.0  # s without a change after which the snapshot is updated
MAX_DELAY = 30.0  # s from the first change to the update if changes never pause

LIVE_STYLE = (Path(__file__).parent / "live.css").read_text(encoding="utf-8")
"""Part of the style sheet of live views."""


class HasSnapshot:
    """Mix-in for widgets that leave a static picture in the notebook; list it before the widget's class.

    Attributes:
        title: Name of the widget in text for users, such as "panel".
    """

    title = "widget"
    _display: "_Display | None" = None

    def snapshot(self) -> Markup:
        """Return what the widget shows as static HTML: images and tables, no scripts."""
        raise NotImplementedError

    def close(self) -> None:
        """Close the widget; its snapshot stays in the notebook."""
        if self._display:
            self._display.close()
        super().close()  # type: ignore[misc]

    def _ipython_display_(self, **_: Any) -> None:
        self._display = self._display or _Display(self)
        self._display.show()


class _Display:
    """The outputs of one widget in a notebook; updates the snapshot when the widget has changed."""

    def __init__(self, widget: Any) -> None:
        self._widget = widget
        self._id = f"walkerlab-{id(widget):x}-{time.time_ns():x}"
        self._html = ""
        self._is_open = widget.comm is not None
        self._first_change = self._last_change = 0.0
        self._timer: threading.Timer | None = None
        self._timing = threading.Lock()
        self._updating = threading.Lock()  # not held while traits change, to avoid a deadlock between two threads

    def show(self) -> None:
        """Display the live view, unless the widget is closed, and the snapshot."""
        from IPython.core.getipython import get_ipython
        from IPython.display import display

        if self._is_open:
            bundle = self._widget._repr_mimebundle_()
            view, metadata = bundle if isinstance(bundle, tuple) else (bundle, None)  # Colab reads the metadata
            html = {"text/html": ""}  # shown instead of the text where there is no live view
            display(view | html, metadata=metadata, raw=True)
        shell: Any = get_ipython()
        if not hasattr(shell, "kernel"):
            return
        if not self._html and self._is_open:
            for piece in [self._widget, *nested_widgets(self._widget)]:
                piece.observe(self._on_change)
            shell.events.register("post_run_cell", self._on_cell_end)
        with self._updating:
            self._html = snapshot_html(self._widget)
            display(_bundle(self._widget, self._html), raw=True, display_id=self._id)

    def update(self) -> None:
        """Replace the snapshot in the notebook if it has changed."""
        from IPython.display import display

        with self._timing:
            if self._timer:
                self._timer.cancel()
            self._timer = None
        with self._updating:
            html = snapshot_html(self._widget) if self._is_open and self._html else self._html
            if html != self._html:
                self._html = html
                display(_bundle(self._widget, html), raw=True, display_id=self._id, update=True)

    def close(self) -> None:
        """Update the snapshot for the last time."""
        from IPython.core.getipython import get_ipython

        if not self._is_open:
            return
        self.update()
        self._is_open = False
        shell: Any = get_ipython()
        if self._html and shell:
            for piece in [self._widget, *nested_widgets(self._widget)]:
                piece.unobserve(self._on_change)
            shell.events.unregister("post_run_cell", self._on_cell_end)

    def _on_change(self, _change: object) -> None:
        with self._timing:
            self._last_change = time.monotonic()
            if not self._timer:
                self._first_change = self._last_change
                self._wait(QUIET_TIME)

    def _wait(self, seconds: float) -> None:
        self._timer = threading.Timer(seconds, self._on_timeout)
        self._timer.daemon = True
        self._timer.start()

    def _on_timeout(self) -> None:
        with self._timing:
            due = min(self._last_change + QUIET_TIME, self._first_change + MAX_DELAY) - time.monotonic()
            if due > 0:
                self._wait(due)
                return
        self.update()

    def _on_cell_end(self, _result: object) -> None:
        """Update before the cell ends; programs that execute notebooks ignore later outputs."""
        if self._timer:
            self.update()


def snapshot_html(widget: Any) -> str:
    """Return the snapshot of a widget with a line that names the widget, as self-contained HTML."""
    content = ""
    error = ""
    try:
        content = widget.snapshot()
    except Exception as caught:  # without its snapshot the live widget still works
        error = f"{type(caught).__name__}: {caught}"
    return render("view/snapshot.html", title=widget.title, content=content, error=error)


def _bundle(widget: Any, html: str) -> dict[str, str]:
    return {"text/html": html, "text/plain": f"Static picture of the {widget.title}"}


def nested_widgets(box: Any) -> list[Any]:
    """Return all widgets in a box and in the boxes inside it, the inner ones first."""
    return [widget for child in getattr(box, "children", ()) for widget in (*nested_widgets(child), child)]


def svg_image_html(picture: str, alt: str = "") -> Markup:
    """Return an SVG as an image element, where no script runs.

    Args:
        picture: Text of the SVG.
        alt: Alternative text; the ``aria-label`` of the SVG if empty.
    """
    label = re.search(r'aria-label="([^"]*)"', picture)
    return image_html("image/svg+xml", picture.encode(), alt or (unescape(label[1]) if label else ""))


def image_html(media_type: str, data: bytes, alt: str) -> Markup:
    """Return an image element that contains the image.

    Args:
        media_type: Media type, such as ``image/png``.
        data: Content of the image file.
        alt: Alternative text.
    """
    return render("view/image.html", url=data_url(media_type, data), alt=alt)
