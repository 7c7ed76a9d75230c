"""Script that draws the picture of the panel in README.

    python -m walkerlab.commands.panel data/panel.png

Requires the extra ``test`` and Chromium: the picture is a screenshot of the panel in a page after two runs.
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

from walkerlab.system.files import file_path, replace_atomically

PANEL_CODE = """import walkerlab as wl
lab = wl.Lab(wl.Settings().with_(generations=20, seed=3))
lab"""
PAGE_SIZE = (1180, 1650)  # pixels
N_COLOURS = 200  # number of colours, few for a small file


def draw_panel(path: Path) -> None:
    """Open the panel, run evolutions with small and with large mutations, and save a screenshot."""
    from playwright.sync_api import sync_playwright

    with serve_notebook(PANEL_CODE) as address, sync_playwright() as playwright:
        flags = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=flags)
        page = browser.new_page(viewport={"width": PAGE_SIZE[0], "height": PAGE_SIZE[1]})
        page.goto(address, timeout=120_000)
        transport = page.locator(".wl-transport")
        for mutation in ("micro", "randomized"):
            page.get_by_role("tab", name="algorithm").click(timeout=120_000)
            page.get_by_role("combobox", name="mutation").first.select_option(mutation)
            transport.get_by_role("button", name="Start", exact=True).click()
            transport.filter(has_text="Running").wait_for(timeout=120_000)
            transport.filter(has_text="Finished").wait_for(timeout=600_000)
        page.get_by_role("tab", name="terrain").click()
        page.wait_for_timeout(5000)
        page.mouse.move(0, 0)
        robot_box = page.locator(".wl-robot").bounding_box()
        assert robot_box
        screenshot = page.screenshot(clip={"x": 0, "y": 0, "width": PAGE_SIZE[0], "height": robot_box["y"]})
        browser.close()
    with replace_atomically(path) as temporary:
        Image.open(BytesIO(screenshot)).convert("RGB").quantize(N_COLOURS).save(temporary, "PNG", optimize=True)


@contextmanager
def serve_notebook(source: str) -> Generator[str]:
    """Serve a notebook with one cell as a page with Voila; yield its address."""
    cell = {"cell_type": "code", "metadata": {}, "source": source, "outputs": [], "execution_count": None}
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    with socket() as probe, tempfile.TemporaryDirectory() as folder:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
        probe.close()
        notebook = Path(folder) / "panel.ipynb"
        notebook.write_text(json.dumps({"nbformat": 4, "nbformat_minor": 4, "metadata": kernel, "cells": [cell]}))
        command = [
            sys.executable,
            "-m",
            "voila",
            "--no-browser",
            f"--port={port}",
            "--Voila.ip=127.0.0.1",
            notebook.name,
        ]
        server = subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True)
        assert server.stderr
        for line in server.stderr:  # it prints the port when it is ready
            if f":{port}" in line:
                break
        try:
            yield f"http://127.0.0.1:{port}"
        finally:
            server.terminate()
            server.wait(20)


if __name__ == "__main__":
    draw_panel(file_path(sys.argv[1]))
