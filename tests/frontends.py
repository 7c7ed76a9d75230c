"""A Jupyter server for the tests, which runs notebooks in JupyterLab, Notebook 7 or Voila."""

import json
import os
import re
import secrets
import shutil
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from socket import socket

import nbformat
from nbformat import NotebookNode

MAX_CONTEXTS = 4  # WebGL contexts that the browser of the tests keeps; usually 16, which takes minutes to exceed

PACKAGES = {"JupyterLab": "jupyterlab", "Notebook 7": "notebook", "Voila": "voila"}

# The workspace is named after the notebook; otherwise, JupyterLab also reopens the notebook of an earlier test.
PLACES = {
    "JupyterLab": "/lab/workspaces/{stem}/tree/{name}",
    "Notebook 7": "/notebooks/{name}",
    "Voila": "/voila/render/{name}",
}

# Console messages of the front ends, also for an empty notebook; Voila requests icons and formulas from the internet.
KNOWN_MESSAGES = {
    PLACES["JupyterLab"]: r"^Plugin .* (took [\d.]+ms|is taking too long) to activate",  # on a busy computer
    PLACES[
        "Notebook 7"
    ]: r"^Menu entry for command|^\[yjs#509\]|reading 'schema'|'filebrowser:open-path' not registered",
    PLACES[
        "Voila"
    ]: r"[Uu]nsatisf|[Ss]atisfy|Failed to create module|shared module|cdn\.jsdelivr\.net|cdnjs\.cloudflare",
}

# --------------------------------------------------------------------------------------------------- server


@dataclass(frozen=True)
class Jupyter:
    """A server that shows the notebooks of a folder in each front end.

    Attributes:
        address: URL without a path.
        folder: Folder of the notebooks.
        token: Token that grants access.
    """

    address: str
    folder: Path
    token: str

    def put(self, notebook: NotebookNode, frontend: str = "JupyterLab", name: str = "book.ipynb") -> str:
        """Write a notebook into the folder; return its URL in a front end."""
        nbformat.write(notebook, self.folder / name)
        return self.address_of(name, frontend)

    def address_of(self, name: str, frontend: str = "JupyterLab", stem: str = "") -> str:
        """Return the URL of a notebook in a front end, in the JupyterLab workspace named ``stem``."""
        place = PLACES[frontend].format(stem=stem or Path(name).stem, name=name)
        return f"{self.address}{place}?token={self.token}"

    def end_kernels(self) -> None:
        """Shut down all kernels."""
        for kernel in json.loads(self.ask("/api/kernels")):
            self.ask(f"/api/kernels/{kernel['id']}", "DELETE")

    def clear(self) -> None:
        """Shut down all kernels and empty the folder."""
        self.end_kernels()
        for path in self.folder.iterdir():  # the folder itself is the server's working directory
            shutil.rmtree(path) if path.is_dir() else path.unlink()

    def ask(self, path: str, method: str = "GET") -> bytes:
        """Send a request to the server; return the body of the response."""
        request = urllib.request.Request(self.address + path, method=method)
        request.add_header("Authorization", f"token {self.token}")
        with urllib.request.urlopen(request, timeout=10) as response:
            return response.read()


@contextmanager
def serving(folder: Path) -> Iterator[Jupyter]:
    """Start a server with separate settings that only this computer reaches; stop it at the end."""
    books = folder / "books"
    private = folder / "private"
    notices = private / "config/lab/user-settings/@jupyterlab/apputils-extension/notification.jupyterlab-settings"
    for new in (books, notices.parent):
        new.mkdir(parents=True)
    notices.write_text('{"fetchNews": "false", "checkForUpdates": false}')
    with socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    jupyter = Jupyter(f"http://127.0.0.1:{port}", books, secrets.token_hex(16))
    # JupyterLab's server also serves the other front ends that are installed.
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--expose-app-in-browser"]
    command += ["--JupyterNotebookApp.expose_app_in_browser=True", "--VoilaConfiguration.show_tracebacks=True"]
    command += ["--ServerApp.ip=127.0.0.1", f"--port={port}", "--ServerApp.port_retries=0"]
    directories = {f"JUPYTER_{home.upper()}_DIR": str(private / home) for home in ("config", "data", "runtime")}
    environment = {**os.environ, **directories, "IPYTHONDIR": str(private / "ipython"), "JUPYTER_TOKEN": jupyter.token}
    with (private / "log").open("w") as log:
        process = subprocess.Popen(command, cwd=books, stdout=log, stderr=log, env=environment)
    try:
        for _ in range(240):
            try:
                jupyter.ask("/api")
                break
            except OSError:
                assert process.poll() is None, (private / "log").read_text()
                time.sleep(0.25)
        yield jupyter
    finally:
        process.terminate()
        process.wait(20)


