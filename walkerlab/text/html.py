"""Escaping of texts for terminals and spreadsheets, and images as parts of a page."""

import re
from base64 import b64encode
from xml.etree import ElementTree

from walkerlab.text.templates import Markup


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


def data_url(media_type: str, data: bytes) -> str:
    """Return a URL that contains a file, such as an image of the media type ``image/png``."""
    return f"data:{media_type};base64,{b64encode(data).decode()}"


def inline_svg(svg: str, name: str, alt: str) -> Markup:
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
    return Markup(ElementTree.tostring(root, encoding="unicode"))


_SVG_NAMESPACE = "http://www.w3.org/2000/svg"
_XLINK_NAMESPACE = "http://www.w3.org/1999/xlink"
_REMOVED_ELEMENTS = {f"{{{_SVG_NAMESPACE}}}{name}" for name in ("metadata", "title", "desc", "style", "script")}
"""Elements that repeat what is on the page, would apply to the whole page, or would be executed."""
