"""The run file: an SQLite file with the settings and the tidy table, written in one transaction per generation.

Even if the process is killed, the file contains only complete generations. Every generation has a seal, so later
changes and damage are detected. The file stores text and numbers only, and a file with anything else in it is rejected:
opening a run file never executes code.
"""

import json
import math
import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing, suppress
from itertools import count
from pathlib import Path
from tempfile import gettempdir
from typing import Any

import pandas as pd

from walkerlab.runfile import provenance, schema
from walkerlab.runfile.history import History
from walkerlab.runfile.opening import DamagedError, RunFile, RunFileError, draft_of, open_database, open_run
from walkerlab.runfile.paths import new_path
from walkerlab.runfile.records import RECORD_COLUMNS, check_table, tidy_table
from walkerlab.system.files import display_path
from walkerlab.text import strict_json

NO_HISTORY = History()
DIGEST_DIGITS = 16  # digits of a digest that are reported


def open_temporary() -> sqlite3.Connection:
    """Open a temporary file for a run without a path.

    It has no name, is deleted when it is closed or its process ends, and is kept in memory while it is small. Any
    thread may use it, but only one at a time.
    """
    return sqlite3.connect("", check_same_thread=False)


def save_temporary(db: sqlite3.Connection) -> Path:
    """Copy a temporary file to a new file with a name: ``kept.walk``, or else ``kept-2.walk`` and so on.

    Args:
        db: Temporary file.

    Returns:
        Path of the new file, in the current folder or, if that cannot be written to, in the system's temporary folder.

    Raises:
        RunFileError: If no file can be created in either folder.
    """
    for folder in (Path(), Path(gettempdir())):
        names = (folder / f"kept{f'-{n}' if n > 1 else ''}.walk" for n in count(1))
        with suppress(RunFileError):
            path = new_path(next(path for path in names if not path.exists()))
            with draft_of(path) as draft, closing(open_database(draft)) as named:
                db.backup(named)
            return path
    raise RunFileError(
        "this run has no file, and none can be created in the current folder or the system's temporary folder."
    )


def create(file: RunFile, settings: dict[str, Any], history: History = NO_HISTORY) -> str:
    """Create a run file without generations, atomically.

    Args:
        file: Path of the new file, or a temporary file.
        settings: Settings as plain data.
        history: Genomes given for generation 0.

    Returns:
        Id of the run.

    Raises:
        RunFileError: If the file exists already (a run is never overwritten) or cannot be created.
    """
    text = json.dumps(settings)
    if not isinstance(file, Path):
        with open_run(file, "create") as db:
            return schema.create_tables(db, text, history.to_json())
    with draft_of(file) as draft, open_run(draft, "create", file) as db:
        return schema.create_tables(db, text, history.to_json())


def append(file: RunFile, generation: pd.DataFrame, run_id: str, functions: Mapping[str, str] = {}) -> None:
    """Add one generation, in one transaction.

    Args:
        file: Run file.
        generation: Tidy table of the generation.
        run_id: Id of the run to which it belongs.
        functions: Facts about the user functions that produced it.

    Raises:
        RunFileError: If the file cannot be written, contains another run, or was changed by another process.
    """
    with open_run(file, "write") as db:
        _require_id(db, file, run_id)
        (n_done,) = db.execute("SELECT count(*) FROM generations").fetchone()
        if not generation.empty and int(generation.generation.iloc[0]) != n_done:
            raise RunFileError(
                f"{display_path(file)} was changed by another program and now has {n_done} generations: another "
                "process has continued the run, or an older copy was put in its place. Resume it when no other "
                "process is using it."
            )
        _insert_generations(db, generation, _current_provenance(functions))


def prepare_resume(path: Path, settings: dict[str, Any], history: History | None = None) -> str:
    """Upgrade a run file to the current layout, and store the settings for further generations.

    Args:
        path: Run file.
        settings: Settings as plain data.
        history: History to write; if None, the history in the file stays unchanged.

    Returns:
        Id of the run.
    """
    with open_run(path, "write") as db:
        schema.write_settings(db, json.dumps(settings))
        if history is not None:
            schema.write_history(db, history.to_json())
        return schema.read_fact(db, "id")


def _insert_generations(db: sqlite3.Connection, table: pd.DataFrame, made_with: str) -> None:
    rows = zip(*(table[name].tolist() for name in RECORD_COLUMNS), strict=True)
    db.executemany(f"INSERT INTO records VALUES ({', '.join('?' * len(RECORD_COLUMNS))})", rows)
    for number in table.generation.unique().tolist():
        schema.seal_generation(db, number, made_with)


def _current_provenance(functions: Mapping[str, str]) -> str:
    return json.dumps({**provenance.current_facts(), **functions})


def read(path: Path) -> tuple[dict[str, Any], pd.DataFrame]:
    """Read the settings of a run, as plain data, and its table.

    Raises:
        RunFileError: If the file does not exist, or is not a run file.
        DamagedError: If its contents were changed or damaged.
    """
    with open_run(path, "check") as db:
        return _read_settings(db, path), _read_table(db, path)


def read_history(path: Path) -> History:
    """Read the genomes that were given for generation 0, and the earlier stages.

    Raises:
        DamagedError: If they were changed or damaged after they were written.
    """
    with open_run(path) as db:
        try:
            return History.from_json(_read_with_digest(db, path, "history"))
        except (ValueError, RecursionError) as error:
            raise DamagedError(path, str(error)) from error


