"""How hypothesis draws: the same examples on every machine, unless asked: pytest --hypothesis-profile explore.

And a browser for the tests that look at a page.
"""

import os
import shutil
import signal

import pytest
from hypothesis import HealthCheck, settings

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
    opened.on("console", lambda message: message.type in ("error", "warning") and complaints.append(message.text))
    opened.on("pageerror", lambda error: complaints.append(str(error)))
    yield opened
    context.close()
    assert not complaints
