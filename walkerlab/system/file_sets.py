"""The output files of a run, replaced as one set: a folder holds all of the old ones or all of the new ones.

The new files are written into a hidden folder, ``STAGE``, beside the old ones. Then they are renamed to their places,
one after another, as a transaction with a rollback journal, as databases do it:

1. each old file is linked (or copied) into ``STAGE/old``, and ``STAGE/undo.json`` lists the files that are new;
2. the new files are renamed;
3. ``STAGE/undo.json`` is deleted. This is the commit.

An error in step 2 is undone at once. A process killed in step 2 leaves ``undo.json``; the next call of ``restore``,
which every ``load`` makes, puts the old files back. Killed before, the old files have not been touched. A lock on
``STAGE/lock``, which the system releases when a process dies, tells a dead writer from one that is at work.

If a part of the set cannot be made, the other parts are made nevertheless, and the error names it. They replace the old
files unless an outdated file of the failed part would remain beside them; then all old files stay.
"""

import json
import os
import re
import shutil
import sys
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from walkerlab.errors import Fault
from walkerlab.system.files import shown, sync, write_text
from walkerlab.system.interrupts import interrupts_held

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

STAGE = ".walkerlab-new"
MARKER = "undo.json"
MAX_MARKER = 100_000  # bytes
PATIENCE = 60.0  # s to wait for another writer
MAX_NAMED = 3  # files of a part that a message names

NAMES = re.compile(
    r"(report|replay)\.html|records\.csv|fitness\.(svg|png)|champion\.(png|txt|xml)"
    r"|pictures/\w+\.(svg|pdf|png)|tables/\w+\.csv"
)
"""Names of the files that a set may hold; no other file is touched, whatever is in the hidden folder of a stranger."""


class OutputError(Fault, OSError):
    """Output files that could not be written; it names each of them."""


