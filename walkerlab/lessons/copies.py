"""Script that makes the students' notebooks from those of the teacher, which contain the answers.

    python -m walkerlab.lessons.copies notebooks

reads ``notebooks/teacher/NN_name.ipynb`` and writes ``notebooks/NN_name.ipynb``. In the code, the lines from
``### BEGIN SOLUTION`` to ``### END SOLUTION``, the marks of nbgrader, are replaced by the text of the comments
``# student: …`` that follow the first mark. In the text, links to ``../file`` become links to ``file``, because the
copy is one folder higher. Cells with the tag ``answer`` or ``teacher``, and outputs, are left out.
"""

import argparse
import json
import re
import sys
from pathlib import Path
from typing import Any

from walkerlab.lessons.exercises import LessonError
from walkerlab.system.files import write_text

TEACHER_FOLDER = "teacher"
REMOVED_TAGS = {"answer", "teacher"}
BEGIN, END = "### BEGIN SOLUTION", "### END SOLUTION"
STUDENT_COMMENT = re.compile(r"(\s*)# student:(?: (.*))?$")
NO_ANSWER = "..."
PARENT_LINK = re.compile(r"""(\]\(|(?:href|src)=")\.\./""")

Notebook = dict[str, Any]


def student_copy(notebook: Notebook) -> Notebook:
    """Return the student copy of a teacher's notebook; the argument is not changed.

    Args:
        notebook: Notebook in format 4, as JSON data.

    Raises:
        LessonError: If a mark of a solution lacks its counterpart.
    """
    cells = [cell for cell in notebook["cells"] if not REMOVED_TAGS & {*cell["metadata"].get("tags", ())}]
    return {**notebook, "cells": [_student_cell(cell) for cell in cells]}


def split_solutions(source: str) -> tuple[list[str], list[str]]:
    """Return the lines of the student copy of a cell, and the lines of the solutions that it lacks.

    Raises:
        LessonError: If a mark of a solution lacks its counterpart.
    """
    copied: list[str] = []
    solutions: list[str] = []
    is_solution = is_replaced = False
    for line in source.splitlines():
        mark = line.strip()
        if mark in (BEGIN, END):
            if is_solution != (mark == END):
                raise LessonError(f"{mark} has no counterpart in the cell that begins {source.splitlines()[0]!r}.")
            if mark == END and not is_replaced:
                copied.append(line.replace(END, NO_ANSWER))
            is_solution, is_replaced = mark == BEGIN, False
        elif not is_solution:
            copied.append(line)
        elif comment := STUDENT_COMMENT.match(line):
            copied.append(f"{comment[1]}{comment[2] or ''}".rstrip())
            is_replaced = True
        else:
            solutions.append(line)
    if is_solution:
        raise LessonError(f"{BEGIN} has no counterpart in the cell that begins {source.splitlines()[0]!r}.")
    return copied, solutions


def read_notebook(path: Path) -> Notebook:
    """Read a notebook as JSON data."""
    return json.loads(path.read_text(encoding="utf-8"))


def notebook_text(notebook: Notebook) -> str:
    """Return the text of a notebook's file, as Jupyter writes it."""
    return json.dumps(notebook, indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def write_copies(folder: Path) -> list[Path]:
    """Write the student copy of each notebook in the folder ``teacher``; return the files written.

    Args:
        folder: Folder of the copies, which contains the folder ``teacher``.

    Raises:
        LessonError: If there is no notebook in it, or a mark of a solution lacks its counterpart.
    """
    sources = sorted((folder / TEACHER_FOLDER).glob("*.ipynb"))
    if not sources:
        raise LessonError(f"there is no notebook in {folder / TEACHER_FOLDER}.")
    copies = {folder / source.name: student_copy(read_notebook(source)) for source in sources}
    for path, copy in copies.items():
        write_text(path, notebook_text(copy))
    return list(copies)


def _student_cell(cell: dict[str, Any]) -> dict[str, Any]:
    source = "".join(cell["source"])
    if cell["cell_type"] != "code":
        return {**cell, "source": _split_lines(PARENT_LINK.sub(r"\1", source))}
    copied = "\n".join(split_solutions(source)[0])
    return {**cell, "source": _split_lines(copied), "outputs": [], "execution_count": None}


def _split_lines(text: str) -> list[str]:
    """Return a text as notebooks store it: lines with their ends."""
    return text.splitlines(keepends=True)


def main() -> None:
    """Parse the arguments, write the copies and print their paths."""
    parser = argparse.ArgumentParser(description="Make the students' notebooks from those of the teacher.")
    parser.add_argument(
        "folder",
        nargs="?",
        type=Path,
        default=Path("notebooks"),
        help=f"folder of the copies, which contains the folder {TEACHER_FOLDER} with the sources [notebooks]",
    )
    try:
        for written in write_copies(parser.parse_args().folder):
            print(written)
    except LessonError as error:
        sys.exit(f"Error: {error}")


if __name__ == "__main__":
    main()
