"""The whole panel in a real browser, used by mouse and by keyboard."""

import os
import re
from pathlib import Path

import pandas as pd
import pytest

import walkerlab as wl
from tests.frontends import book, finish_all, open_notebook, run_all, start_all
from tests.reach import beyond_keyboard, unnamed_controls
from tests.widgets.test_frontends import LONG

PANEL = """
import walkerlab as wl
s = wl.Settings().with_(population_size=20, generations=60, duration=4)
lab = wl.Lab(s)
lab
"""
PLACED = ["form", "world", "transport", "walker", "curve", "run-list"]
IN_NOTEBOOKS = pytest.mark.parametrize("frontend", ["JupyterLab", "Notebook 7"])


def picture(page, name):
    """Save a screenshot of the page if WALKERLAB_SCREENSHOTS names a folder."""
    if folder := os.environ.get("WALKERLAB_SCREENSHOTS"):
        page.screenshot(path=Path(folder) / f"panel-{name}.png")


def open_panel(page, jupyter, frontend, *cells, panel=PANEL):
    page.set_viewport_size({"width": 1280, "height": 800})
    assert run_all(page, jupyter.put(book(panel, *cells), frontend)) == []
    page.locator(".wl-lab .wl-transport").first.scroll_into_view_if_needed()


def button(page, name, within=".wl-transport"):
    return page.locator(within).get_by_role("button", name=name, exact=True)


def says(page, words, within=".wl-transport"):
    page.locator(within, has_text=words).wait_for(timeout=60_000)


def curve_says(page, words):
    page.wait_for_function(
        "words => document.querySelector('.wl-curve svg')?.getAttribute('aria-label').includes(words)",
        arg=words,
        timeout=60_000,
    )


def positions(page):
    """Return the y of each component that is beside or above the runs, from the top of the panel [pixels]."""
    return page.locator(".wl-lab").first.evaluate(
        """(panel, names) => names.map((name) =>
            [name, panel.querySelector(`.wl-${name}`).getBoundingClientRect().y - panel.getBoundingClientRect().y])""",
        PLACED,
    )


def population_is_listed(page):
    """Wait until the population shows the generation that the transport names; it is drawn a moment later."""
    words = page.locator(".wl-transport .words").first.text_content()
    number = int(re.search(r"Paused: (\d+) of", words).group(1)) - 1
    page.locator(".wl-population h4", has_text=f"Generation {number}:").wait_for(timeout=60_000)


def only_run(jupyter):
    """Return the run file that the panel has created."""
    [path] = (jupyter.folder / "lab").glob("*/run.walk")
    return path


