"""Paths as users give them, and files that are replaced in one step.

A path that a user gives is made absolute once, where it comes in, so that a later ``os.chdir`` changes nothing. What is
shown to people is relative to the current folder again.
"""

import os
import re
import shlex
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

from walkerlab.errors import Fault

NOT_A_PATH = re.compile(r"(?i):memory:$|file:|[a-z][a-z0-9+.-]+:/")
"""What SQLite or a browser reads as something other than a path."""

PLAIN = re.compile(r"[\w@%+=:,./\\-]+" if os.name == "nt" else r"[\w@%+=:,./-]+")
"""A path that a shell takes without quotes."""

NOT_SHOWN_ALONE = ("~", "-", ":")
"""How a relative path begins that a shell or SQLite would misread."""


class PathError(Fault, ValueError):
    """A path that cannot be used."""


def absolute_path(given: str | os.PathLike[str], name: str = "path") -> Path:
    """Make a path from a user absolute, with ``~`` expanded.

    Args:
        given: Path of a file or folder.
        name: Name of the argument, for messages.

    Raises:
        PathError: If no file can have this path.
        TypeError: If it is not a path.
    """
    try:
        text = os.fsdecode(given)
        os.fsencode(text)
    except TypeError:
        fix = " If it is an executor, name it: executor=…" if hasattr(given, "submit") else ""
        fix = " If it is a run, its file is run.path." if hasattr(given, "champion") else fix
        raise TypeError(
            f'{name} must be a path, as text or Path, such as "run.walk"; got {given!r:.80}.{fix}'
        ) from None
    except UnicodeError as error:
        raise PathError(f"{name} is {given!r}; it has a character that no file name can have.") from error
    if not text.strip():
        raise PathError(f"{name} is {text!r}, which is empty; it must be a path, such as 'walk'.")
    if "\0" in text:
        raise PathError(f"{name} is {text!r}; a path has no null character.")
    if NOT_A_PATH.match(text):
        raise PathError(f"{name} is {text!r}; it must be a plain path of a file or folder, such as 'run.walk'.")
    expanded = os.path.expanduser(text)
    if expanded.startswith("~") and len(Path(expanded).parts) > 1:
        raise PathError(f"{name} is {text!r}; there is no home folder of {Path(text).parts[0]!r} on this computer.")
    try:
        path = Path(expanded).absolute()
    except OSError as error:
        raise PathError(f"{name} is {text!r}, but the current folder was deleted; give an absolute path.") from error
    if ".." not in path.parts:
        return path
    if path.name == "..":
        return Path(os.path.realpath(path))
    return Path(os.path.realpath(path.parent), path.name)  # a link at the end stays a link


def file_path(given: str | os.PathLike[str], name: str = "path") -> Path:
    """Make the path of a file to be written absolute.

    Raises:
        PathError: If no file can have this path, or it is that of a folder.
        TypeError: If it is not a path.
    """
    path, text = absolute_path(given, name), os.fsdecode(given)
    if text.endswith(("/", os.sep)) or os.path.isdir(path):
        raise PathError(f"{name} is {text!r}, and that is a folder; it must be the path of a file.")
    return path


def folder_path(given: str | os.PathLike[str], name: str = "folder") -> Path:
    """Make the path of a folder to be written into absolute.

    Raises:
        PathError: If no folder can have this path, or it is that of a file.
        TypeError: If it is not a path.
    """
    path = absolute_path(given, name)
    if os.path.lexists(path) and not os.path.isdir(path):
        raise PathError(f"{name} is {os.fsdecode(given)!r}, and that is a file; it must be the path of a folder.")
    return path


def shown(path: object) -> str:
    """Write a path for people: relative to the current folder if it is in it, and absolute otherwise.

    Anything else than a path is written as it is.
    """
    if not isinstance(path, Path) or not path.is_absolute():
        return str(path)
    with suppress(OSError, ValueError):
        relative = str(path.relative_to(Path.cwd()))
        if not relative.startswith(NOT_SHOWN_ALONE) and not NOT_A_PATH.match(relative):
            return relative
    return str(path)


def quoted(path: object) -> str:
    """Write a path for people as ``shown`` does, in quotes if a shell needs them."""
    name = shown(path)
    if PLAIN.fullmatch(name):
        return name
    return f'"{name}"' if os.name == "nt" or not set(name) & set('"$`\\!') else shlex.quote(name)


@contextmanager
def replacing(path: Path) -> Generator[Path, None, None]:
    """Yield a temporary file in the same folder, which replaces ``path`` when the block ends without an error.

    The new file has the permissions of any new file. A symbolic link at ``path`` is replaced; the file that it points
    to stays as it is. After an error ``path`` is as before, and the temporary file is deleted.

    Args:
        path: Absolute path of the file to write.

    Raises:
        FileNotFoundError: If its folder does not exist.
        PathError: If there is something at ``path`` that is not a file.
        OSError: If it cannot be written.
    """
    if not os.path.isdir(path.parent):
        raise FileNotFoundError(f"there is no folder {shown(path.parent)}; make it first, for the file {path.name}.")
    if os.path.exists(path) and not os.path.isfile(path):
        kind = "a folder" if os.path.isdir(path) else "a device or pipe"
        raise PathError(f"{shown(path)} is {kind}; it must be the path of a file.")
    part = path.with_name(f".{uuid4().hex[:8]}.part")  # short: the name of the file may be as long as names can be
    try:
        with suppress(FileNotFoundError):
            os.lstat(path)  # raises if the name is too long
        part.touch(exist_ok=False)
        yield part
        sync(part)
        os.replace(part, path)
        sync(path.parent)
    except OSError as error:
        if error.filename is None or Path(error.filename) != part:
            raise
        raise type(error)(error.errno, error.strerror, str(path)) from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Replace a file by a text, in one step, as ``replacing`` does."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")


def sync(path: Path) -> None:
    """Wait until a file, or the list of files of a folder, is on the disk; Windows cannot do that for folders."""
    if not path.is_dir():
        with open(path, "r+b") as file:
            os.fsync(file)
    elif os.name != "nt":
        with suppress(OSError):  # some file systems cannot do that either
            opened = os.open(path, os.O_RDONLY)
            try:
                os.fsync(opened)
            finally:
                os.close(opened)
