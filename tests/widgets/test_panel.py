"""The whole panel in a real browser, used by mouse and by keyboard."""

import os
import re
from pathlib import Path

import pandas as pd

import walkerlab as wl
from tests.frontends import book, find_errors, finish_all, open_notebook, run_all, start_all
from tests.reach import beyond_keyboard, unnamed_controls
from tests.widgets.test_frontends import ECHO, LONG, check_component, press

PANEL = """
from concurrent.futures import ThreadPoolExecutor
import walkerlab as wl
s = wl.Settings().with_(population_size=8, generations=99, duration=1)
lab = wl.Lab(s, executor=ThreadPoolExecutor(1))
lab
"""
# An export saves each picture in one format, which is faster.
ONE_FORMAT = """
from walkerlab.view.report import page, pictures
page.FORMATS = pictures.FORMATS = ("svg",)
"""
PLACED = ["form", "world", "transport", "walker", "curve", "run-list"]


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
    """Wait until the population shows the last generation of the paused run; it is drawn a moment later."""
    page.wait_for_function(
        """() => {
            const text = (name) => document.querySelector(name).textContent;
            const n = Number(text(".wl-transport .words").match(/Paused: (\\d+) of/)?.[1]);
            return text(".wl-population h4").startsWith(`Generation ${n - 1}:`);
        }""",
        timeout=60_000,
    )


def only_run(jupyter):
    """Return the run file that the panel has created."""
    [path] = (jupyter.folder / "lab").glob("*/run.walk")
    return path


def test_a_student_evolves_a_walker(page, jupyter):
    open_panel(page, jupyter, "JupyterLab", ONE_FORMAT)
    says(page, "99 generations of 8 robots")
    page.locator(".wl-lab").evaluate("panel => { panel.dataset.is = 'the first view'; }")
    assert page.locator(".wl-snapshot").is_hidden()

    # settings, by slider and by keyboard
    page.get_by_role("tab", name="algorithm").click()
    generations = page.get_by_role("slider", name="generations")
    generations.focus()
    page.keyboard.press("ArrowLeft")
    page.locator(".wl-transport", has_not_text="99 generations of 8").wait_for()
    page.locator(".wl-form").get_by_role("spinbutton", name="generations").fill("50")
    says(page, "50 generations of 8 robots")
    page.get_by_role("tab", name="algorithm").focus()
    page.keyboard.press("ArrowLeft")
    assert page.get_by_role("tab", name="robot").get_attribute("aria-selected") == "true"

    # a run that is started, paused and continued
    before = positions(page)
    button(page, "Start").click()
    curve_says(page, "generations:")
    button(page, "Pause").click()
    says(page, "Paused:")
    n = int(re.search(r"Paused: (\d+) of", page.locator(".wl-transport .words").first.text_content()).group(1))
    picture(page, "paused")
    button(page, "One generation").click()
    says(page, re.compile(rf"Paused: (?!{n} )\d+ of"))
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
    reopened = page.context.new_page()  # its console reports a lost connection and a missing widget
    reopened.goto(jupyter.address_of("book.ipynb", stem="reopened"))
    says(reopened, "Stopped:")
    reopened.evaluate("jupyterapp.shell.currentWidget.sessionContext.session.kernel.restart()")
    says(reopened, "Python was restarted")
    assert reopened.locator(".wl-transport button:enabled").count() == 0
    picture(reopened, "disconnected")
    jupyter.end_kernels()
    reopened.reload()
    snapshot = reopened.locator(".wl-snapshot", has_text="Stopped:")
    snapshot.get_by_role("img", name="generations:").wait_for(timeout=30_000)
    reopened.get_by_text("Error displaying widget").wait_for(state="hidden")
    picture(reopened, "reopened")


def test_every_control_has_a_name_and_works_by_keyboard_and_while_a_cell_is_running(page, jupyter, frontend):
    page.set_viewport_size({"width": 1280, "height": 800})
    over = jupyter.folder / "over"
    in_notebook = frontend != "Voila"
    cells = (LONG, "1 / 0", "2 + 2") if in_notebook else ("1 / 0",)
    open_notebook(page, jupyter.put(book(PANEL, ECHO, *cells), frontend))
    if in_notebook:
        start_all(page)
        assert press(page) < 1
        assert page.locator(".wl-echo output").inner_text() == "on another thread"
    button(page, "One generation").click(timeout=60_000)
    says(page, "Paused: 1 of")
    button(page, "Continue").click()
    page.locator(".wl-transport", has_text="Running: ").wait_for()
    button(page, "Pause").click()
    says(page, "Paused:")
    button(page, "Stop").click()
    says(page, "Stopped:")
    page.locator(".wl-population [role=option]").first.wait_for()
    if in_notebook:
        assert page.locator(".jp-InputPrompt", has_text="[*]").count() >= 1, "the cell is still running"
        over.touch()
    [error] = finish_all(page) if in_notebook else find_errors(page)
    assert "ZeroDivisionError: division by zero" in error
    check_component(page, in_notebook)
    # All tabs have the same kinds of control, so they are checked in one front end.
    for tab in ("terrain", "robot", "algorithm") if frontend == "JupyterLab" else ():
        page.get_by_role("tab", name=tab).click()
        assert unnamed_controls(page, ".wl-lab .wl-form") == []
        assert beyond_keyboard(page, ".wl-lab .wl-form") == []
    page.get_by_role("tab", name="simulation").click()
    assert unnamed_controls(page, ".wl-lab") == []
    assert beyond_keyboard(page, ".wl-lab") == []
    picture(page, frontend.replace(" ", "-"))


