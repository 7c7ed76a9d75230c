"""The population lists all robots of a generation in every order, and draws only the visible ones."""

import json

import numpy as np
import pandas as pd
import pytest
import traitlets

import walkerlab as wl
from walkerlab.runfile.records import name_fitness, tidy_table
from walkerlab.widgets import population
from walkerlab.widgets.listing import MAX_DRAWN, MAX_LISTED, SORT_COLUMNS, describe_generation, sort_robots
from walkerlab.widgets.population import Population

RNG = np.random.default_rng(5)
GENES = [str(wl.Genome.random(wl.Robot(), rng=RNG)) for _ in range(5)]


def generation(n=8, number=1, elites=2, void=3, first=100, fitness=None):
    """Return a table of one generation, with elites first and walks that do not count last."""
    place = np.arange(n)
    counts = place < n - void
    table = tidy_table(
        pd.DataFrame(
            {
                "generation": number,
                "individual": first + place,
                "born": np.where(place < elites, number - 1, number),
                "parents": "",
                "operators": "random",
                "fitness": np.where(counts, (n - place) / 2 if fitness is None else fitness, -np.inf),
                "verdict": np.where(counts, "ok", np.where(place % 2, "fell", "too fast")),
                "reason": np.where(counts, "", "it <i>moved</i>"),
                "distance": np.where(counts, -0.5, np.nan),
                "velocity": 0.1,
                "n_segments": 1 + place % 4,
                "n_legs": 2 * (1 + place % 2),
                "weight": 3.0 + place % 3,
                "body_length": 0.5,
                "genome": [GENES[i % len(GENES)] for i in range(n)],
            }
        )
    )
    name_fitness(table, "distance", "m")
    return table


def listed(widget):
    return [row["individual"] for row in widget.generation["rows"]]


@pytest.mark.parametrize("column", SORT_COLUMNS)
def test_every_order_has_all_robots_sorted_by_its_column(column):
    table = generation(30)
    ordered = sort_robots(table, column)
    assert sorted(ordered.individual) == sorted(table.individual)
    if column == "verdict":
        assert (ordered.verdict == "ok").is_monotonic_increasing
    else:
        values = ordered[column].dropna()
        assert values.is_monotonic_increasing if SORT_COLUMNS[column].is_ascending else values.is_monotonic_decreasing
        assert ordered[column].isna().is_monotonic_increasing


def test_kinds_of_robots_differ_in_signs_and_text_and_not_only_in_colour():
    description = describe_generation(generation())
    assert description["title"] == "Generation 1: 8 robots, ★ 2 elites of generation 0"
    assert description["warning"].endswith("3 not counted: 2 fell, 1 too fast")
    fragile = generation().assign(verdict="fragile")
    assert describe_generation(fragile)["warning"].endswith("8 not counted: 8 fragile (much worse from another start)")
    by_kind = {row["kind"]: row for row in description["rows"]}
    assert {kind: row["sign"][:1] for kind, row in by_kind.items()} == {"elite": "★", "": "", "invalid": "⚠"}
    assert by_kind["elite"]["label"] == "3.50 m"
    assert "Its distance is 3.50 m. An elite, unchanged since gen" in by_kind["elite"]["description"]
    assert by_kind["invalid"]["label"] == "fell"
    assert "Not counted: fell. It stood, went down" in by_kind["invalid"]["description"]
    assert "Details: it <i>moved</i>." in by_kind["invalid"]["description"]


def test_only_the_best_robot_is_marked_as_the_best_in_every_order():
    for column in SORT_COLUMNS:
        rows = describe_generation(sort_robots(generation(), column))["rows"]
        assert {row["individual"]: row["rank"] for row in rows if row["rank"]} == {100: "best:"}
        [best] = [row for row in rows if row["rank"]]
        assert "Its distance is 4.00 m. The best of its generation." in best["description"]
    captions = Population(generation()).snapshot()
    assert "★ best: 4.00 m" in captions


def test_without_elites_and_invalid_walks_the_title_is_short():
    description = describe_generation(generation(elites=0, void=0))
    assert description["title"] == "Generation 1: 8 robots"
    assert description["warning"] == ""


def cells_of(table):
    described = describe_generation(table)
    keys = [column["key"] for column in described["columns"]]
    return [dict(zip(keys, row["cells"], strict=True)) for row in described["rows"]]


@pytest.mark.parametrize(("best", "shown"), [(12.345, "12.3"), (1.2345, "1.23"), (0.0123456, "0.0123"), (0.0, "0")])
def test_the_best_fitness_has_three_significant_digits(best, shown):
    [cells] = cells_of(generation(1, elites=0, void=0, fitness=best))
    assert cells["fitness"] == shown
    assert "distance" not in cells, "it is the fitness"


def test_a_value_that_rounds_to_zero_has_no_sign():
    table = generation(2, elites=0, void=0)
    table["velocity"] = [-0.0001, 1.0]
    assert cells_of(table)[0]["velocity"] == "0.00"


