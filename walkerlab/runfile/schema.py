"""Layout of the tables in a run file, of this and earlier releases, and the seals that detect damage.

A file of layout 3 has four tables: ``run``, facts keyed by name; ``records``, the tidy table; ``provenance``, the
versions, machine and functions that produced the generations; ``generations``, the provenance and the seal of each
generation. A seal is a digest of all rows of a generation.
"""

import json
import math
import sqlite3
from collections.abc import Callable, Iterator
from hashlib import sha256
from typing import Any
from uuid import uuid4

from walkerlab.runfile.records import RECORD_COLUMNS
from walkerlab.text import strict_json

APPLICATION_ID = 0x77616C6B  # "walk", in the header of the file
EXPERIMENT_ID = 0x77616C78  # "walx", in the header of a file with an experiment
LAYOUT_VERSION = 3
OLDEST_LAYOUT = 2  # oldest layout that can be read; layout 1 was never released

SQL_TYPES = {int: "INTEGER", float: "REAL", str: "TEXT"}
_CREATE_RUN = "CREATE TABLE run (fact TEXT PRIMARY KEY, value TEXT NOT NULL)"
_CREATE_RECORDS = (
    f"CREATE TABLE records ({', '.join(f'{name} {SQL_TYPES[kind]}' for name, (kind, *_) in RECORD_COLUMNS.items())}, "
    "PRIMARY KEY (generation, individual))"
)
_CREATE_PROVENANCE = "CREATE TABLE provenance (number INTEGER PRIMARY KEY, made_with TEXT NOT NULL UNIQUE)"
_CREATE_GENERATIONS = (
    "CREATE TABLE generations (generation INTEGER PRIMARY KEY, provenance INTEGER NOT NULL, seal TEXT NOT NULL)"
)
_TABLES_BY_LAYOUT = {
    2: (_CREATE_RUN, _CREATE_RECORDS),
    3: (_CREATE_RUN, _CREATE_RECORDS, _CREATE_PROVENANCE, _CREATE_GENERATIONS),
}

_SELECT_ROWS = f"SELECT {', '.join(RECORD_COLUMNS)} FROM records WHERE generation = ? ORDER BY rowid"


class LayoutError(Exception):
    """A SQLite file does not have the layout of a run file; the message is appended to the file name."""


def create_tables(db: sqlite3.Connection, settings: str, history: str = "") -> str:
    """Create the tables of a new run.

    Args:
        db: Open transaction on an empty file.
        settings: Settings as JSON.
        history: History as JSON; "" if there is none.

    Returns:
        Id of the run.
    """
    db.execute(f"PRAGMA application_id = {APPLICATION_ID}")
    db.execute(f"PRAGMA user_version = {LAYOUT_VERSION}")
    for table in _TABLES_BY_LAYOUT[LAYOUT_VERSION]:
        db.execute(table)
    run_id = uuid4().hex
    db.execute("INSERT INTO run VALUES ('id', ?)", [run_id])
    write_settings(db, settings)
    if history:
        write_history(db, history)
    return run_id


def write_settings(db: sqlite3.Connection, settings: str) -> None:
    """Write the settings, as JSON, and their digest."""
    _write_with_digest(db, "settings", settings)


def write_history(db: sqlite3.Connection, history: str) -> None:
    """Write the history, as JSON, and its digest; "" removes it."""
    if history:
        _write_with_digest(db, "history", history)
    else:
        db.execute("DELETE FROM run WHERE fact IN ('history', 'history digest')")


def _write_with_digest(db: sqlite3.Connection, name: str, text: str) -> None:
    facts = {name: text, f"{name} digest": sha256_digest(text)}
    db.executemany("INSERT OR REPLACE INTO run VALUES (?, ?)", facts.items())


def read_layout(db: sqlite3.Connection) -> int:
    """Return the number of a file's layout, after checking that it has exactly the tables of that layout.

    Nothing else of an untrusted file may be read before this.

    Raises:
        LayoutError: If the file is not a run, its layout is unknown, or its tables are not those of its layout.
    """
    found = db.execute("SELECT sql FROM sqlite_schema WHERE sql IS NOT NULL LIMIT 9").fetchall()
    if not found:
        raise LayoutError(
            "is empty: it is being created by another program, or its contents are lost. If it stays empty, delete it "
            "and evolve again"
        )
    (application,) = db.execute("PRAGMA application_id").fetchone()
    if application == EXPERIMENT_ID:
        raise LayoutError(
            "contains an experiment, which has several runs. Open it with wl.load_experiment(path); one of its runs is "
            "then experiment.run(condition, seed)"
        )
    if application != APPLICATION_ID:
        raise LayoutError("is a SQLite file, but not a run file of walkerlab. Give the path of a run file")
    layout = read_layout_version(db, LAYOUT_VERSION)
    if layout < OLDEST_LAYOUT:
        raise LayoutError(
            f"has layout {layout}, from before walkerlab's first release, and can no longer be read. Evolve it again"
        )
    if sorted(str(sql) for (sql,) in found) != sorted(_TABLES_BY_LAYOUT[layout]):
        raise LayoutError("is damaged or was changed by another program: its tables are not those of a run file")
    return layout


