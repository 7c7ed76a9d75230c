"""The microscope, the selection wheel and the landscape work in JupyterLab, by mouse and by keyboard."""

from tests.frontends import book, run_all

WIDGETS = """
from concurrent.futures import ThreadPoolExecutor
import matplotlib.pyplot as plt
from ipywidgets import VBox
import walkerlab as wl
from walkerlab.widgets import ClickablePlot, Landscape, Microscope, SelectionWheel

s = wl.Settings().with_(duration=1)
genomes = [wl.Genome(values) for values in wl.generate_robot_population(s.robot, 2, seed=1)]
microscope, wheel = Microscope(genomes, s), SelectionWheel([1, 4, 2, 8])
with ThreadPoolExecutor(1) as pool:
    landscape = Landscape(wl.analysis.landscape(genomes[0], s, "frequency", 4, pool))
figure, axes = plt.subplots(layout="constrained")
axes.plot([1, 2], [3, 4], "o")
plot = ClickablePlot(axes, [(1, 3), (2, 4)], genomes, s, ["first", "second"])
plt.close(figure)
VBox([microscope, wheel, landscape, plot])
"""


def test_the_microscope_the_wheel_and_the_landscape_answer(page, jupyter):
    page.set_viewport_size({"width": 1280, "height": 800})
    assert run_all(page, jupyter.put(book(WIDGETS))) == []
    for name in ("microscope", "selection-wheel"):
        assert page.locator(f".wl-{name}").count() == 1
    assert page.locator(".wl-clickable-plot").count() == 2

    microscope = page.locator(".wl-microscope")
    assert microscope.locator("figure svg").count() == 3, "both parents and the child"
    microscope.get_by_label("Show").select_option("mutate")
    microscope.locator("figure.child", has_text="mutant").wait_for()
    before = microscope.locator(".genome").inner_html()
    microscope.get_by_role("button", name="Again").press("Enter")
    microscope.locator(".gene.changed").first.wait_for()
    page.wait_for_function(
        "before => document.querySelector('.wl-microscope .genome').innerHTML !== before", arg=before
    )

    wheel = page.locator(".wl-selection-wheel")
    wheel.get_by_label("selection").select_option("tournament")
    slider = wheel.get_by_role("slider")
    slider.press("ArrowRight")
    page.wait_for_function("() => document.querySelector('.wl-selection-wheel output').textContent === '4'")
    wheel.get_by_role("button", name="Spin").click()
    wheel.get_by_text("4 parents selected").wait_for()

    landscape = page.locator(".wl-clickable-plot").first
    label = landscape.locator(".label")
    assert "the genome itself" in label.inner_text()
    landscape.get_by_role("group").press("ArrowRight")
    assert "frequency" in label.inner_text()
    assert "the genome itself" not in label.inner_text()
    landscape.get_by_role("button", name="Play the fittest walk").click()
    page.locator(".wl-frame iframe, .wl-frame canvas").first.wait_for(state="attached")

    plot = page.locator(".wl-clickable-plot").nth(1)
    assert plot.locator(".label").inner_text() == "first"
    box = plot.locator("img").bounding_box()
    plot.locator("img").click(position={"x": 0.9 * box["width"], "y": 0.1 * box["height"]})
    assert plot.locator(".label").inner_text() == "second"
    page.locator(".wl-clickable-area").nth(1).locator("iframe, canvas").first.wait_for(state="attached")
