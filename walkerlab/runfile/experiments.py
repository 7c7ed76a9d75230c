"""The file of an experiment: one SQLite file with the plan and the tables of all runs.

It follows the rules of a run file: one transaction and one seal for each generation, text and numbers only, and nothing
in it is ever executed. Its tables are ``experiment``, facts keyed by name, including the plan; ``records``, the tidy
tables of the runs; ``provenance``; ``generations``, the seal of each generation; and ``finished``, the runs that have
ended.
"""

import json
import sqlite3
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal, NamedTuple
from uuid import uuid4

import pandas as pd

from walkerlab.runfile import provenance, schema
from walkerlab.runfile.opening import DamagedError, RunFile, RunFileError, draft_of, open_run
from walkerlab.runfile.records import RECORD_COLUMNS, check_table, tidy_table
from walkerlab.runfile.schema import LayoutError
from walkerlab.system.files import display_path
from walkerlab.text import strict_json

LAYOUT_VERSION = 1
_COLUMNS = ("condition", "seed", *RECORD_COLUMNS)
_TABLES = (
    "CREATE TABLE experiment (fact TEXT PRIMARY KEY, value TEXT NOT NULL)",
    "CREATE TABLE records (condition INTEGER, seed INTEGER, "
    f"{', '.join(f'{name} {schema.SQL_TYPES[kind]}' for name, (kind, *_) in RECORD_COLUMNS.items())}, "
    "PRIMARY KEY (condition, seed, generation, individual))",
    "CREATE TABLE provenance (number INTEGER PRIMARY KEY, made_with TEXT NOT NULL UNIQUE)",
    "CREATE TABLE generations (condition INTEGER, seed INTEGER, generation INTEGER, provenance INTEGER NOT NULL, "
    "seal TEXT NOT NULL, PRIMARY KEY (condition, seed, generation))",
    "CREATE TABLE finished (condition INTEGER, seed INTEGER, n_generations INTEGER NOT NULL, seal TEXT NOT NULL, "
    "PRIMARY KEY (condition, seed))",
)
_SELECT_ROWS = f"SELECT {', '.join(RECORD_COLUMNS)} FROM records WHERE condition = ? AND seed = ? AND generation = ? "


class StoredRun(NamedTuple):
    """One run of an experiment, as its file contains it.

    Attributes:
        table: Tidy table of the generations that are done.
        is_finished: Whether the run has ended.
        made_with: What its last generation was made with; empty without generations.
    """

    table: pd.DataFrame
    is_finished: bool
    made_with: Mapping[str, str]


class StoredExperiment(NamedTuple):
    """Contents of the file of an experiment.

    Attributes:
        conditions: Plan of each condition, as plain data.
        seeds: Seeds of the runs of each condition.
        runs: Runs that have generations, keyed by the number of the condition and the seed.
    """

    conditions: list[dict[str, Any]]
    seeds: list[int]
    runs: dict[tuple[int, int], StoredRun]


def is_experiment(path: Path) -> bool:
    """Return whether a file is that of an experiment; False if it cannot be opened."""
    try:
        with _opened(path):
            return True
    except RunFileError:
        return False


def create(file: RunFile, conditions: list[dict[str, Any]], seeds: list[int]) -> str:
    """Create the file of an experiment without generations: complete, or not at all.

    Args:
        file: Path of the new file, or a temporary file.
        conditions: Plan of each condition, as plain data.
        seeds: Seeds of the runs of each condition.

    Returns:
        Id of the experiment.

    Raises:
        RunFileError: If the file exists already or cannot be created.
    """
    if not isinstance(file, Path):
        with open_run(file, "create") as db:
            return _create_tables(db, conditions, seeds)
    with draft_of(file) as draft, open_run(draft, "create", file) as db:
        return _create_tables(db, conditions, seeds)


def write_seeds(file: RunFile, experiment_id: str, seeds: list[int]) -> None:
    """Replace the list of seeds, to add more."""
    with _opened(file, "write") as db:
        _require_id(db, file, experiment_id)
        _write_plan(db, [text for _, text in _condition_facts(db)], seeds)


