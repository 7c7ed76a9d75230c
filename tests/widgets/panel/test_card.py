"""The card of a robot shows its origin, its ancestors, and why its walk does not count."""

import re

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.analysis.comparison import compare_with_parents
from walkerlab.analysis.inheritance import shortest_change
from walkerlab.genome.features import build_genes
from walkerlab.genome.repair import repair
from walkerlab.runfile.records import birth_rows
from walkerlab.text.templates import Markup
from walkerlab.widgets.genome_words import genome_lines
from walkerlab.widgets.panel.card import OF_TWO_PARENTS, Card, robot_card
from walkerlab.widgets.panel.origins import describe_origins


def test_only_a_child_has_a_line_of_descent(done):
    child = done.records[done.records.parents != ""].individual.iloc[-1]
    assert "Line of descent" in robot_card(done.records, child)
    assert "tournament: the best of a few drawn at random" in robot_card(done.records, child)
    assert "Operators that made it" not in robot_card(done.records, 0)
    assert "random" in robot_card(done.records, 0)
    assert "Line of descent" not in robot_card(done.records, 0)


def test_a_walk_that_does_not_count_has_a_reason_and_no_fitness(done):
    fell = done.records.assign(verdict="too_fast", reason="9 m/s <b>")
    assert "Details: 9 m/s &lt;b&gt;." in robot_card(fell, 0)
    assert "Fitness" not in robot_card(fell, 0)
    assert "Fitness" in robot_card(done.records, done.champion.individual)


@pytest.mark.parametrize("crossover", wl.Crossover)
def test_a_single_parent_was_drawn_as_both_unless_the_child_is_a_copy(done, crossover):
    child = done.records[done.records.parents != ""].individual.iloc[-1]
    records = done.records.assign(parents="0", operators=f"tournament > {crossover.name} > gaussian")
    assert ("robot 0, drawn as both parents" in robot_card(records, child)) == (crossover.name in OF_TWO_PARENTS)
    records = done.records.assign(parents="0 1", operators=f"tournament > {crossover.name} > gaussian")
    assert "drawn as both" not in robot_card(records, child)


def test_a_speed_below_the_resolution_of_the_eye_is_not_written_with_an_exponent(done):
    slow = done.records.assign(velocity=-7.57e-4, distance=2e-5)
    assert "0 m forward, −0.001 m/s in the last two thirds of the walk" in robot_card(slow, 0)


def test_the_browser_cannot_change_a_description():
    card = Card()
    card.value = Markup("<p>Robot 3</p>")
    card.set_state({"value": "<script>"})
    assert card.snapshot() == "<p>Robot 3</p>"


MODEL = """async (source) => {
    const { default: widget } = await import(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
    let value = "", onChange;
    const model = { get: () => value, on: (_, listener) => { onChange = listener; } };
    widget.render({ model, el: document.body.appendChild(document.createElement("div")) });
    window.describe = (html) => { value = html; onChange(); };
}"""


def test_in_a_browser_an_opened_part_stays_open_when_the_description_changes(page, done):
    page.evaluate(MODEL, Card._esm)
    child = done.records[done.records.parents != ""].individual.iloc[-1]
    page.evaluate("describe", robot_card(done.records, child))
    page.get_by_text("Ancestors").click()
    height = page.locator(".wl-card").bounding_box()["height"]
    page.evaluate("describe", robot_card(done.records, child, is_edited=True))
    assert page.get_by_text("Line of descent").is_visible()
    assert not page.get_by_text("tournament: the best of a few").is_visible()
    assert page.locator(".wl-card").bounding_box()["height"] == height
    page.evaluate("describe", robot_card(done.records, 0))  # has no ancestors
    page.evaluate("describe", robot_card(done.records, child))
    assert page.get_by_text("Line of descent").is_visible()
    page.get_by_text("Ancestors").click()
    page.evaluate("describe", robot_card(done.records, child, is_edited=True))
    assert not page.get_by_text("Line of descent").is_visible()


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
    assert "2 have new values" in shown["summary"]
    assert [one["caption"] for one in shown["parents"]] == ["A: robot 0"]
    assert describe_origins(births, 0) == {}, "the first generation has no parents"
    assert describe_origins(births.drop(index=0), 9) == {}, "the parents are not in the table"


def test_the_genes_of_each_parent_have_its_letter():
    births, _ = family(changes={4: None, 5: None})
    shown = describe_origins(births, 9)
    genes = next(genes for group, genes in shown["groups"] if group == "segment 1")
    assert [gene["sign"] for gene in genes[:3]] == ["B", "B", "="]
    assert "2 come from B (robot 1)" in shown["summary"]
    assert shown["changes"] == []


def test_the_card_shows_a_gene_as_the_microscope_does():
    births, parents = family(changes={4: None, 5: 1.234, 1: 2.5})
    birth = compare_with_parents(births.genome[9], parents, wl.Robot(), ["robot 0", "robot 1"])
    words = {word["gene"]: word for line in genome_lines(birth) for word in line if word["gene"] and not word["faint"]}
    cells = [gene for _, genes in describe_origins(births, 9)["groups"] for gene in genes]
    assert {cell["title"] for cell in cells} == {word["title"] for word in words.values()}
    shown = {cell["title"]: cell for cell in cells}
    for word in words.values():
        cell = shown[word["title"]]
        assert (cell["sign"], cell["is_changed"]) == (word["sign"], bool(word["change"]))
        assert not word["colour"] or cell["colour"] == word["colour"]


def test_a_blend_has_the_letters_of_both_parents_and_no_change():
    births, parents = family(changes={})
    genes = build_genes(wl.Robot())
    first, second = (parent.values for parent in parents)
    blend = repair((first + 0.3 * shortest_change(first, second, genes))[np.newaxis], wl.Robot())[0]
    births.loc[9, "genome"] = str(wl.Genome(blend))
    signs = [gene["sign"] for _, cells in describe_origins(births, 9)["groups"] for gene in cells]
    assert signs.count("AB") > len(signs) / 2


def test_the_card_of_a_child_shows_what_its_parents_gave(done):
    child = int(done.records[done.records.parents != ""].individual.iloc[-1])
    card = str(robot_card(done.records, child))
    parents = birth_rows(done.records).parents[child].split()
    assert "Origin of its genes" in card
    assert all(f": robot {number}" in card for number in dict.fromkeys(parents))
    assert len(re.findall(r'class="gene', card)) > 10
    assert "Origin of its genes" not in robot_card(done.records, 0)
