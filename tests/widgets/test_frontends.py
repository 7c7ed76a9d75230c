"""What a component must do in JupyterLab, Notebook 7 and Voila; ``test_panel`` checks it beside a panel."""

from tests.reach import beyond_keyboard, reached_by_keyboard, unnamed_controls
from walkerlab.widgets.component import load_script

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

# A cell that runs until the file "over" exists, or for a minute.
LONG = """
from pathlib import Path
from time import sleep, monotonic

until = monotonic() + 60
while not Path("over").exists() and monotonic() < until:
    sleep(0.1)
"""


def echo_button(page):
    return page.locator(".wl-echo").get_by_role("button", name="press", exact=True)


def press(page):
    """Press the button; return the time until Python's answer [s]."""
    echo = page.locator(".wl-echo")
    echo.wait_for(timeout=60_000)
    echo.evaluate("echo => delete echo.dataset.waited")
    echo_button(page).click()
    page.locator(".wl-echo[data-waited]").wait_for()
    return float(echo.get_attribute("data-waited")) / 1000


def check_component(page, in_notebook):
    """Check that a component answers, and that each kind of control works by keyboard."""
    assert press(page) < 1
    assert unnamed_controls(page, ".wl-echo") == []
    assert beyond_keyboard(page, ".wl-echo") == []
    assert reached_by_keyboard(page, ".wl-echo").evaluate("reached => reached.length") == 5
    for name, key, expected in (
        ("step height", "ArrowDown", "49"),
        ("camera", "ArrowDown", "top"),
        ("seed", "ArrowUp", "1"),
    ):
        control = page.locator(".wl-echo").get_by_label(name)
        control.focus()
        page.keyboard.press(key)
        assert control.input_value() == expected
    page.locator(".wl-echo").get_by_label("flat").focus()
    page.keyboard.press("ArrowDown")
    assert page.locator(".wl-echo").get_by_label("stairs").is_checked()
    if in_notebook:
        n_cells = page.locator(".jp-CodeCell").count()
        echo_button(page).focus()
        page.keyboard.press("x")
        assert page.locator(".jp-CodeCell").count() == n_cells, "in the notebook, x cuts the cell"


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


CELLS = """<div class="jp-Cell" id="above"><div class="widget"></div></div>
<div class="jp-Cell" id="panel"><div class="widget"></div></div><div class="jp-Cell jp-mod-active">next</div>"""
SHOW = """id => {
    const widget = document.querySelector(`#${id} .widget`);
    startInView(widget);
    widget.style.height = "900px";
}"""


def test_the_start_of_a_widget_is_shown_after_shift_enter_unless_the_user_scrolls(page):
    page.set_content(CELLS)
    page.add_script_tag(content=load_script())
    page.evaluate(
        "() => { window.shown = []; Element.prototype.scrollIntoView = function () { shown.push(this.id); }; }"
    )
    page.evaluate(SHOW, "above")  # the cell below is not active
    page.evaluate(SHOW, "panel")
    page.wait_for_function("shown.length")
    page.evaluate(SHOW, "panel")
    page.evaluate("window.dispatchEvent(new Event('wheel'))")
    page.evaluate(SHOW, "panel")
    page.wait_for_function("shown.length > 1")
    assert page.evaluate("shown") == ["panel", "panel"]
