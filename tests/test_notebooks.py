"""The lessons run from top to bottom: the teacher's copies pass their checks, the students' copies pass none of them.

With WALKERLAB_SCREENSHOTS=<folder>, screenshots of all the cells of the students' copies in JupyterLab are saved there.
"""

import importlib.util
import itertools
import os
import re
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
SHORT_RUN = "generations = 2"
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
        assert output.get("name") != "stderr", output["text"]
        data = output.get("data", {})
        assert "Warning" not in data.get("text/plain", "") + output.get("text", "")
        if "image/png" in data:
            pixels = imread(BytesIO(b64decode(data["image/png"])))
            assert pixels[..., :3].std() > 0.01


def feedback_on_answers(outputs: list[dict[str, Any]]) -> list[str]:
    """Return the first word of the feedback of each check: right, not yet or empty."""
    texts = [output.get("data", {}).get("text/plain", "") for output in outputs]
    return [found[1] for text in texts if (found := re.match(r"(Right|Not yet|Empty)\. ", text))]


@each_of(TEACHERS)
def test_the_teachers_copy_passes_its_checks(path, tmp_path):
    notebook = shorten(path)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    cells = code_cells(notebook)
    outputs = [output for cell in cells for output in cell.outputs]
    assert_outputs_are_clean(outputs)
    n_checks = sum(cell.source.count("wl.lessons.check(") for cell in cells)
    assert feedback_on_answers(outputs) == ["Right"] * n_checks


SLIDERS = {
    "00_meet_a_walker": ("generations", ".wl-transport"),
    "01_bodies_and_genes": ("minimum legs", ".wl-world"),
    "02_the_ground": ("texture density", ".wl-world"),
}
"""One slider of some notebooks, and the selector of an element that changes when it moves."""


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


@each_of(STUDENTS)
def test_the_students_copy_runs_in_jupyterlab_and_no_empty_answer_is_right(path, page, jupyter):
    page.set_viewport_size({"width": 1280, "height": 800})
    assert run_all(page, jupyter.put(shorten(path), name=path.name), timeout=240) == []
    outputs = [output for cell in page.evaluate(OUTPUTS) for output in cell["outputs"]]
    assert_outputs_are_clean(outputs)
    assert "Right" not in feedback_on_answers(outputs)
    if path.stem in SLIDERS:
        assert_slider_has_effect(page, *SLIDERS[path.stem])
    if SCREENSHOT_FOLDER:
        picture_cells(page, Path(SCREENSHOT_FOLDER) / path.stem)