def test_a_generation_in_which_no_walk_counts_is_listed():
    description = describe_generation(generation(4, elites=0, void=4))
    assert {row["kind"] for row in description["rows"]} == {"invalid"}


def test_the_description_is_plain_data():
    description = describe_generation(generation())
    assert json.loads(json.dumps(description, allow_nan=False)) == description


def test_a_large_generation_is_shortened_with_a_note():
    description = describe_generation(generation(1000))
    assert len(description["rows"]) == MAX_LISTED
    assert description["drawn_note"] == "the first 60 of 1,000 are drawn"
    assert description["listed_note"] == "the first 300 of 1,000 are listed"
    assert describe_generation(generation(MAX_DRAWN))["drawn_note"] == ""


def test_nothing_is_drawn_while_nothing_is_visible(monkeypatch):
    monkeypatch.setattr(population.sketch, "draw_robot", lambda *_, **__: pytest.fail("drawn although not visible"))
    widget = Population(generation())
    assert widget.pictures == {}


def test_only_visible_robots_are_drawn(monkeypatch):
    monkeypatch.setattr(population.sketch, "draw_robot", lambda *_, **__: "<svg/>")
    widget = Population(generation(100, void=0))
    widget.visible = [0, 10]
    assert list(widget.pictures) == [str(one) for one in listed(widget)[:10]]
    widget.visible = [5, 15]
    assert list(widget.pictures) == [str(one) for one in listed(widget)[5:15]]
    widget.sort = "weight"
    assert list(widget.pictures) == [str(one) for one in listed(widget)[5:15]]
    widget.show(generation(100, number=2, first=500))
    assert list(widget.pictures) == [str(one) for one in listed(widget)[5:15]]


def test_a_generation_is_sent_to_the_browser_once(monkeypatch):
    monkeypatch.setattr(population.sketch, "draw_robot", lambda *_, **__: "<svg/>")
    widget = Population()
    sent = []
    widget.visible = [0, 10]
    monkeypatch.setattr(widget, "send_state", lambda names: sent.append(set(names)))
    widget.show(generation())
    widget.show(generation())
    assert [names for names in sent if names] == [{"generation", "pictures"}]


def test_an_elite_is_not_drawn_again():
    first, second = generation(8, void=0), generation(8, number=2, first=101, void=0)
    widget = Population(first)
    widget.visible = [0, 8]
    before = dict(widget.pictures)
    second.genome = np.roll(first.genome, -1)
    misses = population.sketch.bodies._draw_robot.cache_info().misses
    widget.show(second)
    assert widget.pictures["101"] is before["101"]
    assert population.sketch.bodies._draw_robot.cache_info().misses == misses


def test_the_number_of_pictures_is_limited(monkeypatch):
    monkeypatch.setattr(population.sketch, "draw_robot", lambda *_, **__: "<svg/>")
    widget = Population(generation(200))
    widget.visible = [-5, 10_000]
    assert len(widget.pictures) == MAX_DRAWN


@pytest.mark.parametrize("visible", [[], [3], [9, 2], [0, 0], [500, 600]])
def test_an_invalid_visible_range_draws_nothing(visible):
    widget = Population(generation())
    widget.visible = visible
    assert widget.pictures == {}


def test_robots_have_different_pictures():
    widget = Population(generation(4, void=0), wl.Settings())
    widget.visible = [0, 4]
    assert all(picture.startswith("<svg") for picture in widget.pictures.values())
    assert len(set(widget.pictures.values())) == 4


def test_the_scale_does_not_depend_on_the_visible_range():
    table = generation(6, void=0)
    table["body_length"] = np.linspace(0.3, 1.3, len(table))
    widget = Population(table)
    widget.visible = [0, 6]
    together = dict(widget.pictures)
    for first in range(6):
        widget.visible = [first, first + 1]
        assert widget.pictures.items() <= together.items()


def test_the_selected_robot_stays_selected_while_it_is_present():
    widget = Population(generation(number=1, first=100))
    widget.selected = 101
    widget.show(generation(number=2, first=101))
    assert widget.selected == 101
    widget.show(generation(number=3, first=200))
    assert widget.selected == -1


def test_of_a_whole_table_the_last_generation_is_shown():
    both = pd.concat([generation(number=0, first=0), generation(number=1, first=50)], ignore_index=True)
    assert min(listed(Population(both))) == 50


def test_an_empty_table_clears_the_widget():
    widget = Population(generation())
    widget.show(tidy_table(pd.DataFrame()))
    assert widget.generation == {}


def test_an_unknown_order_is_rejected():
    with pytest.raises(traitlets.TraitError, match="fitness"):
        Population().sort = "colour"


def test_its_repr_is_short():
    assert repr(Population()) == "<Population: a widget, displayed in a notebook>"
