"""What promises to be read-only is read-only: attributes, tables that are handed out, and arrays also in copies."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from functools import partial

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.evolution.live import LiveRun
from walkerlab.genome.repair import genes_of
from walkerlab.readonly import ReadOnlyArrays, ReadOnlyError
from walkerlab.runfile.records import last_population

SETTINGS = wl.Settings().with_(duration=1, population_size=4, generations=2, n_elites=1)
COPIES = (copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one)))
same = partial(pd.testing.assert_frame_equal, check_exact=True)


@pytest.fixture(scope="module")
def threads():
    with ThreadPoolExecutor(1) as pool:
        yield pool


@pytest.fixture(scope="module")
def run(threads):
    return wl.evolve(SETTINGS, executor=threads, progress=False)


@pytest.fixture(scope="module")
def holders(run):
    """Return an object of each class that promises read-only arrays."""
    champion, population = run.champion, last_population(run.records)
    return [champion.genome, wl.simulate(champion.genome, SETTINGS), population, genes_of(SETTINGS.robot)]


def test_an_object_of_every_class_with_read_only_arrays_is_tested(holders):
    assert {type(one) for one in holders} >= set(ReadOnlyArrays.__subclasses__())


@pytest.mark.parametrize("duplicate", COPIES, ids=["copy", "deepcopy", "pickle"])
def test_arrays_are_read_only_in_every_copy(duplicate, holders):
    for one in holders:
        twin = duplicate(one)
        assert type(twin) is type(one)
        arrays = {name: value for name, value in vars(twin).items() if isinstance(value, np.ndarray)}
        assert arrays
        for name, array in arrays.items():
            assert not array.flags.writeable, f"{type(one).__name__}.{name}"
            np.testing.assert_array_equal(array, getattr(one, name))
        assert {field.name for field in fields(one)} <= vars(twin).keys()


def test_copies_within_other_objects_are_read_only_too(run, threads):
    [evaluation] = wl.evaluate([run.champion.genome], SETTINGS, threads)
    for holder in (run.champion, evaluation, wl.compile_scene(run.champion.genome, SETTINGS), [run.champion.genome]):
        twin = copy.deepcopy(holder)
        genome = twin[0] if isinstance(twin, list) else twin.genome
        assert not genome.values.flags.writeable
        assert genome == run.champion.genome


def test_masks_of_the_gene_table_are_read_only():
    genes = genes_of(SETTINGS.robot)
    assert not genes.is_count.flags.writeable
    assert not genes.is_cyclic.flags.writeable


@pytest.mark.parametrize("change", [
    lambda evolution: setattr(evolution, "settings", evolution.settings.with_(mutation_rate=1.0, structure="stairs")),
    lambda evolution: setattr(evolution, "path", "elsewhere.walk"),
    lambda evolution: delattr(evolution, "settings"),
], ids=["settings", "path", "deleted"])  # fmt: skip
def test_what_an_evolution_is_made_with_is_refused_halfway_and_changes_nothing(change, run, threads):
    evolution = wl.Evolution(SETTINGS, executor=threads)
    for _ in evolution:
        with pytest.raises(ReadOnlyError, match="is read-only") as caught:
            change(evolution)
    assert "wl.Evolution(" in str(caught.value) or "Copy that file" in str(caught.value)
    assert evolution.settings is SETTINGS
    same(evolution.run.records, run.records)


@pytest.mark.parametrize("name", ["settings", "path", "records"])
def test_no_part_of_a_run_can_be_replaced(name, run):
    before = getattr(run, name)
    with pytest.raises(AttributeError, match=rf"Run\.{name} is read-only\. .*\."):
        setattr(run, name, None)
    assert before is getattr(run, name) or before.equals(getattr(run, name))


def test_a_live_run_keeps_its_settings(threads):
    with pytest.raises(AttributeError, match=r"LiveRun\.settings is read-only"):
        LiveRun(SETTINGS, executor=threads).settings = SETTINGS.with_(seed=1)


def test_a_table_that_is_handed_out_cannot_change_the_run(run):
    before, champion, kept = run.records.copy(), run.champion, pickle.dumps(run)
    table = run.records
    table["fitness"] = 0
    table.loc[0, "genome"] = "mine"
    table.pop("genome")
    table.attrs["units"]["distance"] = "miles"
    same(run.records, before)
    assert run.records.attrs == before.attrs
    assert run.champion == champion
    same(pickle.loads(kept).records, before)


def test_a_table_that_was_given_cannot_change_the_run(run):
    table = run.records
    made = wl.Run(SETTINGS, table)
    table["fitness"] = 0
    assert made.champion == run.champion


def test_the_table_of_a_generation_cannot_change_its_champion(run, threads):
    [first, *_] = wl.Evolution(SETTINGS.with_(generations=1), executor=threads)
    champion = first.champion
    table = first.records
    table["fitness"] = 0
    assert first.champion == champion
    assert wl.Run(SETTINGS, first.records).champion == champion
