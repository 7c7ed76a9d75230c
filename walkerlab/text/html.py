"""HTML in which every text from a file or a user is escaped.

Also: escaping of texts for terminals, SVG files, comments and spreadsheets.
"""

import re
from collections.abc import Collection, Iterable, Sequence
from html import escape
from xml.etree import ElementTree

VOID_ELEMENTS = {"img", "meta", "br"}
"""Elements without content and end tag."""

OUTPUT_STYLE = """
.walkerlab{color:var(--jp-ui-font-color1,inherit);line-height:1.45}
.walkerlab.walkerlab table{border-collapse:collapse;margin:.4em 0 .8em;background:transparent;font-size:inherit}
.walkerlab caption{text-align:left;font-weight:600;padding:.3em 0;color:inherit}
.walkerlab.walkerlab table tr,.walkerlab.walkerlab table tbody tr:nth-child(odd){background:transparent}
.walkerlab.walkerlab table th,.walkerlab.walkerlab table td{
 text-align:left;vertical-align:baseline;padding:.2em .75em .2em 0;border:0;
 border-bottom:1px solid var(--jp-border-color2,rgba(128,128,128,.35));max-width:34em;white-space:normal}
.walkerlab.walkerlab table th{font-weight:400;color:inherit}
.walkerlab.walkerlab table thead th{font-weight:600;border-bottom-width:2px;vertical-align:bottom}
.walkerlab.walkerlab table .number{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
.walkerlab.walkerlab table .number+:not(.number){padding-left:.5em}
.walkerlab.walkerlab table thead .group{text-align:center;border-bottom-width:1px}
.walkerlab.walkerlab tr.strong>:nth-child(-n+2){font-weight:700}
.walkerlab .faint{opacity:.66}
.walkerlab .faint .faint{opacity:1}
.walkerlab .wide{overflow-x:auto}
.walkerlab .beside{display:flex;flex-wrap:wrap;column-gap:2.5em}
.walkerlab .beside>*{max-width:100%}
.walkerlab.walkerlab code{font-family:var(--jp-code-font-family,ui-monospace,monospace);padding:0;
 background:transparent;color:inherit}
.walkerlab pre{white-space:pre-wrap;overflow-wrap:anywhere;background:transparent;color:inherit;padding:.5em .8em;
 margin:.3em 0;border-left:3px solid var(--jp-border-color2,rgba(128,128,128,.35))}
.walkerlab summary{cursor:pointer;padding:.2em 0}
.walkerlab p{margin:.35em 0;max-width:50em}
.walkerlab ul{margin:.3em 0;padding-left:1.4em}
.walkerlab .pictures{display:grid;
 grid-template-columns:repeat(auto-fit,minmax(min(22em,100%),1fr));gap:0 1.2em;max-width:66em}
.walkerlab figure{margin:.6em 0;max-width:46em}
.walkerlab figure>svg,.walkerlab figure>img{display:block;width:100%;height:auto;background:#fff;border-radius:6px}
"""
"""Style of all HTML output; in a notebook it takes the colours of the theme, light or dark."""


def printable(text: object, *, keep: str = "") -> str:
    """Replace all characters that are not printable, such as control characters, by their escape sequences.

    Args:
        text: Text from a file or a user.
        keep: Characters that are not replaced, such as line ends.
    """
    string = str(text)
    if string.isprintable():
        return string
    return "".join(letter if letter.isprintable() or letter in keep else ascii(letter)[1:-1] for letter in string)


def escape_cell(text: str) -> str:
    """Escape the text of a spreadsheet's cell: an apostrophe in front prevents that it is executed as a formula."""
    escaped = printable(text, keep="\n")
    return f"'{escaped}" if escaped.startswith(("=", "+", "-", "@")) else escaped


class Html(str):
    """Text that is HTML; all other text is escaped when it becomes part of HTML."""


def join(*content: object) -> Html:
    """Concatenate content: ``Html`` is unchanged, everything else is escaped."""
    return Html("".join(item if isinstance(item, Html) else escape(str(item)) for item in content))


def tag(name: str, /, *content: object, **attributes: object) -> Html:
    """Return an element.

    Args:
        name: Name of the element.
        *content: Content, as for ``join``.
        **attributes: Attributes, such as ``class_="faint"`` or ``aria_label="…"``; those that are None are left out.
    """
    written = (
        f' {key.rstrip("_").replace("_", "-")}="{escape(str(value))}"'
        for key, value in attributes.items()
        if value is not None
    )
    return Html(f"<{name}{''.join(written)}>{'' if name in VOID_ELEMENTS else f'{join(*content)}</{name}>'}")


