"""The lessons run from top to bottom: each answer of the teacher passes its check, and no gap does.

With WALKERLAB_SCREENSHOTS=<folder>, screenshots of all the cells of the students' copies in JupyterLab are saved there.
"""

import importlib.util
import itertools
import os
import re
import shutil
from base64 import b64decode
from io import BytesIO
from pathlib import Path
from statistics import median
from typing import Any

import nbformat
import pytest
from matplotlib.image import imread
from nbclient import NotebookClient

from tests.conftest import skip_without
from tests.frontends import OUTPUTS, picture_cells, run_all

FOLDER = Path(__file__).parents[1] / "notebooks"
NOTEBOOKS = sorted(FOLDER.rglob("*.ipynb"))
"""Those of the teacher, which contain the answers, and the copies for students, which do not."""
TEACHERS = [path for path in NOTEBOOKS if path.parent.name == "teacher"]
STUDENTS = [path for path in NOTEBOOKS if path.parent == FOLDER]
LESSONS = [path for path in STUDENTS if path.stem != "index"]
SHORT_RUN = "generations = 2"
LOG_OF_DASK = re.compile(r"\S+ \S+ - distributed\.")  # lesson 12 kills a worker, which Dask sometimes logs
SCREENSHOT_FOLDER = os.environ.get("WALKERLAB_SCREENSHOTS")


