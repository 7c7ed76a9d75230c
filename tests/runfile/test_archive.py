"""Archives: generations are read on first use, and no genome walks twice."""

import gc
import pickle
import signal
import sqlite3
import sys
import tracemalloc
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

import walkerlab as wl
from walkerlab.evolution import evolution as evolution_module
from walkerlab.evolution.forecast import n_walks
from walkerlab.evolution.live import LiveRun
from walkerlab.genome.genome import Genome
from walkerlab.runfile import archive as archive_module
from walkerlab.runfile import store
from walkerlab.runfile.archive import Archive
from walkerlab.runfile.records import EvaluationRow, concatenate_tables, tidy_table
from walkerlab.simulation.evaluation import Evaluation

SETTINGS = wl.Settings().with_(duration=1, population_size=12, generations=5, n_elites=2, seed=3)
PLAIN = SETTINGS.model_dump()
same = partial(pd.testing.assert_frame_equal, check_exact=True)


def generation(number, n=4, genome="wl1 {individual}"):
    """Return a generation whose first individual is an elite, except in generation 0."""
    individuals = np.arange(n) + number * (n - 1)
    table = pd.DataFrame({"generation": number, "individual": individuals, "born": number, "verdict": "ok"})
    table.loc[0, "born"] = max(0, number - 1)
    table = table.assign(fitness=individuals / 3, distance=np.nan, velocity=-np.inf, weight=1.0, body_length=0.5)
    table = table.assign(n_segments=2, n_legs=4, parents="", operators="random", reason="it's")
    return tidy_table(table.assign(genome=[genome.format(individual=individual) for individual in individuals]))


def filled(path=None, n=3, n_rows=4, **options):
    archive = Archive.create(PLAIN, path)
    for number in range(n):
        archive.add(generation(number, n_rows, **options))
    return archive


@pytest.fixture(params=["run.walk", None], ids=["file", "temporary"])
def path(request, tmp_path):
    return tmp_path / request.param if request.param else None


def is_open(file):
    try:
        return bool(file.execute("SELECT 1"))
    except sqlite3.ProgrammingError:
        return False


# ------------------------------------------------------------------------------------------ the table


def test_the_table_has_all_generations_that_were_added(path):
    archive = filled(path)
    for n in (3, 1, 0, 2):
        table = archive.table(n)
        same(table, concatenate_tables([generation(number) for number in range(n)]))
        assert table.attrs == concatenate_tables([]).attrs


def test_generations_are_read_once(path, monkeypatch):
    read = []
    store_reads = store.read_generations
    monkeypatch.setattr(
        store, "read_generations", lambda path, *span: (read.append(span[1:]), store_reads(path, *span))[1]
    )
    archive = filled(path)
    for n in (2, 2, 1, 3, 3):
        archive.table(n)
    archive.add(generation(3))
    same(archive.table(4), concatenate_tables([generation(number) for number in range(4)]))
    assert read == [(0, 2), (2, 3), (3, 4)]


def test_changing_a_returned_table_does_not_change_the_archive(path):
    archive = filled(path)
    mine = archive.table(3)
    mine["fitness"] = 99.0
    mine.loc[0, "genome"] = "mine"
    mine.attrs["units"] = {}
    same(archive.table(3), concatenate_tables([generation(number) for number in range(3)]))
    assert archive.table(3).attrs == concatenate_tables([]).attrs


@pytest.mark.skipif(sys.platform == "win32", reason="a temporary file has a name there while it is open")
def test_a_temporary_file_is_deleted_with_the_archive(tmp_path, monkeypatch):
    monkeypatch.setenv("SQLITE_TMPDIR", str(tmp_path))
    archive = filled(n=5, n_rows=2000, genome="x" * 1000 + "{individual}")  # more than SQLite holds in memory
    assert not list(tmp_path.iterdir())
    assert len(archive.table(5)) == 10_000
    file = archive._file
    assert is_open(file)
    del archive
    gc.collect()
    assert not is_open(file)


def test_threads_can_read_a_temporary_file_while_another_adds():
    archive = filled(n=1)
    n = 60
    with ThreadPoolExecutor(3) as pool:
        readers = [pool.submit(lambda: [len(archive.table(archive.table(n).generation.max() + 1)) for _ in range(n)])]
        readers += [pool.submit(lambda: [archive.find(["wl1 0"])["wl1 0"].genome for _ in range(n)])]
        for number in range(1, n):
            archive.add(generation(number))
        assert all(reader.result() for reader in readers)
    same(archive.table(n), concatenate_tables([generation(number) for number in range(n)]))


# ------------------------------------------------------------------------------------------ the index


def walked(table):
    return {
        row[-1]: EvaluationRow(*row) for row in table[list(EvaluationRow._fields)].itertuples(index=False, name=None)
    }


