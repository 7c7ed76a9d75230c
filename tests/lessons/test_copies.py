"""Student copies follow from the teacher's notebooks, are up to date, and contain no answer."""

from pathlib import Path

import pytest

from walkerlab.lessons.copies import (
    REMOVED_TAGS,
    TEACHER_FOLDER,
    main,
    notebook_text,
    read_notebook,
    split_solutions,
    student_copy,
    write_copies,
)
from walkerlab.lessons.exercises import LessonError

FOLDER = Path(__file__).parents[2] / "notebooks"
SOURCES = sorted((FOLDER / TEACHER_FOLDER).glob("*.ipynb"))
MIN_ANSWER = 8  # characters; shorter lines, such as "else:", occur elsewhere too

each_source = pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.stem)


def test_a_solution_becomes_the_text_of_its_comments():
    lines = ["def f(x):", "    ### BEGIN SOLUTION", "    # student: y = ...", "    # student:", "    y = 3"]
    lines += ["    ### END SOLUTION", "    return y"]
    copied, solutions = split_solutions("\n".join(lines))
    assert copied == ["def f(x):", "    y = ...", "", "    return y"]
    assert solutions == ["    y = 3"]


def test_a_solution_without_a_comment_becomes_dots():
    assert split_solutions("### BEGIN SOLUTION\n3\n### END SOLUTION")[0] == ["..."]


@pytest.mark.parametrize("source", ["### BEGIN SOLUTION\n3", "3\n### END SOLUTION", "### BEGIN SOLUTION\n" * 2])
def test_a_mark_without_its_counterpart_is_reported(source):
    with pytest.raises(LessonError, match="has no counterpart"):
        split_solutions(source)


def test_copies_lack_tagged_cells_and_outputs_and_sources_are_unchanged(tmp_path):
    cell = {"cell_type": "code", "metadata": {}, "source": ["1"], "outputs": [1], "execution_count": 3}
    cells = [cell, {"cell_type": "markdown", "metadata": {"tags": ["answer"]}, "source": ["secret"]}]
    text = notebook_text({"cells": cells, "nbformat": 4})
    (tmp_path / TEACHER_FOLDER).mkdir()
    source = tmp_path / TEACHER_FOLDER / "00_a.ipynb"
    source.write_text(text)
    [path] = write_copies(tmp_path)
    assert read_notebook(path)["cells"] == [{**cell, "outputs": [], "execution_count": None}]
    assert source.read_text() == text


def test_links_lead_to_the_same_file_from_the_copy():
    links = '[a](../glossary.md#a) [b](glossary.md) [c](https://c/../d) <img src="../e.png">'
    cells = [
        {"cell_type": "markdown", "metadata": {}, "source": [links]},
        {"cell_type": "code", "metadata": {}, "source": ["wl.load('../walk')"], "outputs": [], "execution_count": None},
    ]
    text, code = student_copy({"cells": cells})["cells"]
    assert text["source"] == ['[a](glossary.md#a) [b](glossary.md) [c](https://c/../d) <img src="e.png">']
    assert code == cells[1]


def test_the_script_writes_copies_or_reports_an_error(tmp_path, monkeypatch, capsys):
    (tmp_path / TEACHER_FOLDER).mkdir()
    monkeypatch.setattr("sys.argv", ["copies", str(tmp_path)])
    with pytest.raises(SystemExit, match="there is no notebook in"):
        main()
    (tmp_path / TEACHER_FOLDER / "00_a.ipynb").write_text(notebook_text({"cells": []}))
    main()
    assert capsys.readouterr().out.strip() == str(tmp_path / "00_a.ipynb")
    monkeypatch.setattr("sys.argv", ["copies", "--help"])
    with pytest.raises(SystemExit):
        main()
    assert "folder of the copies" in capsys.readouterr().out


@each_source
def test_the_student_copy_is_up_to_date(source):
    expected = notebook_text(student_copy(read_notebook(source)))
    assert (FOLDER / source.name).read_text(encoding="utf-8") == expected, "run python -m walkerlab.lessons.copies"


@each_source
def test_the_student_copy_contains_no_answer(source):
    notebook = read_notebook(source)
    copy = student_copy(notebook)
    copied = {cell["id"]: "".join(cell["source"]) for cell in copy["cells"]}
    text = "\n".join(copied.values())
    assert "SOLUTION" not in text
    assert "# student:" not in text
    for cell in notebook["cells"]:
        content = "".join(cell["source"])
        if REMOVED_TAGS & {*cell["metadata"].get("tags", ())}:
            assert cell["id"] not in copied
            assert content.strip() not in text
            continue
        answers = [line.strip() for line in split_solutions(content)[1]]
        lines = [line.strip() for line in copied[cell["id"]].splitlines()]
        assert not [line for line in answers if len(line) >= MIN_ANSWER and line in lines]
