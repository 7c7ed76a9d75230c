"""Fixtures for a browser and a Jupyter server, and the profiles of hypothesis.

By default, hypothesis draws the same examples on every machine; ``--hypothesis-profile explore`` draws others.
"""

import importlib.util
import os
import shutil
import signal
import sys

import pytest
from hypothesis import HealthCheck, settings

from tests.frontends import MAX_CONTEXTS, PACKAGES, is_ours, serving

on_shared_machines = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("repeatable", derandomize=True, database=None, print_blob=True, **on_shared_machines)
settings.register_profile("explore", max_examples=1000, **on_shared_machines)
settings.load_profile("repeatable")

# A process that a shell starts in the background ignores Ctrl-C; the tests of Ctrl-C must pass there too.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def skip_without(what):
    """Skip a test that needs a part of the system that is missing here; fail it if the variable CI is set."""
    (pytest.fail if os.environ.get("CI") else pytest.skip)(f"no {what} on this machine")


@pytest.fixture(scope="session")
def browser():
    """Start a Chromium that renders WebGL in software."""
    playwright = pytest.importorskip("playwright.sync_api")
    chromium = shutil.which("chromium")
    if not chromium:
        skip_without("chromium")
    flags = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    flags += [f"--max-active-webgl-contexts={MAX_CONTEXTS}"]
    with playwright.sync_playwright() as running:
        started = running.chromium.launch(executable_path=chromium, args=flags)
        yield started
        started.close()


@pytest.fixture
def page(browser):
    """Open a page of 900 × 500 pixels; errors and warnings in its console fail the test."""
    context = browser.new_context(viewport={"width": 900, "height": 500})
    opened = context.new_page()
    console_errors = []

    def add_error(text):
        if is_ours(text, opened.url):
            console_errors.append(text)

    def check_message(message):
        if message.type in ("error", "warning"):
            add_error(f"{message.text} {message.location.get('url', '')}")

    opened.on("console", check_message)
    opened.on("pageerror", lambda error: add_error(str(error)))
    yield opened
    context.close()
    assert not console_errors


@pytest.fixture(scope="session")
def server(tmp_path_factory):
    """Start a Jupyter server, once for all tests."""
    if not importlib.util.find_spec("jupyterlab"):
        skip_without("jupyterlab")
    with serving(tmp_path_factory.mktemp("jupyter")) as started:
        yield started


@pytest.fixture
def jupyter(server):
    """Return the Jupyter server, empty; jupyter.put(book("1 + 1")) returns the address of a notebook."""
    server.clear()
    return server


@pytest.fixture(params=PACKAGES)
def frontend(request):
    """Return the name of a front end; a test with this fixture runs in each of them."""
    if not importlib.util.find_spec(PACKAGES[request.param]):
        skip_without(request.param)
    return request.param


@pytest.fixture(autouse=True)
def close_figures():
    """Close all pyplot figures after each test."""
    yield
    if pyplot := sys.modules.get("matplotlib.pyplot"):
        pyplot.close("all")