def test_find_returns_stored_evaluations_only(path):
    archive = filled(path, 9)
    born = concatenate_tables([generation(number) for number in range(9)])
    some = born.genome[::3].tolist()
    found = archive.find([*some, "wl1 unknown"])
    assert found.keys() == set(some)
    wanted = walked(born[born.genome.isin(some)])
    for text, one in found.items():
        assert one._replace(distance=None) == wanted[text]._replace(distance=None)
        assert one.distance is None, "NaN is NULL in the file"
    assert Archive.create(PLAIN).find(some) == archive.find([]) == {}


def test_genomes_with_equal_hashes_are_not_confused(path, monkeypatch):
    monkeypatch.setattr(archive_module, "hash", lambda text: 7, raising=False)
    archive = filled(path)
    found = [archive.find([text]).get(text) for text in ("wl1 0", "wl1 1", "wl1 unknown")]
    assert [one and one.genome for one in found] == ["wl1 0", None, None]


@hypothesis_settings(max_examples=50)
@given(sizes=st.lists(st.integers(2, 5), max_size=40))
def test_the_index_has_all_genomes_in_few_blocks(sizes):
    archive = Archive.create(PLAIN)
    texts = []
    for number, n in enumerate(sizes):
        archive._add_to_index(generation(number, n, genome=f"{number}-{{individual}}"))
        texts += [f"{number}-{i + number * (n - 1)}" for i in range(1 if number else 0, n)]
    hashes = [one for known in archive._index for one in known[0].tolist()]
    assert sorted(hashes) == sorted(map(hash, texts))
    assert all((known[0][:-1] <= known[0][1:]).all() for known in archive._index)
    assert len(archive._index) <= 9


# ------------------------------------------------------------------------------------------ no repeated walks


def measured(values):
    """Return the evaluation of a replaced walk: repeatable, with the same types of values."""
    genome = Genome(values)
    fitness = float(values[1:].sum() % 7)
    counts = fitness > 1
    return Evaluation(
        genome, fitness if counts else -np.inf, "ok" if counts else "airborne", "" if counts else "too long",
        fitness / 3, np.nan if fitness > 6 else 0.1, int(values[0]), 4, float(values[3]), float(values[2]),
    )  # fmt: skip


@pytest.fixture
def seen(monkeypatch):
    """Texts of the genomes that walk; the walks are replaced by ``measured``."""
    seen = []

    def evaluate(genomes, settings, executor=None, *, on_done=lambda n: None, starts=None, **_):
        if starts is None:
            seen.extend(str(Genome(values)) for values in genomes)
        on_done(len(genomes))
        return [measured(values) for values in genomes]

    monkeypatch.setattr(evolution_module, "evaluate", evaluate)
    return seen


@pytest.fixture
def without_reuse(monkeypatch):
    """Function that makes all children walk from then on, also those that have walked before."""

    def walk(self, genomes):
        return [EvaluationRow.of(one, str(one.genome)) for one in self._evaluate(genomes)]

    return lambda: monkeypatch.setattr(evolution_module.Evolution, "_evaluate_new", walk)


def often_copies(genomes, genes, *, rng, share=0.5):
    """Change one gene of some genomes, and copy the others."""
    changed = genomes.copy()
    changed[:, 1] += np.where(rng.random(len(genomes)) < share, 0.0, 0.001)
    return changed


COPIES = SETTINGS.with_(crossover="none", mutation=often_copies, generations=8)


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("seed", range(3))
def test_reusing_evaluations_does_not_change_the_table(seed, share, path, seen, without_reuse):
    settings = COPIES.with_(seed=seed, mutation=partial(often_copies, share=share))
    records = wl.evolve(settings, path, progress=False).records
    assert len(seen) == len(set(seen)) == records.genome.nunique()
    assert len(seen) < records.individual.nunique() or not share
    without_reuse()
    same(wl.evolve(settings, progress=False).records, records)
    assert len(seen) > records.individual.nunique(), "the earlier walks, and one for each robot"


def test_copies_do_not_walk_again(seen):
    run = wl.evolve(COPIES.with_(mutation=partial(often_copies, share=1.0)), progress=False)
    assert len(seen) == COPIES.algorithm.population_size
    assert run.n_generations == COPIES.algorithm.generations


def test_evaluations_from_before_a_resume_are_reused(seen, tmp_path):
    whole = wl.evolve(COPIES, progress=False).records
    for stop in (1, 3, 7):
        seen.clear()
        path = tmp_path / f"{stop}.walk"
        wl.evolve(COPIES.with_(generations=stop), path, progress=False)
        same(wl.resume(path, 8, progress=False, mutation=often_copies).records, whole)
        assert len(seen) == len(set(seen)) == whole.genome.nunique()


