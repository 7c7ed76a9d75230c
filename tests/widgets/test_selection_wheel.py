"""The selection wheel shows the probabilities of the selected operator, and spins on request."""

import re

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.widgets import SelectionWheel

FITNESS = [1.0, 4.0, 2.0, -np.inf, 8.0]


def chance_of_the_fittest(wheel):
    return float(re.search(r"has a chance of ([\d.]+) %", wheel.picture)[1])


def expected(select):
    return round(100 * wl.analysis.selection_probabilities(FITNESS, select).probability[4], 1)


def softmax(fitness, n_parents, *, rng):
    weights = np.exp(fitness)
    return rng.choice(len(fitness), size=n_parents, p=weights / weights.sum())


def test_it_shows_the_selected_operator_and_its_pressure():
    wheel = SelectionWheel(FITNESS, [softmax])
    assert [option["name"] for option in wheel.options] == [*wl.Selection.__members__, "softmax"]
    for name in ("rank", "top_half"):
        wheel.selection = name
        assert chance_of_the_fittest(wheel) == expected(name)
    wheel.selection = "tournament"
    chances = []
    for size in (1, 6):
        wheel.parameters = {"tournament": size}
        chances.append(chance_of_the_fittest(wheel))
    assert chances == [25.0, 82.2]
    wheel.selection = "softmax"
    assert "estimated" in wheel.picture


def test_a_spin_selects_as_many_parents_as_individuals():
    wheel = SelectionWheel(FITNESS)
    wheel.selection = "top_half"
    wheel._handle_custom_msg("spin", [])
    assert wheel.words == "5 parents selected: 2 of 5 individuals at least once, the fittest 3 times."
    assert "share of the parents in this spin" in wheel.picture
    wheel.selection = "uniform"
    assert wheel.words == ""
    pictures = set()
    for _ in range(3):
        wheel.spin()
        pictures.add(re.sub(r"wheel\d+", "", wheel.picture))
    assert len(pictures) == 3


def test_invalid_messages_and_values_are_ignored():
    wheel = SelectionWheel()
    picture = wheel.picture
    for message in (None, {}, "spin ", ["spin"], 7):
        wheel._handle_custom_msg(message, [])
        assert wheel.picture == picture
    wheel.selection = "rank"
    wheel.parameters = {"rank": "high", "tournament": -3}
    assert wheel.picture
    wheel.selection = "nothing"
    assert "gradient" in wheel.picture


def test_wrong_fitness_and_functions_are_reported_at_once():
    with pytest.raises(ValueError, match="at least one number"):
        SelectionWheel([])
    with pytest.raises(wl.OperatorError, match="must return"):
        SelectionWheel(FITNESS, [lambda fitness, n_parents, *, rng: None])
