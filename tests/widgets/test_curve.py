"""A curve has space for coming generations, and IDs that are unique on the page."""

import re

import pytest

from walkerlab.runfile.records import name_fitness
from walkerlab.widgets.curve import Curve


def ids(picture):
    return set(re.findall(r' id="([^"]*)"', picture))


def lines(picture):
    return re.findall(r' d="(M[^"]*)"', picture)


def test_a_new_drawing_shares_no_id_with_the_previous_one(done):
    curve = Curve({"run": done.records})
    before = ids(curve.value)
    curve.draw({"run": done.records})
    assert before
    assert not before & ids(curve.value)


def test_two_curves_share_no_id(done):
    first, second = (ids(Curve({"run": done.records}).value) for _ in range(2))
    assert first
    assert not first & second


@pytest.mark.parametrize("n_generations", [1, 3])
def test_axes_are_extended_if_a_run_is_longer_than_expected(done, n_generations):
    runs = {"run": done.records}
    assert lines(Curve(runs, n_generations).value) == lines(Curve(runs, done.n_generations).value)


def test_axes_have_space_for_the_expected_generations(done):
    runs = {"run": done.records}
    assert lines(Curve(runs, 10).value) != lines(Curve(runs, done.n_generations).value)


def test_runs_with_different_fitness_functions_have_separate_axes(done):
    other = done.records.copy()
    name_fitness(other, "efficiency", "m/J")
    runs = {"far": done.records, "thrifty": other, "farther": done.records}
    picture = Curve(runs).value
    assert len(re.findall(r' id="[^"]*-axes_\d+"', picture)) == 2
    alternative_text = re.search(r'aria-label="([^"]*)"', picture)[1]
    assert re.findall(r"(\w+): (\w+) over", alternative_text) == [
        ("Far", "distance"),
        ("Farther", "distance"),
        ("Thrifty", "efficiency"),
    ]
    assert len(re.findall(r' id="[^"]*-axes_\d+"', Curve({"far": done.records, "farther": done.records}).value)) == 1
