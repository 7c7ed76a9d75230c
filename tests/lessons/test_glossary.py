"""The glossary is up to date, and every link of a lesson leads to one of its terms."""

import re
from pathlib import Path

from walkerlab.lessons.glossary import HEADING, MORE_TERMS, anchor, glossary_text
from walkerlab.settings.terms import TERMS

FOLDER = Path(__file__).parents[2] / "notebooks"


def test_the_glossary_is_up_to_date():
    text = (FOLDER / "glossary.md").read_text(encoding="utf-8")
    assert text == glossary_text(), "run python -m walkerlab.lessons.glossary notebooks/glossary.md"
    assert text.startswith(HEADING)


def test_every_link_leads_to_a_term_and_no_term_has_two_explanations():
    anchors = {anchor(name) for name in re.findall(r"^## (.+)$", glossary_text(), re.MULTILINE)}
    texts = [path.read_text(encoding="utf-8") for path in FOLDER.rglob("*.ipynb")]
    linked = {link for text in texts for link in re.findall(r"glossary\.md#([\w-]+)", text)}
    assert linked <= anchors
    assert not TERMS.keys() & MORE_TERMS.keys()
