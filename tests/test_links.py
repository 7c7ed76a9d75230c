"""Every relative link of a notebook or a document leads to a file, and to a heading of it."""

import json
import re
from pathlib import Path
from urllib.parse import unquote

import pytest

ROOT = Path(__file__).parents[1]
NOTEBOOKS = ROOT / "notebooks"
DOCUMENTS = sorted(
    path
    for pattern in ("*.md", "docs/**/*.md", "notebooks/**/*.md", "notebooks/**/*.ipynb")
    for path in ROOT.glob(pattern)
    if ".ipynb_checkpoints" not in path.parts
)
LINK = re.compile(r"""\]\(<?([^)\s>]+)>?[^)]*\)|\b(?:href|src)="([^"]+)\"""")
CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.MULTILINE | re.DOTALL)
UNWRITTEN = "11_class_tournament"  # lesson that the index links to before it is written
EXTERNAL = re.compile(r"[a-z]+:")


def markdown(path):
    """Return the text of a document without its code."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".ipynb":
        cells = json.loads(text)["cells"]
        text = "\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
    return CODE.sub("", text)


def links(path):
    """Return the relative links of a document."""
    found = [unquote(one or other) for one, other in LINK.findall(markdown(path))]
    return [link for link in found if not EXTERNAL.match(link) and Path(link).stem != UNWRITTEN]


def anchors(path):
    """Return the anchors of the headings of a document, as GitHub forms them."""
    headings = re.findall(r"^#+ +(.+)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(path):
    """Return the links of a document that lead nowhere."""
    broken = []
    for link in links(path):
        name, _, anchor = link.partition("#")
        target = path.parent / name if name else path
        if not target.exists() and path.parent == NOTEBOOKS / "teacher":
            target = NOTEBOOKS / name
        if not target.exists() or (anchor and anchor not in anchors(target)):
            broken.append(link)
    return broken


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_every_link_leads_to_a_file_and_a_heading(path):
    assert broken_links(path) == []


def test_broken_links_are_found(tmp_path):
    (tmp_path / "b.md").write_text("# One & two\n")
    document = tmp_path / "a.md"
    document.write_text(
        '# Here\n[1](b.md#one--two) [2](b.md "title") [3](#here) [4](b.md#three) ![5](c.png) <img src="d.png">\n'
        "`[6](e.md)` [7](https://f/g.md)\n```\n[8](h.md)\n```\n"
    )
    assert broken_links(document) == ["b.md#three", "c.png", "d.png"]


def test_only_the_unwritten_lesson_is_excepted():
    assert not (NOTEBOOKS / f"{UNWRITTEN}.ipynb").exists(), "remove UNWRITTEN"


def test_links_are_found_in_the_lessons():
    assert sum(len(links(path)) for path in NOTEBOOKS.glob("*.ipynb")) > 20
