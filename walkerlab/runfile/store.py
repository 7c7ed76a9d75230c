"""The run file: one SQLite file that holds the settings and the tidy table, a generation to a transaction.

Whatever moment the process dies at, the file holds whole generations; whatever happens to the file afterwards, what is
read of it is as it was written, for each generation has a seal. It stores text and numbers only: nothing in it can run
when it is opened, and a file with anything else in it is not used.
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
from walkerlab.runfile.opening import DamagedError, File, RunFileError, connect, drafted, opened
from walkerlab.runfile.records import COLUMNS, check, tidy
from walkerlab.system.files import PathError, absolute_path, file_path, shown
from walkerlab.text import strict_json

RUN_FILE = "run.walk"  # its name in a folder of its own
SHOWN = 16  # digits of a digest, enough to tell two apart


def locate(path: str | Path) -> Path:
    """Return the absolute path of a run file, given its own path, or that of its folder, if that has one only.

    Raises:
        RunFileError: If no file can have this path, or it is a folder with no run file, or with several.
    """
    try:
        path = absolute_path(path)
    except PathError as error:
        raise RunFileError(str(error)) from error
    if not path.is_dir():
        return path
    found = sorted(path.glob("*.walk"))
    if len(found) == 1 or path / RUN_FILE in found:
        return found[0] if len(found) == 1 else path / RUN_FILE
    if not found:
        raise RunFileError(f"the folder {shown(path)} has no run file in it: no file ends in .walk")
    names = ", ".join(one.name for one in found[:9]) + (" …" if len(found) > 9 else "")
    raise RunFileError(
        f"the folder {shown(path)} has {len(found)} run files in it: {names}. Name one of them: {shown(found[0])!r}"
    )


def new_path(path: str | Path, name: str = "path") -> Path:
    """Return the absolute path of a run file to be created.

    Args:
        path: Path of the file.
        name: Name of the argument, for messages.

    Raises:
        RunFileError: If no file can have this path.
        TypeError: If it is not a path.
    """
    try:
        return file_path(path, name)
    except PathError as error:
        folder = Path(path).expanduser()
        example = f" For example: {shown(folder.absolute() / RUN_FILE)!r}." if _is_folder(folder) else ""
        raise RunFileError(f"no run file can be created: {error}{example}") from error


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except ValueError:  # a null character
        return False


def passing() -> sqlite3.Connection:
    """Make a file for a run without a path: it has no name, and is gone when it is closed or its process ends.

    It is in memory while it is small. It is for one thread at a time, whichever that is.
    """
    return sqlite3.connect("", check_same_thread=False)


def keep(db: sqlite3.Connection) -> Path:
    """Copy a passing file into one with a name, ``kept.walk`` or ``kept-2.walk`` and so on, and return its path.

    It is in this folder, or if nothing can be written here, in that of the system for such things.
    """
    for folder in (Path(), Path(gettempdir())):
        names = (folder / f"kept{f'-{n}' if n > 1 else ''}.walk" for n in count(1))
        with suppress(RunFileError):
            path = new_path(next(path for path in names if not path.exists()))
            with drafted(path) as draft, closing(connect(draft)) as named:
                db.backup(named)
            return path
    raise RunFileError("this run has no file, and none can be made: neither here nor in the system's temporary folder.")


def create(file: File, settings: dict[str, Any]) -> str:
    """Create a run file that has no generation yet: complete, or not at all.

    Args:
        file: Path of the new file, or a passing file.
        settings: Settings as plain data.

    Returns:
        The run's id.

    Raises:
        RunFileError: if something exists at this path (a run is never overwritten), or nothing can be written there.
    """
    text = json.dumps(settings)
    if not isinstance(file, Path):
        with opened(file, "make") as db:
            return schema.lay_out(db, text)
    with drafted(file) as draft, opened(draft, "make", file) as db:
        return schema.lay_out(db, text)


def append(file: File, generation: pd.DataFrame, run_id: str, functions: Mapping[str, str] = {}) -> None:
    """Add one generation: all of it, or nothing.

    Args:
        file: of the run.
        generation: its tidy table.
        run_id: of the run that it belongs to.
        functions: facts about the functions that it was made with.

    Raises:
        RunFileError: if it cannot be written, or another run is in the file, or another process has gone on with it.
    """
    with opened(file, "change") as db:
        _require(db, file, run_id)
        (n_done,) = db.execute("SELECT count(*) FROM generations").fetchone()
        if not generation.empty and int(generation.generation.iloc[0]) != n_done:
            raise RunFileError(
                f"somebody else has changed {shown(file)} meanwhile, which has {n_done} generations now: another "
                "process has gone on with it, or an older copy was put in its place. Go on with that when nobody else "
                "does."
            )
        _insert(db, generation, _made_with_here(functions))


def go_on(path: Path, settings: dict[str, Any]) -> str:
    """Make ready to go on with a run: bring its file to this layout, and write down under which settings.

    Returns:
        The run's id.
    """
    with opened(path, "change") as db:
        schema.write_settings(db, json.dumps(settings))
        return schema.fact(db, "id")


def _insert(db: sqlite3.Connection, generation: pd.DataFrame, made_with: str) -> None:
    rows = zip(*(generation[name].tolist() for name in COLUMNS), strict=True)
    db.executemany(f"INSERT INTO records VALUES ({', '.join('?' * len(COLUMNS))})", rows)
    for number in generation.generation.unique().tolist():
        schema.seal(db, number, made_with)


def _made_with_here(functions: Mapping[str, str]) -> str:
    return json.dumps({**provenance.here(), **functions})


def read(path: Path) -> tuple[dict[str, Any], pd.DataFrame]:
    """Read a run file: its settings as plain data, and its table.

    Raises:
        RunFileError: if there is no such file, or it is not one of ours.
        DamagedError: if anything in it is not as it was written.
    """
    with opened(path, "check") as db:
        return _settings(db, path), _table(db, path)


def read_facts(path: Path) -> tuple[dict[str, str], dict[str, str]]:
    """Read what a run says of itself: its id and the digest of its settings; what its last generation was made with."""
    with opened(path) as db:
        try:
            whose = {"id": schema.fact(db, "id"), "settings digest": schema.fact(db, "settings digest")[:SHOWN]}
            return whose, schema.made_with(db)
        except (AttributeError, ValueError, RecursionError) as error:
            raise DamagedError(path, str(error)) from error


def read_generations(file: File, run_id: str, first: int, end: int) -> pd.DataFrame:
    """Read the table of some generations of a run: the first of them, and those after it that are before the end."""
    with opened(file) as db:
        _require(db, file, run_id)
        return _table(db, file, first, end)


def read_births(
    file: File, run_id: str, columns: Sequence[str], births: Iterable[Sequence[int]]
) -> list[tuple[Any, ...]]:
    """Read some columns of some individuals, each in the generation given, where it is there.

    Args:
        file: of the run.
        run_id: of the run.
        columns: their names.
        births: generation and number of each individual.
    """
    of_one = f"SELECT {', '.join(columns)} FROM records WHERE generation = ? AND individual = ?"
    with opened(file) as db:
        _require(db, file, run_id)
        return [row for birth in births for row in db.execute(of_one, birth)]


def rescue(path: Path, to: Path) -> int:
    """Copy what is whole of a damaged run, its generations before the damage, into a new run file.

    Args:
        path: of the damaged run.
        to: of the new one.

    Returns:
        How many generations were saved; if none, the settings are, from which the run can begin again.

    Raises:
        RunFileError: if nothing can be saved, or the new file cannot be made; there is none then.
    """
    if not path.is_file():
        raise RunFileError(f"there is no run file at {shown(path)}")
    with drafted(to) as draft:
        return _rescue(path, draft, to)


def _rescue(path: Path, draft: Path, to: Path) -> int:
    whole = list[tuple[str, pd.DataFrame]]()
    try:
        with opened(path, "rescue") as db:
            settings = _settings(db, path)
            with suppress(sqlite3.Error, ValueError):
                for number, (generation, made_with, rows) in enumerate(schema.generations(db)):
                    if rows is None or generation != number:
                        break
                    whole.append((made_with, check(_tidied(rows, path))))
    except DamagedError as error:
        raise RunFileError(f"nothing can be saved of {shown(path)}: {error.what}.") from error
    with opened(draft, "make", to) as db:
        schema.lay_out(db, json.dumps(settings))
        for made_with, table in whole:
            _insert(db, table, made_with)
    return len(whole)


def require(file: File, run_id: str) -> None:
    """Make sure that a run is in a file still.

    Raises:
        RunFileError: if not.
    """
    with opened(file) as db:
        _require(db, file, run_id)


def _require(db: sqlite3.Connection, file: File, run_id: str) -> None:
    if schema.fact(db, "id") != run_id:
        raise RunFileError(
            f"{shown(file)} was replaced by another run while this one went on; that one is left as it is."
        )


def _settings(db: sqlite3.Connection, file: File) -> dict[str, Any]:
    text = schema.fact(db, "settings")
    if schema.digest(text) != schema.fact(db, "settings digest"):
        raise DamagedError(file, "its settings are not as they were written")
    try:
        return strict_json.loads(text)
    except (ValueError, RecursionError) as error:
        raise DamagedError(file, str(error)) from error


def _table(db: sqlite3.Connection, file: File, first: float = -math.inf, end: float = math.inf) -> pd.DataFrame:
    table = list[tuple[Any, ...]]()
    for generation, _, rows in schema.generations(db, first, end):
        if rows is None:
            raise DamagedError(file, f"generation {generation} is not as it was written")
        table += rows
    n_rows = "SELECT count(*) FROM records WHERE generation >= ? AND generation < ?"
    if db.execute(n_rows, (first, end)).fetchone() != (len(table),):
        raise DamagedError(file, "there are robots of a generation that is not there")
    return _tidied(table, file)


def _tidied(rows: list[tuple[Any, ...]], file: File) -> pd.DataFrame:
    try:
        return tidy(pd.DataFrame(rows, columns=list(COLUMNS)))
    except (TypeError, ValueError) as error:
        raise DamagedError(file, str(error)) from error