def append(
    file: RunFile, experiment_id: str, place: tuple[int, int], table: pd.DataFrame, functions: Mapping[str, str]
) -> None:
    """Add one generation of a run, in one transaction.

    Args:
        file: File of the experiment.
        experiment_id: Id of the experiment that the file must contain.
        place: Number of the condition, and seed.
        table: Tidy table of the generation.
        functions: Facts about the user functions that it was made with.

    Raises:
        RunFileError: If the file cannot be written, contains another experiment, or was changed by another process.
    """
    with _opened(file, "write") as db:
        _require_id(db, file, experiment_id)
        (n_done,) = db.execute("SELECT count(*) FROM generations WHERE condition = ? AND seed = ?", place).fetchone()
        generation = int(table.generation.iloc[0])
        if generation != n_done:
            raise RunFileError(
                f"{display_path(file)} was changed by another program, which continues the same experiment. Wait until "
                "it has finished, and repeat the call."
            )
        rows = zip(*(table[name].tolist() for name in RECORD_COLUMNS), strict=True)
        db.executemany(
            f"INSERT INTO records VALUES ({', '.join('?' * len(_COLUMNS))})", ((*place, *row) for row in rows)
        )
        made_with = json.dumps({**provenance.current_facts(), **functions})
        db.execute("INSERT OR IGNORE INTO provenance (made_with) VALUES (?)", [made_with])
        seal = _seal_of(db, *place, generation, made_with, _read_rows(db, place, generation))
        values = "SELECT ?, ?, ?, number, ? FROM provenance WHERE made_with = ?"
        db.execute(f"INSERT INTO generations {values}", [*place, generation, seal, made_with])


def finish(file: RunFile, experiment_id: str, place: tuple[int, int], n_generations: int) -> None:
    """Record that a run has ended.

    Args:
        file: File of the experiment.
        experiment_id: Id of the experiment that the file must contain.
        place: Number of the condition, and seed.
        n_generations: Number of its generations.
    """
    with _opened(file, "write") as db:
        _require_id(db, file, experiment_id)
        seal = _seal_of(db, *place, n_generations)
        db.execute("INSERT OR REPLACE INTO finished VALUES (?, ?, ?, ?)", [*place, n_generations, seal])


def read(file: RunFile) -> tuple[str, StoredExperiment]:
    """Read an experiment from its file.

    Returns:
        Id of the experiment, and its contents.

    Raises:
        RunFileError: If the file does not exist, is not an experiment, or is damaged.
    """
    with _opened(file, "check") as db:
        try:
            conditions = [strict_json.loads(text) for _, text in _condition_facts(db)]
            seeds = strict_json.loads(_read_fact(db, "seeds"))
        except (ValueError, RecursionError) as error:
            raise DamagedError(file, str(error)) from error
        if _read_fact(db, "plan digest") != _plan_digest(db):
            raise DamagedError(file, "its plan was changed or damaged after it was written")
        return _read_fact(db, "id"), StoredExperiment(conditions, seeds, _read_runs(db, file))


def _read_runs(db: sqlite3.Connection, file: RunFile) -> dict[tuple[int, int], StoredRun]:
    rows: dict[tuple[int, int], list[tuple[Any, ...]]] = {}
    made_with_last: dict[tuple[int, int], str] = {}
    sealed = (
        "SELECT condition, seed, generation, made_with, generations.seal FROM generations "
        "LEFT JOIN provenance ON number = provenance ORDER BY condition, seed, generation"
    )
    n_sealed = 0
    for condition, seed, generation, made_with, seal in db.execute(sealed).fetchall():
        place = (condition, seed)
        found = _read_rows(db, place, generation)
        if seal != _seal_of(db, *place, generation, made_with, found):
            raise DamagedError(
                file, f"generation {generation} of a run with seed {seed} was changed or damaged after it was written"
            )
        rows.setdefault(place, []).extend(found)
        made_with_last[place] = made_with
        n_sealed += len(found)
    if db.execute("SELECT count(*) FROM records").fetchone() != (n_sealed,):
        raise DamagedError(file, "it has robots of a generation that is missing")
    finished: dict[tuple[int, int], int] = {}
    for condition, seed, n_generations, seal in db.execute("SELECT * FROM finished").fetchall():
        if seal != _seal_of(db, condition, seed, n_generations):
            raise DamagedError(file, "its list of finished runs was changed or damaged after it was written")
        finished[condition, seed] = n_generations
    runs: dict[tuple[int, int], StoredRun] = {}
    for place, of_run in rows.items():
        try:
            table = check_table(tidy_table(pd.DataFrame(of_run, columns=list(RECORD_COLUMNS))))
            facts = {name: str(value) for name, value in strict_json.loads(made_with_last[place]).items()}
        except (AttributeError, TypeError, ValueError, RecursionError) as error:
            raise DamagedError(file, str(error)) from error
        n_generations = int(table.generation.nunique())
        if table.generation.max() != n_generations - 1 or finished.get(place, n_generations) != n_generations:
            raise DamagedError(file, "a generation is missing")
        runs[place] = StoredRun(table, place in finished, facts)
    return runs


