"""Paths as users give them, and files that are replaced in one step.

A path from a user is made absolute once, when it is received, so that a later ``os.chdir`` has no effect. In messages a
path is relative to the current folder again.
"""

import os
import re
import shlex
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

from walkerlab.system.errors import WalkerlabError

NOT_A_PATH = re.compile(r"(?i):memory:$|file:|[a-z][a-z0-9+.-]+:/")
"""Strings that SQLite or a browser would not read as a path."""

SHELL_SAFE_PATTERN = re.compile(r"[\w@%+=:,./\\-]+" if os.name == "nt" else r"[\w@%+=:,./-]+")
"""Paths that a shell reads correctly without quotes."""

MISREAD_STARTS = ("~", "-", ":")
"""Prefixes of a relative path that a shell or SQLite would misread."""


class PathError(WalkerlabError, ValueError):
    """A path that cannot be used."""


def absolute_path(given: str | os.PathLike[str], name: str = "path") -> Path:
    """Return the absolute path of a file or folder, with ``~`` expanded.

    Args:
        given: Path from a user.
        name: Name of the argument, for messages.

    Raises:
        PathError: If the path is not valid.
        TypeError: If the value is not a path.
    """
    try:
        text = os.fsdecode(given)
        os.fsencode(text)
    except TypeError:
        fix = " If it is an executor, pass it by name: executor=…" if hasattr(given, "submit") else ""
        fix = " If it is a run, its file is run.path." if hasattr(given, "champion") else fix
        raise TypeError(
            f'{name} must be a path, as text or Path, such as "run.walk"; got {given!r:.80}.{fix}'
        ) from None
    except UnicodeError as error:
        raise PathError(f"{name} is {given!r}; it contains a character that is not allowed in file names.") from error
    if not text.strip():
        raise PathError(f"{name} is {text!r}, which is empty; it must be a path, such as 'walk'.")
    if "\0" in text:
        raise PathError(
            f"{name} is {text!r}; a path must not contain a null character. Write backslashes as in r'C:\\walk'."
        )
    if NOT_A_PATH.match(text):
        raise PathError(f"{name} is {text!r}; it must be the path of a file or folder on disk, such as 'run.walk'.")
    expanded = os.path.expanduser(text)
    if expanded.startswith("~") and len(Path(expanded).parts) > 1:
        raise PathError(
            f"{name} is {text!r}; there is no home folder of {Path(text).parts[0]!r} on this computer. "
            "Use '~/…' or an absolute path."
        )
    try:
        path = Path(expanded).absolute()
    except OSError as error:
        raise PathError(f"{name} is {text!r}, but the current folder was deleted; use an absolute path.") from error
    if ".." not in path.parts:
        return path
    if path.name == "..":
        return Path(os.path.realpath(path))
    return Path(os.path.realpath(path.parent), path.name)  # a link at the end stays a link


def file_path(given: str | os.PathLike[str], name: str = "path") -> Path:
    """Return the absolute path of a file to be written.

    Args:
        given: Path from a user.
        name: Name of the argument, for messages.

    Raises:
        PathError: If the path is not valid, or is a folder.
        TypeError: If the value is not a path.
    """
    path = absolute_path(given, name)
    text = os.fsdecode(given)
    if text.endswith(("/", os.sep)) or os.path.isdir(path):
        raise PathError(f"{name} is {text!r}, which is a folder; it must be the path of a file.")
    return path


def folder_path(given: str | os.PathLike[str], name: str = "folder") -> Path:
    """Return the absolute path of a folder for new files.

    Args:
        given: Path from a user.
        name: Name of the argument, for messages.

    Raises:
        PathError: If the path is not valid, or is a file.
        TypeError: If the value is not a path.
    """
    path = absolute_path(given, name)
    if os.path.lexists(path) and not os.path.isdir(path):
        raise PathError(f"{name} is {os.fsdecode(given)!r}, which is a file; it must be the path of a folder.")
    return path


def display_path(path: object) -> str:
    """Return a path as text for messages: relative to the current folder if inside it, otherwise absolute.

    Args:
        path: Path, or any other object, which is converted by ``str``.
    """
    if not isinstance(path, Path) or not path.is_absolute():
        return str(path)
    with suppress(OSError, ValueError):
        relative = str(path.relative_to(Path.cwd()))
        if not relative.startswith(MISREAD_STARTS) and not NOT_A_PATH.match(relative):
            return relative
    return str(path)


def quote_path(path: object) -> str:
    """Return a path as ``display_path`` does, in quotes if a shell requires them."""
    name = display_path(path)
    if SHELL_SAFE_PATTERN.fullmatch(name):
        return name
    return f'"{name}"' if os.name == "nt" or not set(name) & set('"$`\\!') else shlex.quote(name)


@contextmanager
def replace_atomically(path: Path) -> Generator[Path, None, None]:
    """Yield a temporary file in the same folder; it replaces ``path`` when the block ends without an error.

    The new file has the permissions of any new file. A symbolic link at ``path`` is replaced; the file that it points
    to stays as it is. After an error ``path`` is as before, and the temporary file is deleted.

    Args:
        path: Absolute path of the file to write.

    Raises:
        FileNotFoundError: If the folder does not exist.
        PathError: If ``path`` exists and is not a file.
        OSError: If the file cannot be written.
    """
    if not os.path.isdir(path.parent):
        raise FileNotFoundError(
            f"there is no folder {display_path(path.parent)} for the file {path.name}; create it first."
        )
    if os.path.exists(path) and not os.path.isfile(path):
        kind = "a folder" if os.path.isdir(path) else "a device or pipe"
        raise PathError(f"{display_path(path)} is {kind}; it must be the path of a file.")
    temporary = path.with_name(f".{uuid4().hex[:8]}.part")  # short, because the file's name may have any length
    try:
        with suppress(FileNotFoundError):
            os.lstat(path)  # raises if the name is too long
        temporary.touch(exist_ok=False)
        yield temporary
        sync_to_disk(temporary)
        os.replace(temporary, path)
        sync_to_disk(path.parent)
    except OSError as error:
        if error.filename is None or Path(error.filename) != temporary:
            raise
        raise type(error)(error.errno, error.strerror, str(path)) from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Replace the contents of a file in one step, as ``replace_atomically`` does.

    Args:
        path: Absolute path of the file.
        text: New contents.
    """
    with replace_atomically(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def sync_to_disk(path: Path) -> None:
    """Wait until the contents of a file or the entries of a folder are on the disk; folders are skipped on Windows."""
    if not path.is_dir():
        with open(path, "r+b") as file:
            os.fsync(file)
    elif os.name != "nt":
        with suppress(OSError):  # some file systems cannot do that for folders
            descriptor = os.open(path, os.O_RDONLY)
            try:
                os.fsync(descriptor)
            finally:
                os.close(descriptor)
