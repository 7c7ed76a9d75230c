"""How a run file is laid out inside, now and in earlier releases; and the seals by which damage is known.

A file of layout 3 has four tables: ``run``, facts by name; ``records``, the tidy table; ``provenance``, with what
generations were made; ``generations``, of each its provenance and its seal.
"""

import json
import math
import sqlite3
from collections.abc import Callable, Iterator
from hashlib import sha256
from typing import Any
from uuid import uuid4

from walkerlab.runfile.records import COLUMNS
from walkerlab.text import strict_json

APPLICATION = 0x77616C6B  # "walk", in the file's header
LAYOUT = 3
OLDEST = 2  # that can be read; layout 1 was never released

_SQL = {int: "INTEGER", float: "REAL", str: "TEXT"}
_RUN = "CREATE TABLE run (fact TEXT PRIMARY KEY, value TEXT NOT NULL)"
_RECORDS = (
    f"CREATE TABLE records ({', '.join(f'{name} {_SQL[kind]}' for name, (kind, *_) in COLUMNS.items())}, "
    "PRIMARY KEY (generation, individual))"
)
_PROVENANCE = "CREATE TABLE provenance (number INTEGER PRIMARY KEY, made_with TEXT NOT NULL UNIQUE)"
_GENERATIONS = (
    "CREATE TABLE generations (generation INTEGER PRIMARY KEY, provenance INTEGER NOT NULL, seal TEXT NOT NULL)"
)
_TABLES = {2: (_RUN, _RECORDS), 3: (_RUN, _RECORDS, _PROVENANCE, _GENERATIONS)}

_ROWS = f"SELECT {', '.join(COLUMNS)} FROM records WHERE generation = ? ORDER BY rowid"


class NotARun(Exception):
    """A SQLite file that is not laid out as a run of ours; it says how."""


def lay_out(db: sqlite3.Connection, settings: str) -> str:
    """Make the tables of a new run, with its facts, and return its id."""
    db.execute(f"PRAGMA application_id = {APPLICATION}")
    db.execute(f"PRAGMA user_version = {LAYOUT}")
    for table in _TABLES[LAYOUT]:
        db.execute(table)
    run_id = uuid4().hex
    db.execute("INSERT INTO run VALUES ('id', ?)", [run_id])
    write_settings(db, settings)
    return run_id


def write_settings(db: sqlite3.Connection, settings: str) -> None:
    """Write down the settings, and their digest."""
    facts = {"settings": settings, "settings digest": digest(settings)}
    db.executemany("INSERT OR REPLACE INTO run VALUES (?, ?)", facts.items())


def recognise(db: sqlite3.Connection) -> int:
    """Return the layout of a file, of which nothing is used before: one that has anything else in it is none.

    Raises:
        NotARun: if it is no run, of a layout that is not known, or holds more or less than its layout says.
    """
    found = db.execute("SELECT sql FROM sqlite_schema WHERE sql IS NOT NULL LIMIT 9").fetchall()
    if not found:
        raise NotARun(
            "is empty: it is being created just now, nothing was ever written to it, or its contents are lost. If it "
            "stays empty, delete it and evolve again"
        )
    if db.execute("PRAGMA application_id").fetchone() != (APPLICATION,):
        raise NotARun("is a SQLite file, but not a run of walkerlab's")
    layout: int = db.execute("PRAGMA user_version").fetchone()[0]
    if layout > LAYOUT:
        raise NotARun(
            f"has layout {layout}, and this walkerlab knows layouts up to {LAYOUT}: a newer one wrote it. "
            "Update with: pip install --upgrade walkerlab"
        )
    if layout < OLDEST:
        raise NotARun(
            f"has layout {layout}, from before walkerlab's first release, and cannot be read any more. Evolve it anew"
        )
    if sorted(str(sql) for (sql,) in found) != sorted(_TABLES[layout]):
        raise NotARun("is damaged, or somebody has meddled with it: it is not laid out as a run file is")
    return layout


def renew(db: sqlite3.Connection, layout: int) -> None:
    """Bring a file of an earlier layout to this one, a step at a time."""
    for step in range(layout, LAYOUT):
        _STEPS[step](db)
    db.execute(f"PRAGMA user_version = {LAYOUT}")


def rows(db: sqlite3.Connection, generation: int) -> list[tuple[Any, ...]]:
    """Read the rows of a generation in the order in which they were written."""
    return db.execute(_ROWS, [generation]).fetchall()


def seal(db: sqlite3.Connection, generation: int, made_with: str) -> None:
    """Seal a generation, whose rows are written, with what it was made with."""
    db.execute("INSERT OR IGNORE INTO provenance (made_with) VALUES (?)", [made_with])
    of_it = _seal(db, generation, made_with, rows(db, generation))
    whose = "SELECT ?, number, ? FROM provenance WHERE made_with = ?"
    db.execute(f"INSERT INTO generations {whose}", [generation, of_it, made_with])


def generations(
    db: sqlite3.Connection, first: float = -math.inf, end: float = math.inf
) -> Iterator[tuple[int, str, list[tuple[Any, ...]] | None]]:
    """Yield the generations from the first to before the end: number, what it was made with, rows as they were written.

    Of one in which anything is otherwise there are no rows, but None.
    """
    sealed = (
        "SELECT generation, made_with, seal FROM generations LEFT JOIN provenance ON number = provenance "
        "WHERE generation >= ? AND generation < ? ORDER BY generation"
    )
    for generation, made_with, of_it in db.execute(sealed, (first, end)):
        found = rows(db, generation)
        yield generation, made_with, found if of_it == _seal(db, generation, made_with, found) else None


def made_with(db: sqlite3.Connection) -> dict[str, str]:
    """Return what the last generation was made with."""
    last = "SELECT max(generation), made_with FROM generations JOIN provenance ON number = provenance"
    _, facts = db.execute(last).fetchone()
    return {name: str(value) for name, value in strict_json.loads(facts or "{}").items()}


def fact(db: sqlite3.Connection, name: str) -> str:
    """Return a fact of the run; "" if there is none of that name."""
    found = db.execute("SELECT value FROM run WHERE fact = ?", [name]).fetchone()
    return str(found[0]) if found else ""


def digest(text: str) -> str:
    """Return the SHA-256 of a text, 64 hexadecimal digits."""
    return sha256(text.encode(errors="replace")).hexdigest()


def _seal(db: sqlite3.Connection, *sealed: object) -> str:
    """Digest what is sealed, together with whose it is, so that no generation fits into another run."""
    return digest(repr((fact(db, "id"), *sealed)))


def _from_2(db: sqlite3.Connection) -> None:
    """Give each generation the versions, which were facts of the whole run, and a seal."""
    db.execute(_PROVENANCE)
    db.execute(_GENERATIONS)
    versions = dict(db.execute("SELECT fact, value FROM run WHERE fact != 'settings'"))
    settings = fact(db, "settings")
    db.execute("DELETE FROM run")
    db.execute("INSERT INTO run VALUES ('id', ?)", [digest(repr((settings, versions)))[:32]])
    write_settings(db, settings)
    for (generation,) in db.execute("SELECT DISTINCT generation FROM records").fetchall():
        seal(db, generation, json.dumps(versions))


_STEPS: dict[int, Callable[[sqlite3.Connection], None]] = {2: _from_2}
