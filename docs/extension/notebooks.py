"""Notebooks as pages, without running them, and the gallery of the lessons."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

from docutils import nodes
from myst_parser.parsers.sphinx_ import MystParser
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

INDEX = "notebooks/index.ipynb"  # path in the repository

CARD = re.compile(
    r'<a href="(?P<notebook>[^"]+)"><img src="(?P<picture>[^"]+)" width="\d+" alt="(?P<alt>[^"]+)"></a><br>\s*'
    r"<a [^>]+><b>(?P<title>[^<]+)</b></a><br>\s*(?P<question>[^<]+)</td>"
)
"""One lesson in the tables of ``notebooks/index.ipynb``."""


NOTE = """:::{{note}}
This page shows the text and the code of a notebook, without results. `walkerlab lab` opens the lessons in
JupyterLab. {{download}}`Download this notebook <{name}>`
:::"""
"""Text below the title of each notebook."""


class NotebookParser(MystParser):
    """Parser of notebooks: text cells are Markdown, and code cells become blocks of code; there are no outputs."""

    supported = ("notebook",)

    def parse(self, inputstring: str, document: nodes.document) -> None:
        """Parse the text of a notebook file into a document, with a picture and a note below its title."""
        environment = document.settings.env
        path = Path(environment.doc2path(environment.docname))
        title, *cells = _read_cells(inputstring)
        heading, _, introduction = title.partition("\n")
        cards = [card for _, cards in _read_gallery(Path(environment.srcdir)) for card in cards]
        pictures = [f"![{card['alt']}]({card['picture']})" for card in cards if card["notebook"] == path.name]
        note = NOTE.format(name=path.name)
        super().parse("\n\n".join([heading, *pictures, introduction, note, *cells]), document)


class LessonGallery(SphinxDirective):
    """Show the pictures and questions of the lessons, which are read from the index notebook."""

    def run(self) -> list[nodes.Node]:
        """Return the headings and the cards."""
        self.env.note_dependency(INDEX)
        lines: list[str] = []
        for heading, cards in _read_gallery(Path(self.env.srcdir)):
            if not cards:
                raise self.error(f"there is no lesson under {heading!r} in {INDEX}")
            lines += [heading, "", ":::::{container} gallery", *map(_card_text, cards), ":::::", ""]
        return self.parse_text_to_nodes("\n".join(lines), allow_section_headings=True)


def _read_gallery(root: Path) -> list[tuple[str, list[re.Match[str]]]]:
    """Return each heading of the index notebook with the lessons below it."""
    notebook = json.loads((root / INDEX).read_text(encoding="utf-8"))
    cells = ["".join(cell["source"]) for cell in notebook["cells"]]
    return [(text.partition("\n")[0], list(CARD.finditer(text))) for text in cells if "<table>" in text]


def _read_cells(notebook: str) -> Iterator[str]:
    """Yield the cells of a notebook as Markdown; each heading is at most one level below the one in front of it.

    If several headings have the first level, all but the first are one level lower, because a page has one title.
    """
    cells = [("".join(cell["source"]), cell["cell_type"]) for cell in json.loads(notebook)["cells"]]
    n_titles = sum(len(re.findall("^# ", text, re.MULTILINE)) for text, kind in cells if kind == "markdown")
    level = 0

    def lower(heading: re.Match[str]) -> str:
        nonlocal level
        level = min(len(heading[0]) + (level > 0 and n_titles > 1), level + 1)
        return "#" * level

    for text, kind in cells:
        yield (
            re.sub(r"^#+(?= )", lower, text, flags=re.MULTILINE) if kind == "markdown" else f"````python\n{text}\n````"
        )


def _card_text(card: re.Match[str]) -> str:
    target = f"/notebooks/{card['notebook']}"
    return (
        f"::::{{container}} card\n[![{card['alt']}](/notebooks/{card['picture']})]({target})\n\n"
        f"**[{card['title']}]({target})**\n\n{card['question']}\n::::"
    )


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the parser and the directive."""
    app.add_source_parser(NotebookParser)
    app.add_source_suffix(".ipynb", "notebook")
    app.add_directive("lesson-gallery", LessonGallery)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
