"""The card of a robot shows its origin, its ancestors, and why its walk does not count."""

import re

import numpy as np
import pandas as pd

import walkerlab as wl
from walkerlab.runfile.records import birth_rows
from walkerlab.widgets.card import robot_card
from walkerlab.widgets.origins import NEW, SHARED, describe_origins, find_origins


def test_only_a_child_has_a_line_of_descent(done):
    child = done.records[done.records.parents != ""].individual.iloc[-1]
    assert "Line of descent" in robot_card(done.records, child)
    assert "random" in robot_card(done.records, 0)
    assert "Line of descent" not in robot_card(done.records, 0)


def test_a_walk_that_does_not_count_has_a_reason_and_no_fitness(done):
    fell = done.records.assign(verdict="too_fast", reason="9 m/s <b>")
    assert "Details: 9 m/s &lt;b&gt;." in robot_card(fell, 0)
    assert "Fitness" not in robot_card(fell, 0)
    assert "Fitness" in robot_card(done.records, done.champion.individual)


def test_each_gene_is_from_the_parent_with_the_same_value_or_new():
    parents = np.array([[1.0, 2.0, 3.0, 4.0], [1.0, 5.0, 6.0, 7.0]])
    assert find_origins(np.array([1.0, 2.0, 6.0, 4.2]), parents).tolist() == [SHARED, 0, 1, NEW]
    assert find_origins(np.array([1.0, 2.0, 3.0, 4.2]), parents[:1]).tolist() == [0, 0, 0, NEW]


def family(*, changes, n_parents=2):
    """Return the births of parents and a child: a copy of parent 0 with genes of parent 1 or new values."""
    parents = [wl.Genome.random(wl.Robot(), rng=np.random.default_rng(seed)) for seed in (2, 3)][:n_parents]
    values = parents[0].values.copy()
    for gene, value in changes.items():
        values[gene] = parents[1].values[gene] if value is None else value
    rows = [{"individual": i, "parents": "", "genome": str(one)} for i, one in enumerate(parents)]
    rows.append({"individual": 9, "parents": " ".join(map(str, range(n_parents))), "genome": str(wl.Genome(values))})
    return pd.DataFrame(rows).set_index("individual", drop=False), parents


def test_a_mutated_child_lists_the_changed_genes_with_old_and_new_value():
    births, (parent,) = family(changes={4: 0.333, 1: 2.5}, n_parents=1)
    shown = describe_origins(births, 9)
    assert {change.name for change in shown["changes"]} == {"segment 1, length", "whole robot, frequency"}
    length = next(change for change in shown["changes"] if change.name == "segment 1, length")
    assert float(length.before) == parent.values[4]
    assert length.after == "0.333 m"
    assert "2 new" in shown["summary"]
    assert [one["caption"] for one in shown["parents"]] == ["A: robot 0"]
    assert describe_origins(births, 0) == {}, "the first generation has no parents"
    assert describe_origins(births.drop(index=0), 9) == {}, "the parents are not in the table"


def test_the_genes_of_each_parent_have_its_letter():
    births, _ = family(changes={4: None, 5: None})
    shown = describe_origins(births, 9)
    kinds = [gene["kind"] for group, genes in shown["groups"] if group == "segment 1" for gene in genes]
    assert kinds[:2] == ["p1", "p1"]
    assert "2 from B" in shown["summary"]
    assert shown["changes"] == []


def test_the_card_of_a_child_shows_what_its_parents_gave(done):
    child = int(done.records[done.records.parents != ""].individual.iloc[-1])
    card = str(robot_card(done.records, child))
    parents = birth_rows(done.records).parents[child].split()
    assert "Who gave what" in card
    assert all(f": robot {number}" in card for number in dict.fromkeys(parents))
    assert len(re.findall(r'class="gene ', card)) > 10
    assert "Who gave what" not in robot_card(done.records, 0)
