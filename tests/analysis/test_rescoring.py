"""A finished run can be rated by another fitness."""

import numpy as np
import pytest

import walkerlab as wl


def recorded(run):
    return run.records.drop_duplicates("individual")


def test_recorded_columns_give_the_same_as_new_walks(run, pool):
    from_columns = wl.analysis.rescore(run, "velocity")
    assert from_columns.attrs["source"] == "recorded columns"
    settings = run.settings.with_(fitness="velocity")
    walked = wl.evaluate(from_columns.genome.tolist(), settings, pool)
    assert from_columns.fitness_after.tolist() == [evaluation.fitness for evaluation in walked]
    assert from_columns.verdict_after.tolist() == [evaluation.verdict for evaluation in walked]


def test_ranks_are_those_of_the_fitness(run):
    table = wl.analysis.rescore(run, "distance")
    assert table.rank_after.tolist() == list(range(1, len(table) + 1))
    assert (np.diff(table.fitness_after[np.isfinite(table.fitness_after)]) <= 0).all()
    assert table.loc[table["rank"] == 1, "individual"].item() == run.champion.individual
    assert sorted(table.individual) == sorted(recorded(run).individual)
    assert (table.verdict == "rejected").any()
    assert not (table.verdict_after == "rejected").any()


def test_another_fitness_walks_again_and_the_summary_names_both_champions(run, pool):
    done = []
    table = wl.analysis.rescore(run, sideways, pool, on_done=done.append)
    assert table.attrs["source"] == "new walks"
    assert sum(done) == len(table) == len(recorded(run))
    assert table.attrs["fitness_after"] == "sideways"
    new = table.iloc[0]
    assert new.individual != run.champion.individual
    assert f"robot {run.champion.individual}, rank" in table.attrs["summary"]
    assert f"robot {new.individual}, rank {new['rank']}" in table.attrs["summary"]
    same = wl.analysis.rescore(run, "distance")
    assert same.attrs["summary"] == f"Robot {run.champion.individual} is the champion by forward_only and by distance."


def test_wrong_fitness_functions_are_rejected(run, pool):
    with pytest.raises(ValueError, match="velocity"):
        wl.analysis.rescore(run, "velocty")
    with pytest.raises(wl.OperatorError, match="one finite number"):
        wl.analysis.rescore(run, lambda rollout: "far", pool)


def sideways(rollout):
    """Rate the sideways displacement."""
    return abs(float(rollout.com[-1, 1] - rollout.com[0, 1]))
