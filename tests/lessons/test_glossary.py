"""The glossary is up to date, and explains each term once."""

from pathlib import Path

from walkerlab.lessons.glossary import HEADING, MORE_TERMS, glossary_text
from walkerlab.settings.terms import TERMS

FILE = Path(__file__).parents[2] / "notebooks" / "glossary.md"


def test_the_glossary_is_up_to_date():
    text = FILE.read_text(encoding="utf-8")
    assert text == glossary_text(), "run python -m walkerlab.lessons.glossary notebooks/glossary.md"
    assert text.startswith(HEADING)


def test_no_term_has_two_explanations():
    assert not TERMS.keys() & MORE_TERMS.keys()