class NewFiles:
    """The new files of a set while they are being written.

    Attributes:
        folder: Folder in which to write them.
        failed: Error of each part that could not be made, by the names of its files.
    """

    def __init__(self, folder: Path) -> None:
        """Start with no files."""
        self.folder = folder
        self.failed: dict[tuple[str, ...], Exception] = {}

    @contextmanager
    def part(self, *names: str) -> Generator[None, None, None]:
        """Write one part of the set; an error within the block is recorded, and the other parts are still made.

        Args:
            *names: Files of the part, relative to ``folder``. Their folders are made.
        """
        assert all(map(NAMES.fullmatch, names)), f"{names} are not all output files"
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
        folder: Absolute path of the folder; made if it does not exist.
        is_current: Whether an old file is of the same state of the run as the new files, so that it may stay among
            them if its own new version cannot be made; never, if None.

    Raises:
        OutputError: If a part could not be made, or the files cannot be replaced.
    """
    stage = folder / STAGE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = _acquire(stage, PATIENCE)
    except OSError as error:
        raise OutputError(f"nothing can be written into {shown(folder)}: {error.strerror or error}.") from error
    if lock is None:
        raise OutputError(f"another program is writing into {shown(folder)}. Try again when it is done.")
    try:
        new = _begin(folder, stage)
        yield new
        named = [name for names in new.failed for name in names]
        there = [folder / name for name in named if os.path.lexists(folder / name)]
        outdated = [path for path in there if not (is_current and is_current(path))]
        if not outdated:
            _swap(folder, stage)
        if new.failed:
            rest = "All files stay as they were" if outdated else "All other files are written"
            first = next(iter(new.failed.values()))
            raise OutputError(f"Not all files could be made for {shown(folder)}. {rest}.\n{_faults(new)}") from first
    finally:
        _release(stage, lock)


def _begin(folder: Path, stage: Path) -> NewFiles:
    try:
        _undo(folder, stage)
        _clear(stage)
        (stage / "new").mkdir()
    except OSError as error:
        raise OutputError(f"nothing can be written into {shown(stage)}: {error.strerror}. Delete it.") from error
    return NewFiles(stage / "new")


def restore(folder: Path) -> None:
    """Put the old files back if a process was killed while it replaced them; delete what it left.

    Nothing happens while another process is writing, or if the folder cannot be written to.
    """
    stage = folder / STAGE
    if not os.path.lexists(stage):
        return
    with suppress(OSError):
        lock = _acquire(stage, patience=0.0)
        if lock is not None:
            try:
                _undo(folder, stage)
            finally:
                _release(stage, lock)


def _faults(new: NewFiles) -> str:
    return "\n".join(f"  {_listed(names)}: {_words(error)}" for names, error in new.failed.items())


def _listed(names: Sequence[str]) -> str:
    return f"{names[0]} and {len(names) - 1} more" if len(names) > MAX_NAMED else ", ".join(names)


def _words(error: Exception) -> str:
    words = (isinstance(error, OSError) and error.strerror) or str(error)  # strerror: without the temporary path
    return words if isinstance(error, Fault) else f"{type(error).__name__}: {words}"


# ------------------------------------------------------------------------------------------------- the transaction


def _swap(folder: Path, stage: Path) -> None:
    """Rename all new files to their places, or none.

    Raises:
        OutputError: If one of them cannot be replaced.
    """
    new, old = stage / "new", stage / "old"
    names = sorted(filter(NAMES.fullmatch, _names(new)), key=lambda name: (name == "report.html", name))
    old.mkdir()
    try:
        absent = [name for name in names if not _keep(folder / name, old / name)]
        write_text(stage / MARKER, json.dumps(absent))
        with interrupts_held():
            try:
                for name in names:
                    (folder / name).parent.mkdir(exist_ok=True)
                    os.replace(new / name, folder / name)
            except BaseException:
                _undo(folder, stage)
                raise
            for parent in {(folder / name).parent for name in names}:
                sync(parent)
            (stage / MARKER).unlink()
            sync(stage)
    except OSError as error:
        raise OutputError(
            f"{shown(Path(error.filename2 or error.filename or folder))} could not be replaced: "
            f"{error.strerror or error}. All files stay as they were. Close it if another program has it open."
        ) from error


def _keep(path: Path, copy: Path) -> bool:
    """Link or copy an old file, as it is; return False if there is none."""
    if path.parent.is_symlink():  # and could lead anywhere
        raise FileExistsError(0, "it is a link, and this writes into real folders only", str(path.parent))
    if not os.path.lexists(path):
        return False
    copy.parent.mkdir(exist_ok=True)
    try:
        os.link(path, copy, follow_symlinks=False)
    except (OSError, NotImplementedError):  # some file systems have no hard links
        shutil.copy2(path, copy, follow_symlinks=False)
        if not copy.is_symlink():
            sync(copy)
    return True


def _undo(folder: Path, stage: Path) -> None:
    """Put the old files back if a swap was begun and not committed. If this is interrupted, it can be repeated."""
    marker, old = stage / MARKER, stage / "old"
    if not os.path.lexists(marker):
        return
    absent: Any = []
    with suppress(OSError, ValueError, RecursionError):  # the folder may come from a stranger
        if marker.is_file() and marker.stat().st_size < MAX_MARKER:
            absent = json.loads(marker.read_text(encoding="utf-8"))
    for name in filter(_is_safe(folder), absent if isinstance(absent, list) else []):
        (folder / name).unlink(missing_ok=True)
        if "/" in name:
            with suppress(OSError):
                (folder / name).parent.rmdir()  # if this left it empty
    for name in filter(_is_safe(folder), [] if old.is_symlink() else _names(old)):
        os.replace(old / name, folder / name)
    sync(folder)
    marker.unlink()


def _is_safe(folder: Path) -> Callable[[Any], bool]:
    """Return what says whether a name is that of an output file, in the folder itself."""
    return lambda name: (
        isinstance(name, str) and bool(NAMES.fullmatch(name)) and not (folder / name).parent.is_symlink()
    )


def _names(folder: Path) -> Iterator[str]:
    """Yield the relative name of each file in a folder and in its folders; links to folders are not followed."""
    found = [(Path(parent) / file) for parent, _, files in os.walk(folder) for file in files]
    return (path.relative_to(folder).as_posix() for path in found)


# -------------------------------------------------------------------------------------------------------- the lock


def _acquire(stage: Path, patience: float) -> int | None:
    """Lock the hidden folder, which is made if need be; return the open lock file, or None if another has it."""
    until = time.monotonic() + patience
    while True:
        if stage.is_symlink():
            stage.unlink()
        stage.mkdir(exist_ok=True)
        path = stage / "lock"
        try:
            file = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
        except FileNotFoundError:  # its owner has just deleted the folder
            continue
        with suppress(OSError):
            if _lock(file) and os.path.samestat(os.fstat(file), os.lstat(path)):
                return file
        os.close(file)
        if time.monotonic() >= until:
            return None
        time.sleep(0.05)


def _lock(file: int) -> bool:
    """Lock an open file for this process; the system unlocks it when the file is closed or the process dies."""
    try:
        if sys.platform == "win32":
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        else:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:  # any other is of a file system without locks
        return not isinstance(error, BlockingIOError | PermissionError)
    return True


def _release(stage: Path, lock: int) -> None:
    """Delete the hidden folder and unlock it, unless files in it are needed to put the old ones back."""
    with suppress(OSError):
        if not os.path.lexists(stage / MARKER):
            _clear(stage)
            if sys.platform != "win32":
                (stage / "lock").unlink()  # while it is locked, or it could be another's
    os.close(lock)
    if sys.platform == "win32":
        with suppress(OSError):
            (stage / "lock").unlink()  # which fails while another has it open
    with suppress(OSError):
        stage.rmdir()


def _clear(stage: Path) -> None:
    """Delete all but the lock."""
    for path in stage.iterdir():
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        elif path.name != "lock":
            path.unlink()