def test_evaluations_of_inserted_genomes_are_reused(seen):
    evolution = wl.Evolution(SETTINGS)
    for generation in evolution:
        evolution.insert(generation.champion.genome) if generation.number < 4 else None
    records = evolution.run.records
    assert (records.operators == "by hand").sum() >= 4
    assert len(seen) == len(set(seen)) == records.genome.nunique() < records.individual.nunique()


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_reported_progress_adds_up_to_all_walks(share, seen):
    settings = COPIES.with_(mutation=partial(often_copies, share=share))
    reported = []
    for _ in wl.Evolution(settings, on_walks=reported.append):
        pass
    assert sum(reported) == n_walks(settings)
    assert 0 not in reported


def test_the_text_of_a_genome_is_written_once(seen, monkeypatch):
    written = []
    write = Genome.__str__
    monkeypatch.setattr(Genome, "__str__", lambda genome: (written.append(genome), write(genome))[1])
    records = wl.evolve(SETTINGS, progress=False).records
    assert len(written) - len(seen) == records.individual.nunique()  # the replaced walks write them too


def test_equal_hashes_do_not_change_the_table(seen, monkeypatch):
    whole = wl.evolve(COPIES, progress=False).records
    monkeypatch.setattr(archive_module, "hash", lambda text: len(text) % 3, raising=False)
    same(wl.evolve(COPIES, progress=False).records, whole)


def test_reusing_real_walks_does_not_change_the_table(without_reuse):
    class Counting(ThreadPoolExecutor):
        walks = 0

        def submit(self, fn, robots, *args):
            self.walks += len(robots)
            return super().submit(fn, robots, *args)

    settings = COPIES.with_(generations=3, fitness=lambda rollout: float(rollout.com[-1, 2]), forgive="fragile")
    with Counting(2) as pool:
        records = wl.evolve(settings, executor=pool, progress=False).records
        assert pool.walks == records.genome.nunique() < records.individual.nunique()
        without_reuse()
        same(wl.evolve(settings, executor=pool, progress=False).records, records)


# ------------------------------------------------------------------------------------------ memory and reads


def test_memory_does_not_grow_with_the_number_of_generations(path, seen):
    size = 30
    held = {}
    tracemalloc.start()
    try:
        for generation in wl.Evolution(SETTINGS.with_(population_size=size, generations=16), path):
            seen.clear()
            gc.collect()
            held[generation.number] = tracemalloc.get_traced_memory()[0]
    finally:
        tracemalloc.stop()
    assert (held[15] - held[5]) / (10 * size) < 100, "bytes per individual; a row has a thousand"


def test_the_table_of_a_run_is_read_once_on_first_use(path, seen, monkeypatch):
    reads = []
    read = store.read_generations
    monkeypatch.setattr(store, "read_generations", lambda *span: (reads.append(span), read(*span))[1])
    run = wl.evolve(SETTINGS, path, progress=False)
    assert not reads
    assert run.records.equals(run.records)
    assert run.n_generations == len(run.records.groupby("generation")) == 5
    assert len(reads) == 1


def test_a_run_does_not_grow_with_its_evolution(path, seen):
    runs = {}
    evolution = wl.Evolution(SETTINGS, path)
    for generation in evolution:
        runs[generation.number] = evolution.run
    for number in (3, 1, 4):
        assert runs[number].n_generations == number + 1
        assert runs[number].records.attrs["fitness"] == "distance"


def test_a_live_run_is_not_read_again_for_each_use(seen, monkeypatch):
    live = LiveRun(SETTINGS)
    for _ in live._evolution:
        pass
    first = live.run.records
    monkeypatch.setattr(store, "read_generations", None)
    same(live.run.records, first)


def test_a_temporary_file_lasts_until_its_run_is_read(seen):
    evolution = wl.Evolution(SETTINGS)
    for _ in evolution:
        pass
    run = evolution.run
    file = evolution._archive._file
    del evolution
    gc.collect()
    assert is_open(file)
    assert len(run.records) == 60
    gc.collect()
    assert not is_open(file)


def test_a_run_that_has_not_been_read_can_be_pickled(path, seen):
    run = wl.evolve(SETTINGS, path, progress=False)
    sent = pickle.loads(pickle.dumps(run))
    same(sent.records, run.records)
    assert (sent.settings, sent.path) == (run.settings, run.path)


def test_ctrl_c_while_evaluations_are_reused_keeps_earlier_generations(seen, path):
    calls = []

    def interrupt(n):
        calls.append(n)
        if len(calls) == 2:
            signal.raise_signal(signal.SIGINT)

    evolution = wl.Evolution(COPIES.with_(mutation=partial(often_copies, share=1.0)), path, on_walks=interrupt)
    with pytest.raises(KeyboardInterrupt):
        list(evolution)
    assert evolution.run.n_generations == evolution.n_generations == 1
