"""Run files: complete or absent, sealed, and rejected if they are damaged or are not runs."""

import json
import os
import sqlite3
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from walkerlab.genome.breeding import generate_robot_population
from walkerlab.genome.genome import Genome
from walkerlab.runfile import opening, paths, provenance, schema, store
from walkerlab.runfile.opening import RunFileError
from walkerlab.runfile.records import RECORD_COLUMNS, tidy_table
from walkerlab.settings.settings import Settings

INTEGERS = st.integers(-(2**63), 2**63 - 1)
EMPTY = tidy_table(pd.DataFrame(columns=list(RECORD_COLUMNS)))
CELLS = {int: INTEGERS, float: st.floats(), str: st.text(st.characters(codec="utf-8", exclude_characters="\0"))}


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "run.wl"
    store.create(path, Settings().model_dump())
    return path


def generation(number, n=5):
    """Return a generation with extreme values in every type of column."""
    extreme = {
        int: np.arange(n),
        float: np.resize([-np.inf, np.nan, 0.1 + 0.2, 5e-324, -0.0, np.inf, 1.7976931348623157e308], n),
        str: np.resize(["", "ok", "it's; DROP TABLE records --", "‾‾ €𝄞", "a\nb\tc"], n),
    }
    table = pd.DataFrame({name: extreme[kind] for name, (kind, *_) in RECORD_COLUMNS.items()})
    return tidy_table(table.assign(generation=number, individual=np.arange(n) + 100 * number))


def add(path, table):
    store.append(path, table, store.read_facts(path)[0]["id"])


def table_of(path):
    return store.read(path)[1]


def same(one, other):
    pd.testing.assert_frame_equal(one, other, check_exact=True)
    assert one.attrs == other.attrs
    return True


def broken(path, *statements):
    with closing(sqlite3.connect(path)) as db, db:
        for statement in statements:
            db.execute(statement)
    return path


# -------------------------------------------------------------------------------------------------- round trips


def test_a_run_is_read_as_it_was_written(path):
    assert same(table_of(path), tidy_table(pd.DataFrame(columns=list(RECORD_COLUMNS))))
    tables = [generation(number) for number in range(3)]
    for table in tables:
        add(path, table)
    assert same(table_of(path), tidy_table(pd.concat(tables, ignore_index=True)))
    assert Settings(**store.read(path)[0]) == Settings()
    assert store.read_facts(path)[1] == provenance.current_facts()


@hypothesis_settings(max_examples=25)
@given(
    rows=st.lists(st.fixed_dictionaries({name: CELLS[kind] for name, (kind, *_) in RECORD_COLUMNS.items()}), min_size=1)
)
def test_any_table_is_read_bit_for_bit(tmp_path_factory, rows):
    path = tmp_path_factory.mktemp("any") / "run.wl"
    store.create(path, {})
    table = tidy_table(pd.DataFrame(rows).assign(generation=0, individual=range(len(rows))))
    add(path, table)
    assert same(table_of(path), table)


def test_rows_keep_their_order(path):
    table = generation(0).iloc[::-1].reset_index(drop=True)
    add(path, table)
    assert same(table_of(path), table)


def test_single_generations_and_individuals_can_be_read(path):
    tables = [generation(number) for number in range(4)]
    for table in tables:
        add(path, table)
    run_id = store.read_facts(path)[0]["id"]
    assert same(store.read_generations(path, run_id, 1, 3), tidy_table(pd.concat(tables[1:3], ignore_index=True)))
    assert same(store.read_generations(path, run_id, 3, 99), tables[3])
    assert same(store.read_generations(path, run_id, 4, 4), EMPTY)
    born = [(2, 203), (0, 0), (1, 203), (9, 900)]  # the last two do not exist
    found = store.read_births(path, run_id, ["generation", "individual", "genome"], born)
    assert found == [(2, 203, tables[2].genome[3]), (0, 0, tables[0].genome[0])]