def test_a_student_evolves_a_walker(page, jupyter):
    open_panel(page, jupyter, "JupyterLab")
    says(page, "60 generations of 20 robots")
    page.locator(".wl-lab").evaluate("panel => { panel.dataset.is = 'the first view'; }")
    assert page.locator(".wl-snapshot").is_hidden()

    # settings, by slider and by keyboard
    page.get_by_role("tab", name="algorithm").click()
    generations = page.get_by_role("slider", name="generations")
    generations.focus()
    page.keyboard.press("ArrowLeft")
    page.locator(".wl-transport", has_not_text="60 generations of 20").wait_for()
    page.locator(".wl-form").get_by_role("spinbutton", name="generations").fill("50")
    says(page, "50 generations of 20 robots")
    page.get_by_role("tab", name="algorithm").focus()
    page.keyboard.press("ArrowLeft")
    assert page.get_by_role("tab", name="robot").get_attribute("aria-selected") == "true"

    # a run that is started, paused and continued
    before = positions(page)
    button(page, "Start").click()
    curve_says(page, "generations:")
    button(page, "Pause").click()
    says(page, "Paused:")
    at_rest = page.locator(".wl-transport .words").first.text_content()
    picture(page, "paused")
    button(page, "One generation").click()
    page.locator(".wl-transport", has_not_text=at_rest).wait_for()
    says(page, "Paused:")
    assert positions(page) == before

    # one robot: selected by keyboard, watched, inserted into the next generation
    population_is_listed(page)
    robots = page.locator(".wl-population [role=option]")
    robots.first.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    number = robots.nth(1).get_attribute("data-robot")
    says(page, f"Robot {number}", ".wl-robot")
    page.get_by_role("button", name="Play its walk").click()
    replay = page.locator(".wl-robot iframe").element_handle(timeout=30_000).content_frame()
    replay.wait_for_function("window.walkerlab && walkerlab.state.time > 0.1", timeout=30_000)
    picture(page, "replay")
    page.locator('button[title="Close the replay"]').click()
    page.get_by_role("button", name="Insert into the next generation").click()
    says(page, "The genome will be in generation", ".wl-robot")

    # stop, export and code
    button(page, "Continue").click()
    page.locator(".wl-transport", has_not_text="Paused").wait_for()
    button(page, "Stop").click()
    says(page, "Stopped:")
    button(page, "Export", ".wl-drawer").click()
    says(page, "Exported into the folder", ".wl-drawer")
    button(page, "Copy as code", ".wl-drawer").click()
    says(page, "Copied", ".wl-drawer")
    path = only_run(jupyter)
    records = wl.load(path).records
    namespace = {}
    exec(page.get_by_label("Python code that repeats this run").input_value(), namespace)
    pd.testing.assert_frame_equal(namespace["run"].records, records)
    assert {"report.html", "replay.html", "fitness.svg", "records.csv"} <= {one.name for one in path.parent.iterdir()}
    picture(page, "stopped")
    page.set_viewport_size({"width": 900, "height": 800})
    picture(page, "narrow")

    # the snapshot is up to date, and replaces the panel only without a kernel
    page.locator(".wl-snapshot", has_text="Stopped:").wait_for(state="attached")
    assert page.locator(".wl-snapshot").is_hidden()
    assert page.locator(".wl-lab[data-is='the first view']").count() == 1
    page.evaluate("jupyterapp.commands.execute('docmanager:save')")
    jupyter.end_kernels()
    reopened = page.context.new_page()  # its console reports a missing widget
    reopened.goto(jupyter.address_of("book.ipynb", stem="reopened"))
    snapshot = reopened.locator(".wl-snapshot", has_text="Stopped:")
    snapshot.get_by_role("img", name="generations:").wait_for(timeout=30_000)
    reopened.get_by_text("Error displaying widget").wait_for(state="hidden")
    picture(reopened, "reopened")


@IN_NOTEBOOKS
def test_it_answers_while_a_cell_is_running(page, jupyter, frontend):
    over = jupyter.folder / "over"
    open_notebook(page, jupyter.put(book(PANEL, LONG, "other = 6 * 7"), frontend))
    start_all(page)
    button(page, "Start").click()
    curve_says(page, "generations:")
    button(page, "Pause").click()
    says(page, "Paused:")
    button(page, "Stop").click()
    says(page, "Stopped:")
    assert page.locator(".jp-InputPrompt", has_text="[*]").count() >= 1, "the cell is still running"
    over.touch()
    assert finish_all(page) == []


def test_cells_run_during_a_run_and_a_closed_panel_is_removed(page, jupyter):
    wait = "import time\nwhile not (lab.run and lab.run.n_generations):\n    time.sleep(0.1)"
    n_workers = (
        "from pathlib import Path\nimport os\n\n"
        "def workers():\n"
        "    names = (p.read_bytes() for p in Path('/proc').glob('[0-9]*/cmdline') if "
        "f' {os.getpid()} ' in (p.parent / 'stat').read_text()[:60])\n"
        "    return sum(b'LokyProcess' in name for name in names)\n"
    )
    end = "lab.close()\nend = time.monotonic() + 20\nwhile workers() and time.monotonic() < end:\n    time.sleep(0.2)\n"
    cells = (f"{wait}\n{n_workers}", "assert workers() > 0, 'the panel has workers'", f"{end}assert not workers()")
    open_notebook(page, jupyter.put(book(PANEL, *cells)))
    start_all(page)
    button(page, "Start").click()
    assert finish_all(page) == []
    assert page.locator(".wl-transport").count() == 0


