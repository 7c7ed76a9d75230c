"""A Jupyter server of the tests' own, and running a notebook on it in JupyterLab, Notebook 7 or Voila."""

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

PACKAGES = {"JupyterLab": "jupyterlab", "Notebook 7": "notebook", "Voila": "voila"}

# The workspace is named after the notebook, or the notebook of an earlier test would be opened again beside it.
PLACES = {
    "JupyterLab": "/lab/workspaces/{stem}/tree/{name}",
    "Notebook 7": "/notebooks/{name}",
    "Voila": "/voila/render/{name}",
}

# What they complain of themselves, also about an empty notebook; and Voila asks the internet for icons and formulas.
OWN_COMPLAINTS = {
    PLACES[
        "Notebook 7"
    ]: r"^Menu entry for command|^\[yjs#509\]|reading 'schema'|'filebrowser:open-path' not registered",
    PLACES[
        "Voila"
    ]: r"[Uu]nsatisf|[Ss]atisfy|Failed to create module|shared module|cdn\.jsdelivr\.net|cdnjs\.cloudflare",
}

# ------------------------------------------------------------------------------------------------ the server


@dataclass(frozen=True)
class Jupyter:
    """A server that shows the notebooks of a folder in each of the front ends, to whoever has the token."""

    address: str
    folder: Path
    token: str

    def put(self, notebook: NotebookNode, frontend: str = "JupyterLab", name: str = "book.ipynb") -> str:
        """Write a notebook into the folder, and return the address at which a front end shows it."""
        nbformat.write(notebook, self.folder / name)
        return self.address_of(name, frontend)

    def address_of(self, name: str, frontend: str = "JupyterLab", stem: str = "") -> str:
        """Return the address at which a front end shows a notebook, in a workspace of JupyterLab named ``stem``."""
        place = PLACES[frontend].format(stem=stem or Path(name).stem, name=name)
        return f"{self.address}{place}?token={self.token}"

    def end_kernels(self) -> None:
        """End every kernel."""
        for kernel in json.loads(self.ask("/api/kernels")):
            self.ask(f"/api/kernels/{kernel['id']}", "DELETE")

    def clear(self) -> None:
        """End what earlier notebooks have left running, and remove what they have left in the folder."""
        self.end_kernels()
        for left in self.folder.iterdir():  # but not the folder: the server works in it
            shutil.rmtree(left) if left.is_dir() else left.unlink()

    def ask(self, path: str, method: str = "GET") -> bytes:
        """Ask the server itself."""
        question = urllib.request.Request(self.address + path, method=method)
        question.add_header("Authorization", f"token {self.token}")
        with urllib.request.urlopen(question, timeout=10) as answer:
            return answer.read()


@contextmanager
def serving(folder: Path) -> Iterator[Jupyter]:
    """Start a server for this computer only, which has no settings but its own; at the end, stop it."""
    books, own = folder / "books", folder / "own"
    notices = own / "config/lab/user-settings/@jupyterlab/apputils-extension/notification.jupyterlab-settings"
    for new in (books, notices.parent):
        new.mkdir(parents=True)
    notices.write_text('{"fetchNews": "false", "checkForUpdates": false}')
    with socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    jupyter = Jupyter(f"http://127.0.0.1:{port}", books, secrets.token_hex(16))
    # One server is enough: JupyterLab's serves the other front ends as well, as far as they are installed.
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--expose-app-in-browser"]
    command += ["--JupyterNotebookApp.expose_app_in_browser=True", "--VoilaConfiguration.show_tracebacks=True"]
    command += ["--ServerApp.ip=127.0.0.1", f"--port={port}", "--ServerApp.port_retries=0"]
    homes = {f"JUPYTER_{home.upper()}_DIR": str(own / home) for home in ("config", "data", "runtime")}
    environment = {**os.environ, **homes, "IPYTHONDIR": str(own / "ipython"), "JUPYTER_TOKEN": jupyter.token}
    with (own / "log").open("w") as log:
        process = subprocess.Popen(command, cwd=books, stdout=log, stderr=log, env=environment)
    try:
        for _ in range(240):
            try:
                jupyter.ask("/api")
                break
            except OSError:
                assert process.poll() is None, (own / "log").read_text()
                time.sleep(0.25)
        yield jupyter
    finally:
        process.terminate()
        process.wait(20)


