"""Replace a set of output files as a whole: a folder holds either all the old files or all the new ones.

The new files are written into a hidden folder beside the old ones. Then they are moved into place, one after another,
as a transaction with a rollback journal, as in a database:

1. each old file is linked (or copied) into ``old`` in the hidden folder, and the journal ``undo.json`` lists the new
   files that have no old version;
2. the new files are renamed;
3. the journal is deleted. This is the commit.

If step 2 fails, it is undone at once. A process killed in step 2 leaves the journal behind; the next call to
``restore``, which every ``load`` calls, puts the old files back. A process killed before step 2 has not changed the old
files. The lock of the hidden folder, which the system releases when a process dies, distinguishes a dead writer from an
active one.

If a part of the set cannot be created, the other parts are created nevertheless, and the error names the failed part.
The new files replace the old ones, unless an outdated file of the failed part would remain beside them; in that case,
all old files are kept.
"""

import json
import os
import re
import shutil
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

from walkerlab.system import folder_locks
from walkerlab.system.errors import WalkerlabError
from walkerlab.system.files import display_path, sync_to_disk, write_text
from walkerlab.system.interrupts import interrupts_held

HIDDEN_FOLDER = ".walkerlab-new"
JOURNAL_NAME = "undo.json"
MAX_JOURNAL_SIZE = 100_000  # bytes
LOCK_TIMEOUT = 60.0  # s to wait for another writer
MAX_NAMED = 3  # maximum number of files of a part that a message names

OUTPUT_NAMES = re.compile(
    r"(report|replay)\.html|records\.csv|fitness\.(svg|png)|champion\.(png|txt|xml|html)"
    r"|pictures/\w+\.(svg|pdf|png)|tables/\w+\.csv"
)
"""Names of the files that a set may hold; no other file is changed, whatever an untrusted hidden folder contains."""


class OutputError(WalkerlabError, OSError):
    """Output files could not be written; the message names each of them."""


class NewFiles:
    """New files of a set, while they are being written.

    Attributes:
        folder: Folder in which to write them.
        failed: Errors of the parts that could not be created, keyed by the names of their files.
    """

    def __init__(self, folder: Path) -> None:
        """Start with no files."""
        self.folder = folder
        self.failed: dict[tuple[str, ...], Exception] = {}

    @contextmanager
    def write_part(self, *names: str) -> Generator[None, None, None]:
        """Write one part of the set; an error within the block is recorded, and the other parts are still created.

        Args:
            *names: Files of the part, relative to ``folder``; their folders are created.
        """
        assert all(map(OUTPUT_NAMES.fullmatch, names)), f"{names} are not all output files"
        try:
            for name in names:
                (self.folder / name).parent.mkdir(exist_ok=True)
            yield
        except Exception as error:
            self.failed[names] = error
            for name in names:
                (self.folder / name).unlink(missing_ok=True)


@contextmanager
def replacing_files(folder: Path, is_current: Callable[[Path], bool] | None = None) -> Generator[NewFiles, None, None]:
    """Replace a set of output files when the block ends without an error.

    Args:
        folder: Absolute path of the folder; created if it does not exist.
        is_current: Function that returns whether an old file is up to date, so that it may stay among the new files if
            its new version cannot be created. If None, no file is up to date.

    Raises:
        OutputError: If a part could not be created, or the files cannot be replaced.
    """
    hidden = folder / HIDDEN_FOLDER
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = folder_locks.acquire(hidden, LOCK_TIMEOUT)
    except OSError as error:
        raise OutputError(f"no files can be written into {display_path(folder)}: {error.strerror or error}.") from error
    if lock is None:
        raise OutputError(f"another program is writing into {display_path(folder)}. Try again when it is done.")
    try:
        new = _prepare(folder, hidden)
        yield new
        failed = [folder / name for names in new.failed for name in names]
        old = [path for path in failed if os.path.lexists(path)]
        outdated = [path for path in old if not (is_current and is_current(path))]
        if not outdated:
            _replace_files(folder, hidden)
        if new.failed:
            rest = "No file was changed" if outdated else "All other files were written"
            first = next(iter(new.failed.values()))
            raise OutputError(
                f"Not all files could be created for {display_path(folder)}. {rest}.\n{_failures(new)}"
            ) from first
    finally:
        folder_locks.release(hidden, lock, keep_contents=os.path.lexists(hidden / JOURNAL_NAME))


def _prepare(folder: Path, hidden: Path) -> NewFiles:
    """Undo an interrupted replacement, and empty the hidden folder."""
    try:
        _undo_replacement(folder, hidden)
        folder_locks.clear(hidden)
        (hidden / "new").mkdir()
    except OSError as error:
        raise OutputError(
            f"no files can be written into {display_path(hidden)}: {error.strerror}. Delete this folder and try again."
        ) from error
    return NewFiles(hidden / "new")