@contextmanager
def _opened(file: RunFile, mode: Literal["read", "check", "write"] = "read") -> Generator[sqlite3.Connection]:
    """Open the file of an experiment for one transaction; an error says how to continue with a damaged one."""
    try:
        with open_run(file, mode, read_layout=_read_layout) as db:
            yield db
    except DamagedError as error:
        raise RunFileError(
            f"{display_path(file)} is damaged: {error.what}. Use a copy of it if you have one; if not, delete it and "
            "repeat the experiment."
        ) from error


def _read_layout(db: sqlite3.Connection) -> int:
    """Check that a file has exactly the tables of an experiment; return the current layout of run files."""
    found = db.execute("SELECT sql FROM sqlite_schema WHERE sql IS NOT NULL LIMIT 9").fetchall()
    if db.execute("PRAGMA application_id").fetchone() != (schema.EXPERIMENT_ID,):
        raise LayoutError("does not contain an experiment. A file with a single run is opened with wl.load(path)")
    schema.read_layout_version(db, LAYOUT_VERSION)
    if sorted(str(sql) for (sql,) in found) != sorted(_TABLES):
        raise LayoutError("is damaged or was changed by another program: its tables are not those of an experiment")
    return schema.LAYOUT_VERSION


def _create_tables(db: sqlite3.Connection, conditions: list[dict[str, Any]], seeds: list[int]) -> str:
    db.execute(f"PRAGMA application_id = {schema.EXPERIMENT_ID}")
    db.execute(f"PRAGMA user_version = {LAYOUT_VERSION}")
    for table in _TABLES:
        db.execute(table)
    experiment_id = uuid4().hex
    _write_fact(db, "id", experiment_id)
    _write_plan(db, [json.dumps(condition) for condition in conditions], seeds)
    return experiment_id


def _write_plan(db: sqlite3.Connection, conditions: list[str], seeds: list[int]) -> None:
    for number, text in enumerate(conditions):
        _write_fact(db, f"condition {number}", text)
    _write_fact(db, "seeds", json.dumps(seeds))
    _write_fact(db, "plan digest", _plan_digest(db))


def _plan_digest(db: sqlite3.Connection) -> str:
    return _seal_of(db, _condition_facts(db), _read_fact(db, "seeds"))


def _condition_facts(db: sqlite3.Connection) -> list[tuple[int, str]]:
    """Return the number and the plan of each condition, in order."""
    found = db.execute("SELECT fact, value FROM experiment WHERE fact GLOB 'condition [0-9]*'").fetchall()
    return sorted((int(fact.rpartition(" ")[2]), str(value)) for fact, value in found)


def _write_fact(db: sqlite3.Connection, name: str, value: str) -> None:
    db.execute("INSERT OR REPLACE INTO experiment VALUES (?, ?)", [name, value])


def _read_fact(db: sqlite3.Connection, name: str) -> str:
    row = db.execute("SELECT value FROM experiment WHERE fact = ?", [name]).fetchone()
    return str(row[0]) if row else ""


def _require_id(db: sqlite3.Connection, file: RunFile, experiment_id: str) -> None:
    if _read_fact(db, "id") != experiment_id:
        raise RunFileError(f"{display_path(file)} was replaced by another experiment; that one is not changed.")


def _read_rows(db: sqlite3.Connection, place: tuple[int, int], generation: int) -> list[tuple[Any, ...]]:
    return db.execute(f"{_SELECT_ROWS} ORDER BY rowid", (*place, generation)).fetchall()


def _seal_of(db: sqlite3.Connection, *contents: object) -> str:
    """Return the digest of contents and of the id of the experiment."""
    return schema.sha256_digest(repr((_read_fact(db, "id"), *contents)))
