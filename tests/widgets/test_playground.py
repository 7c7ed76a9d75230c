"""A playground in a notebook synchronises the genome of its sliders with Python."""

from tests.frontends import book, open_notebook, start_all
from walkerlab.commands.worlds import WALKER_GENOME as GENOME

CELLS = (
    f"import walkerlab as wl\nlive = wl.playground({GENOME!r}, wl.Settings().with_(duration=2))\nlive",
    "print('frequency', live.genome.values[1])",
    f"live.gene_text = {GENOME.replace('frequency=1.2', 'frequency=0.9')!r}",
)


def test_sliders_and_python_change_the_same_genome(page, jupyter):
    page.set_viewport_size({"width": 900, "height": 700})
    open_notebook(page, jupyter.put(book(*CELLS)))
    start_all(page)
    page.locator('.wl-playground button[title="Walk live"]').click(timeout=60_000)
    frame = page.locator(".wl-playground iframe").element_handle(timeout=30_000).content_frame()
    frame.wait_for_function("window.walkerlab && walkerlab.walks[0].time > 0.1", timeout=60_000)
    frame.wait_for_function("walkerlab.listeners.length === 1 && walkerlab.genome.includes('frequency=0.9')")
    frame.get_by_label("frequency").fill("1.7")
    page.locator(".jp-Cell").nth(1).click()
    page.keyboard.press("Control+Enter")
    page.get_by_text("frequency 1.7").wait_for()
    page.get_by_role("button", name="Close").last.click()
    assert page.locator("iframe").count() == 0
