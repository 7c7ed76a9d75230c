"""Each sheet is one page."""

import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import skip_without
from walkerlab.lessons.exercises import LessonError
from walkerlab.lessons.sheets import print_sheets

SHEETS = sorted((Path(__file__).parents[2] / "notebooks" / "teacher" / "sheets").glob("*.md"))
PAGE = re.compile(rb"/Type\s*/Page\b")


def test_each_sheet_fits_one_page(tmp_path):
    if not shutil.which("chromium") or not importlib.util.find_spec("playwright"):
        skip_without("chromium")
    long, short = tmp_path / "long.md", tmp_path / "short.md"
    long.write_text("# Long\n\n" + "A line.\n\n" * 200)
    short.write_text("# Short\n\n| a | b |\n|---|---|\n| 1 | |\n\n____\n")
    # in a new process, because the tests' own browser may be running in this one
    command = [sys.executable, "-m", "walkerlab.lessons.sheets", tmp_path / "pdf", *SHEETS, long, short]
    subprocess.run(command, check=True)
    n_pages = {path.stem: len(PAGE.findall(path.read_bytes())) for path in (tmp_path / "pdf").glob("*.pdf")}
    assert n_pages.pop("long") > 1
    assert n_pages == dict.fromkeys([path.stem for path in SHEETS] + ["short"], 1)


def test_a_missing_sheet_is_reported():
    with pytest.raises(LessonError, match="no sheet"):
        print_sheets([], Path("unused"))
