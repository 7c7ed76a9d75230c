"""The base class of the panel's components: shared styles and scripts, and replies while a cell is running."""

from pathlib import Path
from typing import Any

import anywidget

from walkerlab.view.snapshots import LIVE_STYLE, HasSnapshot

STATIC_FOLDER = Path(__file__).parent


def load_style(*names: str) -> str:
    """Return the style sheet of a component.

    Args:
        names: Style sheets that are appended to the shared one, by file name without extension.
    """
    return f"{_join_files('css', names)}\n{LIVE_STYLE}"


def load_script(*names: str) -> str:
    """Return the JavaScript of a component.

    Args:
        names: Scripts that are appended to the shared one, by file name without extension; the last one renders.
    """
    return _join_files("js", names)


def _join_files(extension: str, names: tuple[str, ...]) -> str:
    files = (STATIC_FOLDER / f"{name}.{extension}" for name in ("component", *names))
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


class Component(HasSnapshot, anywidget.AnyWidget):
    """A component of the panel: traits shared by the browser and Python, and the JavaScript that displays them.

    Components use plain HTML controls, which work with every keyboard and screen reader.
    """

    def __init__(self, **traits: Any) -> None:
        """Create the component.

        Args:
            **traits: Initial values of its traits.
        """
        super().__init__(**traits)
        answer_on_requested_thread(self)

    def __repr__(self) -> str:
        """Return a short description without the traits, which are long."""
        return f"<{type(self).__name__}: a widget, displayed in a notebook>"


def answer_on_requested_thread(widget: anywidget.AnyWidget) -> None:
    """Process the browser's messages on the thread that the browser requests, even while a cell is running.

    JupyterLab requests a thread other than the one that runs cells. ipykernel 7.4 ignores the request and uses the
    thread that last sent a message to the browser, which is the one that runs cells; earlier kernels honour the
    request.
    """
    if hasattr(widget.comm, "_reply_subshell_for"):
        widget.comm._reply_subshell_for = _requested_subshell  # type: ignore[union-attr]


def _requested_subshell(_data: object, requested: object) -> object:
    return requested
