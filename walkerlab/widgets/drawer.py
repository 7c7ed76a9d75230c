"""The drawer of a panel: run files to load, a run to export, and its code to copy."""

from collections.abc import Callable
from typing import Any

import traitlets

from walkerlab.text.html import Html, code, details, join, tag
from walkerlab.widgets.component import Part, script, style


class Drawer(Part):
    """What is taken out of a panel and put into it. What its buttons do is up to whoever listens.

    Attributes:
        files: the run files that can be loaded, newest first.
        code: the Python that repeats the run, or "".
        words: what became of the last wish.
        can_export: whether there is something to export.
    """

    title = "run files"
    _esm = script("drawer")
    _css = style("drawer")
    files = traitlets.List(traitlets.Unicode()).tag(sync=True)
    code = traitlets.Unicode("").tag(sync=True)
    words = traitlets.Unicode("").tag(sync=True)
    can_export = traitlets.Bool(False).tag(sync=True)

    def __init__(
        self, on_load: Callable[[str], None], on_export: Callable[[], None], on_settings: Callable[[], None]
    ) -> None:
        """Make it.

        Args:
            on_load: told the path of a run file that is to be loaded.
            on_export: told that the run is to be exported.
            on_settings: told that its settings are wanted for the next one.
        """
        super().__init__()
        self._on_load, self._on_export, self._on_settings = on_load, on_export, on_settings
        self.on_msg(self._hear)

    def snapshot(self) -> Html:
        """Write what became of the last wish, and the code of the run, as static HTML."""
        code_of_run = details("The Python that repeats this run", code(self.code)) if self.code else ""
        said = tag("p", self.words) if self.words else ""
        return join(said, code_of_run) or tag("p", "No run was loaded or exported.")

    def _hear(self, _widget: object, message: Any, _buffers: object) -> None:
        match message:
            case {"load": str(path)}:
                self._on_load(path)
            case {"export": True}:
                self._on_export()
            case {"settings": True}:
                self._on_settings()
            case _:
                pass
