"""Notebooks as pages, without running them, and the gallery of the lessons."""

import json
import re
from pathlib import Path

from docutils import nodes
from myst_parser.parsers.sphinx_ import MystParser
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

CARD = re.compile(
    r'<a href="(?P<notebook>[^"]+)"><img src="(?P<picture>[^"]+)" width="\d+" alt="(?P<alt>[^"]+)"></a><br>\s*'
    r"<a [^>]+><b>(?P<title>[^<]+)</b></a><br>\s*(?P<question>[^<]+)</td>"
)
"""One lesson in the tables of ``notebooks/index.ipynb``."""


NOTE = """:::{{note}}
This page shows the text and the code of a notebook, without results. `walkerlab lab` opens all lessons; or
{{download}}`download this notebook <{name}>`.
:::"""
"""Text below the title of each notebook."""


class NotebookParser(MystParser):
    """Parser of notebooks: text cells are Markdown, and code cells become blocks of code; there are no outputs."""

    supported = ("notebook",)

    def parse(self, inputstring: str, document: nodes.document) -> None:
        """Parse the text of a notebook file into a document, with a picture and a note below its title."""
        path = Path(self.env.doc2path(self.env.docname))
        title, *cells = _demote_headings(list(map(_cell_text, json.loads(inputstring)["cells"])))
        heading, _, introduction = title.partition("\n")
        picture = Path("pictures", f"{path.stem}.png")
        pictures = [f"![The picture of this lesson]({picture.as_posix()})"] if (path.parent / picture).exists() else []
        note = NOTE.format(name=path.name)
        super().parse("\n\n".join([heading, *pictures, introduction, note, *cells]), document)


def _demote_headings(cells: list[str]) -> list[str]:
    """Make all headings but the first one level lower if there are several of the first level."""
    if sum(cell.startswith("# ") for cell in cells) < 2:
        return cells
    return [cells[0], *(re.sub(r"^(?=#+ )", "#", cell) for cell in cells[1:])]


class LessonGallery(SphinxDirective):
    """Show the pictures and questions of the lessons, which are read from the index notebook."""

    def run(self) -> list[nodes.Node]:
        """Return the headings and the cards."""
        path = Path(self.env.srcdir, "notebooks", "index.ipynb")
        self.env.note_dependency(path)
        cells = ["".join(cell["source"]) for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]]
        sections = [(text.partition("\n")[0], list(CARD.finditer(text))) for text in cells if "<table>" in text]
        lines: list[str] = []
        for heading, cards in sections:
            if not cards:
                raise self.error(f"there is no lesson under {heading!r} in {path.name}")
            lines += [heading, "", ":::::{container} gallery", *map(_card_text, cards), ":::::", ""]
        return self.parse_text_to_nodes("\n".join(lines), allow_section_headings=True)


def _cell_text(cell: dict[str, list[str] | str]) -> str:
    text = "".join(cell["source"])
    return f"````python\n{text}\n````" if cell["cell_type"] == "code" else text


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
