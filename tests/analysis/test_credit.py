"""Operators are credited with the gains of their children over their parents."""

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl


def make_table(*fitness, operators="rank > paired > micro"):
    """Return a table with two parents, of fitness 1 and 3, and children with the given fitness."""
    n = len(fitness)
    return pd.DataFrame(
        {
            "generation": [0, 0, *[1] * n],
            "individual": range(n + 2),
            "born": [0, 0, *[1] * n],
            "parents": ["", "", *["0 1"] * n],
            "operators": ["random", "random", *[operators] * n],
            "fitness": [1.0, 3.0, *fitness],
            "verdict": ["ok", "ok", *("ok" if np.isfinite(value) else "unstable" for value in fitness)],
        }
    )


def test_credit_of_a_small_table():
    (row,) = wl.analysis.operator_credit(make_table(3.0, 4.0, 0.0, -np.inf)).itertuples()
    assert (row.crossover, row.mutation, row.children, row.counted) == ("paired", "micro", 4, 3)
    assert row.better == 1 / 4  # equal is not better, and a walk that does not count is not better
    assert row.mean_gain == pytest.approx((1 + 2 - 2) / 3)
    assert row.best_gain == 1


def test_each_pair_of_operators_has_a_row():
    tables = [make_table(5.0, operators="a > b > c"), make_table(0.0, 0.0, operators="a > b+b > c")]
    experiment = pd.concat([table.assign(condition=str(i), seed=0) for i, table in enumerate(tables)])
    credit = wl.analysis.operator_credit(experiment)
    assert credit[["crossover", "mutation", "children"]].to_numpy().tolist() == [["b+b", "c", 2], ["b", "c", 1]]
    assert credit.better.tolist() == [0, 1]


def test_every_child_of_a_run_is_counted_once(run):
    table = run.records
    credit = wl.analysis.operator_credit(run)
    is_child = (table.born == table.generation) & (table.parents != "")
    assert credit.children.tolist() == [is_child.sum()]
    assert credit.counted.tolist() == [(is_child & (table.verdict == "ok")).sum()]
    fitness = table.set_index("individual").fitness.to_dict()
    better = [
        row.fitness > max(fitness[int(parent)] for parent in row.parents.split())
        for row in table[is_child].itertuples()
    ]
    assert credit.better[0] == pytest.approx(np.mean(better))


def test_a_run_without_children_has_no_rows(run):
    table = run.records
    assert wl.analysis.operator_credit(table[table.generation == 0]).empty
    with pytest.raises(ValueError, match=r"run\.records"):
        wl.analysis.operator_credit(table[(table.generation > 0) | (table.individual > 5)])
