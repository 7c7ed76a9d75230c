"""JupyterLab, opened on a student's own copies of the notebooks."""

import argparse
import secrets
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from walkerlab.commands.terminal import REFUSED, say
from walkerlab.system.files import replacing

FOLDER = "walkerlab-notebooks"
FIRST = "00_meet_a_walker.ipynb"

ONLY_HERE = [
    "--ServerApp.ip=127.0.0.1",
    "--ServerApp.allow_remote_access=False",
    "--KernelManager.ip=127.0.0.1",
    "--ServerKernelManager.ip=127.0.0.1",
]
"""Whatever a user's own settings of Jupyter say, nobody else's computer reaches the server or its kernels."""


def originals() -> list[Path]:
    """Return the notebooks that walkerlab came with: inside an installed package, or beside the one of a checkout."""
    package = Path(__file__).parents[1]
    installed, checkout = (
        sorted(folder.glob("*.ipynb")) for folder in (package / "notebooks", package.parent / "notebooks")
    )
    return installed or checkout


def copy_notebooks(folder: Path) -> list[Path]:
    """Put those notebooks into a folder that are not there yet; what is there is somebody's work, and stays.

    Returns:
        The copies made now.
    """
    folder.mkdir(parents=True, exist_ok=True)
    fresh = [(original, folder / original.name) for original in originals() if not (folder / original.name).exists()]
    for original, copy in fresh:
        with replacing(copy) as part:
            shutil.copyfile(original, part)
    return [copy for _, copy in fresh]


def open_lab(folder: Path, options: Sequence[str] = ()) -> None:
    """Run JupyterLab on a folder, opened on the first notebook, until it is stopped.

    It is for this computer only, and for those on it who have its token, or the user's password if there is one.

    Raises:
        ImportError: if JupyterLab is not installed.
    """
    from jupyterlab.labapp import LabApp  # type: ignore[import-untyped]

    first = f"--LabApp.default_url=/lab/tree/{FIRST}"  # a file's name alone would print the address of the Launcher
    server = LabApp.initialize_server([f"--ServerApp.root_dir={folder.resolve()}", *ONLY_HERE, first, *options])
    if not getattr(server.identity_provider, "hashed_password", "") and not server.identity_provider.token:
        server.identity_provider.token = secrets.token_hex(24)
        server.identity_provider.token_generated = True  # or the address would be printed without it
    server.start()


def run(given: argparse.Namespace) -> int:
    """Copy the notebooks, say so, and open JupyterLab on them."""
    folder = Path(FOLDER)
    try:
        copied = copy_notebooks(folder)
    except OSError as error:
        return say(
            f"No notebooks can be put into {FOLDER}: {error.strerror or error}. cd to a folder of your own.", to=REFUSED
        )
    notebooks = f"{len(copied)} notebook{'' if len(copied) == 1 else 's'}"
    new = f"New in {FOLDER}: {notebooks}." if copied else f"All notebooks are in {FOLDER} already."
    print(f"{new} What was there before stays as it was.", flush=True)
    options = [f"--{name.replace('_', '-')}" for name in ("no_browser", "allow_root") if getattr(given, name)]
    options += [f"--port={given.port}"] if given.port else []
    try:
        open_lab(folder, options)
    except ImportError:
        return say(f'JupyterLab is not installed. Mend: "{sys.executable}" -m pip install jupyterlab', to=REFUSED)
    return 0
