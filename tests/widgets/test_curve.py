"""A curve has room for what is to come, and no part of it is taken for a part of another."""

import re

import pytest

from walkerlab.runfile.records import name_fitness
from walkerlab.widgets.curve import Curve


def ids(picture):
    return set(re.findall(r' id="([^"]*)"', picture))


def lines(picture):
    return re.findall(r' d="(M[^"]*)"', picture)


def test_drawn_anew_it_shares_no_id_with_what_it_was(done):
    curve = Curve({"run": done.records})
    before = ids(curve.value)
    curve.draw({"run": done.records})
    assert before
    assert not before & ids(curve.value)


def test_two_on_a_page_share_no_id(done):
    first, second = (ids(Curve({"run": done.records}).value) for _ in range(2))
    assert first
    assert not first & second


@pytest.mark.parametrize("room", [1, 3])
def test_one_that_outgrows_its_room_gets_more(done, room):
    runs = {"run": done.records}
    assert lines(Curve(runs, room).value) == lines(Curve(runs, done.n_generations).value)


def test_one_with_room_to_grow_keeps_it(done):
    runs = {"run": done.records}
    assert lines(Curve(runs, 10).value) != lines(Curve(runs, done.n_generations).value)


def test_runs_that_measure_different_things_get_axes_of_their_own(done):
    other = done.records.copy()
    name_fitness(other, "efficiency", "m/J")
    runs = {"far": done.records, "thrifty": other, "farther": done.records}
    picture = Curve(runs).value
    assert len(re.findall(r' id="[^"]*-axes_\d+"', picture)) == 2
    words = re.search(r'aria-label="([^"]*)"', picture)[1]
    assert re.findall(r"(\w+): (\w+) over", words) == [
        ("Far", "distance"),
        ("Farther", "distance"),
        ("Thrifty", "efficiency"),
    ]
    assert len(re.findall(r' id="[^"]*-axes_\d+"', Curve({"far": done.records, "farther": done.records}).value)) == 1
