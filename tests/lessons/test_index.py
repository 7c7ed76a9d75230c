"""The index shows every lesson with its title, its question and a small picture."""

import json
import re
from pathlib import Path

import pytest

from tests.text.test_html import Seen
from walkerlab.lessons.pictures import PICTURES
from walkerlab.text.templates import render

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "notebooks"
LESSONS = sorted(FOLDER.glob("[0-9]*.ipynb"))
MAX_PICTURE_SIZE = 30_000  # bytes
MAX_DATA_SIZE = 5_000_000  # bytes


def texts(path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown"]


@pytest.mark.parametrize("folder", [FOLDER, FOLDER / "teacher"], ids=["students", "teachers"])
def test_the_index_has_the_title_and_the_question_of_every_lesson(folder):
    index = "\n".join(texts(folder / "index.ipynb"))
    for lesson in LESSONS:
        first = texts(lesson)[0]
        title = re.search(r"^# (.+)$", first, re.MULTILINE)[1]
        question = " ".join(re.search(r"\*\*(.+?)\*\*", first, re.DOTALL)[1].split())
        assert f'<a href="{lesson.name}"><b>{title}</b></a><br>\n{question}</td>' in index


def test_only_teachers_are_shown_the_guides_and_sheets():
    names = {lesson.stem for lesson in LESSONS}
    teacher = texts(FOLDER / "teacher" / "index.ipynb")[-1]
    assert names <= set(re.findall(r"\(guides/(.+?)\.md\)", teacher)) & set(
        re.findall(r"\(sheets/(.+?)\.md\)", teacher)
    )
    assert teacher not in texts(FOLDER / "index.ipynb")


def test_every_picture_is_described_small_and_drawn_by_the_script():
    files = {path.stem: path for path in (FOLDER / "pictures").glob("*")}
    described = dict(
        re.findall(r'src="pictures/(.+?)\.png" width="200" alt="(.+?)"', "\n".join(texts(FOLDER / "index.ipynb")))
    )
    assert files.keys() == PICTURES.keys() == described.keys() >= {lesson.stem for lesson in LESSONS}
    assert len(set(described.values())) == len(described)
    assert all(path.suffix == ".png" and path.stat().st_size < MAX_PICTURE_SIZE for path in files.values())


@pytest.mark.parametrize("name", ["03_selection", "08_your_own_operator", "09_broken_operators"])
def test_a_picture_is_made_of_drawings_or_of_code(name):
    picture = PICTURES[name]()
    page = Seen(render("lessons/picture.html", picture=picture))
    assert len(page.all("img")) == len(picture.drawings)
    assert bool(picture.drawings) != bool(picture.code)
    assert picture.code in page.text


def test_the_data_of_the_lessons_is_small():
    assert sum(path.stat().st_size for path in (ROOT / "data").rglob("*") if path.is_file()) < MAX_DATA_SIZE
