"""Whatever text is put into HTML comes out as that text, and as nothing else."""

import re
from html.parser import HTMLParser

from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from walkerlab.text import html
from walkerlab.view import plots

HOSTILE = "</pre><script>alert(1)</script><img src=x onerror=alert(2)>\" onload='x'"

VOID = {"img", "meta", "br", "path", "use", "rect"}


class Seen(HTMLParser):
    """What a browser would make of a page: its elements, its text, and whether every element is closed in turn."""

    def __init__(self, html):
        super().__init__()
        self.elements, self.texts, self._open = [], [], []
        self.feed(html)
        self.close()
        assert not self._open, f"left open: {self._open}"

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in html.VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self._open, f"</{tag}> closes nothing"
        assert self._open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)

    @property
    def text(self):
        return "".join(self.texts)

    def all(self, tag):
        return [attributes for name, attributes in self.elements if name == tag]


def assert_harmless(html):
    """Nothing in it runs, nothing is loaded from anywhere, every picture can be heard; it is well-formed."""
    seen = Seen(html)
    assert not {tag for tag, _ in seen.elements} & {"script", "iframe", "object", "embed", "link", "base", "form"}
    for tag, attributes in seen.elements:
        assert not [name for name in attributes if name.startswith("on")]
        for name in ("src", "href", "xlink:href", "poster", "action"):
            where = attributes.get(name, "#")
            assert not re.match(r"\s*([a-z+.-]+:)?//|\s*(javascript|vbscript):", where, re.IGNORECASE), where
            assert not where.startswith("data:") or re.match(r"data:image/(png|svg\+xml);base64,", where)
            assert not where.startswith("data:image/svg") or tag == "img", "in an image, no script of an SVG runs"
        assert tag != "img" or attributes.get("alt")
        assert tag != "svg" or (attributes.get("role") == "img" and attributes.get("aria-label"))
    assert not re.search(r"@import|url\((?!#)", html)
    ids = [attributes["id"] for _, attributes in seen.elements if "id" in attributes]
    assert len(ids) == len(set(ids))
    for wanted in re.findall(r'(?:href="|url\()#([^")]*)', html):
        assert wanted in ids
    return seen


@given(st.text(), st.text())
def test_any_text_stays_text(text, other):
    page = html.tag("p", text, html.tag("b", other, title=text), class_=other)
    seen = Seen(page)
    assert [tag for tag, _ in seen.elements] == ["p", "b"]
    assert seen.all("b") == [{"title": _read(text)}]
    assert seen.text == _read(text) + _read(other)


def _read(text):
    """A parser of HTML takes some characters for others."""
    return _Echo.of(text)


class _Echo(HTMLParser):
    @classmethod
    def of(cls, text):
        echo = cls()
        echo.found = ""
        echo.handle_data = lambda data: setattr(echo, "found", echo.found + data)
        echo.feed(text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;"))
        echo.close()
        return echo.found


def test_every_piece_escapes_what_it_is_given():
    h = HOSTILE
    pieces = [
        html.table(h, [h, h], [[h, h]], groups=[(h, 2)], classes=["strong"]),
        html.facts(h, [(h, h)]),
        html.details(h, h),
        html.code(h),
    ]
    seen = assert_harmless(html.page(h, "", *pieces))
    assert seen.text.count(HOSTILE) == 6 + 3 + 2 + 1 + 1  # of each piece, and of the page's title
    assert_harmless(html.shown(*pieces, h))


def test_a_table_has_a_caption_and_headers_that_say_what_of():
    seen = Seen(html.table("Robots", ["robot", "mass"], [[1, 2.5], [2, 3.5]], numbers=(1,), classes=["", "faint"]))
    assert len(seen.all("caption")) == 1
    assert [cell["scope"] for cell in seen.all("th")] == ["col", "col", "row", "row"]
    assert [row.get("class") for row in seen.all("tr")] == [None, None, "faint"]
    assert all(cell["class"] == "number" for cell in seen.all("td"))


def test_a_page_says_its_language_and_title_and_lets_nothing_in():
    page = html.page("A title", "")
    seen = assert_harmless(page)
    assert page.startswith("<!doctype html>")
    assert seen.all("html") == [{"lang": "en"}]
    policy = next(one["content"] for one in seen.all("meta") if one.get("http-equiv") == "Content-Security-Policy")
    assert policy.startswith("default-src 'none'")
    assert not html.Html(page).count("http:")


def test_two_pictures_on_a_page_keep_their_own_parts(tmp_path):
    pictures = []
    for name in ("one", "two"):
        axes = Figure(figsize=(3, 2)).add_subplot()
        axes.plot([0, 1], [0, 1], marker="o", clip_on=True)
        axes.set_title("<b>&amp;</b>")
        plots.save(axes, tmp_path / f"{name}.svg")
        pictures.append(html.inline_svg((tmp_path / f"{name}.svg").read_text(encoding="utf-8"), name, "a line < 2"))
    seen = assert_harmless(html.page("Two", "", *pictures))
    assert [svg["aria-label"] for svg in seen.all("svg")] == ["a line < 2"] * 2
    assert seen.text.count("<b>&amp;</b>") == 2
    assert all("viewbox" in svg and "width" not in svg for svg in seen.all("svg"))
    assert len(Seen(pictures[0]).all("style")) == 0, "or its style would be that of the whole page"


def test_what_would_run_in_a_picture_is_left_out():
    svg = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1 1"><script>alert(1)</script><g id="a"/></svg>'
    assert_harmless(html.inline_svg(svg, "x", "nothing"))
