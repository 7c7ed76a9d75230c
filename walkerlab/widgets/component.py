"""What all pieces of the panel share: their looks, and that they answer while a cell is running."""

from pathlib import Path
from typing import Any

import anywidget

from walkerlab.view.snapshots import LIVE_STYLE, HasSnapshot

HERE = Path(__file__).parent


def style(*names: str) -> str:
    """Return the style sheet of a piece: what all share, and those of these names."""
    return f"{_joined('css', names)}\n{LIVE_STYLE}"


def script(*names: str) -> str:
    """Return the JavaScript of a piece: what all share, and those of these names, of which the last renders."""
    return _joined("js", names)


def _joined(kind: str, names: tuple[str, ...]) -> str:
    return "\n".join((HERE / f"{name}.{kind}").read_text(encoding="utf-8") for name in ("component", *names))


class Part(HasSnapshot, anywidget.AnyWidget):
    """A piece of the panel: traits that a browser and Python both see, and the JavaScript that shows them.

    Its controls are those of HTML, which every keyboard reaches and every screen reader knows.
    """

    def __init__(self, **traits: Any) -> None:
        """Make it, with the values of its traits."""
        super().__init__(**traits)
        answer_at_once(self)

    def __repr__(self) -> str:
        """Name it; its traits are long."""
        return f"<{type(self).__name__}: a widget, to be seen in a notebook>"


def answer_at_once(widget: anywidget.AnyWidget) -> None:
    """Let what a browser says be heard on the thread that the browser asks for, also while a cell is running.

    JupyterLab asks for a thread beside that of the cells. ipykernel 7.4 hands its messages to the thread that spoke
    last to the browser instead, which is that of the cells; earlier kernels do as they are asked.
    """
    if hasattr(widget.comm, "_reply_subshell_for"):
        widget.comm._reply_subshell_for = _as_asked  # type: ignore[union-attr]


def _as_asked(_data: object, asked: object) -> object:
    return asked
