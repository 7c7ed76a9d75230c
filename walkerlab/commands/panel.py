"""The picture of the panel in README.

    python -m walkerlab.commands.panel data/panel.png

Needs the extra ``test`` and Chromium, for it is a photograph: of the panel in a page, after two runs.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from socket import socket

from PIL import Image

from walkerlab.system.files import file_path, replacing

PANEL = """import walkerlab as wl
lab = wl.Lab(wl.Settings().with_(generations=20, seed=3))
lab"""
SIZE = (1180, 1650)  # pixels of the page
COLOURS = 200  # of the file, which is to be small


def photograph(path: Path) -> None:
    """Open a panel, let it run with small and with large mutations, and take its picture."""
    from playwright.sync_api import sync_playwright

    with served(PANEL) as address, sync_playwright() as running:
        flags = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        browser = running.chromium.launch(executable_path=shutil.which("chromium"), args=flags)
        page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
        page.goto(address, timeout=120_000)
        transport = page.locator(".wl-transport")
        for mutation in ("micro", "randomized"):
            page.get_by_role("tab", name="algorithm").click(timeout=120_000)
            page.get_by_role("combobox", name="mutation").first.select_option(mutation)
            transport.get_by_role("button", name="Start", exact=True).click()
            transport.filter(has_text="walks:").wait_for(timeout=120_000)
            transport.filter(has_text="Finished").wait_for(timeout=600_000)
        page.get_by_role("tab", name="terrain").click()
        page.wait_for_timeout(5000)
        page.mouse.move(0, 0)
        end = page.locator(".wl-robot").bounding_box()
        assert end
        picture = page.screenshot(clip={"x": 0, "y": 0, "width": SIZE[0], "height": end["y"]})
        browser.close()
    with replacing(path) as part:
        Image.open(BytesIO(picture)).convert("RGB").quantize(COLOURS).save(part, "PNG", optimize=True)


@contextmanager
def served(source: str) -> Generator[str]:
    """Show a notebook of one cell as a page, by Voila; yields its address."""
    cell = {"cell_type": "code", "metadata": {}, "source": source, "outputs": [], "execution_count": None}
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    with socket() as probe, tempfile.TemporaryDirectory() as folder:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
        probe.close()
        book = Path(folder) / "panel.ipynb"
        book.write_text(json.dumps({"nbformat": 4, "nbformat_minor": 4, "metadata": kernel, "cells": [cell]}))
        command = [sys.executable, "-m", "voila", "--no-browser", f"--port={port}", "--Voila.ip=127.0.0.1", book.name]
        server = subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True)
        assert server.stderr
        for line in server.stderr:  # which says when it listens
            if f":{port}" in line:
                break
        try:
            yield f"http://127.0.0.1:{port}"
        finally:
            server.terminate()
            server.wait(20)


if __name__ == "__main__":
    photograph(file_path(sys.argv[1]))
