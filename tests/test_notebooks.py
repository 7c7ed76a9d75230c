"""The notebooks have short cells, a question before each cell, and run from top to bottom.

With WALKERLAB_SCREENSHOTS=<folder>, screenshots of all their cells in JupyterLab are saved in that folder.
"""

import importlib.util
import itertools
import os
import re
from pathlib import Path
from statistics import median

import nbformat
import pytest
from nbclient import NotebookClient

from tests.conftest import skip_without
from tests.frontends import picture_cells, run_all

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))
SHORT_RUN = "generations = 2"
SCREENSHOT_FOLDER = os.environ.get("WALKERLAB_SCREENSHOTS")

each_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def read_notebook(path: Path) -> nbformat.NotebookNode:
    return nbformat.read(path, as_version=4)


def code_cells(path: Path) -> list[nbformat.NotebookNode]:
    return [cell for cell in read_notebook(path).cells if cell.cell_type == "code"]


def count_lines(cell: nbformat.NotebookNode) -> int:
    return len([line for line in cell.source.splitlines() if line.strip()])


def test_notebooks_are_found():
    assert NOTEBOOKS


@each_notebook
def test_notebook_is_valid_and_stripped(path):
    nbformat.validate(read_notebook(path))
    assert all(not cell.outputs and cell.execution_count is None for cell in code_cells(path))


@each_notebook
def test_cells_are_short_and_define_no_class(path):
    lengths = list(map(count_lines, code_cells(path)))
    assert median(lengths) <= 6
    assert max(lengths) <= 15
    assert not any(re.search(r"^\s*class ", cell.source, re.MULTILINE) for cell in code_cells(path))


@each_notebook
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
    [parameters] = [cell for cell in notebook.cells if "parameters" in cell.metadata.get("tags", [])]
    parameters.source, replaced = re.subn(r"^generations = \d+$", SHORT_RUN, parameters.source, flags=re.MULTILINE)
    assert replaced == 1
    return notebook


@each_notebook
def test_notebook_runs_with_few_generations(path, tmp_path):
    NotebookClient(shorten(path), timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()


SLIDERS = {
    "00_meet_a_walker": ("generations", ".wl-transport"),
    "01_terrain": ("texture density", ".wl-world"),
    "02_robot": ("minimum legs", ".wl-world"),
    "03_algorithm": ("elites", "[data-setting='algorithm.n_elites']"),
}
"""One slider of each notebook that has any, and the selector of an element that changes when it moves."""


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


@each_notebook
def test_notebook_runs_in_jupyterlab_and_its_slider_has_an_effect(path, page, jupyter):
    page.set_viewport_size({"width": 1280, "height": 800})
    assert run_all(page, jupyter.put(shorten(path), name=path.name)) == []
    if path.stem in SLIDERS:
        assert_slider_has_effect(page, *SLIDERS[path.stem])
    if SCREENSHOT_FOLDER:
        picture_cells(page, Path(SCREENSHOT_FOLDER) / path.stem)
