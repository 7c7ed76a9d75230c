"""A robot that walks live in the browser, as a widget or as a page."""

import threading
from functools import cached_property
from pathlib import Path
from typing import Any

import traitlets

from walkerlab.genome.genome import Genome
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.choices import Camera
from walkerlab.settings.settings import Settings
from walkerlab.text.html import data_url
from walkerlab.text.templates import Markup, render
from walkerlab.view.pages import write_page
from walkerlab.view.playground.page import build_page, prepare_walks
from walkerlab.view.replay.preview import draw_preview
from walkerlab.widgets.component import Component, load_script, load_style


class Playground(Component):
    """A robot, or a race of up to four, that MuJoCo simulates in the browser; genes and world can be changed.

    The page of about 5 MB is built and sent to the browser when the widget is opened.

    Attributes:
        gene_text: Text of the genome of the robot that is selected on the page; setting a valid text changes the robot
            on the page.
        original: Text of its genome before any change.
        preview: Data URL of a picture of the robot, which is shown until the page is opened.
        alt: Alternative text of the picture.
        is_open: Whether the page is displayed.
        opens_at_once: Whether the page is opened without a click when the widget is displayed.
    """

    title = "playground"
    _esm = load_script("playground")
    _css = load_style("playground")
    gene_text = traitlets.Unicode("").tag(sync=True)
    original = traitlets.Unicode("").tag(sync=True)
    preview = traitlets.Unicode("").tag(sync=True)
    alt = traitlets.Unicode("").tag(sync=True)
    is_open = traitlets.Bool(False).tag(sync=True)
    opens_at_once = traitlets.Bool(False).tag(sync=True)

    def __init__(self, walkers: Any, settings: Settings) -> None:
        """Create the playground; for the arguments see ``playground``."""
        self._walks = prepare_walks(walkers, settings)
        self._settings = settings
        self._lock = threading.Lock()
        names = ", ".join(walk.label for walk in self._walks)
        super().__init__(
            gene_text=str(self._walks[0].scene.genome),
            original=str(self._walks[0].scene.genome),
            preview=data_url("image/png", draw_preview(self._walks, settings)),
            alt=f"Playground of {names}.",
        )
        self.on_msg(self._handle_message)

    @property
    def genome(self) -> Genome:
        """Genome of the robot that is selected on the page, with the values of its sliders.

        Raises:
            GenomeError: If ``gene_text`` was set to a string that is not a valid genome.
        """
        return Genome.parse(self.gene_text)

    @cached_property
    def page(self) -> str:
        """The complete page, as HTML."""
        return build_page(self._walks, self._settings)

    def to_html(self, path: str | Path) -> Path:
        """Save the playground as one file that works offline in any current browser, on a computer or a phone.

        Args:
            path: File to write, whose name ends in ``.html``; an existing file is replaced.

        Returns:
            The path of the file.

        Raises:
            ValueError: If the name does not end in ``.html``.
            OSError: If the file cannot be written.
        """
        return write_page(lambda: self.page, path)

    def __repr__(self) -> str:
        """Return the names of the robots and how to show the playground."""
        return f"<{self.alt.removesuffix('.')}: show it in a notebook, or save it with .to_html(path)>"

    def snapshot(self) -> Markup:
        """Return the picture as static HTML."""
        return render("view/replay/frame.html", url=self.preview, alt=self.alt)

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        """Send the page if the browser requests it; it is not a trait, which would be saved in the notebook."""
        if message == "page":
            with self._lock:
                self.send("page", [self.page.encode("utf-8")])


def playground(
    walkers: Any, settings: Settings | None = None, *, camera: Camera | str | int | None = None
) -> Playground:
    """Simulate a robot live in the browser, where its genes and the world can be changed while it walks.

    MuJoCo, compiled to WebAssembly, simulates the robot on the page as ``simulate`` does. ``to_html`` saves the page as
    one file, which requires neither Python nor a network. In a notebook, the property ``genome`` follows the sliders.

    Args:
        walkers: Genome, its text, an individual, or a run (its champion); or up to four of these for a race, as a list,
            or as a dict with labels as keys.
        settings: Settings of terrain, robot and simulation; the defaults if None.
        camera: Camera at the start: side, front, top, chase or orbit; if None, the camera in the settings.

    Raises:
        GenomeError: If a string is not a valid genome.
        SettingsError: If the camera does not exist.
        TypeError: If ``walkers`` contains anything else.
        ValueError: If there is no robot, or there are more than four.
    """
    settings = Settings() if settings is None or isinstance(walkers, Settings) else require_settings(settings)
    if camera is not None:
        settings = settings.with_(camera=camera)
    return Playground(walkers, settings)
