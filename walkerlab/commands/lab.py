"""JupyterLab, opened on a student's own copies of the notebooks."""

import shutil
from collections.abc import Sequence
from pathlib import Path

FOLDER = "walkerlab-notebooks"
FIRST = "00_meet_a_walker.ipynb"


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
    return [Path(shutil.copyfile(original, copy)) for original, copy in fresh]


def open_lab(folder: Path, options: Sequence[str] = ()) -> None:
    """Run JupyterLab on a folder, opened on the first notebook, for this computer only, until it is stopped.

    Raises:
        ImportError: if JupyterLab is not installed.
    """
    from jupyterlab.labapp import LabApp  # type: ignore[import-untyped]

    first = f"--LabApp.default_url=/lab/tree/{FIRST}"  # a file's name alone would print the address of the Launcher
    where = [f"--ServerApp.root_dir={folder.resolve()}", "--ServerApp.ip=127.0.0.1"]
    LabApp.launch_instance([*where, first, *options])