# --------------------------------------------------------------------------------------------- the notebook

READY = """() => {
    const panel = window.jupyterapp?.shell.currentWidget;
    return panel?.content?.model?.cells.length && panel.sessionContext.session?.kernel?.status === "idle";
}"""

OUTPUTS = """() => [...window.jupyterapp.shell.currentWidget.content.model.cells]
    .filter(({ type, sharedModel }) => type === "code" && sharedModel.source.trim())
    .map(({ executionCount, outputs }) => ({ executionCount, outputs: outputs.toJSON() }))"""

# A cell that fails keeps those below it from running.
DONE = f"""() => {{
    const cells = ({OUTPUTS})();
    const failed = cells.some(({{ outputs }}) => outputs.some(({{ output_type }}) => output_type === "error"));
    const ran = cells.every(({{ executionCount }}) => executionCount !== null);
    return (failed || ran) && ({READY})();
}}"""

COLOURS_OF_A_TERMINAL = re.compile(r"\x1b\[[\d;]*m")


def book(*sources: str) -> NotebookNode:
    """Return a notebook with these code cells."""
    kernel = {"name": "python3", "display_name": "Python 3 (ipykernel)", "language": "python"}
    cells = [nbformat.v4.new_code_cell(source) for source in sources]
    return nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": kernel})


def is_voila(address: str) -> bool:
    return "/voila/" in address


def open_notebook(page, address):
    """Go to a notebook, and wait until its kernel is there; Voila has then run its cells."""
    page.goto(address)
    if not is_voila(address):
        page.wait_for_function(READY, timeout=60_000)


def start_all(page):
    """Have all cells run, as a person does; does not wait for them."""
    page.locator('.lm-MenuBar-item:has-text("Run")').click()
    page.locator('.lm-Menu-item:has-text("Run All Cells")').first.click()


def finish_all(page, timeout=120):
    """Wait until all cells have run, or one has failed: at most that many seconds. Returns the texts of the errors."""
    page.wait_for_function(DONE, timeout=1000 * timeout)
    outputs = [output for cell in page.evaluate(OUTPUTS) for output in cell["outputs"]]
    errors = ["\n".join(output["traceback"]) for output in outputs if output["output_type"] == "error"]
    return [COLOURS_OF_A_TERMINAL.sub("", error) for error in errors]


def run_all(page, address, timeout=120):
    """Open a notebook in any of the front ends and run it from top to bottom. Returns the texts of the errors."""
    open_notebook(page, address)
    if is_voila(address):
        return page.locator('[data-mime-type$="stderr"]', has_text="Traceback").all_inner_texts()
    start_all(page)
    return finish_all(page, timeout)


def picture_cells(page, folder: Path):
    """Save what each cell looks like, for people to look at."""
    folder.mkdir(parents=True, exist_ok=True)
    page.set_viewport_size({**page.viewport_size, "height": 2000})  # what is taller than the page would be cut off
    for number in range(page.evaluate("window.jupyterapp.shell.currentWidget.content.model.cells.length")):
        cell = page.locator(f'.jp-Cell[data-windowed-list-index="{number}"]')
        cell.scroll_into_view_if_needed()
        cell.screenshot(path=folder / f"{number:02}.png")


def is_ours(complaint: str, address: str) -> bool:
    """Whether a complaint of a page's console is none that the front end makes about whatever it shows."""
    own = [pattern for place, pattern in OWN_COMPLAINTS.items() if place.split("{")[0] in address]
    return not any(re.search(pattern, complaint) for pattern in own)
