"""A run file opened: for one transaction, with bounds on what it may take, and in words where it cannot be."""

import os
import shutil
import sqlite3
from collections.abc import Generator
from contextlib import closing, contextmanager
from itertools import count
from pathlib import Path
from typing import Literal, TypeAlias
from uuid import uuid4

from walkerlab.errors import Fault
from walkerlab.runfile import schema
from walkerlab.runfile.schema import LAYOUT, NotARun
from walkerlab.system.files import quoted, shown

PAGE = 8192  # bytes; rows of nearly a kilobyte leave less of it empty than of the 4096 that SQLite takes
PATIENCE = 60  # s that a writer waits for who is reading, and the other way round
LONGEST = 200_000  # bytes of a text in the file; a longer one is refused before memory is taken for it
STEPS = 5_000_000  # of SQLite's machine that anything may take, and one more for each byte: ten times what is usual
STRIDE = 1000  # steps between two looks at how many are left

File: TypeAlias = Path | sqlite3.Connection
"""A run file, by its path; or a passing one, which has none."""


class RunFileError(Fault, ValueError):
    """A run file that cannot be used as asked; it says why, and what would."""


class DamagedError(RunFileError):
    """A run file of which something is not as it was written."""

    def __init__(self, file: File | str, what: str) -> None:
        """Say what is the matter, and how to save what is whole."""
        name = shown(file)
        super().__init__(
            f"{name} is damaged: {what}. The generations before the damage can be saved as a run of their own: "
            f'walkerlab rescue {quoted(file)}, or in Python wl.rescue({name!r}, "rescued.walk").'
        )
        self.what = what


@contextmanager
def drafted(path: Path) -> Generator[Path]:
    """Create a file complete and exclusively: yield the path of an empty draft beside it, which then gets its name.

    No reader sees a part of the file, and if several processes create it at once, all but one get an error.

    Args:
        path: File to create; its folder is created if it does not exist.

    Raises:
        RunFileError: if something exists at ``path`` (a run is never overwritten), or nothing can be written there.
    """
    with _in_words_if_impossible(path):
        if path.exists():
            raise FileExistsError
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = path.with_name(f".{uuid4().hex}.draft")
        draft.touch(exist_ok=False)
    try:
        yield draft
        with _in_words_if_impossible(path):
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
def _in_words_if_impossible(path: Path) -> Generator[None]:
    """Turn the errors of creating a file into a ``RunFileError``."""
    try:
        yield
    except FileExistsError as error:
        if error.filename and Path(error.filename) in path.parents:
            raise RunFileError(_impossible(path, f"{error.filename} is not a folder")) from error
        raise RunFileError(
            f"{path} exists already, and a run is never overwritten. "
            "Resume it, or give the new run another name or folder."
        ) from error
    except OSError as error:
        raise RunFileError(_impossible(path, error.strerror)) from error
    except ValueError as error:
        raise RunFileError(_impossible(path, str(error))) from error


def _impossible(path: Path, why: str | None) -> str:
    return f"no run file can be made at {str(path)!r}: {why}. Give it another name or folder."


@contextmanager
def opened(
    file: File, how: Literal["make", "look", "check", "rescue", "change"] = "look", name: Path | None = None
) -> Generator[sqlite3.Connection, None, None]:
    """Open a run file for one transaction; of one of an earlier layout, a renewed copy in memory.

    Args:
        file: a run file.
        how: ``make`` it; ``look`` into it; ``check`` first if all of its pages hold together; ``rescue`` what can be
            read, also where the end is cut off; or ``change`` it, which renews the file itself.
        name: what messages call the file; its own path if None.
    """
    if isinstance(file, Path) and how != "make" and not file.is_file():
        raise RunFileError(f"there is no run file at {shown(file)}")
    db = file
    try:
        db = connect(file) if isinstance(file, Path) else file
        if how == "make":
            db.execute("PRAGMA journal_mode = MEMORY")  # nobody knows a draft, so nobody needs to repair one
            db.set_progress_handler(None, 0)  # all that is in it comes from here
        db.execute(f"PRAGMA page_size = {PAGE}")  # of a new file; any other has its own
        db.execute(f"PRAGMA writable_schema = {how == 'rescue'}")  # or SQLite refuses a file that is cut off
        layout = LAYOUT if how == "make" else schema.recognise(db)
        if how == "change":
            db.execute("PRAGMA journal_mode = DELETE")  # also where another program has set a mode of several files
        if (how == "check" or layout < LAYOUT) and db.execute("PRAGMA quick_check(1)").fetchone() != ("ok",):
            raise DamagedError(file, "its pages do not hold together")
        if layout < LAYOUT and how != "change":
            if db.execute("PRAGMA freelist_count").fetchone()[0] > 9:  # pages that no run leaves empty
                raise DamagedError(file, "most of it is empty")
            old, db = db, connect(":memory:", n_bytes=file.stat().st_size if isinstance(file, Path) else 0)
            with closing(old):
                old.backup(db)
        db.execute("BEGIN")
        try:
            if layout < LAYOUT:
                schema.renew(db, layout)
            yield db
            if how in ("make", "change"):
                db.commit()
        finally:
            db.rollback()  # of what is not committed
    except NotARun as error:
        raise RunFileError(f"{shown(file)} {error}.") from error
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_CORRUPT) & 0xFF  # none where a text is no text
        if code in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_TOOBIG):
            raise DamagedError(name or file, f"as SQLite says, {error}") from error
        if code == sqlite3.SQLITE_INTERRUPT:
            raise DamagedError(name or file, "there is no end to what is in it, as far as one can see") from error
        whole = " What was in it is whole." if how == "change" else ""
        raise RunFileError(f"{shown(name or file)} cannot be used: {_WORDS.get(code, error)}.{whole}") from error
    finally:
        if isinstance(db, sqlite3.Connection) and db is not file:
            db.close()


def connect(file: Path | str, n_bytes: int = 0) -> sqlite3.Connection:
    """Open a file with the bounds that hold for a stranger's.

    Args:
        file: Path of the file, or ``:memory:``.
        n_bytes: Size of what will be copied into it.
    """
    db = sqlite3.connect(file, timeout=PATIENCE)
    db.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LONGEST)
    left = count(STEPS + (Path(file).stat().st_size if Path(file).is_file() else n_bytes), -STRIDE)
    db.set_progress_handler(lambda: next(left) < 0, STRIDE)
    db.execute("PRAGMA trusted_schema = OFF")
    return db


_WORDS = {
    sqlite3.SQLITE_FULL: "the disk is full. Make room",
    sqlite3.SQLITE_READONLY: "it, or the folder that it is in, cannot be written to. Copy it into a folder of your own",
    sqlite3.SQLITE_CANTOPEN: "it, or the folder that it is in, cannot be opened. Copy it into a folder of your own",
    sqlite3.SQLITE_PERM: "you may not write to it. Copy it into a folder of your own",
    sqlite3.SQLITE_BUSY: f"another program has been busy with it for {PATIENCE} s. Try again when that is done",
    sqlite3.SQLITE_NOTADB: "it is not a database, but something else",
    sqlite3.SQLITE_IOERR: "the disk is full, or failed, or the network before it is gone",
}
"""What is the matter, and the mend, by what SQLite calls it."""
