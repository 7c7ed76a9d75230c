"""Paths of run files, as users give them."""

import os
from pathlib import Path

from walkerlab.runfile.opening import RunFileError
from walkerlab.system.files import PathError, absolute_path, display_path, file_path

RUN_FILE = "run.walk"  # name of the run file in the folder of a run
MAX_NAMED = 9  # maximum number of files that a message names


def locate_run_file(path: str | Path) -> Path:
    """Return the absolute path of a run file.

    Args:
        path: Run file, or a folder that contains ``run.walk`` or a single run file.

    Raises:
        RunFileError: If the path is not valid, or is a folder without a run file or with several.
    """
    try:
        path = absolute_path(path)
    except PathError as error:
        raise RunFileError(str(error)) from error
    if not path.is_dir():
        return path
    found = sorted(path.glob("*.walk"))
    if len(found) == 1 or path / RUN_FILE in found:
        return found[0] if len(found) == 1 else path / RUN_FILE
    if not found:
        raise RunFileError(f"the folder {display_path(path)} contains no run file: no file name ends in .walk")
    names = ", ".join(file.name for file in found[:MAX_NAMED]) + (" …" if len(found) > MAX_NAMED else "")
    raise RunFileError(
        f"the folder {display_path(path)} contains {len(found)} run files: {names}. Name one of them: "
        f"{display_path(found[0])!r}"
    )


def new_path(path: str | Path, name: str = "path") -> Path:
    """Return the absolute path of a run file to be created.

    Args:
        path: Path of the file.
        name: Name of the argument, for messages.

    Raises:
        RunFileError: If the path is not valid.
        TypeError: If it is not a path.
    """
    try:
        return file_path(path, name)
    except PathError as error:
        folder = os.path.expanduser(path)
        example = f" For example: {display_path(Path(folder, RUN_FILE).absolute())!r}." if os.path.isdir(folder) else ""
        raise RunFileError(f"no run file can be created: {error}{example}") from error
