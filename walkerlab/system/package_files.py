"""Files that belong to walkerlab but are not Python modules: notebooks and saved runs."""

from pathlib import Path

PACKAGE = Path(__file__).parents[1]


def find_package_file(path: str | Path) -> Path:
    """Return the path of a file or folder: inside an installed package, or next to the package in a checkout.

    Args:
        path: Path in the repository, such as ``data/walker.json``.

    Raises:
        FileNotFoundError: If there is no such file.
    """
    for folder in (PACKAGE, PACKAGE.parent):
        if (folder / path).exists():
            return folder / path
    raise FileNotFoundError(f"walkerlab has no file {path}; install walkerlab again.")
