import random
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from walkerlab.system.randomness import PURPOSES, random_stream

addresses = st.tuples(
    st.integers(0, 2**31 - 1), st.sampled_from(PURPOSES), st.lists(st.integers(0, 2**32 - 1), max_size=4)
)


def draws(seed, purpose, address):
    return random_stream(seed, purpose, *address).random(4).tolist()


@hypothesis_settings(max_examples=50)
@given(addresses, addresses)
def test_draws_are_equal_exactly_if_their_addresses_are(one, other):
    assert draws(*one) == draws(*one)
    assert (draws(*one) == draws(*other)) == (one == other)


def test_neighbouring_addresses_give_different_draws():
    lengths = [(), *product(range(3)), *product(range(3), repeat=2), *product(range(3), repeat=3)]
    first = [tuple(draws(*one)) for one in product(range(3), PURPOSES, lengths)]
    assert len(set(first)) == len(first)


def test_draws_do_not_depend_on_draws_at_other_addresses():
    alone = draws(7, "mutation", (3, 0))
    before = random_stream(7, "mutation", 3, 0)
    for purpose in PURPOSES:
        random_stream(7, purpose, 3).random(1000)
    assert before.random(4).tolist() == alone
    assert draws(7, "mutation", (3, 0)) == alone


def test_global_random_state_is_neither_used_nor_changed():
    state = random.getstate()
    numpy_state = np.random.get_state()[1].tolist()  # noqa: NPY002
    one = draws(1, "check", ())
    random.seed(99)
    np.random.seed(99)  # noqa: NPY002
    assert draws(1, "check", ()) == one
    random.setstate(state)
    assert np.random.default_rng(0) is not random_stream(0, "check")
    assert len(numpy_state) == 624


def test_purposes_are_only_ever_appended():
    recorded = ("population", "selection", "crossover", "mutation", "perturbation", "terrain", "check")
    assert PURPOSES[: len(recorded)] == recorded
    assert len(set(PURPOSES)) == len(PURPOSES)
    with pytest.raises(ValueError):  # noqa: PT011 - a programming error, not a user's
        random_stream(0, "no such purpose")
