"""The list of runs carries out valid requests of the browser and ignores invalid ones."""

import json
from itertools import product

import pytest

from walkerlab.view.plots.style import RUN_COLOURS, RUN_MARKERS
from walkerlab.widgets.panel.run_list import MAX_NAME_LENGTH, RunList


@pytest.fixture
def run_list():
    run_list = RunList()
    for key, name in (("a", "Moon"), ("b", "ice"), ("c", "stairs")):
        run_list.add(key, name=name)
    run_list.selected = "b"
    return run_list


def send(run_list, message):
    """Send a message as a browser does."""
    run_list._handle_custom_msg(message, [])


def values(run_list, field):
    return [run[field] for run in run_list.runs]


def test_a_new_run_is_last_and_has_an_unused_look(run_list):
    assert values(run_list, "key") == ["a", "b", "c"]
    for key in "defghijk":
        run_list.add(key)
    looks = [(run["colour"], run["mark"]) for run in run_list.runs]
    assert looks[:6] == list(zip(RUN_COLOURS, RUN_MARKERS, strict=True))
    assert looks[6:] == looks[:5]


def test_the_look_of_a_removed_run_is_used_again(run_list):
    run_list.remove("b")
    run_list.add("d")
    assert values(run_list, "colour") == [RUN_COLOURS[0], RUN_COLOURS[2], RUN_COLOURS[1]]


def test_changes_of_a_run_affect_only_its_entry(run_list):
    before = run_list.runs
    run_list.add("b", best="5.32 m", state="running")
    assert run_list.runs == [before[0], before[1] | {"best": "5.32 m", "state": "running"}, before[2]]
    assert json.loads(json.dumps(run_list.runs)) == run_list.runs


def test_changes_of_a_removed_run_do_not_add_it_again(run_list):
    run_list.remove("b")
    run_list.update("b", best="5.32 m")
    assert values(run_list, "key") == ["a", "c"]


def test_a_browser_renames_shows_selects_and_removes(run_list):
    send(run_list, {"of": "a", "name": "  Moon\n again "})
    send(run_list, {"of": "c", "shown": False})
    send(run_list, {"select": "c"})
    assert values(run_list, "name") == ["Moon again", "ice", "stairs"]
    assert values(run_list, "shown") == [True, True, False]
    assert run_list.selected == "c"
    send(run_list, {"remove": "a"})
    assert values(run_list, "key") == ["b", "c"]


def test_observers_of_the_runs_are_called_with_each_change(run_list):
    lengths = []
    run_list.observe(lambda change: lengths.append(len(change.new)), "runs")
    send(run_list, {"of": "a", "name": "other"})
    send(run_list, {"remove": "a"})
    assert lengths == [3, 2]


def test_names_are_unique(run_list):
    run_list.add("c", name="Moon")
    run_list.add("d", name="Moon")
    assert values(run_list, "name") == ["Moon", "ice", "Moon (2)", "Moon (3)"]
    run_list.add("a", name="Moon")
    assert values(run_list, "name")[0] == "Moon"


def test_a_name_is_not_blank_and_not_too_long(run_list):
    run_list.add("a", name="   ")
    assert values(run_list, "name")[0] == "Moon"
    run_list.add("a", name="x" * 500)
    assert len(values(run_list, "name")[0]) == MAX_NAME_LENGTH


def test_the_neighbour_of_a_removed_run_is_selected(run_list):
    for removed, selected in (("b", "c"), ("c", "a"), ("a", "")):
        run_list.remove(removed)
        assert run_list.selected == selected


INVALID_MESSAGES = [
    "x",
    None,
    7,
    [],
    {},
    {"remove": 3},
    {"remove": "no such run"},
    {"name": 5, "of": "a"},
    {"select": "unknown"},
]
INVALID_MESSAGES += [{"of": of, "shown": shown} for of, shown in product(["a", "unknown", None], ["yes", 1, None])]
INVALID_MESSAGES += [{"of": "unknown", "name": "x"}, {"of": ["a"], "name": "x"}, {"of": "unknown", "shown": True}]


@pytest.mark.parametrize("message", INVALID_MESSAGES, ids=str)
def test_invalid_messages_change_nothing(run_list, message):
    before = run_list.runs
    send(run_list, message)
    assert run_list.runs == before
    assert run_list.selected == "b"