def test_every_control_has_a_name_and_is_reached_by_keyboard(page, jupyter, frontend):
    open_panel(page, jupyter, frontend, panel=PANEL.replace("duration=4", "duration=1"))
    says(page, "A new run:")
    button(page, "One generation").click()
    says(page, "Paused: 1 of")
    page.locator(".wl-population [role=option]").first.wait_for()
    for tab, part in (("terrain", ".wl-form"), ("robot", ".wl-form"), ("algorithm", ".wl-form"), ("simulation", "")):
        page.get_by_role("tab", name=tab).click()
        assert unnamed_controls(page, ".wl-lab") == []
        assert beyond_keyboard(page, f".wl-lab {part}") == []
    button(page, "Continue").click()
    curve_says(page, "generations:")
    button(page, "Stop").click()
    says(page, "Stopped:")
    picture(page, frontend.replace(" ", "-"))


def test_invalid_settings_disable_the_start_button(page, jupyter):
    open_panel(page, jupyter, "JupyterLab")
    page.get_by_role("tab", name="algorithm").click()
    page.get_by_role("spinbutton", name="elites").fill("20")
    says(page, "Cannot start. Elites is 20; it must be less than population size")
    assert button(page, "Start").is_disabled()
    assert button(page, "One generation").is_disabled()
    assert "Elites is 20; it must be less than population size" in page.locator(".wl-form").text_content()
    picture(page, "fault")
    page.get_by_role("spinbutton", name="elites").fill("2")
    page.locator(".wl-transport", has_not_text="Cannot start").wait_for()
    assert button(page, "Start").is_enabled()


def test_two_panels_in_one_notebook(page, jupyter):
    other = "other = wl.Lab(s.with_(seed=3))\nother"
    open_panel(page, jupyter, "JupyterLab", other)
    first, second = (page.locator(".wl-lab").nth(i) for i in (0, 1))
    for panel in (first, second):
        button(panel, "One generation").click()
        panel.locator(".wl-transport", has_text="Paused: 1 of").wait_for(timeout=60_000)
    button(first, "Continue").click()
    first.locator(".wl-transport", has_text=re.compile(r"Running: \d+ of 60")).wait_for(timeout=60_000)
    assert second.locator(".wl-transport", has_text="Paused: 1 of").count() == 1  # although it is not visible
    button(first, "Stop").click()
    first.locator(".wl-transport", has_text="Stopped").wait_for()
    assert button(second, "Continue").is_enabled()


def test_a_cell_that_runs_again_closes_its_earlier_panel(page, jupyter):
    open_panel(page, jupyter, "JupyterLab")
    button(page, "Start").click()
    curve_says(page, "generations:")
    page.locator(".jp-Cell .jp-InputArea-editor").first.click()
    page.keyboard.press("Control+Enter")
    says(page, "The earlier panel of this cell was closed")
    assert page.locator(".wl-transport").count() == 1
    assert button(page, "Start").is_enabled()
    page.get_by_label("run file to load").select_option(str(only_run(jupyter).relative_to(jupyter.folder)))
    button(page, "Load", ".wl-drawer").click()
    says(page, "Loaded", ".wl-drawer")
    button(page, "Use these settings", ".wl-drawer").click()
    curve_says(page, "generations:")


FAULTY = """
import walkerlab as wl
calls = []
def bad(genomes, genes, *, rng):
    calls.append(1)
    return genomes + (undefined if len(calls) > 4 else 0)
lab = wl.Lab(wl.Settings().with_(mutation=bad, population_size=8, generations=6, duration=1))
lab
"""


def test_an_error_in_a_user_function_is_reported_with_how_to_resume(page, jupyter):
    page.set_viewport_size({"width": 1280, "height": 800})
    assert run_all(page, jupyter.put(book(FAULTY), "JupyterLab")) == []
    page.locator(".wl-lab .wl-transport").first.scroll_into_view_if_needed()
    button(page, "Start").click()
    says(page, "mutation 'bad' raised NameError")
    says(page, "(line 5), while making generation 3")
    path = only_run(jupyter).relative_to(jupyter.folder)
    says(page, f"run = wl.resume('{path}', mutation=bad)", ".wl-drawer")
    drawer = page.locator(".wl-drawer").first
    drawer.scroll_into_view_if_needed()
    assert drawer.evaluate("one => one.scrollHeight <= one.clientHeight"), "the message is not cut off"
    picture(page, "fault")
