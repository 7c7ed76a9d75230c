"""Pages that open in a browser without a server: the snapshot of a K3D plot, completed and written to a file."""

import re
from collections.abc import Callable
from pathlib import Path

from walkerlab.system.files import file_path, replace_atomically
from walkerlab.text.templates import Markup, render

CANVAS = '<div id="canvasTarget"></div>'
"""Element of the snapshot in which K3D draws."""


def complete_snapshot(snapshot: str, head: Markup, body: str) -> str:
    """Return the snapshot of a K3D plot with a different head and body, and the script for a notebook's keys.

    Args:
        snapshot: HTML from ``get_snapshot``.
        head: Elements that replace the title.
        body: HTML that replaces the canvas.
    """
    complete_head = render("view/page_head.html", head=head)
    page = re.sub(r"<title>.*?</title>", lambda _: complete_head, snapshot, count=1, flags=re.DOTALL)
    return page.replace(CANVAS, body, 1).replace("<html>", '<html lang="en">', 1)


def write_page(make_page: Callable[[], str], path: str | Path) -> Path:
    """Write a page to a file.

    Args:
        make_page: Function that returns the page; called once the path is checked.
        path: File to write, whose name ends in ``.html``; an existing file is replaced.

    Raises:
        ValueError: If the name does not end in ``.html``.
        OSError: If the file cannot be written.
    """
    path = file_path(path)
    if path.suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"path is {str(path)!r}; it must end in .html, because the file is a page for a browser")
    with replace_atomically(path) as part:
        part.write_text(make_page(), encoding="utf-8")
    return path
