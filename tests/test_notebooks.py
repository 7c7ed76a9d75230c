"""The notebooks are short, ask before they tell, and run from top to bottom.

With WALKERLAB_SCREENSHOTS=<folder>, pictures of all their cells in JupyterLab are left there for people to look at.
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

from tests.conftest import lacking
from tests.frontends import picture_cells, run_all

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))
BUDGET = "generations = 2"
PICTURES = os.environ.get("WALKERLAB_SCREENSHOTS")

each_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def read(path: Path) -> nbformat.NotebookNode:
    return nbformat.read(path, as_version=4)


def code_cells(path: Path) -> list[nbformat.NotebookNode]:
    return [cell for cell in read(path).cells if cell.cell_type == "code"]


def n_lines(cell: nbformat.NotebookNode) -> int:
    return len([line for line in cell.source.splitlines() if line.strip()])


def test_there_is_a_notebook():
    assert NOTEBOOKS


@each_notebook
def test_it_is_valid_and_stripped(path):
    nbformat.validate(read(path))
    assert all(not cell.outputs and cell.execution_count is None for cell in code_cells(path))


@each_notebook
def test_its_cells_are_short_and_define_no_class(path):
    lengths = list(map(n_lines, code_cells(path)))
    assert median(lengths) <= 6
    assert max(lengths) <= 15
    assert not any(re.search(r"^\s*class ", cell.source, re.MULTILINE) for cell in code_cells(path))


@each_notebook
def test_a_question_stands_before_every_cell(path):
    cells = read(path).cells
    for before, cell in itertools.pairwise(cells):
        if cell.cell_type == "code":
            assert before.cell_type == "markdown"
            assert "?" in before.source


def shortened(path: Path) -> nbformat.NotebookNode:
    if path.stem == "05_cluster" and not importlib.util.find_spec("dask_jobqueue"):
        lacking("dask_jobqueue")
    notebook = read(path)
    [parameters] = [cell for cell in notebook.cells if "parameters" in cell.metadata.get("tags", [])]
    parameters.source, replaced = re.subn(r"^generations = \d+$", BUDGET, parameters.source, flags=re.MULTILINE)
    assert replaced == 1
    return notebook


@each_notebook
def test_it_runs_whole_with_a_small_budget(path, tmp_path):
    NotebookClient(shortened(path), timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()


SLIDERS = {
    "00_meet_a_walker": ("generations", ".wl-transport"),
    "01_terrain": ("texture density", ".wl-world"),
    "02_robot": ("least legs", ".wl-world"),
    "03_algorithm": ("elites", "[data-setting='algorithm.n_elites']"),
}
"""Of each notebook with sliders, one of them, and where it is to be seen that it was moved."""


def assert_a_slider_moves(page, name, seen):
    if page.get_by_role("tab", name="algorithm").count():
        page.get_by_role("tab", name="algorithm").click()
    shown, slider = page.locator(seen).first, page.get_by_role("slider", name=name, exact=True)
    slider.scroll_into_view_if_needed()
    before = shown.inner_html()
    slider.focus()
    for _ in range(2):
        page.keyboard.press("ArrowRight")
    page.wait_for_function(
        "([seen, before]) => document.querySelector(seen).innerHTML !== before", arg=[seen, before], timeout=20_000
    )


@each_notebook
def test_it_runs_whole_in_jupyterlab_and_its_sliders_move_what_they_say(path, page, jupyter):
    page.set_viewport_size({"width": 1280, "height": 800})
    assert run_all(page, jupyter.put(shortened(path), name=path.name)) == []
    if path.stem in SLIDERS:
        assert_a_slider_moves(page, *SLIDERS[path.stem])
    if PICTURES:
        picture_cells(page, Path(PICTURES) / path.stem)
