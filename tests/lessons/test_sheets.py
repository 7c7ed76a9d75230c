"""Each sheet is one page."""

import re
from contextlib import nullcontext
from pathlib import Path

import pytest

from walkerlab.lessons import sheets
from walkerlab.lessons.exercises import LessonError

SHEETS = sorted((Path(__file__).parents[2] / "notebooks" / "teacher" / "sheets").glob("*.md"))
PAGE = re.compile(rb"/Type\s*/Page\b")


def test_each_sheet_fits_one_page(tmp_path, page, monkeypatch):
    long, short = tmp_path / "long.md", tmp_path / "short.md"
    long.write_text("# Long\n\n" + "A line.\n\n" * 200)
    short.write_text("# Short\n\n| a | b |\n|---|---|\n| 1 | |\n\n____\n")
    monkeypatch.setattr(sheets, "_open_page", lambda: nullcontext(page))
    monkeypatch.setattr("sys.argv", ["sheets", *map(str, [tmp_path / "pdf", *SHEETS, long, short])])
    sheets.main()
    n_pages = {path.stem: len(PAGE.findall(path.read_bytes())) for path in (tmp_path / "pdf").glob("*.pdf")}
    assert n_pages.pop("long") > 1
    assert n_pages == dict.fromkeys([path.stem for path in SHEETS] + ["short"], 1)


def test_a_missing_sheet_is_reported():
    with pytest.raises(LessonError, match="no sheet"):
        sheets.print_sheets([], Path("unused"))
