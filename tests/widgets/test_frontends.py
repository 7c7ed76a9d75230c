"""Components work in JupyterLab, Notebook 7 and Voila, by mouse and by keyboard, also while a cell is running."""

from tests.frontends import book, finish_all, open_notebook, run_all, start_all
from tests.reach import beyond_keyboard, reached_by_keyboard, unnamed_controls

# A component with a button that Python answers and one of each kind of control.
ECHO = '''
import threading
from ipywidgets import VBox
from walkerlab.widgets.component import Component

class Echo(Component):
    _esm = """
    function render({ model, el }) {
        const root = document.createElement("div"), answer = document.createElement("output");
        root.className = "wl-component wl-echo";
        root.innerHTML = `<button>press</button>
            <label>step height <input type="range"></label>
            <label>camera <select><option>side<option>top</select></label>
            <label><input type="radio" name="ground" checked> flat</label>
            <label><input type="radio" name="ground"> stairs</label>
            <label>seed <input type="number"></label>`;
        root.append(answer);
        el.append(root);
        root.addEventListener("focusin", ({ target }) => target.setAttribute("data-lm-suppress-shortcuts", "true"));
        const button = root.querySelector("button");
        button.onclick = () => { root.dataset.pressed = performance.now(); model.send("press"); };
        model.on("msg:custom", text => {
            answer.textContent = text;
            root.dataset.waited = performance.now() - root.dataset.pressed;
        });
    }
    export default { render }"""

echo = Echo()
echo.on_msg(lambda *_: echo.send("on the cells' thread" if on_main() else "on another thread"))
on_main = lambda: threading.current_thread() is threading.main_thread()
VBox([echo])
'''

# A cell that runs until the file "over" exists.
LONG = """
from pathlib import Path
from time import sleep, monotonic

until = monotonic() + 60
while not Path("over").exists() and monotonic() < until:
    sleep(0.1)
"""


def press(page):
    """Press the button; return the time until Python's answer [s]."""
    echo = page.locator(".wl-echo")
    echo.wait_for(timeout=60_000)
    echo.evaluate("echo => delete echo.dataset.waited")
    page.get_by_role("button", name="press").click()
    page.locator(".wl-echo[data-waited]").wait_for()
    return float(echo.get_attribute("data-waited")) / 1000


def test_a_component_answers_by_mouse_and_keyboard_also_while_a_cell_is_running(page, jupyter, frontend):
    over = jupyter.folder / "over"
    in_notebook = frontend != "Voila"
    cells = (ECHO, LONG, "1 / 0", "2 + 2") if in_notebook else (ECHO,)
    open_notebook(page, jupyter.put(book(*cells), frontend))
    if in_notebook:
        start_all(page)
        assert press(page) < 1
        assert page.locator(".wl-echo output").inner_text() == "on another thread"
        assert page.locator(".jp-InputPrompt", has_text="[*]").count() >= 1, "the cell is still running"
        over.touch()
        [error] = finish_all(page)
        assert "ZeroDivisionError: division by zero" in error
    assert press(page) < 1

    assert unnamed_controls(page, ".wl-echo") == []
    assert beyond_keyboard(page, ".wl-echo") == []
    assert reached_by_keyboard(page, ".wl-echo").evaluate("reached => reached.length") == 5
    for name, key, expected in (
        ("step height", "ArrowDown", "49"),
        ("camera", "ArrowDown", "top"),
        ("seed", "ArrowUp", "1"),
    ):
        control = page.get_by_label(name)
        control.focus()
        page.keyboard.press(key)
        assert control.input_value() == expected
    page.get_by_label("flat").focus()
    page.keyboard.press("ArrowDown")
    assert page.get_by_label("stairs").is_checked()
    if in_notebook:
        page.get_by_role("button", name="press").focus()
        page.keyboard.press("x")
        assert page.locator(".jp-CodeCell").count() == len(cells), "in the notebook, x cuts the cell"


def test_an_error_of_a_cell_is_returned_by_voila(page, jupyter):
    [error] = run_all(page, jupyter.put(book("1 + 1", "1 / 0", "2 + 2"), "Voila"))
    assert "ZeroDivisionError: division by zero" in error


def test_unreachable_and_unnamed_controls_are_found(page):
    page.set_content(
        """<div id="panel"><button>named</button> <input type="range"> <button disabled></button>
        <span role="button" tabindex="0"></span> <button tabindex="-1">never</button> <button hidden></button>
        <div role="listbox"><i role="option" tabindex="0">a</i> <i role="option" tabindex="-1">b</i></div>
        <div role="slider" aria-label="by mouse only"></div> <label>flat <input type="radio" name="g"></label></div>"""
    )
    assert unnamed_controls(page, "#panel") == [
        '<input type="range">',
        '<button disabled="">',
        '<span role="button" tabindex="0">',
        '<div role="listbox">',
    ]
    assert beyond_keyboard(page, "#panel") == [
        '<button tabindex="-1"></button>',
        '<div role="slider" aria-label="by mouse only"></div>',
    ]
