"""Images as parts of an HTML page."""

import re
from base64 import b64encode
from xml.etree import ElementTree

from walkerlab.text.templates import Markup


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