def each_of(paths: list[Path]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("path", paths, ids=lambda path: str(path.relative_to(FOLDER).with_suffix("")))


def read_notebook(path: Path) -> nbformat.NotebookNode:
    return nbformat.read(path, as_version=4)


def code_cells(notebook: nbformat.NotebookNode) -> list[nbformat.NotebookNode]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def count_lines(cell: nbformat.NotebookNode) -> int:
    return len([line for line in cell.source.splitlines() if line.strip()])


def test_notebooks_are_found():
    assert len(TEACHERS) > 10
    assert {path.name for path in TEACHERS} <= {path.name for path in STUDENTS}


@each_of(NOTEBOOKS)
def test_notebook_is_valid_and_stripped(path):
    notebook = read_notebook(path)
    nbformat.validate(notebook)
    assert all(not cell.outputs and cell.execution_count is None for cell in code_cells(notebook))


@each_of(STUDENTS)
def test_cells_are_short_and_define_no_class(path):
    cells = code_cells(read_notebook(path))
    lengths = [count_lines(cell) for cell in cells] or [0]
    assert median(lengths) <= 6
    assert max(lengths) <= 15
    assert not any(re.search(r"^\s*class ", cell.source, re.MULTILINE) for cell in cells)


@each_of(STUDENTS)
def test_a_question_precedes_every_code_cell(path):
    cells = read_notebook(path).cells
    for previous, cell in itertools.pairwise(cells):
        if cell.cell_type == "code":
            assert previous.cell_type == "markdown"
            assert "?" in previous.source


def headings(notebook: nbformat.NotebookNode) -> list[str]:
    texts = [cell.source for cell in notebook.cells if cell.cell_type == "markdown"]
    return re.findall(r"^#+ .+$", "\n".join(texts), re.MULTILINE)


@each_of(LESSONS)
def test_every_lesson_has_the_same_form(path):
    """Title with one question, marked predictions, numbered exercises, a quiz, three lines and what comes next."""
    notebook = read_notebook(path)
    title, *others = headings(notebook)
    assert re.match(rf"{re.escape(title)}\n\n\*\*[^*]+\?\*\*\n\n", notebook.cells[0].source)
    assert title.startswith(f"# {path.stem[:2]} · ")
    assert all(re.match("###? ", heading) for heading in others)
    assert others[-3:] == ["## Quiz", "## In three lines", "## What next?"]
    assert len(re.findall(r"^\* ", notebook.cells[-1].source.partition("## What next?")[0], re.MULTILINE)) == 3
    checks = [number for cell in code_cells(notebook) for number in re.findall(r'\.check\("([\d.]+)"', cell.source)]
    assert re.findall(r"^###? Exercise ([\d.]+)(?:: .+)?$", "\n".join(others), re.MULTILINE) == checks
    for previous, cell in itertools.pairwise(notebook.cells):
        if re.search(r"^wl\.lessons\.(predict|choose)\(", cell.source, re.MULTILINE):
            assert re.search(r"\*\*Predict:\*\*\s", previous.source), cell.source


def shorten(path: Path) -> nbformat.NotebookNode:
    if path.stem == "12_a_bigger_computer" and not importlib.util.find_spec("dask_jobqueue"):
        skip_without("dask_jobqueue")
    notebook = read_notebook(path)
    parameters = [cell for cell in notebook.cells if "parameters" in cell.metadata.get("tags", [])]
    for cell in parameters:
        cell.source, replaced = re.subn(r"^generations = \d+$", SHORT_RUN, cell.source, flags=re.MULTILINE)
        assert replaced == 1
    assert len(parameters) <= 1
    return notebook


def assert_outputs_are_clean(outputs: list[dict[str, Any]]) -> None:
    """Raise an error if an output is a warning or a picture of one colour."""
    for output in outputs:
        if output.get("name") == "stderr":
            assert all(LOG_OF_DASK.match(line) for line in output["text"].splitlines()), output["text"]
        data = output.get("data", {})
        assert "Warning" not in data.get("text/plain", "") + output.get("text", "")
        if "image/png" in data:
            pixels = imread(BytesIO(b64decode(data["image/png"])))
            assert pixels[..., :3].std() > 0.01


def feedback_on_answers(outputs: list[dict[str, Any]]) -> list[str]:
    """Return the first word of the feedback of each check: right, not yet or empty."""
    texts = [output.get("data", {}).get("text/plain", "") for output in outputs]
    return [found[1] for text in texts if (found := re.match(r"(Right|Not yet|Empty)\. ", text))]


def with_answers(students: nbformat.NotebookNode, teachers: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """Return a student's copy in which each cell with a gap is followed by the teacher's cell."""
    of_teacher = {cell.id: cell for cell in teachers.cells}
    cells = []
    for cell in students.cells:
        answer = of_teacher[cell.id]
        cells += [cell] if cell.source == answer.source else [cell, {**answer, "id": f"{cell.id}-answer"}]
    return nbformat.from_dict({**students, "cells": cells})


@each_of(TEACHERS)
def test_no_gap_is_right_and_every_answer_of_the_teacher_is(path, tmp_path):
    notebook = with_answers(shorten(FOLDER / path.name), shorten(path))
    NotebookClient(notebook, timeout=240, resources={"metadata": {"path": str(tmp_path)}}).execute()
    cells = code_cells(notebook)
    assert_outputs_are_clean([output for cell in cells for output in cell.outputs])
    n_checks = 0
    for cell, following in itertools.pairwise([*cells, cells[-1]]) if cells else ():
        feedback = feedback_on_answers(cell.outputs)
        if following.id == f"{cell.id}-answer":
            assert "Right" not in feedback, cell.source
        elif "wl.lessons.check(" in cell.source:
            n_checks += 1
            assert feedback == ["Right"], cell.source
    assert n_checks == sum("wl.lessons.check(" in cell.source for cell in code_cells(read_notebook(path)))


SLIDERS = {
    "00_meet_a_walker": ("generations", ".wl-transport"),
    "01_bodies_and_genes": ("minimum legs", ".wl-world"),
    "02_the_ground": ("texture density", ".wl-world"),
}
"""One slider of some notebooks, and the selector of an element that changes when it moves."""

IN_JUPYTERLAB = {*SLIDERS, "04_crossover", "06_evolve_and_watch", "11_class_tournament", "index"}
"""Notebooks that contain, together, every kind of output; with WALKERLAB_SCREENSHOTS, all run in JupyterLab."""


def assert_slider_has_effect(page, name, selector):
    if page.get_by_role("tab", name="algorithm").count():
        page.get_by_role("tab", name="algorithm").click()
    element = page.locator(selector).first
    slider = page.get_by_role("slider", name=name, exact=True)
    slider.scroll_into_view_if_needed()
    before = element.inner_html()
    slider.focus()
    for _ in range(2):
        page.keyboard.press("ArrowRight")
    page.wait_for_function(
        "([selector, before]) => document.querySelector(selector).innerHTML !== before",
        arg=[selector, before],
        timeout=20_000,
    )


@each_of(STUDENTS if SCREENSHOT_FOLDER else [path for path in STUDENTS if path.stem in IN_JUPYTERLAB])
def test_the_students_copy_runs_in_jupyterlab(path, page, jupyter):
    page.set_viewport_size({"width": 1280, "height": 800})
    shutil.copytree(FOLDER / "pictures", jupyter.folder / "pictures")
    assert run_all(page, jupyter.put(shorten(path), name=path.name), timeout=240) == []
    outputs = [output for cell in page.evaluate(OUTPUTS) for output in cell["outputs"]]
    assert_outputs_are_clean(outputs)
    if path.stem in SLIDERS:
        assert_slider_has_effect(page, *SLIDERS[path.stem])
    if SCREENSHOT_FOLDER:
        picture_cells(page, Path(SCREENSHOT_FOLDER) / path.stem)
