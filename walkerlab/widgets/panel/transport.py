"""The buttons that start, pause, step and stop a run, its progress, and the remaining time."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any

import traitlets

from walkerlab.evolution.stopping import Stop, StopError
from walkerlab.text.templates import Markup, render
from walkerlab.widgets.component import Component, load_script, load_style

_CONDITIONS = {"minutes": "after", "target": "target", "patience": "patience"}
"""Argument of ``Stop`` for each field of the panel."""


class Transport(Component):
    """The buttons and the progress bar of a run; the action is a callback.

    Attributes:
        state: State of the run: ready, running, paused, stopped, finished or failed.
        share: Completed share of the run, 0 to 1.
        words: Message about the run.
        forecast: Message about the next run, if one can be started.
        note: Message about the settings during a run.
        end_early: Conditions under which a run ends early: any of ``minutes``, ``target`` and ``patience``.
        fault: Why no run can be started; empty if one can.
    """

    title = "run controls"
    _esm = load_script("panel/transport")
    _css = load_style("panel/transport", "panel/lab")  # the panel itself is a plain Box without a style sheet
    state = traitlets.Unicode("ready").tag(sync=True)
    share = traitlets.Float(0.0).tag(sync=True)
    words = traitlets.Unicode("").tag(sync=True)
    forecast = traitlets.Unicode("").tag(sync=True)
    note = traitlets.Unicode("").tag(sync=True)
    fault = traitlets.Unicode("").tag(sync=True)
    end_early = traitlets.Dict().tag(sync=True)

    def __init__(self, on_press: Callable[[str], None]) -> None:
        """Create the buttons.

        Args:
            on_press: Called with the name of the button: start, pause, continue, stop or step.
        """
        super().__init__()
        self._on_press = on_press
        self.on_msg(self._handle_message)

    @property
    def stop(self) -> Stop | None:
        """Conditions under which the next run ends early; None if there are none. Invalid values are ignored."""
        given: dict[str, Any] = {}
        for name, value in self.end_early.items():
            if name in _CONDITIONS and isinstance(value, int | float):
                condition: dict[str, Any] = {_CONDITIONS[name]: 60 * value if name == "minutes" else value}
                with suppress(StopError):
                    Stop(**condition)
                    given |= condition
        return Stop(**given) if given else None

    def snapshot(self) -> Markup:
        """Return the messages as static HTML."""
        messages = [message for message in (self.words, self.fault or self.forecast) if message]
        return render("widgets/panel/transport.html", messages=messages, state=self.state)

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        match message:
            case {"press": str(button)}:
                self._on_press(button)
            case _:
                pass
