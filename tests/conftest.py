"""How hypothesis draws: the same examples on every machine, unless asked: pytest --hypothesis-profile explore.

And a browser for the tests that look at a page, and a Jupyter for those that look at a notebook.
"""

import importlib.util
import os
import shutil
import signal
import sys

import pytest
from hypothesis import HealthCheck, settings

from tests.frontends import PACKAGES, is_ours, serving

on_shared_machines = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("repeatable", derandomize=True, database=None, print_blob=True, **on_shared_machines)
settings.register_profile("explore", max_examples=1000, **on_shared_machines)
settings.load_profile("repeatable")

# A shell that starts something in the background has it ignore Ctrl-C; the tests of Ctrl-C must hold there too.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def lacking(what):
    """Skip a test for want of a part of the system; where everything is to be tested, that is a failure."""
    (pytest.fail if os.environ.get("CI") else pytest.skip)(f"no {what} on this machine")


@pytest.fixture(scope="session")
def browser():
    """A Chromium that draws WebGL in software."""
    playwright, chromium = pytest.importorskip("playwright.sync_api"), shutil.which("chromium")
    if not chromium:
        lacking("chromium")
    flags = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with playwright.sync_playwright() as running:
        started = running.chromium.launch(executable_path=chromium, args=flags)
        yield started
        started.close()


@pytest.fixture
def page(browser):
    """A new page of 900 × 500 pixels, of which the console must not complain of anything."""
    context = browser.new_context(viewport={"width": 900, "height": 500})
    opened, complaints = context.new_page(), []

    def hear(complaint):
        if is_ours(complaint, opened.url):
            complaints.append(complaint)

    def hear_console(message):
        if message.type in ("error", "warning"):
            hear(f"{message.text} {message.location.get('url', '')}")

    opened.on("console", hear_console)
    opened.on("pageerror", lambda error: hear(str(error)))
    yield opened
    context.close()
    assert not complaints


@pytest.fixture(scope="session")
def server(tmp_path_factory):
    """A Jupyter server, started once."""
    if not importlib.util.find_spec("jupyterlab"):
        lacking("jupyterlab")
    with serving(tmp_path_factory.mktemp("jupyter")) as started:
        yield started


@pytest.fixture
def jupyter(server):
    """A Jupyter server on which nothing runs or lies: jupyter.put(book("1 + 1")) is the address of a notebook."""
    server.clear()
    return server


@pytest.fixture(params=PACKAGES)
def frontend(request):
    """The name of a front end: a test that asks for it is made in each."""
    if not importlib.util.find_spec(PACKAGES[request.param]):
        lacking(request.param)
    return request.param


@pytest.fixture(autouse=True)
def close_figures():
    """Close the pyplot figures that a test has left open."""
    yield
    if pyplot := sys.modules.get("matplotlib.pyplot"):
        pyplot.close("all")
