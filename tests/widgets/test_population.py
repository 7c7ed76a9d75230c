"""The robots of a generation: all are told of, in every order, and only those are drawn that somebody sees."""

import json

import numpy as np
import pandas as pd
import pytest
import traitlets

import walkerlab as wl
from walkerlab.runfile.records import name_fitness, tidy
from walkerlab.widgets import population
from walkerlab.widgets.listing import COLUMNS, DRAWN, LISTED, order, roster
from walkerlab.widgets.population import Population

RNG = np.random.default_rng(5)
GENES = [str(wl.Genome.random(wl.Robot(), rng=RNG)) for _ in range(5)]


def generation(n=8, number=1, elites=2, void=3, first=100, fitness=None):
    """Make up a generation: its elites first, and those that do not count last."""
    place = np.arange(n)
    counts = place < n - void
    table = tidy(
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


def seen(widget):
    return [row["individual"] for row in widget.roster["rows"]]


@pytest.mark.parametrize("column", COLUMNS)
def test_every_order_has_everyone_and_sorts_by_its_column(column):
    table = generation(30)
    ordered = order(table, column)
    assert sorted(ordered.individual) == sorted(table.individual)
    if column == "verdict":
        assert (ordered.verdict == "ok").is_monotonic_increasing
    else:
        values = ordered[column].dropna()
        assert values.is_monotonic_increasing if COLUMNS[column].rising else values.is_monotonic_decreasing
        assert ordered[column].isna().is_monotonic_increasing


def test_who_is_who_is_told_in_signs_and_words_and_not_in_colour_alone():
    told = roster(generation())
    assert told["title"] == "Generation 1: 8 robots, ★ 2 elites"
    assert told["warning"].endswith("3 not counted: 2 fell, 1 too fast")
    by_kind = {row["kind"]: row for row in told["rows"]}
    assert {kind: row["sign"][:1] for kind, row in by_kind.items()} == {"elite": "★", "": "", "void": "⚠"}
    assert by_kind["elite"]["worth"] == "3.50 m"
    assert "Its distance is 3.50 m. An elite, which lives on unchanged since gen" in by_kind["elite"]["says"]
    assert by_kind["void"]["worth"] == "fell"
    assert "Not counted: fell. It stood, went down" in by_kind["void"]["says"]
    assert "That is, it <i>moved</i>." in by_kind["void"]["says"]


def test_where_all_count_and_none_is_an_elite_nothing_is_said_of_such():
    told = roster(generation(elites=0, void=0))
    assert told["title"] == "Generation 1: 8 robots"
    assert told["warning"] == ""


@pytest.mark.parametrize(("best", "shown"), [(12.345, "12.3"), (1.2345, "1.23"), (0.0123456, "0.0123"), (0.0, "0")])
def test_the_best_fitness_has_three_figures_whatever_its_unit(best, shown):
    row = roster(generation(1, elites=0, void=0, fitness=best))["rows"][0]
    assert dict(zip(COLUMNS, row["cells"], strict=True))["fitness"] == shown


def test_nearly_nothing_has_no_sign():
    table = generation(2, elites=0, void=0)
    table["velocity"] = [-0.0001, 1.0]
    assert dict(zip(COLUMNS, roster(table)["rows"][0]["cells"], strict=True))["velocity"] == "0.00"


def test_a_generation_where_none_counts_is_told_of():
    told = roster(generation(4, elites=0, void=4))
    assert {row["kind"] for row in told["rows"]} == {"void"}


def test_what_is_told_is_plain_data():
    told = roster(generation())
    assert json.loads(json.dumps(told, allow_nan=False)) == told


def test_a_crowd_is_cut_and_the_cut_is_told():
    told = roster(generation(1000))
    assert len(told["rows"]) == LISTED
    assert told["some_drawn"] == "the first 60 of 1,000 are drawn"
    assert told["some_listed"] == "the first 300 of 1,000 are listed"
    assert roster(generation(DRAWN))["some_drawn"] == ""


def test_nobody_looks_nothing_is_drawn(monkeypatch):
    monkeypatch.setattr(population.sketch, "draw_robot", lambda *_, **__: pytest.fail("drawn for nobody"))
    widget = Population(generation())
    assert widget.pictures == {}


def test_those_in_sight_are_drawn_and_no_others(monkeypatch):
    monkeypatch.setattr(population.sketch, "draw_robot", lambda *_, **__: "<svg/>")
    widget = Population(generation(100, void=0))
    widget.sight = [0, 10]
    assert list(widget.pictures) == [str(one) for one in seen(widget)[:10]]
    widget.sight = [5, 15]
    assert list(widget.pictures) == [str(one) for one in seen(widget)[5:15]]
    widget.sort = "weight"
    assert list(widget.pictures) == [str(one) for one in seen(widget)[5:15]]
    widget.show(generation(100, number=2, first=500))
    assert list(widget.pictures) == [str(one) for one in seen(widget)[5:15]]


def test_a_generation_goes_to_the_browser_at_once_and_only_once(monkeypatch):
    monkeypatch.setattr(population.sketch, "draw_robot", lambda *_, **__: "<svg/>")
    widget, sent = Population(), []
    widget.sight = [0, 10]
    monkeypatch.setattr(widget, "send_state", lambda names: sent.append(set(names)))
    widget.show(generation())
    widget.show(generation())
    assert [names for names in sent if names] == [{"roster", "pictures"}]


def test_an_elite_is_not_drawn_again():
    first, second = generation(8, void=0), generation(8, number=2, first=101, void=0)
    widget = Population(first)
    widget.sight = [0, 8]
    before = dict(widget.pictures)
    second.genome = np.roll(first.genome, -1)
    misses = population.sketch.bodies._draw_robot.cache_info().misses
    widget.show(second)
    assert widget.pictures["101"] is before["101"]
    assert population.sketch.bodies._draw_robot.cache_info().misses == misses


def test_however_much_is_in_sight_no_more_than_some_are_drawn(monkeypatch):
    monkeypatch.setattr(population.sketch, "draw_robot", lambda *_, **__: "<svg/>")
    widget = Population(generation(200))
    widget.sight = [-5, 10_000]
    assert len(widget.pictures) == DRAWN


@pytest.mark.parametrize("sight", [[], [3], [9, 2], [0, 0], [500, 600]])
def test_a_strange_sight_draws_nothing(sight):
    widget = Population(generation())
    widget.sight = sight
    assert widget.pictures == {}


def test_the_pictures_are_of_these_robots():
    widget = Population(generation(4, void=0), wl.Settings())
    widget.sight = [0, 4]
    assert all(picture.startswith("<svg") for picture in widget.pictures.values())
    assert len(set(widget.pictures.values())) == 4


def test_the_scale_is_one_whoever_is_in_sight():
    table = generation(6, void=0)
    table["body_length"] = np.linspace(0.3, 1.3, len(table))
    widget = Population(table)
    widget.sight = [0, 6]
    together = dict(widget.pictures)
    for first in range(6):
        widget.sight = [first, first + 1]
        assert widget.pictures.items() <= together.items()


def test_who_is_selected_stays_so_as_long_as_it_lives():
    widget = Population(generation(number=1, first=100))
    widget.selected = 101
    widget.show(generation(number=2, first=101))
    assert widget.selected == 101
    widget.show(generation(number=3, first=200))
    assert widget.selected == -1


def test_of_a_whole_table_the_last_generation_is_shown():
    both = pd.concat([generation(number=0, first=0), generation(number=1, first=50)], ignore_index=True)
    assert min(seen(Population(both))) == 50


def test_a_run_of_which_nothing_is_done_clears_it():
    widget = Population(generation())
    widget.show(tidy(pd.DataFrame()))
    assert widget.roster == {}


def test_an_unknown_order_is_refused():
    with pytest.raises(traitlets.TraitError, match="fitness"):
        Population().sort = "colour"


def test_its_name_is_short():
    assert repr(Population()) == "<Population: a widget, to be seen in a notebook>"
