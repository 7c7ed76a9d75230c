import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from walkerlab.ga.ranges import reflect, wrap

lows, rooms, far = st.floats(-1e3, 1e3), st.floats(1e-3, 1e3), st.floats(-1e5, 1e5)


@given(lows, rooms, far)
@example(0.0, 1.0, -1e-18)  # rounds to the upper end, which is the lower
def test_wrap_goes_round_by_whole_turns(low, room, value):
    high = low + room
    inside = wrap(np.array([value]), np.array([low]), np.array([high]))[0]
    assert low <= inside < high
    turns = (inside - value) / (high - low)
    assert abs(turns - round(turns)) < 1e-4


@given(lows, rooms, far)
def test_reflect_comes_back_as_from_a_mirror(low, room, value):
    ends = np.array([low]), np.array([low + room])
    inside = reflect(np.array([value]), *ends)[0]
    assert low <= inside <= low + room
    assert np.isclose(inside, reflect(np.array([2 * low - value]), *ends)[0], atol=1e-6)
    assert np.isclose(inside, reflect(np.array([2 * (low + room) - value]), *ends)[0], atol=1e-6)


@given(lows, rooms, st.floats(0, 1))
def test_what_has_not_left_stays_to_the_last_bit(low, room, share):
    high = low + room
    value = np.array([min(low + share * room, np.nextafter(high, low))])
    for back in (wrap, reflect):
        assert back(value, np.array([low]), np.array([high])) == value


def test_without_room_there_is_one_place_to_be():
    here = np.array([2.0])
    for back in (wrap, reflect):
        assert back(np.array([5.0]), here, here) == 2.0
