"""The run file: one SQLite file that holds the settings and the tidy table, a generation to a transaction.

Whatever moment the process dies at, the file holds whole generations. It stores text and numbers only: nothing in
it can run when it is opened.
"""

import json
import platform
import sqlite3
import weakref
from collections.abc import Generator, Iterable, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeAlias

import pandas as pd

from walkerlab.records import COLUMNS, tidy

APPLICATION = 0x77616C6B  # "walk", in the file's header
SCHEMA = 2
RUN_FILE = "run.walk"  # its name in a folder of its own
PAGE = 8192  # bytes; rows of nearly a kilobyte leave less of it empty than of the 4096 that SQLite takes
PATIENCE = 60  # s that a writer waits for who is reading, and the other way round

File: TypeAlias = Path | sqlite3.Connection
"""A run file, by its path; or a passing one, which has none."""

_SQL = {int: "INTEGER", float: "REAL", str: "TEXT"}
_FACTS = "CREATE TABLE run (fact TEXT PRIMARY KEY, value TEXT NOT NULL)"
_RECORDS = (
    f"CREATE TABLE records ({', '.join(f'{name} {_SQL[kind]}' for name, (kind, *_) in COLUMNS.items())}, "
    "PRIMARY KEY (generation, individual))"
)


class RunFileError(ValueError):
    """A run file that cannot be used as asked; it says why, and what would."""


def locate(path: str | Path) -> Path:
    """Return the run file that is meant by its own path, or by that of its folder."""
    path = Path(path)
    return path / RUN_FILE if path.is_dir() else path


def claim(path: Path) -> None:
    """Make sure that a new run file can be made here; its folder is made if need be.

    Raises:
        RunFileError: if something is there already (a run is never written over), or nothing can be written there.
    """
    if path.exists():
        raise RunFileError(
            f"{path} exists already, and a run is never written over. "
            "Resume it, or give the new run another name or folder."
        )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch(exist_ok=False)
        path.unlink()
    except OSError as error:
        raise RunFileError(f"no run file can be made at {path}: {error.strerror}. Give it another folder.") from error


def passing(keeper: object) -> sqlite3.Connection:
    """Make a file for a run that nobody keeps: it has no name, and goes with its keeper, whatever ends that.

    It is in memory while it is small. It is for one thread at a time, whichever that is.
    """
    db = sqlite3.connect("", check_same_thread=False)
    weakref.finalize(keeper, db.close)
    return db


def create(file: File, settings: dict[str, Any], generation: pd.DataFrame) -> None:
    """Make a run file with its first generation: all of it, or nothing.

    Args:
        file: claimed before, or passing.
        settings: as plain data.
        generation: the tidy table of generation 0.

    Raises:
        RunFileError: if the file cannot be written.
    """
    facts = {
        "settings": json.dumps(settings),
        "python": platform.python_version(),
        "machine": f"{platform.system()} {platform.machine()}",
        **{name: version(name) for name in ("walkerlab", "mujoco", "dm-control", "numpy")},
    }
    with _open(file, new=True) as db:
        db.execute(f"PRAGMA application_id = {APPLICATION}")
        db.execute(f"PRAGMA user_version = {SCHEMA}")
        db.execute(_FACTS)
        db.execute(_RECORDS)
        db.executemany("INSERT INTO run VALUES (?, ?)", facts.items())
        _insert(db, generation)


def append(file: File, generation: pd.DataFrame) -> None:
    """Add one generation: all of it, or nothing."""
    with _open(file) as db:
        _insert(db, generation)


def _insert(db: sqlite3.Connection, generation: pd.DataFrame) -> None:
    rows = zip(*(generation[name].tolist() for name in COLUMNS), strict=True)
    db.executemany(f"INSERT INTO records VALUES ({', '.join('?' * len(COLUMNS))})", rows)


def change_settings(path: Path, settings: dict[str, Any]) -> None:
    """Write down the settings under which a run goes on."""
    with _open(path) as db:
        db.execute("UPDATE run SET value = ? WHERE fact = 'settings'", [json.dumps(settings)])


def read(path: Path) -> tuple[dict[str, str], dict[str, Any], pd.DataFrame]:
    """Read a run file: its facts, its settings as plain data, and its table.

    Raises:
        RunFileError: if there is no such file, or it is not one of ours.
    """
    with _open(path) as db:
        facts = dict(db.execute("SELECT fact, value FROM run"))
        table = _table(db, path)
    try:
        return facts, json.loads(facts["settings"]), table
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        raise RunFileError(f"{path} is damaged: {error!r}") from error


def read_generations(file: File, first: int, end: int) -> pd.DataFrame:
    """Read the table of some generations: the first of them, and those after it that are before the end."""
    with _open(file) as db:
        return _table(db, file, "WHERE generation >= ? AND generation < ?", (first, end))


def read_births(file: File, columns: Sequence[str], births: Iterable[Sequence[int]]) -> list[tuple[Any, ...]]:
    """Read some columns of some individuals, each in the generation given, where it is there.

    Args:
        file: of the run.
        columns: their names.
        births: generation and number of each individual.
    """
    of_one = f"SELECT {', '.join(columns)} FROM records WHERE generation = ? AND individual = ?"
    with _open(file) as db:
        return [row for birth in births for row in db.execute(of_one, birth)]


def _table(db: sqlite3.Connection, file: File, where: str = "", given: Sequence[int] = ()) -> pd.DataFrame:
    rows = db.execute(f"SELECT {', '.join(COLUMNS)} FROM records {where} ORDER BY generation, rowid", given).fetchall()
    try:
        return tidy(pd.DataFrame(rows, columns=list(COLUMNS)))
    except (TypeError, ValueError) as error:
        raise RunFileError(f"{file} is damaged: {error!r}") from error


@contextmanager
def _open(file: File, *, new: bool = False) -> Generator[sqlite3.Connection, None, None]:
    """Open a run file for one transaction."""
    if isinstance(file, Path) and not new and not file.is_file():
        raise RunFileError(f"there is no run file at {file}")
    db = sqlite3.connect(file, timeout=PATIENCE) if isinstance(file, Path) else file
    try:
        db.execute(f"PRAGMA page_size = {PAGE}")  # of a new file; any other has its own
        db.execute("PRAGMA trusted_schema = OFF")
        if not new and db.execute("PRAGMA application_id").fetchone() != (APPLICATION,):
            raise RunFileError(f"{file} is a SQLite file, but not a run of walkerlab's")
        found = SCHEMA if new else db.execute("PRAGMA user_version").fetchone()[0]
        if found > SCHEMA:
            raise RunFileError(
                f"{file} has layout {found}, and this walkerlab knows layouts up to {SCHEMA}: a newer one wrote it. "
                "Update with: pip install --upgrade walkerlab"
            )
        if found < SCHEMA:
            raise RunFileError(
                f"{file} has layout {found}, from before walkerlab's first release, and cannot be read any more. "
                "Evolve it anew."
            )
        with db:
            db.execute("BEGIN")
            yield db
    except sqlite3.Error as error:
        raise RunFileError(f"{file} cannot be used as a run file: {error}") from error
    finally:
        if db is not file:
            db.close()
