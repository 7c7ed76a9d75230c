"""A function that is called again whenever a plain control of a setting changes, with its output below the controls.

def climb(**changes):
    print(wl.simulate(walker, s.with_(structure="stairs", **changes)))

wl.widgets.Interactive(climb, ["step_height", "texture"])
"""

import io
import traceback
from base64 import b64decode
from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager, redirect_stdout
from typing import Any

import ipywidgets
from IPython.core.getipython import get_ipython
from IPython.display import display
from ipywidgets.widgets.interaction import show_inline_matplotlib_plots

from walkerlab.settings.settings import Settings
from walkerlab.text.templates import Markup, render
from walkerlab.view.snapshots import HasSnapshot, image_html, svg_image_html
from walkerlab.widgets.plain import sliders

PNG, SVG, TEXT = "image/png", "image/svg+xml", "text/plain"


class Interactive(HasSnapshot, ipywidgets.VBox):
    """Controls of settings, and the output of a function of their values.

    Attributes:
        controls: Control of each setting, keyed by name.
        output: What the last call printed, displayed and returned.
    """

    title = "output"

    def __init__(self, function: Callable[..., Any], names: Iterable[str], settings: Settings | None = None) -> None:
        """Create the controls and call the function.

        Args:
            function: Function with an argument for each setting; what it prints, displays and returns is shown.
            names: Names of the settings.
            settings: Settings with the initial values; the defaults if None.

        Raises:
            ValueError: As for ``slider``.
        """
        self._function = function
        self.controls = sliders(names, settings)
        self.output = ipywidgets.Output()
        super().__init__([*self.controls.values(), self.output])
        for control in self.controls.values():
            control.observe(self._call, "value")
        self._call()

    def snapshot(self) -> Markup:
        """Return the values of the controls and the output as static HTML."""
        values = [(control.description, _shown_value(control)) for control in self.controls.values()]
        return render("widgets/interactive.html", values=values, outputs=list(map(_to_html, self.output.outputs)))

    def _call(self, _: object = None) -> None:
        with capture_outputs() as outputs:
            try:
                result = self._function(**{name: control.value for name, control in self.controls.items()})
                show_inline_matplotlib_plots()
                if result is not None:
                    display(result)
            except Exception:  # a function of a user; a change of a control must not end in silence
                print(traceback.format_exc(limit=-1))
        self.output.outputs = tuple(outputs)


@contextmanager
def capture_outputs() -> Generator[list[dict[str, Any]]]:
    """Collect what is printed and displayed, as outputs of a notebook.

    Only the calling thread's displays are collected: snapshots of widgets are displayed by another thread.
    """
    outputs: list[dict[str, Any]] = []
    printed = io.StringIO()

    def keep(message: dict[str, Any]) -> None:
        content = message["content"]
        if "data" in content:
            outputs.append({"output_type": "display_data", "data": content["data"], "metadata": content["metadata"]})
        else:  # clear_output()
            outputs.clear()
            printed.seek(0)
            printed.truncate()

    publisher: Any = getattr(get_ipython(), "display_pub", None)
    has_hooks = hasattr(publisher, "register_hook")  # each thread has its own
    if has_hooks:
        publisher.register_hook(keep)
    try:
        with redirect_stdout(printed):
            yield outputs
    finally:
        if has_hooks:
            publisher.unregister_hook(keep)
        if text := printed.getvalue():
            outputs.insert(0, {"output_type": "stream", "name": "stdout", "text": text})


def _shown_value(control: Any) -> str:
    """Return the value as the control shows it: the label of a choice, or a number."""
    return str(getattr(control, "label", None) or control.value)


def _to_html(output: dict[str, Any]) -> Markup:
    """Return an output as static HTML; HTML of the user's objects is left out, and their text shown instead."""
    data: dict[str, Any] = output.get("data", {TEXT: output.get("text", "")})
    text = str(data.get(TEXT, ""))
    if PNG in data:
        return image_html(PNG, b64decode(data[PNG]), text)
    if SVG in data:
        return svg_image_html(data[SVG], text)
    return render("widgets/interactive_text.html", text=text)
