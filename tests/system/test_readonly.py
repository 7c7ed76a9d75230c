"""Attributes, tables and arrays that are documented as read-only are read-only, also in copies."""

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
from walkerlab.genome.features import build_genes
from walkerlab.runfile.records import last_population
from walkerlab.system.readonly import ReadOnlyArrays, ReadOnlyError

SETTINGS = wl.Settings().with_(duration=1, population_size=4, generations=2, n_elites=1)
COPIES = (copy.copy, copy.deepcopy, lambda original: pickle.loads(pickle.dumps(original)))
assert_same_table = partial(pd.testing.assert_frame_equal, check_exact=True)


@pytest.fixture(scope="module")
def threads():
    with ThreadPoolExecutor(1) as pool:
        yield pool


@pytest.fixture(scope="module")
def run(threads):
    return wl.evolve(SETTINGS, executor=threads, progress=False)


@pytest.fixture(scope="module")
def objects_with_arrays(run):
    """Return an object of each class with read-only arrays."""
    champion = run.champion
    population = last_population(run.records)
    birth = wl.analysis.mutate(champion.genome, SETTINGS, rng=np.random.default_rng(0))
    rollout = wl.simulate(champion.genome, SETTINGS)
    return [champion.genome, rollout, population, build_genes(SETTINGS.robot), birth, birth.sources]


def test_an_object_of_every_class_with_read_only_arrays_is_tested(objects_with_arrays):
    assert {type(item) for item in objects_with_arrays} >= set(ReadOnlyArrays.__subclasses__())


@pytest.mark.parametrize("duplicate", COPIES, ids=["copy", "deepcopy", "pickle"])
def test_arrays_are_read_only_in_every_copy(duplicate, objects_with_arrays):
    for original in objects_with_arrays:
        duplicated = duplicate(original)
        assert type(duplicated) is type(original)
        arrays = {name: value for name, value in vars(duplicated).items() if isinstance(value, np.ndarray)}
        assert arrays
        for name, array in arrays.items():
            assert not array.flags.writeable, f"{type(original).__name__}.{name}"
            np.testing.assert_array_equal(array, getattr(original, name))
        assert {field.name for field in fields(original)} <= vars(duplicated).keys()


def test_arrays_of_copied_containers_are_read_only(run, threads):
    [evaluation] = wl.evaluate([run.champion.genome], SETTINGS, threads)
    for holder in (run.champion, evaluation, wl.compile_scene(run.champion.genome, SETTINGS), [run.champion.genome]):
        duplicated = copy.deepcopy(holder)
        genome = duplicated[0] if isinstance(duplicated, list) else duplicated.genome
        assert not genome.values.flags.writeable
        assert genome == run.champion.genome


def test_masks_of_the_gene_table_are_read_only():
    genes = build_genes(SETTINGS.robot)
    assert not genes.is_count.flags.writeable
    assert not genes.is_cyclic.flags.writeable


@pytest.mark.parametrize("change", [
    lambda evolution: setattr(evolution, "settings", evolution.settings.with_(mutation_rate=1.0, structure="stairs")),
    lambda evolution: setattr(evolution, "path", "elsewhere.walk"),
    lambda evolution: delattr(evolution, "settings"),
], ids=["settings", "path", "deleted"])  # fmt: skip
def test_settings_and_path_of_an_evolution_cannot_be_assigned_during_a_run(change, run, threads):
    evolution = wl.Evolution(SETTINGS, executor=threads)
    for _ in evolution:
        with pytest.raises(ReadOnlyError, match="is read-only") as caught:
            change(evolution)
    assert "wl.Evolution(" in str(caught.value) or "Copy that file" in str(caught.value)
    assert evolution.settings is SETTINGS
    assert_same_table(evolution.run.records, run.records)


@pytest.mark.parametrize("name", ["settings", "path", "records"])
def test_attributes_of_a_run_cannot_be_replaced(name, run):
    before = getattr(run, name)
    with pytest.raises(AttributeError, match=rf"Run\.{name} is read-only\. .*\."):
        setattr(run, name, None)
    assert before is getattr(run, name) or before.equals(getattr(run, name))


def test_the_settings_of_a_live_run_cannot_be_replaced(threads):
    with pytest.raises(AttributeError, match=r"LiveRun\.settings is read-only"):
        LiveRun(SETTINGS, executor=threads).settings = SETTINGS.with_(seed=1)


def test_changing_a_returned_table_does_not_change_the_run(run):
    before = run.records.copy()
    champion = run.champion
    pickled = pickle.dumps(run)
    table = run.records
    table["fitness"] = 0
    table.loc[0, "genome"] = "mine"
    table.pop("genome")
    table.attrs["units"]["distance"] = "miles"
    assert_same_table(run.records, before)
    assert run.records.attrs == before.attrs
    assert run.champion == champion
    assert_same_table(pickle.loads(pickled).records, before)


def test_changing_a_table_given_to_a_run_does_not_change_the_run(run):
    table = run.records
    other = wl.Run(SETTINGS, table)
    table["fitness"] = 0
    assert other.champion == run.champion


def test_changing_the_table_of_a_generation_does_not_change_its_champion(run, threads):
    [first, *_] = wl.Evolution(SETTINGS.with_(generations=1), executor=threads)
    champion = first.champion
    table = first.records
    table["fitness"] = 0
    assert first.champion == champion
    assert wl.Run(SETTINGS, first.records).champion == champion
