"""The list of kept runs: what a browser asks for is done, and what makes no sense is not."""

import json
from itertools import product

import pytest

from walkerlab.view.plots.style import RUN_COLOURS, RUN_MARKERS
from walkerlab.widgets.run_list import LONGEST, Shelf


@pytest.fixture
def shelf():
    shelf = Shelf()
    for key, name in (("a", "Moon"), ("b", "ice"), ("c", "stairs")):
        shelf.put(key, name=name)
    shelf.selected = "b"
    return shelf


def ask(shelf, message):
    """Say what a browser would."""
    shelf._handle_custom_msg(message, [])


def of_all(shelf, what):
    return [run[what] for run in shelf.runs]


def test_a_new_run_stands_last_and_looks_like_no_other(shelf):
    assert of_all(shelf, "key") == ["a", "b", "c"]
    for key in "defghijk":
        shelf.put(key)
    looks = [(run["colour"], run["mark"]) for run in shelf.runs]
    assert looks[:6] == list(zip(RUN_COLOURS, RUN_MARKERS, strict=True))
    assert looks[6:] == looks[:5]


def test_the_look_of_a_dropped_run_is_free_for_the_next(shelf):
    shelf.drop("b")
    shelf.put("d")
    assert of_all(shelf, "colour") == [RUN_COLOURS[0], RUN_COLOURS[2], RUN_COLOURS[1]]


def test_what_is_new_of_a_run_changes_nothing_else(shelf):
    before = shelf.runs
    shelf.put("b", best="5.32 m", state="running")
    assert shelf.runs == [before[0], before[1] | {"best": "5.32 m", "state": "running"}, before[2]]
    assert json.loads(json.dumps(shelf.runs)) == shelf.runs


def test_what_is_told_of_a_dropped_run_does_not_bring_it_back(shelf):
    shelf.drop("b")
    shelf.tell("b", best="5.32 m")
    assert of_all(shelf, "key") == ["a", "c"]


def test_a_browser_renames_shows_selects_and_drops(shelf):
    ask(shelf, {"of": "a", "name": "  Moon\n again "})
    ask(shelf, {"of": "c", "shown": False})
    ask(shelf, {"select": "c"})
    assert of_all(shelf, "name") == ["Moon again", "ice", "stairs"]
    assert of_all(shelf, "shown") == [True, True, False]
    assert shelf.selected == "c"
    ask(shelf, {"drop": "a"})
    assert of_all(shelf, "key") == ["b", "c"]


def test_who_observes_the_runs_hears_of_each_change(shelf):
    heard = []
    shelf.observe(lambda change: heard.append(len(change.new)), "runs")
    ask(shelf, {"of": "a", "name": "other"})
    ask(shelf, {"drop": "a"})
    assert heard == [3, 2]


def test_two_runs_never_have_one_name(shelf):
    shelf.put("c", name="Moon")
    shelf.put("d", name="Moon")
    assert of_all(shelf, "name") == ["Moon", "ice", "Moon (2)", "Moon (3)"]
    shelf.put("a", name="Moon")
    assert of_all(shelf, "name")[0] == "Moon"


def test_a_name_is_there_and_not_too_long(shelf):
    shelf.put("a", name="   ")
    assert of_all(shelf, "name")[0] == "Moon"
    shelf.put("a", name="x" * 500)
    assert len(of_all(shelf, "name")[0]) == LONGEST


def test_when_the_run_that_is_looked_at_is_dropped_its_neighbour_is(shelf):
    for dropped, looked_at in (("b", "c"), ("c", "a"), ("a", "")):
        shelf.drop(dropped)
        assert shelf.selected == looked_at


NONSENSE = ["x", None, 7, [], {}, {"drop": 3}, {"drop": "no such run"}, {"name": 5, "of": "a"}, {"select": "nobody"}]
NONSENSE += [{"of": of, "shown": shown} for of, shown in product(["a", "nobody", None], ["yes", 1, None])]
NONSENSE += [{"of": "nobody", "name": "x"}, {"of": ["a"], "name": "x"}, {"of": "nobody", "shown": True}]


@pytest.mark.parametrize("message", NONSENSE, ids=str)
def test_nonsense_changes_nothing(shelf, message):
    before = shelf.runs
    ask(shelf, message)
    assert shelf.runs == before
    assert shelf.selected == "b"
