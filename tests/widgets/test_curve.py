"""A curve has room for what is to come, and no part of it is taken for a part of another."""

import re

import pytest

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