def test_a_robot_takes_less_than_a_kilobyte(path):
    settings = Settings()
    genomes = [str(Genome(values)) for values in generate_robot_population(settings.robot, 500, seed=0)]
    for number in range(4):
        created = generation(number, 500).assign(
            genome=genomes, operators="gradient > paired > randomized", parents="7 9"
        )
        add(path, created.assign(reason="", verdict="ok"))
    assert path.stat().st_size / 2000 < 1000


def test_changing_the_settings_does_not_change_the_table(path):
    add(path, generation(0))
    before = table_of(path)
    store.prepare_resume(path, Settings().with_(generations=99).model_dump())
    assert Settings(**store.read(path)[0]).algorithm.generations == 99
    assert same(table_of(path), before)


# -------------------------------------------------------------------------------------- a generation or nothing


def test_a_generation_that_cannot_be_written_completely_is_absent(path):
    add(path, generation(0))
    before = table_of(path)
    half = generation(1)
    half.loc[4, "individual"] = half.loc[0, "individual"]  # violates the primary key
    with pytest.raises(RunFileError, match="cannot be used"):
        add(path, half)
    assert same(table_of(path), before)
    add(path, generation(1))
    assert len(table_of(path)) == 10


KILLED_DURING_APPEND = """
import os, signal, sys
from pathlib import Path
sys.path[:0] = sys.argv[2:]
import pandas as pd
from tests.runfile.test_store import add, generation, table_of

class KillsProcess:
    def __conform__(self, protocol):
        os.kill(os.getpid(), signal.SIGKILL)

half = generation(table_of(Path(sys.argv[1])).generation.max() + 1, n=4000).astype({"genome": object})
genomes = ["x" * 2000] * 3999  # more than SQLite holds in memory, so that a part is written to the disk
half["genome"] = pd.Series([*genomes, KillsProcess()], dtype=object)
add(Path(sys.argv[1]), half)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="nothing there kills like SIGKILL")
def test_a_generation_whose_writer_was_killed_is_absent(path, request):
    add(path, generation(0))
    size = path.stat().st_size
    before = table_of(path)
    killed = subprocess.run([sys.executable, "-c", KILLED_DURING_APPEND, path, request.config.rootpath], check=False)
    assert killed.returncode == -9
    assert path.stat().st_size > 10 * size
    assert same(table_of(path), before)
    add(path, generation(1))
    assert len(table_of(path)) == 10


def test_failing_to_create_a_file_leaves_nothing(tmp_path):
    (tmp_path / "a file").touch()
    for path in (tmp_path / "a file" / "run.wl", tmp_path / "a file" / "b" / "run.wl", tmp_path / ("x" * 300)):
        with pytest.raises(RunFileError, match="no run file can be created"):
            store.create(path, {})
    with pytest.raises(RunFileError, match="no run file can be created"):
        store.create(tmp_path / "a\0b", {})
    assert [one.name for one in tmp_path.iterdir()] == ["a file"]


def without_links(*_):
    raise OSError(95, "Operation not supported")


@pytest.mark.parametrize("links", [True, False])
def test_one_of_several_concurrent_creators_succeeds_and_readers_see_no_incomplete_file(tmp_path, links, monkeypatch):
    if not links:
        monkeypatch.setattr(os, "link", without_links)
    n = 6
    seen = []
    rejections = []

    def create(path, barrier):
        barrier.wait()
        try:
            return store.create(path, Settings().model_dump())
        except RunFileError as error:
            rejections.append(str(error))

    def watch(path, stop):
        while not stop.is_set():
            if links and path.exists():
                seen.append(store.read(path)[0] == Settings().model_dump())

    for number in range(5):
        path = tmp_path / f"{number}.wl"
        barrier = threading.Barrier(n)
        stop = threading.Event()
        with ThreadPoolExecutor(n + 1) as pool:
            watcher = pool.submit(watch, path, stop)
            created = [one.result() for one in [pool.submit(create, path, barrier) for _ in range(n)]]
            stop.set()
            watcher.result()
        assert created.count(None) == n - 1
        assert store.read_facts(path)[0]["id"] in created
    assert all(seen)
    assert all("exists already" in message for message in rejections)
    assert len(list(tmp_path.iterdir())) == 5, "no drafts are left"


def test_without_hard_links_a_failed_copy_leaves_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "link", without_links)
    monkeypatch.setattr(os, "fsync", without_links)
    with pytest.raises(RunFileError, match="not supported"):
        store.create(tmp_path / "run.wl", {})
    assert not list(tmp_path.iterdir())


def test_a_folder_stands_for_its_run_file(tmp_path):
    with pytest.raises(RunFileError, match="contains no run file"):
        paths.locate_run_file(tmp_path)
    assert paths.locate_run_file(tmp_path / "mine.walk") == tmp_path / "mine.walk"
    (tmp_path / "mine.walk").touch()
    assert paths.locate_run_file(tmp_path) == tmp_path / "mine.walk", "the only run file of the folder"
    (tmp_path / "yours.walk").touch()
    with pytest.raises(RunFileError, match=r"contains 2 run files: mine\.walk, yours\.walk"):
        paths.locate_run_file(tmp_path)
    (tmp_path / paths.RUN_FILE).touch()
    assert paths.locate_run_file(tmp_path) == tmp_path / paths.RUN_FILE


def test_a_file_is_created_complete_or_not_at_all(tmp_path, monkeypatch):
    monkeypatch.setitem(schema._TABLES_BY_LAYOUT, schema.LAYOUT_VERSION, (schema._CREATE_RUN, "CREATE TABLE nonsense"))
    with pytest.raises(RunFileError):
        store.create(tmp_path / "run.wl", {})
    assert not list(tmp_path.iterdir())


def test_another_run_at_the_same_path_is_not_changed(path):
    add(path, generation(0))
    run_id = store.read_facts(path)[0]["id"]
    path.unlink()
    store.create(path, Settings().model_dump())
    before = path.read_bytes()
    with pytest.raises(RunFileError, match="replaced by another run"):
        store.append(path, generation(1), run_id)
    assert path.read_bytes() == before


def test_the_second_of_two_processes_that_resume_a_run_gets_an_error(path):
    for number in range(3):
        add(path, generation(number))
    before = table_of(path)
    with pytest.raises(RunFileError, match=r"was changed by another program and now has 3 generations"):
        add(path, generation(2))
    assert same(table_of(path), before)


def test_an_older_copy_at_the_same_path_is_not_continued(path):
    add(path, generation(0))
    older = path.read_bytes()
    add(path, generation(1))
    path.write_bytes(older)
    with pytest.raises(RunFileError, match="an older copy was put in its place"):
        add(path, generation(2))
    assert path.read_bytes() == older


def test_reading_with_the_id_of_another_run_raises(path):
    add(path, generation(0))
    for read in (
        lambda: store.read_generations(path, "another", 0, 1),
        lambda: store.read_births(path, "another", ["genome"], [(0, 0)]),
        lambda: store.require_run(path, "another"),
    ):
        with pytest.raises(RunFileError, match="replaced by another run"):
            read()


def test_rescue_ends_at_a_missing_generation_and_at_invalid_rows(path, tmp_path):
    for number in range(3):
        add(path, generation(number).assign(fitness=1.0, parents="", verdict="ok", born=0, reason=""))
    with closing(sqlite3.connect(path)) as db, db:
        db.execute("DELETE FROM generations WHERE generation = 1")
    assert store.rescue(path, tmp_path / "one.walk") == 1
    with closing(sqlite3.connect(path)) as db, db:
        db.execute("UPDATE records SET parents = 'invalid' WHERE generation = 0")
        db.execute("DELETE FROM generations WHERE generation = 0")
        schema.seal_generation(db, 0, "{}")
    assert store.rescue(path, tmp_path / "none.walk") == 0
    assert store.read(tmp_path / "none.walk")[0] == Settings().model_dump()


def test_the_step_limit_grows_with_the_file_when_it_is_rescued_or_upgraded(path, tmp_path, monkeypatch):
    monkeypatch.setattr(opening, "MAX_STEPS", 2_000)
    for number in range(2):
        created = generation(number, 300).assign(
            fitness=1.0, parents="", verdict="ok", born=0, reason="", genome="x" * 600
        )
        add(path, created)
    whole = table_of(path)
    assert store.rescue(path, tmp_path / "rescued.walk") == 2
    assert same(table_of(tmp_path / "rescued.walk"), whole)
    with closing(sqlite3.connect(path)) as db:
        db.executescript("DROP TABLE provenance; DROP TABLE generations; PRAGMA user_version = 2; VACUUM")
    assert same(table_of(path), whole)


def test_writing_turns_a_file_in_wal_mode_into_a_single_file(path):
    with closing(sqlite3.connect(path)) as db:
        assert db.execute("PRAGMA journal_mode = WAL").fetchone() == ("wal",)
    add(path, generation(0))
    assert list(path.parent.iterdir()) == [path]
    with closing(sqlite3.connect(path)) as db:
        assert db.execute("PRAGMA journal_mode").fetchone() == ("delete",)


def test_creating_over_a_run_raises_and_does_not_change_it(path):
    before = path.read_bytes()
    with pytest.raises(RunFileError, match="already"):
        store.create(path, {})
    assert path.read_bytes() == before


def test_the_file_records_what_each_generation_was_made_with(path, monkeypatch, tmp_path):
    add(path, generation(0))
    add(path, generation(1))
    here = provenance.current_facts()
    monkeypatch.setattr(provenance, "current_facts", lambda: {**here, "mujoco": "9.9"})
    add(path, generation(2))
    assert store.read_facts(path)[1]["mujoco"] == "9.9"
    with closing(sqlite3.connect(path)) as db:
        made_with = [json.loads(facts)["mujoco"] for _, facts, _ in schema.sealed_generations(db)]
        assert db.execute("SELECT count(*) FROM provenance").fetchone() == (2,)
    assert made_with == [here["mujoco"], here["mujoco"], "9.9"]


@pytest.mark.parametrize("change", [
    "UPDATE records SET fitness = fitness + 1e-12 WHERE individual = 102",
    "UPDATE records SET genome = genome || ' ' WHERE individual = 102",
    "UPDATE records SET individual = 99 WHERE individual = 102",
    "DELETE FROM records WHERE individual = 102",
    "INSERT INTO records (generation, individual) VALUES (1, 999)",
    "INSERT INTO records (generation, individual) VALUES (7, 999)",
    "DELETE FROM generations WHERE generation = 1",
    "UPDATE generations SET seal = (SELECT seal FROM generations WHERE generation = 0) WHERE generation = 1",
    "UPDATE provenance SET made_with = '{}'",
    "DELETE FROM provenance",
    "UPDATE run SET value = 'another' WHERE fact = 'id'",
    """UPDATE run SET value = replace(value, '"seed": 0', '"seed": 1') WHERE fact = 'settings'""",
])  # fmt: skip
def test_every_change_by_another_program_is_detected(path, change):
    for number in range(3):
        add(path, generation(number).assign(reason="it's"))
    broken(path, change)
    with pytest.raises(store.DamagedError, match="walkerlab rescue"):
        store.read(path)


# --------------------------------------------------------------------------------------------------- wrong files


def rejections(path):
    """Yield the message with which each function rejects a run file."""
    for use in (
        lambda: store.read(path),
        lambda: store.read_generations(path, "another", 0, 1),
        lambda: store.read_births(path, "another", ["genome"], [(0, 0)]),
        lambda: store.append(path, generation(9), "another"),
        lambda: store.prepare_resume(path, {}),
    ):
        with pytest.raises(RunFileError) as caught:
            use()
        assert str(path) in str(caught.value)
        yield str(caught.value)


def test_a_file_is_never_overwritten(path, tmp_path):
    add(path, generation(0))
    text = tmp_path / "thesis.txt"
    text.write_text("three years of work")
    for taken in (path, text):
        before = taken.read_bytes() if taken.is_file() else None
        with pytest.raises(RunFileError, match="never overwritten"):
            store.create(taken, {})
        assert before == (taken.read_bytes() if taken.is_file() else None)


def test_other_files_are_rejected_and_not_changed(tmp_path):
    text = tmp_path / "a.txt"
    empty = tmp_path / "empty"
    foreign = tmp_path / "foreign.db"
    text.write_text("generation,individual\n0,1\n" * 100)
    empty.touch()
    broken(foreign, "CREATE TABLE records (generation)", "CREATE TABLE run (fact, value)")
    for path, reason in ((text, "not a run file"), (empty, "is empty"), (foreign, "not a run")):
        before = path.read_bytes()
        assert all(reason in message for message in rejections(path))
        assert path.read_bytes() == before
    assert {file.name for file in tmp_path.iterdir()} == {"a.txt", "empty", "foreign.db"}


def test_a_missing_file_is_rejected_and_not_created(tmp_path):
    for path in (tmp_path / "none.wl", tmp_path / "no folder" / "none.wl", tmp_path):
        assert all("there is no run file" in message for message in rejections(path))
    assert not list(tmp_path.iterdir())


def test_a_run_of_a_newer_walkerlab_is_rejected_with_the_fix(path):
    broken(path, f"PRAGMA user_version = {schema.LAYOUT_VERSION + 1}")
    before = path.read_bytes()
    assert all("newer" in message and "pip install --upgrade walkerlab" in message for message in rejections(path))
    assert path.read_bytes() == before


def test_a_run_from_before_the_first_release_is_rejected_with_the_reason(path):
    broken(path, "PRAGMA user_version = 1")
    before = path.read_bytes()
    assert all("before walkerlab's first release" in message for message in rejections(path))
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    "damage",
    [
        "DROP TABLE records",
        "DROP TABLE run",
        "DELETE FROM run WHERE fact = 'settings'",
        "UPDATE run SET value = '{' WHERE fact = 'settings'",
        "UPDATE records SET fitness = 'high'",
        "UPDATE records SET n_legs = NULL",
        "ALTER TABLE records DROP COLUMN genome",
    ],
)
def test_a_damaged_run_is_rejected(path, damage):
    add(path, generation(0))
    broken(path, damage)
    with pytest.raises(RunFileError, match=path.name):
        store.read(path)


def test_a_truncated_file_is_rejected(path):
    add(path, generation(0, n=2000))
    path.write_bytes(path.read_bytes()[:20_000])
    with pytest.raises(RunFileError, match=path.name):
        store.read(path)


# ------------------------------------------------------------------------------------------ contents and traces


def test_a_file_holds_only_text_and_numbers(path):
    add(path, generation(0))
    with closing(sqlite3.connect(path)) as db:
        for table in ("run", "records", "generations"):
            columns = [column for _, column, *_ in db.execute(f"PRAGMA table_info({table})")]
            kinds = ", ".join(f"typeof({column})" for column in columns)
            found = {kind for row in db.execute(f"SELECT {kinds} FROM {table}") for kind in row}
            assert found <= {"text", "integer", "real", "null"}
        assert json.loads(dict(db.execute("SELECT * FROM run"))["settings"]) == Settings().model_dump()


def test_a_run_is_one_file_and_its_folder_is_created(tmp_path):
    path = tmp_path / "new" / "folder" / "my run?#%20.wl"
    store.create(path, {})
    add(path, generation(0))
    store.read(path)
    assert list(path.parent.iterdir()) == [path]


def test_reading_does_not_change_the_file(path):
    add(path, generation(0))
    before = path.read_bytes()
    when = path.stat().st_mtime_ns
    store.read(path)
    assert (path.read_bytes(), path.stat().st_mtime_ns) == (before, when)
    assert list(path.parent.iterdir()) == [path]