ONE_WORKER = """
import os
os.environ["LOKY_MAX_CPU_COUNT"] = "1"
"""
N_WORKERS = """
from pathlib import Path
import os, time

def workers():
    names = (p.read_bytes() for p in Path("/proc").glob("[0-9]*/cmdline")
             if f" {os.getpid()} " in (p.parent / "stat").read_text()[:60])
    return sum(b"LokyProcess" in name for name in names)
"""


def test_a_panel_is_closed_by_its_cell_or_by_code_while_it_runs(page, jupyter):
    wait = "while not (lab.run and lab.run.n_generations and over.exists()):\n    time.sleep(0.1)"
    end = "lab.close()\nend = time.monotonic() + 20\nwhile workers() and time.monotonic() < end:\n    time.sleep(0.2)\n"
    cells = (
        "over = Path('over')\n" + wait,
        "assert workers() > 0, 'the panel has workers'",
        f"{end}assert not workers()",
    )
    panel = ONE_WORKER + PANEL.replace(", executor=ThreadPoolExecutor(1)", "") + N_WORKERS.replace("\n\n", "\n") + "lab"
    page.set_viewport_size({"width": 1280, "height": 800})
    open_notebook(page, jupyter.put(book(panel, *cells)))
    page.locator(".jp-Cell .jp-InputArea-editor").first.click()
    page.keyboard.press("Control+Enter")
    button(page, "Start").click(timeout=60_000)
    curve_says(page, "generations:")

    # the cell runs again: the new panel takes over the run, which continues
    start_all(page)
    page.wait_for_function("document.querySelectorAll('.wl-transport').length === 1")
    curve_says(page, "generations:")
    page.locator(".wl-transport", has_text=re.compile(r"Running: [1-9]\d* of 99")).wait_for(timeout=60_000)
    path = only_run(jupyter).relative_to(jupyter.folder)

    # the run is removed from the list, and can be loaded
    button(page, "Stop").click()
    page.get_by_role("button", name="remove run 1 from the list").click()
    button(page, "Remove", ".wl-run-list").click()
    page.get_by_label("run file to load").select_option(str(path))
    button(page, "Load", ".wl-drawer").click()
    says(page, "Loaded", ".wl-drawer")
    button(page, "Use these settings", ".wl-drawer").click()
    says(page, "The form now has", ".wl-drawer")
    curve_says(page, "generations:")

    # a later cell closes it
    button(page, "Start").click()
    page.locator(".wl-transport", has_text=re.compile(r"Running: [1-9]\d* of 99")).wait_for(timeout=60_000)
    (jupyter.folder / "over").touch()
    assert finish_all(page) == []
    page.locator(".wl-transport").wait_for(state="detached")


FAULTY = """
calls = []
def bad(genomes, genes, *, rng):
    calls.append(1)
    return genomes + (undefined if len(calls) > 4 else 0)
other = wl.Lab(s.with_(seed=3, mutation=bad, generations=6), executor=ThreadPoolExecutor(1))
other
"""


def test_two_panels_in_one_notebook_are_independent_even_if_a_user_function_fails(page, jupyter):
    open_panel(page, jupyter, "JupyterLab", FAULTY.strip())
    first, second = (page.locator(".wl-lab").nth(i) for i in (0, 1))

    # invalid settings disable the start button of their panel
    first.get_by_role("tab", name="algorithm").click()
    first.get_by_role("spinbutton", name="elites").fill("8")
    first.locator(
        ".wl-transport", has_text="Cannot start. Elites is 8; it must be less than population size"
    ).wait_for()
    assert button(first, "Start").is_disabled()
    assert button(first, "One generation").is_disabled()
    assert button(second, "Start").is_enabled()
    first.locator(".wl-form", has_text="Elites is 8; it must be less than population size").wait_for()
    picture(page, "fault")
    first.get_by_role("spinbutton", name="elites").fill("2")
    first.locator(".wl-transport", has_not_text="Cannot start").wait_for()
    assert button(first, "Start").is_enabled()

    # each has its own run
    for panel in (first, second):
        button(panel, "One generation").click()
        panel.locator(".wl-transport", has_text="Paused: 1 of").wait_for(timeout=60_000)
    button(first, "Continue").click()
    first.locator(".wl-transport", has_text=re.compile(r"Running: \d+ of 99")).wait_for(timeout=60_000)
    assert second.locator(".wl-transport", has_text="Paused: 1 of").count() == 1  # although it is not visible
    button(first, "Stop").click()
    first.locator(".wl-transport", has_text="Stopped").wait_for()

    # an error in a user function is reported with how to resume
    button(second, "Continue").click()
    second.locator(".wl-transport", has_text="mutation 'bad' raised NameError").wait_for(timeout=60_000)
    assert "(line 4), while making generation 3" in second.locator(".wl-transport").inner_text()
    drawer = second.locator(".wl-drawer")
    drawer.get_by_text(re.compile(r"run = wl.resume\('lab.+run.walk', mutation=bad\)")).wait_for()
    drawer.scroll_into_view_if_needed()
    assert drawer.evaluate("one => one.scrollHeight <= one.clientHeight"), "the message is not cut off"
    assert first.locator(".wl-transport", has_text="Stopped").count() == 1  # although it is not visible
    picture(page, "fault")
