"""The buttons that start, pause, step and stop a run, how far it has come, and how long it will still take."""

from collections.abc import Callable
from typing import Any

import traitlets

from walkerlab.text.html import Html, join, tag
from walkerlab.widgets.component import Part, script, style


class Transport(Part):
    """The buttons of a run. What they do is up to whoever listens.

    Attributes:
        state: what the run does: ready, running, paused, stopped, finished or failed.
        share: how much of it is done, 0 to 1.
        words: what is said of it.
        forecast: what is said of the next run, where one can be started.
        fault: why no run can be started, or "".
    """

    title = "run controls"
    _esm = script("transport")
    _css = style("transport", "lab")  # the panel itself has no front end to bring its style
    state = traitlets.Unicode("ready").tag(sync=True)
    share = traitlets.Float(0.0).tag(sync=True)
    words = traitlets.Unicode("").tag(sync=True)
    forecast = traitlets.Unicode("").tag(sync=True)
    fault = traitlets.Unicode("").tag(sync=True)

    def __init__(self, on_press: Callable[[str], None]) -> None:
        """Make it.

        Args:
            on_press: told which button was pressed: start, pause, go_on, stop or step.
        """
        super().__init__()
        self._on_press = on_press
        self.on_msg(self._hear)

    def snapshot(self) -> Html:
        """Write what is said of the run as static HTML."""
        said = [self.words, self.fault or self.forecast]
        return join(*(tag("p", words) for words in said if words)) or tag("p", f"The run is {self.state}.")

    def _hear(self, _widget: object, message: Any, _buffers: object) -> None:
        match message:
            case {"press": str(button)}:
                self._on_press(button)
            case _:
                pass