def restore(folder: Path) -> None:
    """Put the old files back if a process was killed while it was replacing them, and delete the hidden folder.

    Do nothing while another process is writing, or if the folder cannot be written to.

    Args:
        folder: Absolute path of the folder.
    """
    hidden = folder / HIDDEN_FOLDER
    if not os.path.lexists(hidden):
        return
    with suppress(OSError):
        lock = folder_locks.acquire(hidden, timeout=0.0)
        if lock is not None:
            try:
                _undo_replacement(folder, hidden)
            finally:
                folder_locks.release(hidden, lock, keep_contents=os.path.lexists(hidden / JOURNAL_NAME))


def _failures(new: NewFiles) -> str:
    """List the parts that could not be created, with their errors."""
    return "\n".join(f"  {_listed(names)}: {_message(error)}" for names, error in new.failed.items())


def _listed(names: Sequence[str]) -> str:
    return f"{names[0]} and {len(names) - 1} more" if len(names) > MAX_NAMED else ", ".join(names)


def _message(error: Exception) -> str:
    message = (isinstance(error, OSError) and error.strerror) or str(error)  # strerror omits the temporary path
    return message if isinstance(error, WalkerlabError) else f"{type(error).__name__}: {message}"


# ------------------------------------------------------------------------------------------------- the transaction


def _replace_files(folder: Path, hidden: Path) -> None:
    """Move all new files into place, or leave all the old files as they are.

    Raises:
        OutputError: If one of them cannot be replaced.
    """
    new = hidden / "new"
    old = hidden / "old"
    names = sorted(filter(OUTPUT_NAMES.fullmatch, _relative_names(new)), key=lambda name: (name == "report.html", name))
    old.mkdir()
    try:
        absent = [name for name in names if not _save_old(folder / name, old / name)]
        write_text(hidden / JOURNAL_NAME, json.dumps(absent))
        with interrupts_held():
            try:
                for name in names:
                    (folder / name).parent.mkdir(exist_ok=True)
                    os.replace(new / name, folder / name)
            except BaseException:
                _undo_replacement(folder, hidden)
                raise
            for parent in {(folder / name).parent for name in names}:
                sync_to_disk(parent)
            (hidden / JOURNAL_NAME).unlink()
            sync_to_disk(hidden)
    except OSError as error:
        raise OutputError(
            f"{display_path(Path(error.filename2 or error.filename or folder))} could not be replaced: "
            f"{error.strerror or error}. No file was changed. If another program has it open, close it there."
        ) from error


def _save_old(path: Path, copy: Path) -> bool:
    """Link or copy an old file; a symbolic link is copied as a link. Return False if there is no old file."""
    if path.parent.is_symlink():  # files must not be written outside the folder
        raise FileExistsError(0, "it is a symbolic link; replace it with a folder", str(path.parent))
    if not os.path.lexists(path):
        return False
    copy.parent.mkdir(exist_ok=True)
    try:
        os.link(path, copy, follow_symlinks=False)
    except (OSError, NotImplementedError):  # some file systems have no hard links
        shutil.copy2(path, copy, follow_symlinks=False)
        if not copy.is_symlink():
            sync_to_disk(copy)
    return True


def _undo_replacement(folder: Path, hidden: Path) -> None:
    """Put the old files back if a replacement was begun and not committed; can be repeated after an interruption."""
    journal = hidden / JOURNAL_NAME
    old = hidden / "old"
    if not os.path.lexists(journal):
        return
    is_output = partial(_is_output, folder)
    absent: Any = []
    with suppress(OSError, ValueError, RecursionError):  # the folder may be untrusted
        if journal.is_file() and journal.stat().st_size < MAX_JOURNAL_SIZE:
            absent = json.loads(journal.read_text(encoding="utf-8"))
    for name in filter(is_output, absent if isinstance(absent, list) else []):
        (folder / name).unlink(missing_ok=True)
        if "/" in name:
            with suppress(OSError):
                (folder / name).parent.rmdir()  # only if it is empty now
    for name in filter(is_output, [] if old.is_symlink() else _relative_names(old)):
        os.replace(old / name, folder / name)
    sync_to_disk(folder)
    journal.unlink()


def _is_output(folder: Path, name: Any) -> bool:
    """Return whether a name is the name of an output file and its path does not lead out of the folder."""
    return isinstance(name, str) and bool(OUTPUT_NAMES.fullmatch(name)) and not (folder / name).parent.is_symlink()


def _relative_names(folder: Path) -> Iterator[str]:
    """Return the relative names of all files in a folder and its subfolders; links to folders are not followed."""
    found = [(Path(parent) / file) for parent, _, files in os.walk(folder) for file in files]
    return (path.relative_to(folder).as_posix() for path in found)
