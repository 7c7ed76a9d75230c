"""Open a run file for one transaction, with limits on the time and memory that an untrusted file may use."""

import os
import shutil
import sqlite3
from collections.abc import Callable, Generator
from contextlib import closing, contextmanager
from itertools import count
from pathlib import Path
from typing import Literal, TypeAlias
from uuid import uuid4

from walkerlab.runfile import schema
from walkerlab.runfile.schema import LAYOUT_VERSION, LayoutError
from walkerlab.system.errors import WalkerlabError
from walkerlab.system.files import display_path, quote_path

PAGE_SIZE = 8192  # bytes; rows of nearly a kilobyte waste less space than with SQLite's default, 4096
LOCK_TIMEOUT = 60  # s to wait while another program reads or writes the file
MAX_TEXT_SIZE = 200_000  # bytes; a longer text is rejected before memory is allocated for it
MAX_STEPS = 5_000_000  # SQLite's virtual machine steps per transaction, plus one per byte; ten times the usual
STEPS_PER_CHECK = 1000  # steps between two checks of MAX_STEPS
MAX_FREE_PAGES = 9  # maximum number of unused pages in a file of an earlier layout; no run leaves that many

RunFile: TypeAlias = Path | sqlite3.Connection
"""Path of a run file, or the connection to a temporary one, which has no path."""


class RunFileError(WalkerlabError, ValueError):
    """A run file cannot be used as requested; the message says why, and how to fix it."""


class DamagedError(RunFileError):
    """The contents of a run file were changed or damaged after they were written."""

    def __init__(self, file: RunFile | str, what: str) -> None:
        """Compose the message, which says how to save the undamaged part.

        Args:
            file: Damaged file.
            what: Description of the damage.
        """
        name = display_path(file)
        super().__init__(
            f"{name} is damaged: {what}. The generations before the damage can be saved as a new run: "
            f'walkerlab rescue {quote_path(file)}, or in Python wl.rescue({name!r}, "rescued.walk").'
        )
        self.what = what


@contextmanager
def draft_of(path: Path) -> Generator[Path]:
    """Yield the path of an empty draft beside a new file; when the block ends, the draft gets the name of the file.

    Readers never see an incomplete file. If several processes create the same file at once, all but one get an error.

    Args:
        path: File to create; its folder is created if it does not exist.

    Raises:
        RunFileError: If ``path`` exists already (a run is never overwritten) or cannot be created.
    """
    with _errors_explained(path):
        if path.exists():
            raise FileExistsError
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = path.with_name(f".{uuid4().hex}.draft")
        draft.touch(exist_ok=False)
    try:
        yield draft
        with _errors_explained(path):
            _publish(draft, path)
    finally:
        draft.unlink(missing_ok=True)


def _publish(draft: Path, path: Path) -> None:
    """Give a complete file its final name, which must be unused."""
    try:
        os.link(draft, path)
    except FileExistsError:
        raise
    except OSError:  # a file system without hard links, such as FAT or a mounted cloud drive
        with path.open("xb") as copy, draft.open("rb") as complete:
            try:
                shutil.copyfileobj(complete, copy)
                copy.flush()
                os.fsync(copy.fileno())
            except BaseException:
                copy.close()
                path.unlink()
                raise


@contextmanager
def _errors_explained(path: Path) -> Generator[None]:
    """Convert errors raised while a file is created to a ``RunFileError``."""
    try:
        yield
    except FileExistsError as error:
        if error.filename and Path(error.filename) in path.parents:
            raise RunFileError(_cannot_create(path, f"{error.filename} is not a folder")) from error
        raise RunFileError(
            f"{display_path(path)} exists already, and a run is never overwritten. "
            "Resume it, or give the new run another name or folder."
        ) from error
    except OSError as error:
        raise RunFileError(_cannot_create(path, error.strerror)) from error
    except ValueError as error:
        raise RunFileError(_cannot_create(path, str(error))) from error


def _cannot_create(path: Path, reason: str | None) -> str:
    return f"no run file can be created at {str(path)!r}: {reason}. Give it another name or folder."


