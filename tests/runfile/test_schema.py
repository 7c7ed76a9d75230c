"""Run files of every release open in this one; a file that is not laid out as one of these is not used."""

import shutil
import sqlite3
import warnings
from contextlib import closing
from pathlib import Path

import pytest

import walkerlab as wl
from tests.faults.standins import evaluate
from tests.runfile.test_store import broken
from walkerlab.evolution import evolution
from walkerlab.runfile import opening, provenance, schema, store

KEPT = Path(__file__).parents[1] / "kept"
FILES = sorted(KEPT.glob("layout_*.walk"))


def nudge(genomes, genes, *, rng):
    return genomes + 0.01 * (genes.high - genes.low) * rng.uniform(-1, 1, genomes.shape)


@pytest.fixture(params=FILES, ids=[file.stem for file in FILES])
def kept(request, tmp_path):
    return Path(shutil.copy(request.param, tmp_path / "run.walk"))


def layout(path):
    with closing(sqlite3.connect(path)) as db:
        return db.execute("PRAGMA user_version").fetchone()[0]


def test_there_is_a_file_of_every_layout():
    assert [layout(file) for file in FILES] == [*range(schema.OLDEST, schema.LAYOUT + 1)]


def test_each_gives_the_table_that_was_written_and_is_left_as_it_is(kept):
    before = kept.read_bytes()
    assert wl.load(kept).records.to_csv(index=False).encode() == (KEPT / "records.csv").read_bytes()
    facts, made_with = store.read_facts(kept)
    assert facts == store.read_facts(kept)[0]
    assert made_with["mujoco"] == "3.17.0"
    assert kept.read_bytes() == before
    assert [one.name for one in kept.parent.iterdir()] == [kept.name]


def test_each_is_gone_on_with_and_is_of_this_layout_then(kept, monkeypatch):
    monkeypatch.setattr(evolution, "evaluate", evaluate)
    before = wl.load(kept).records.to_csv(index=False)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it was made elsewhere
        run = wl.resume(kept, 5, progress=False, mutation=nudge)
    assert run.n_generations == 5
    assert wl.load(kept).records.to_csv(index=False).startswith(before)
    assert layout(kept) == schema.LAYOUT
    assert provenance.here().items() <= store.read_facts(kept)[1].items()


def test_each_can_be_rescued(kept, tmp_path):
    run = wl.rescue(kept, tmp_path / "rescued.walk")
    assert run.records.to_csv(index=False).encode() == (KEPT / "records.csv").read_bytes()
    assert store.read_facts(run.path)[1] == store.read_facts(kept)[1]


@pytest.mark.parametrize("more", [
    "CREATE TABLE more (words)",
    "CREATE VIEW more AS SELECT * FROM records",
    "CREATE INDEX more ON records (fitness)",
    "CREATE TRIGGER more AFTER INSERT ON records BEGIN DELETE FROM records; END",
    "CREATE TRIGGER more AFTER UPDATE ON run BEGIN DELETE FROM records; END",
    "ALTER TABLE records ADD COLUMN more",
    "ALTER TABLE records ADD COLUMN more AS (zeroblob(100000000))",
    "DROP TABLE run",
])  # fmt: skip
def test_with_anything_more_or_less_in_it_it_is_not_used(kept, more):
    before = broken(kept, more).read_bytes()
    for use in (wl.load, store.read_facts, lambda path: store.go_on(path, {}), lambda path: wl.rescue(path, "x.walk")):
        with pytest.raises(wl.RunFileError, match="not laid out as a run file is"):
            use(kept)
    assert kept.read_bytes() == before
    assert not Path("x.walk").exists()


def test_a_table_that_is_a_view_is_none(kept):
    broken(
        kept,
        "ALTER TABLE records RENAME TO hidden",
        "CREATE VIEW records AS SELECT * FROM hidden UNION ALL SELECT * FROM hidden",
    )
    with pytest.raises(wl.RunFileError, match="not laid out"):
        wl.load(kept)


def test_what_is_written_is_on_the_disk_before_it_counts(kept):
    """SQLite's own promise, for a machine that is switched off; nothing here may weaken it."""
    with opening.opened(kept, "change") as db:
        assert db.execute("PRAGMA synchronous").fetchone() == (2,)  # FULL
        assert db.execute("PRAGMA journal_mode").fetchone() == ("delete",)
