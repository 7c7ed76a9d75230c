"""Texts that become part of HTML stay texts."""

import re
from html.parser import HTMLParser

from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from walkerlab.text import html
from walkerlab.text.templates import environment, render
from walkerlab.view import plots

HOSTILE = "</pre><script>alert(1)</script><img src=x onerror=alert(2)>\" onload='x'"


VOID_ELEMENTS = {"img", "meta", "br"}
"""Elements without content and end tag."""


class Seen(HTMLParser):
    """Elements and text of a page as a browser would parse it; all elements must be closed in order."""

    def __init__(self, html):
        super().__init__()
        self.elements = []
        self.texts = []
        self._open = []
        self.feed(html)
        self.close()
        assert not self._open, f"not closed: {self._open}"

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID_ELEMENTS:
            self._open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self._open, f"no element to close: </{tag}>"
        assert self._open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)

    @property
    def text(self):
        return "".join(self.texts)

    def all(self, tag):
        return [attributes for name, attributes in self.elements if name == tag]


def assert_harmless(html):
    """Check that a page is well-formed, runs and loads nothing, and has an alternative text for each picture."""
    seen = Seen(html)
    assert not {tag for tag, _ in seen.elements} & {"script", "iframe", "object", "embed", "link", "base", "form"}
    for tag, attributes in seen.elements:
        assert not [name for name in attributes if name.startswith("on")]
        for name in ("src", "href", "xlink:href", "poster", "action"):
            address = attributes.get(name, "#")
            assert not re.match(r"\s*([a-z+.-]+:)?//|\s*(javascript|vbscript):", address, re.IGNORECASE), address
            assert not address.startswith("data:") or re.match(r"data:image/(png|svg\+xml);base64,", address)
            assert not address.startswith("data:image/svg") or tag == "img", "scripts run in an SVG outside an image"
        assert tag != "img" or attributes.get("alt")
        assert tag != "svg" or (attributes.get("role") == "img" and attributes.get("aria-label"))
    assert not re.search(r"@import|url\((?!#)", html)
    ids = [attributes["id"] for _, attributes in seen.elements if "id" in attributes]
    assert len(ids) == len(set(ids))
    for reference in re.findall(r'(?:href="|url\()#([^")]*)', html):
        assert reference in ids
    return seen


@given(st.text(), st.text())
def test_every_text_is_escaped(text, other):
    source = '<p class="{{ other }}">{{ text }}<b title="{{ text }}">{{ other }}</b></p>'
    seen = Seen(environment().from_string(source).render(text=text, other=other))
    assert [tag for tag, _ in seen.elements] == ["p", "b"]
    assert seen.all("b") == [{"title": _read(text)}]
    assert seen.text == _read(text) + _read(other)


def _read(text):
    """Return a text as a parser of HTML reads it; it replaces some characters."""
    return _TextParser.parse(text)


class _TextParser(HTMLParser):
    @classmethod
    def parse(cls, text):
        parser = cls()
        parser.text = ""
        parser.feed(text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;"))
        parser.close()
        return parser.text

    def handle_data(self, data):
        self.text += data


ELEMENTS = """{% from "text/elements.html" import table, facts, details, code %}
{{ table(h, [h, h], [[h, h]], groups=[(h, 2)], classes=["strong"]) }}
{% call(cell) table("", [], [["", h]]) %}<i>{{ cell }}</i>{% endcall %}
{{ facts(h, [(h, h)]) }}
{% call details(h) %}{{ h }}{% endcall %}
{{ code(h) }}"""


def test_every_element_escapes_its_texts():
    seen = assert_harmless(environment().from_string(ELEMENTS).render(h=HOSTILE))
    assert seen.text.count(HOSTILE) == 6 + 1 + 3 + 2 + 1  # of each element
    assert_harmless(render("text/output.html", content=[HOSTILE]))


def standalone_page(title, *content):
    """Return a complete page."""
    source = '{% extends "text/standalone.html" %}{% block content %}{{ content|join }}{% endblock %}'
    return environment().from_string(source).render(title=title, content=content)


def test_a_table_has_a_caption_and_headers_with_their_scope():
    source = """{% from "text/elements.html" import table %}
    {{ table("Robots", ["robot", "mass"], [[1, 2.5], [2, 3.5]], numbers=[1], classes=["", "faint"]) }}"""
    seen = Seen(environment().from_string(source).render())
    assert len(seen.all("caption")) == 1
    assert [cell["scope"] for cell in seen.all("th")] == ["col", "col", "row", "row"]
    assert [row.get("class") for row in seen.all("tr")] == [None, None, "faint"]
    assert all(cell["class"] == "number" for cell in seen.all("td"))


def test_a_page_has_a_language_and_a_strict_security_policy():
    page = standalone_page("A title" + HOSTILE, HOSTILE)
    seen = assert_harmless(page)
    assert seen.text.count(HOSTILE) == 2
    assert page.startswith("<!doctype html>")
    assert seen.all("html") == [{"lang": "en"}]
    policy = next(meta["content"] for meta in seen.all("meta") if meta.get("http-equiv") == "Content-Security-Policy")
    assert policy.startswith("default-src 'none'")
    assert not page.count("http:")


def test_two_pictures_on_a_page_have_different_ids(tmp_path):
    pictures = []
    for name in ("one", "two"):
        axes = Figure(figsize=(3, 2)).add_subplot()
        axes.plot([0, 1], [0, 1], marker="o", clip_on=True)
        axes.set_title("<b>&amp;</b>")
        plots.save(axes, tmp_path / f"{name}.svg")
        pictures.append(html.inline_svg((tmp_path / f"{name}.svg").read_text(encoding="utf-8"), name, "a line < 2"))
    seen = assert_harmless(standalone_page("Two", *pictures))
    assert [svg["aria-label"] for svg in seen.all("svg")] == ["a line < 2"] * 2
    assert seen.text.count("<b>&amp;</b>") == 2
    assert all("viewbox" in svg and "width" not in svg for svg in seen.all("svg"))
    assert len(Seen(pictures[0]).all("style")) == 0, "its style would apply to the whole page"


def test_scripts_of_a_picture_are_removed():
    svg = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1 1"><script>alert(1)</script><g id="a"/></svg>'
    assert_harmless(html.inline_svg(svg, "x", "nothing"))