def read_facts(path: Path) -> tuple[dict[str, str], dict[str, str]]:
    """Read a run's id, settings digest and provenance.

    Returns:
        Id of the run and digest of its settings; and the provenance of its last generation.
    """
    with open_run(path) as db:
        try:
            settings_digest = schema.read_fact(db, "settings digest")[:DIGEST_DIGITS]
            return {"id": schema.read_fact(db, "id"), "settings digest": settings_digest}, schema.read_made_with(db)
        except (AttributeError, ValueError, RecursionError) as error:
            raise DamagedError(path, str(error)) from error


def read_generations(file: RunFile, run_id: str, first: int, end: int) -> pd.DataFrame:
    """Read the table rows of a range of generations.

    Args:
        file: Run file.
        run_id: Id of the run.
        first: Number of the first generation.
        end: Number of the generation after the last one to read (exclusive).
    """
    with open_run(file) as db:
        _require_id(db, file, run_id)
        return _read_table(db, file, first, end)


def read_births(
    file: RunFile, run_id: str, columns: Sequence[str], births: Iterable[Sequence[int]]
) -> list[tuple[Any, ...]]:
    """Read the given columns of the given individuals; individuals that are not in the file are skipped.

    Args:
        file: Run file.
        run_id: Id of the run.
        columns: Names of the columns.
        births: Generation and number of each individual.
    """
    select = f"SELECT {', '.join(columns)} FROM records WHERE generation = ? AND individual = ?"
    with open_run(file) as db:
        _require_id(db, file, run_id)
        return [row for birth in births for row in db.execute(select, birth)]


def rescue(path: Path, to: Path) -> int:
    """Copy the undamaged part of a damaged run, its generations before the damage, to a new run file.

    Args:
        path: Damaged run file.
        to: Run file to create.

    Returns:
        Number of generations that were saved; if 0, the new file contains only the settings.

    Raises:
        RunFileError: If nothing can be recovered, or the new file cannot be created.
    """
    if not path.is_file():
        raise RunFileError(f"there is no run file at {display_path(path)}")
    with draft_of(to) as draft:
        return _rescue(path, draft, to)


def _rescue(path: Path, draft: Path, to: Path) -> int:
    undamaged: list[tuple[str, pd.DataFrame]] = []
    try:
        with open_run(path, "rescue") as db:
            settings = _read_settings(db, path)
            history = _read_with_digest(db, path, "history")
            with suppress(sqlite3.Error, ValueError):
                for number, (generation, made_with, rows) in enumerate(schema.sealed_generations(db)):
                    if rows is None or generation != number:
                        break
                    undamaged.append((made_with, check_table(_as_table(rows, path))))
    except DamagedError as error:
        raise RunFileError(f"nothing can be recovered from {display_path(path)}: {error.what}.") from error
    with open_run(draft, "create", to) as db:
        schema.create_tables(db, json.dumps(settings), history)
        for made_with, table in undamaged:
            _insert_generations(db, table, made_with)
    return len(undamaged)


def require_run(file: RunFile, run_id: str) -> None:
    """Check that a file still contains the run with this id.

    Raises:
        RunFileError: If it does not.
    """
    with open_run(file) as db:
        _require_id(db, file, run_id)


def _require_id(db: sqlite3.Connection, file: RunFile, run_id: str) -> None:
    if schema.read_fact(db, "id") != run_id:
        raise RunFileError(
            f"{display_path(file)} was replaced by another run in the meantime; that run was left unchanged."
        )


def _read_settings(db: sqlite3.Connection, file: RunFile) -> dict[str, Any]:
    text = _read_with_digest(db, file, "settings")
    try:
        return strict_json.loads(text)
    except (ValueError, RecursionError) as error:
        raise DamagedError(file, str(error)) from error


def _read_with_digest(db: sqlite3.Connection, file: RunFile, name: str) -> str:
    """Return a fact that has a digest; "" if the run does not have it."""
    text = schema.read_fact(db, name)
    digest = schema.read_fact(db, f"{name} digest")
    verb, written = ("were", "they were") if name == "settings" else ("was", "it was")
    if (text or digest or name == "settings") and schema.sha256_digest(text) != digest:
        raise DamagedError(file, f"its {name} {verb} changed or damaged after {written} written")
    return text


def _read_table(db: sqlite3.Connection, file: RunFile, first: float = -math.inf, end: float = math.inf) -> pd.DataFrame:
    table: list[tuple[Any, ...]] = []
    for generation, _, rows in schema.sealed_generations(db, first, end):
        if rows is None:
            raise DamagedError(file, f"generation {generation} was changed or damaged after it was written")
        table += rows
    n_rows = "SELECT count(*) FROM records WHERE generation >= ? AND generation < ?"
    if db.execute(n_rows, (first, end)).fetchone() != (len(table),):
        raise DamagedError(file, "it has robots of a generation that is missing")
    return _as_table(table, file)


def _as_table(rows: list[tuple[Any, ...]], file: RunFile) -> pd.DataFrame:
    try:
        return tidy_table(pd.DataFrame(rows, columns=list(RECORD_COLUMNS)))
    except (TypeError, ValueError) as error:
        raise DamagedError(file, str(error)) from error
