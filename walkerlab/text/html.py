"""HTML for people: every text is escaped when it is put in, so that what comes from a file or a user stays text.

And the same for other places in which a text could do something: a terminal, an SVG, a comment, a spreadsheet.
"""

import re
from collections.abc import Collection, Iterable, Sequence
from html import escape
from xml.etree import ElementTree

VOID = {"img", "meta", "br"}
"""Elements that hold nothing and have no end tag."""

SHOWN = """
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
"""How it looks below a cell: the colours are the notebook's own, so it is at home in a light theme and a dark one."""


def printable(text: object, *, keep: str = "") -> str:
    """Write out as its code whatever would not be seen in a text, but act: on a terminal, in an SVG, in a comment.

    Args:
        text: from a file or a user.
        keep: what is meant, as the ends of lines.
    """
    said = str(text)
    if said.isprintable():
        return said
    return "".join(one if one.isprintable() or one in keep else ascii(one)[1:-1] for one in said)


def cell(text: str) -> str:
    """Keep a spreadsheet from taking a text for a formula, by the apostrophe that one would type there."""
    said = printable(text, keep="\n")
    return f"'{said}" if said.startswith(("=", "+", "-", "@")) else said


class Html(str):
    """Text that is HTML already; any other text is escaped when it is put into some."""


def join(*content: object) -> Html:
    """Put pieces one after the other: ``Html`` as it is, all else as the text it is."""
    return Html("".join(piece if isinstance(piece, Html) else escape(str(piece)) for piece in content))


def tag(name: str, /, *content: object, **attributes: object) -> Html:
    """Write an element.

    Args:
        name: of the element.
        content: as ``join`` takes it.
        attributes: ``class_="faint"`` or ``aria_label="…"``; one that is None is left out.
    """
    words = (
        f' {key.rstrip("_").replace("_", "-")}="{escape(str(value))}"'
        for key, value in attributes.items()
        if value is not None
    )
    return Html(f"<{name}{''.join(words)}>{'' if name in VOID else f'{join(*content)}</{name}>'}")


def table(
    caption: object,
    columns: Sequence[object],
    rows: Iterable[Sequence[object]],
    *,
    groups: Sequence[tuple[object, int]] = (),
    numbers: Collection[int] = (),
    classes: Sequence[str] = (),
) -> Html:
    """Write a table in which each row's first cell is its header.

    Args:
        caption: what it shows.
        columns: the header of each column.
        rows: as many cells each.
        groups: headers over several columns: each with the number of columns it is over.
        numbers: the columns in which numbers stand, by their place.
        classes: of each row: ``"strong"``, ``"faint"`` or ``""``; none of any if empty.
    """

    def cell(place: int, content: object, *, header: bool = False, scope: str = "row") -> Html:
        kind = "number" if place in numbers else None
        return tag("th", content, scope=scope, class_=kind) if header else tag("td", content, class_=kind)

    over = tag("tr", *(tag("th", name, scope="colgroup", colspan=n, class_="group") for name, n in groups))
    heads = tag("tr", *(cell(place, name, header=True, scope="col") for place, name in enumerate(columns)))
    lines = [[cell(place, one, header=place == 0) for place, one in enumerate(row)] for row in rows]
    kinds = [kind or None for kind in classes] if classes else [None] * len(lines)
    body = (tag("tr", *line, class_=kind) for line, kind in zip(lines, kinds, strict=True))
    whole = tag("table", tag("caption", caption), tag("thead", *([over] if groups else []), heads), tag("tbody", *body))
    return tag("div", whole, class_="wide")


def facts(caption: object, pairs: Iterable[tuple[object, object]]) -> Html:
    """Write what is known of one thing: a name and a value to a line."""
    rows = (tag("tr", tag("th", name, scope="row"), tag("td", value)) for name, value in pairs)
    return tag("table", tag("caption", caption), tag("tbody", *rows))


def details(summary: object, *content: object) -> Html:
    """Fold something away under a line that opens it."""
    return tag("details", tag("summary", summary), *content)


def code(text: str) -> Html:
    """Show text that is to be copied as it is."""
    return tag("pre", tag("code", text))


def shown(*content: object) -> str:
    """Wrap up what a notebook shows below a cell: the answer of a ``_repr_html_``."""
    return tag("div", tag("style", Html(SHOWN)), *content, class_="walkerlab")


def inline_svg(svg: str, name: str, alt: str) -> Html:
    """Make an SVG file part of a page.

    Args:
        svg: the file's text, as matplotlib writes it.
        name: put before every id, so that two pictures on a page do not take each other's parts.
        alt: what it shows, for those who cannot see it.
    """
    ElementTree.register_namespace("", _SVG)
    ElementTree.register_namespace("xlink", _XLINK)
    root = ElementTree.fromstring(svg)
    for parent in list(root.iter()):
        for child in list(parent):
            if child.tag in _LEFT_OUT:
                parent.remove(child)
    for element in root.iter():
        for key, value in element.attrib.items():
            if key == "id":
                element.set(key, f"{name}-{value}")
            elif key in {"href", f"{{{_XLINK}}}href"} and value.startswith("#"):
                element.set(key, f"#{name}-{value[1:]}")
            elif "url(#" in value:
                element.set(key, re.sub(r"url\(#", f"url(#{name}-", value))
    for size in ("width", "height"):  # the page decides, and the viewBox keeps its shape
        root.attrib.pop(size, None)
    root.attrib |= {"role": "img", "aria-label": alt, "style": "stroke-linejoin:round;stroke-linecap:butt"}
    return Html(ElementTree.tostring(root, encoding="unicode"))


_SVG, _XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
_LEFT_OUT = {f"{{{_SVG}}}{name}" for name in ("metadata", "title", "desc", "style", "script")}
"""What the page says already, or would apply to all of it, or run."""


def page(title: str, style: str, *content: object) -> str:
    """Write a whole page that stands alone: it loads nothing from anywhere, and nothing in it can run."""
    policy = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=policy),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("title", title),
        tag("style", Html(SHOWN + style)),
    )
    body = tag("body", tag("main", *content), class_="walkerlab")
    return f"<!doctype html>\n{tag('html', head, body, lang='en')}\n"
