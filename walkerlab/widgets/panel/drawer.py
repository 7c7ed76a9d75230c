"""The run files of a panel: load one, export the selected run, and copy its code."""

from collections.abc import Callable
from typing import Any, Protocol

import traitlets

from walkerlab.text.templates import Markup, render
from walkerlab.widgets.component import Component, load_script, load_style
from walkerlab.widgets.controls import use_labels


class EvolveFurther(Protocol):
    """Function that continues a run."""

    def __call__(self, n_generations: int, *, with_form: bool) -> None:
        """Evolve a number of further generations, with the settings of the form or of the run."""
        ...


class Drawer(Component):
    """Controls that load and export runs and show the code of the selected one; the actions are callbacks.

    Attributes:
        files: ``path`` and ``name`` of the run files that can be loaded, newest first.
        code: Python code that repeats the run; empty if there is none.
        about_code: What the code does.
        words: Message about the last action.
        can_export: Whether there is a run to export.
        can_hand_in: Whether robots can be handed in to a class.
        exported: Paths of the files that were exported last, relative to the notebook.
        n_further: Number of generations proposed to continue the selected run; 0 if it cannot be continued now.
    """

    title = "run files"
    _esm = load_script("panel/drawer")
    _css = load_style("panel/drawer")
    files = traitlets.List(traitlets.Dict()).tag(sync=True)
    code = traitlets.Unicode("").tag(sync=True)
    about_code = traitlets.Unicode("").tag(sync=True)
    words = traitlets.Unicode("").tag(sync=True)
    can_export = traitlets.Bool(False).tag(sync=True)
    can_hand_in = traitlets.Bool(False).tag(sync=True)
    exported = traitlets.List(traitlets.Unicode()).tag(sync=True)
    n_further = traitlets.Int(0).tag(sync=True)

    def __init__(
        self,
        on_load: Callable[[str], None],
        on_export: Callable[[], None],
        on_settings: Callable[[], None],
        on_further: EvolveFurther,
        on_hand_in: Callable[[], None] | None = None,
    ) -> None:
        """Create the controls.

        Args:
            on_load: Called with the path of a run file to load.
            on_export: Called to export the selected run.
            on_settings: Called to copy the settings of the selected run to the form.
            on_further: Called to continue the selected run.
            on_hand_in: Called to hand in the champion of the selected run; if None, there is no button for it.
        """
        super().__init__(can_hand_in=on_hand_in is not None)
        self._on_load = on_load
        self._on_export = on_export
        self._on_settings = on_settings
        self._on_further = on_further
        self._on_hand_in = on_hand_in
        self.on_msg(self._handle_message)

    def report_fault(self, fault: object) -> None:
        """Show why an action failed, as a sentence with a sign.

        Args:
            fault: Error, or its message.
        """
        text = use_labels(str(fault))
        self.words = f"⚠ {text[:1].upper()}{text[1:]}"

    def snapshot(self) -> Markup:
        """Return the last message and the code of the run as static HTML."""
        return render("widgets/panel/drawer.html", words=self.words, python=self.code)

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        match message:
            case {"load": str(path)}:
                self._on_load(path)
            case {"export": True}:
                self._on_export()
            case {"settings": True}:
                self._on_settings()
            case {"hand_in": True} if self._on_hand_in:
                self._on_hand_in()
            case {"further": int(n_generations), "with_form": bool(with_form)} if n_generations > 0:
                self._on_further(n_generations, with_form=with_form)
            case _:
                pass