def read_layout_version(db: sqlite3.Connection, newest: int) -> int:
    """Return the number of a file's layout.

    Args:
        db: Open transaction.
        newest: Highest number that this version of walkerlab reads.

    Raises:
        LayoutError: If the number is higher.
    """
    layout: int = db.execute("PRAGMA user_version").fetchone()[0]
    if layout > newest:
        raise LayoutError(
            f"has layout {layout}, which a newer walkerlab wrote; this one reads layouts up to {newest}. "
            "Update with: pip install --upgrade walkerlab"
        )
    return layout


def upgrade_file(db: sqlite3.Connection, layout: int) -> None:
    """Convert a file of an earlier layout to the current one, one layout at a time."""
    for step in range(layout, LAYOUT_VERSION):
        _UPGRADES[step](db)
    db.execute(f"PRAGMA user_version = {LAYOUT_VERSION}")


def read_rows(db: sqlite3.Connection, generation: int) -> list[tuple[Any, ...]]:
    """Read the rows of a generation, in the order in which they were written."""
    return db.execute(_SELECT_ROWS, [generation]).fetchall()


def seal_generation(db: sqlite3.Connection, generation: int, made_with: str) -> None:
    """Seal a generation after its rows have been written.

    Args:
        db: Open transaction.
        generation: Number of the generation.
        made_with: Provenance of the generation, as JSON.
    """
    db.execute("INSERT OR IGNORE INTO provenance (made_with) VALUES (?)", [made_with])
    seal = _seal_of(db, generation, made_with, read_rows(db, generation))
    row = "SELECT ?, number, ? FROM provenance WHERE made_with = ?"
    db.execute(f"INSERT INTO generations {row}", [generation, seal, made_with])


def sealed_generations(
    db: sqlite3.Connection, first: float = -math.inf, end: float = math.inf
) -> Iterator[tuple[int, str, list[tuple[Any, ...]] | None]]:
    """Yield the number, provenance and rows of each generation; None in place of rows that do not match the seal.

    Args:
        db: Open transaction.
        first: Number of the first generation.
        end: Number of the generation after the last.
    """
    sealed = (
        "SELECT generation, made_with, seal FROM generations LEFT JOIN provenance ON number = provenance "
        "WHERE generation >= ? AND generation < ? ORDER BY generation"
    )
    for generation, made_with, seal in db.execute(sealed, (first, end)):
        rows = read_rows(db, generation)
        yield generation, made_with, rows if seal == _seal_of(db, generation, made_with, rows) else None


def read_made_with(db: sqlite3.Connection) -> dict[str, str]:
    """Return the provenance of the last generation."""
    last = "SELECT max(generation), made_with FROM generations JOIN provenance ON number = provenance"
    _, facts = db.execute(last).fetchone()
    return {name: str(value) for name, value in strict_json.loads(facts or "{}").items()}


def read_fact(db: sqlite3.Connection, name: str) -> str:
    """Return a fact of the run; "" if it has no fact with this name."""
    row = db.execute("SELECT value FROM run WHERE fact = ?", [name]).fetchone()
    return str(row[0]) if row else ""


def sha256_digest(text: str) -> str:
    """Return the SHA-256 of a string, 64 hexadecimal digits."""
    return sha256(text.encode(errors="replace")).hexdigest()


def _seal_of(db: sqlite3.Connection, *contents: object) -> str:
    """Return the digest of contents and of the id of the run, so that a generation cannot be moved to another run."""
    return sha256_digest(repr((read_fact(db, "id"), *contents)))


def _upgrade_from_2(db: sqlite3.Connection) -> None:
    """Record the versions, which were facts of the run, with each generation, and seal it."""
    db.execute(_CREATE_PROVENANCE)
    db.execute(_CREATE_GENERATIONS)
    versions = dict(db.execute("SELECT fact, value FROM run WHERE fact != 'settings'"))
    settings = read_fact(db, "settings")
    db.execute("DELETE FROM run")
    db.execute("INSERT INTO run VALUES ('id', ?)", [sha256_digest(repr((settings, versions)))[:32]])
    write_settings(db, settings)
    for (generation,) in db.execute("SELECT DISTINCT generation FROM records").fetchall():
        seal_generation(db, generation, json.dumps(versions))


_UPGRADES: dict[int, Callable[[sqlite3.Connection], None]] = {2: _upgrade_from_2}