@contextmanager
def open_run(
    file: RunFile,
    mode: Literal["create", "read", "check", "rescue", "write"] = "read",
    name: Path | None = None,
    read_layout: Callable[[sqlite3.Connection], int] = schema.read_layout,
) -> Generator[sqlite3.Connection, None, None]:
    """Open a run file for one transaction; a file of an earlier layout is read from an upgraded copy in memory.

    Args:
        file: Run file.
        mode: ``create`` fills an empty file; ``read`` reads; ``check`` reads after checking the integrity of all pages;
            ``rescue`` reads as much as possible, even from a truncated file; ``write`` writes, and upgrades the layout.
        name: Path for messages; if None, the path of the file.
        read_layout: Function that checks the tables of the file and returns the number of its layout.

    Raises:
        RunFileError: If the file does not exist, is not a run, or cannot be used.
        DamagedError: If its contents were changed or damaged.
    """
    if isinstance(file, Path) and mode != "create" and not file.is_file():
        raise RunFileError(f"there is no run file at {display_path(file)}")
    db = file
    try:
        db = open_database(file) if isinstance(file, Path) else file
        if mode == "create":
            db.execute("PRAGMA journal_mode = MEMORY")  # an incomplete draft is deleted, and never repaired
            db.set_progress_handler(None, 0)  # no limit, since all contents are our own
        db.execute(f"PRAGMA page_size = {PAGE_SIZE}")  # has an effect on a new file only
        db.execute(f"PRAGMA writable_schema = {mode == 'rescue'}")  # without it SQLite rejects a truncated file
        layout = LAYOUT_VERSION if mode == "create" else read_layout(db)
        if mode == "write":
            db.execute("PRAGMA journal_mode = DELETE")  # another program may have set a mode with several files
        if (mode == "check" or layout < LAYOUT_VERSION) and db.execute("PRAGMA quick_check(1)").fetchone() != ("ok",):
            raise DamagedError(file, "its pages are inconsistent")
        if layout < LAYOUT_VERSION and mode != "write":
            if db.execute("PRAGMA freelist_count").fetchone()[0] > MAX_FREE_PAGES:
                raise DamagedError(file, "most of it is empty")
            original = db
            db = open_database(":memory:", n_bytes=file.stat().st_size if isinstance(file, Path) else 0)
            with closing(original):
                original.backup(db)
        db.execute("BEGIN")
        try:
            if layout < LAYOUT_VERSION:
                schema.upgrade_file(db, layout)
            yield db
            if mode in ("create", "write"):
                db.commit()
        finally:
            db.rollback()  # has no effect after a commit
    except LayoutError as error:
        raise RunFileError(f"{display_path(file)} {error}.") from error
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_CORRUPT) & 0xFF  # text that is not UTF-8 has no code
        if code in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_TOOBIG):
            raise DamagedError(name or file, f"SQLite reports: {error}") from error
        if code == sqlite3.SQLITE_INTERRUPT:
            raise DamagedError(name or file, "reading it takes far longer than its size allows") from error
        unchanged = " Its contents have not changed." if mode == "write" else ""
        raise RunFileError(
            f"{display_path(name or file)} cannot be used: {_SQLITE_ADVICE.get(code, error)}.{unchanged}"
        ) from error
    finally:
        if isinstance(db, sqlite3.Connection) and db is not file:
            db.close()


def open_database(file: Path | str, n_bytes: int = 0) -> sqlite3.Connection:
    """Open a SQLite file with the limits for an untrusted file.

    Args:
        file: Path of the file, or ``:memory:``.
        n_bytes: Size of the data that will be copied into it.
    """
    db = sqlite3.connect(file, timeout=LOCK_TIMEOUT)
    db.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_TEXT_SIZE)
    n_bytes = Path(file).stat().st_size if Path(file).is_file() else n_bytes
    steps_left = count(MAX_STEPS + n_bytes, -STEPS_PER_CHECK)
    db.set_progress_handler(lambda: next(steps_left) < 0, STEPS_PER_CHECK)
    db.execute("PRAGMA trusted_schema = OFF")
    return db


_SQLITE_ADVICE = {
    sqlite3.SQLITE_FULL: "the disk is full. Free some space",
    sqlite3.SQLITE_READONLY: "the file or its folder cannot be written to. Copy it into a folder that you can write to",
    sqlite3.SQLITE_CANTOPEN: "the file or its folder cannot be opened. Copy it into a folder that you can write to",
    sqlite3.SQLITE_PERM: "you have no permission to write to it. Copy it into a folder that you can write to",
    sqlite3.SQLITE_BUSY: f"another program has been using it for {LOCK_TIMEOUT} s. Try again when that program is done",
    sqlite3.SQLITE_NOTADB: "it is not a run file; walkerlab evolve writes one, with a name that ends in .walk",
    sqlite3.SQLITE_IOERR: "the disk is full or has failed, or its network connection is lost",
}
"""What is wrong and how to fix it, keyed by SQLite's error code."""