# ------------------------------------------------------------------------------------------------- notebook

READY = """() => {
    const panel = window.jupyterapp?.shell.currentWidget;
    return panel?.content?.model?.cells.length && panel.sessionContext.session?.kernel?.status === "idle";
}"""

OUTPUTS = """() => [...window.jupyterapp.shell.currentWidget.content.model.cells]
    .filter(({ type, sharedModel }) => type === "code" && sharedModel.source.trim())
    .map(({ executionCount, outputs }) => ({ executionCount, outputs: outputs.toJSON() }))"""

# After a cell fails, the cells below it do not run.
DONE = f"""() => {{
    const cells = ({OUTPUTS})();
    const failed = cells.some(({{ outputs }}) => outputs.some(({{ output_type }}) => output_type === "error"));
    const ran = cells.every(({{ executionCount }}) => executionCount !== null);
    return (failed || ran) && ({READY})();
}}"""

TERMINAL_COLOURS = re.compile(r"\x1b\[[\d;]*m")


def book(*sources: str) -> NotebookNode:
    """Return a notebook with these code cells."""
    kernel = {"name": "python3", "display_name": "Python 3 (ipykernel)", "language": "python"}
    cells = [nbformat.v4.new_code_cell(source) for source in sources]
    return nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": kernel})


def is_voila(address: str) -> bool:
    return "/voila/" in address


def open_notebook(page, address):
    """Open a notebook and wait until its kernel is idle; Voila runs the cells before it shows the page."""
    page.goto(address, timeout=60_000)
    if not is_voila(address):
        page.wait_for_function(READY, timeout=60_000)


def start_all(page):
    """Start all cells from the menu, without waiting for them."""
    page.locator('.lm-MenuBar-item:has-text("Run")').click()
    page.locator('.lm-Menu-item:has-text("Run All Cells")').first.click()


def finish_all(page, timeout=120):
    """Wait until all cells have run or one has failed; return the error texts. ``timeout`` is in seconds."""
    page.wait_for_function(DONE, timeout=1000 * timeout)
    outputs = [output for cell in page.evaluate(OUTPUTS) for output in cell["outputs"]]
    errors = ["\n".join(output["traceback"]) for output in outputs if output["output_type"] == "error"]
    return [TERMINAL_COLOURS.sub("", error) for error in errors]


def find_errors(page):
    """Return the error texts on a page of Voila."""
    return page.locator('[data-mime-type$="stderr"]', has_text="Traceback").all_inner_texts()


def run_all(page, address, timeout=120):
    """Open a notebook in any front end and run all cells; return the error texts. ``timeout`` is in seconds."""
    open_notebook(page, address)
    if is_voila(address):
        return find_errors(page)
    start_all(page)
    return finish_all(page, timeout)


def picture_cells(page, folder: Path):
    """Save a screenshot of each cell."""
    folder.mkdir(parents=True, exist_ok=True)
    page.set_viewport_size({**page.viewport_size, "height": 2000})  # screenshots do not extend beyond the page
    for number in range(page.evaluate("window.jupyterapp.shell.currentWidget.content.model.cells.length")):
        cell = page.locator(f'.jp-Cell[data-windowed-list-index="{number}"]')
        cell.scroll_into_view_if_needed()
        cell.screenshot(path=folder / f"{number:02}.png")


def is_ours(message: str, address: str) -> bool:
    """Return whether a console message of a page is not one that the front end logs for every notebook."""
    known = [pattern for place, pattern in KNOWN_MESSAGES.items() if place.split("{")[0] in address]
    return not any(re.search(pattern, message) for pattern in known)
