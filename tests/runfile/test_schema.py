"""Layouts of run files: those of every release can be used, and no other."""

import re
import shutil
import sqlite3
import warnings
from contextlib import closing
from pathlib import Path

import pandas as pd
import pytest

import walkerlab as wl
from tests.faults.standins import evaluate
from tests.runfile.test_store import broken
from walkerlab.__main__ import main
from walkerlab.evolution import evolution
from walkerlab.runfile import opening, schema, store
from walkerlab.text.numbers import with_unit

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


def test_there_is_a_test_file_of_every_layout():
    assert [layout(file) for file in FILES] == [*range(schema.OLDEST_LAYOUT, schema.LAYOUT_VERSION + 1)]


def warns_of_version_1():
    return pytest.warns(UserWarning, match=r"run\.walk was made by walkerlab 0\.1\. .* its robots walk differently")


def test_each_layout_is_read_without_changing_the_file(kept):
    before = kept.read_bytes()
    with warns_of_version_1():
        run = wl.load(kept)
    assert run.records.to_csv(index=False).encode() == (KEPT / "records.csv").read_bytes()
    facts, made_with = store.read_facts(kept)
    assert facts == store.read_facts(kept)[0]
    assert made_with["mujoco"] == "3.17.0"
    assert kept.read_bytes() == before
    assert [one.name for one in kept.parent.iterdir()] == [kept.name]


def test_a_run_of_version_1_has_the_same_champion_and_can_be_shown(kept):
    with warns_of_version_1():
        run = wl.load(kept)
    table = pd.read_csv(KEPT / "records.csv")
    best = table.iloc[table.fitness.idxmax()]
    assert (run.champion.fitness, run.champion.genome) == (best.fitness, wl.Genome.parse(best.genome))
    assert with_unit(best.fitness, "m") in run._repr_html_()


def test_a_run_of_version_1_is_not_resumed_but_can_be_evolved_again(kept, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(evolution, "evaluate", evaluate)
    before = kept.read_bytes()
    advice = r"made by walkerlab 0\.1, .* cannot be resumed\. Evolve again .* wl\.evolve"
    for functions in ({"mutation": nudge}, {}):
        with warns_of_version_1(), pytest.raises(wl.RunFileError, match=advice):
            wl.resume(kept, 5, progress=False, **functions)
    with warnings.catch_warnings():
        warnings.simplefilter("always")  # the command prints warnings
        assert main(["resume", str(kept)]) == 2
    assert re.search(advice, " ".join(capsys.readouterr().err.split()))
    assert kept.read_bytes() == before
    with warns_of_version_1():
        settings = wl.load(kept).settings
    again = wl.evolve(settings.with_(mutation=nudge), tmp_path / "new.walk", progress=False)
    assert again.n_generations == settings.algorithm.generations
    assert again.settings.robot == settings.robot


def test_each_layout_is_upgraded_before_anything_is_written(kept):
    with warns_of_version_1():
        run = wl.load(kept)
    store.prepare_resume(kept, run.settings.model_dump())
    assert layout(kept) == schema.LAYOUT_VERSION
    with warns_of_version_1():
        assert wl.load(kept).records.equals(run.records)


def test_each_layout_can_be_rescued(kept, tmp_path):
    with pytest.warns(UserWarning, match=r"rescued\.walk was made by walkerlab 0\.1"):
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
def test_a_file_with_additional_or_missing_parts_is_rejected(kept, more):
    before = broken(kept, more).read_bytes()
    for use in (
        wl.load,
        store.read_facts,
        lambda path: store.prepare_resume(path, {}),
        lambda path: wl.rescue(path, "x.walk"),
    ):
        with pytest.raises(wl.RunFileError, match="not those of a run file"):
            use(kept)
    assert kept.read_bytes() == before
    assert not Path("x.walk").exists()


def test_a_view_in_place_of_a_table_is_rejected(kept):
    broken(
        kept,
        "ALTER TABLE records RENAME TO hidden",
        "CREATE VIEW records AS SELECT * FROM hidden UNION ALL SELECT * FROM hidden",
    )
    with pytest.raises(wl.RunFileError, match="not those of a run file"):
        wl.load(kept)


def test_a_commit_waits_until_the_data_is_on_the_disk(kept):
    """SQLite guarantees this also after a power failure, unless these settings are weakened."""
    with opening.open_run(kept, "write") as db:
        assert db.execute("PRAGMA synchronous").fetchone() == (2,)  # FULL
        assert db.execute("PRAGMA journal_mode").fetchone() == ("delete",)
