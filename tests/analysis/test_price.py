"""The terms of the Price equation add up to the change of the mean, in every generation of a real run."""

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.analysis.price import TERMS
from walkerlab.runfile.records import parent_numbers


def test_the_run_contains_elites_failed_walks_and_insertions(run):
    table = run.records
    assert (table.born < table.generation).any(), "elites"
    assert set(table.verdict) > {"ok"}, "walks that do not count"
    assert (table.operators == "by hand").any(), "inserted robots"


@pytest.mark.parametrize("trait", ["fitness", "body_length", "n_segments"])
def test_the_terms_add_up_to_the_change_in_every_generation(run, trait):
    split = wl.analysis.price_equation(run, trait)
    table = run.records
    means = table[table.verdict == "ok"].groupby("generation")[trait].mean()
    assert split.generation.tolist() == [1, 2, 3, 4]
    assert np.allclose(split["mean"], means[1:], rtol=0, atol=1e-12)
    assert np.allclose(split.mean_before, means[:-1], rtol=0, atol=1e-12)
    assert np.abs(split[[*TERMS]].sum(axis=1) - split.change).max() < 1e-9
    assert np.abs(split.change - np.diff(means)).max() < 1e-9
    counted = table[(table.operators == "by hand") & (table.born == table.generation) & (table.verdict == "ok")]
    has_insertion = split.generation.isin(counted.generation)
    assert has_insertion.any()
    assert (split.insertion[~has_insertion].abs() < 1e-12).all()
    assert trait != "fitness" or (split.insertion[has_insertion].abs() > 1e-6).all()


def test_selection_is_the_covariance_of_fitness_and_number_of_children(run):
    split = wl.analysis.price_equation(run).set_index("generation")
    table = run.records
    for generation in split.index:
        before = table[(table.generation == generation - 1) & (table.verdict == "ok")].set_index("individual")
        children = pd.Series(0.0, index=before.index)
        for row in table[table.generation == generation].itertuples():
            parents = (row.individual,) if row.born < generation else parent_numbers(row.parents)
            for parent in parents:
                children[parent] += 1 / len(parents)
        covariance = np.cov(before.fitness, children, ddof=0)[0, 1]
        assert split.selection[generation] == pytest.approx(covariance / children.mean(), abs=1e-12)


def test_a_table_from_a_csv_file_gives_the_same(run, tmp_path):
    run.records.to_csv(tmp_path / "run.csv", index=False)
    read = wl.analysis.price_equation(pd.read_csv(tmp_path / "run.csv"))
    pd.testing.assert_frame_equal(read, wl.analysis.price_equation(run))


def test_without_variation_only_selection_changes_the_mean():
    clones = pd.DataFrame(
        {
            "generation": [0, 0, 1, 1],
            "individual": [0, 1, 2, 3],
            "born": [0, 0, 1, 1],
            "parents": ["", "", "1", "1"],
            "verdict": "ok",
            "fitness": [1.0, 3.0, 3.0, 3.0],
        }
    )
    (row,) = wl.analysis.price_equation(clones).itertuples()
    assert (row.change, row.selection, row.variation, row.failed_walks, row.insertion) == (1, 1, 0, 0, 0)
    void = clones.assign(verdict=["ok", "ok", "unstable", "unstable"], fitness=[1, 3, -np.inf, -np.inf])
    assert wl.analysis.price_equation(void)[[*TERMS]].isna().all().all()


def test_incomplete_tables_are_rejected(run):
    table = run.records
    with pytest.raises(ValueError, match=r"run\.records"):
        wl.analysis.price_equation(table[(table.generation > 0) | (table.individual > 5)])
    with pytest.raises(ValueError, match="is not numeric"):
        wl.analysis.price_equation(run, "genome")
    with pytest.raises(ValueError, match="no column 'height'"):
        wl.analysis.price_equation(run, "height")