def table(
    caption: object,
    columns: Sequence[object],
    rows: Iterable[Sequence[object]],
    *,
    groups: Sequence[tuple[object, int]] = (),
    numbers: Collection[int] = (),
    classes: Sequence[str] = (),
) -> Html:
    """Return a table in which the first cell of each row is its header.

    Args:
        caption: Caption.
        columns: Header of each column.
        rows: Cells of each row, as many as columns.
        groups: Headers above several columns, each with the number of columns that it spans.
        numbers: Indices of the columns that contain numbers.
        classes: Class of each row: ``"strong"``, ``"faint"`` or ``""``; no row has a class if empty.
    """

    def cell(column: int, content: object, *, header: bool = False, scope: str = "row") -> Html:
        alignment = "number" if column in numbers else None
        return tag("th", content, scope=scope, class_=alignment) if header else tag("td", content, class_=alignment)

    group_row = tag("tr", *(tag("th", name, scope="colgroup", colspan=n, class_="group") for name, n in groups))
    header_row = tag("tr", *(cell(column, name, header=True, scope="col") for column, name in enumerate(columns)))
    cells = [[cell(column, content, header=column == 0) for column, content in enumerate(row)] for row in rows]
    row_classes = [row_class or None for row_class in classes] if classes else [None] * len(cells)
    body = (tag("tr", *row, class_=row_class) for row, row_class in zip(cells, row_classes, strict=True))
    head = tag("thead", *([group_row] if groups else []), header_row)
    return tag("div", tag("table", tag("caption", caption), head, tag("tbody", *body)), class_="wide")


def facts(caption: object, pairs: Iterable[tuple[object, object]]) -> Html:
    """Return a table of facts about one thing, with a name and a value in each row."""
    rows = (tag("tr", tag("th", name, scope="row"), tag("td", value)) for name, value in pairs)
    return tag("table", tag("caption", caption), tag("tbody", *rows))


def details(summary: object, *content: object) -> Html:
    """Return content that is hidden until its summary is clicked."""
    return tag("details", tag("summary", summary), *content)


def code(text: str) -> Html:
    """Return a block of code."""
    return tag("pre", tag("code", text))


def shown(*content: object) -> str:
    """Return content with its style, as the result of a ``_repr_html_`` method."""
    return tag("div", tag("style", Html(OUTPUT_STYLE)), *content, class_="walkerlab")


def inline_svg(svg: str, name: str, alt: str) -> Html:
    """Convert an SVG file into an element of a page.

    Args:
        svg: Text of the file, as written by matplotlib.
        name: Prefix of every id, unique on the page.
        alt: Alternative text.
    """
    ElementTree.register_namespace("", _SVG_NAMESPACE)
    ElementTree.register_namespace("xlink", _XLINK_NAMESPACE)
    root = ElementTree.fromstring(svg)
    for parent in list(root.iter()):
        for child in list(parent):
            if child.tag in _REMOVED_ELEMENTS:
                parent.remove(child)
    for element in root.iter():
        for key, value in element.attrib.items():
            if key == "id":
                element.set(key, f"{name}-{value}")
            elif key in {"href", f"{{{_XLINK_NAMESPACE}}}href"} and value.startswith("#"):
                element.set(key, f"#{name}-{value[1:]}")
            elif "url(#" in value:
                element.set(key, re.sub(r"url\(#", f"url(#{name}-", value))
    for size in ("width", "height"):  # the page sets the size, and the viewBox keeps the aspect ratio
        root.attrib.pop(size, None)
    root.attrib |= {"role": "img", "aria-label": alt, "style": "stroke-linejoin:round;stroke-linecap:butt"}
    return Html(ElementTree.tostring(root, encoding="unicode"))


_SVG_NAMESPACE = "http://www.w3.org/2000/svg"
_XLINK_NAMESPACE = "http://www.w3.org/1999/xlink"
_REMOVED_ELEMENTS = {f"{{{_SVG_NAMESPACE}}}{name}" for name in ("metadata", "title", "desc", "style", "script")}
"""Elements that repeat what is on the page, would apply to the whole page, or would be executed."""


def standalone_page(title: str, style: str, *content: object) -> str:
    """Return a complete page that loads no other files and in which no script can run.

    Args:
        title: Title of the page.
        style: Style sheet, in addition to ``OUTPUT_STYLE``.
        *content: Content, as for ``join``.
    """
    policy = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=policy),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("title", title),
        tag("style", Html(OUTPUT_STYLE + style)),
    )
    body = tag("body", tag("main", *content), class_="walkerlab")
    return f"<!doctype html>\n{tag('html', head, body, lang='en')}\n"
