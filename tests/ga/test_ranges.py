import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from walkerlab.ga.ranges import reflect, wrap

lows = st.floats(-1e3, 1e3)
widths = st.floats(1e-3, 1e3)
any_values = st.floats(-1e5, 1e5)


@given(lows, widths, any_values)
@example(0.0, 1.0, -1e-18)  # rounds to the upper end, which is equivalent to the lower
def test_wrap_shifts_a_value_by_whole_periods(low, width, value):
    high = low + width
    inside = wrap(np.array([value]), np.array([low]), np.array([high]))[0]
    assert low <= inside < high
    n_periods = (inside - value) / (high - low)
    assert abs(n_periods - round(n_periods)) < 1e-4


@given(lows, widths, any_values)
def test_reflect_is_symmetric_about_both_ends(low, width, value):
    ends = np.array([low]), np.array([low + width])
    inside = reflect(np.array([value]), *ends)[0]
    assert low <= inside <= low + width
    assert np.isclose(inside, reflect(np.array([2 * low - value]), *ends)[0], atol=1e-6)
    assert np.isclose(inside, reflect(np.array([2 * (low + width) - value]), *ends)[0], atol=1e-6)


@given(lows, widths, st.floats(0, 1))
def test_a_value_inside_the_range_is_unchanged(low, width, fraction):
    high = low + width
    value = np.array([min(low + fraction * width, np.nextafter(high, low))])
    for into_range in (wrap, reflect):
        assert into_range(value, np.array([low]), np.array([high])) == value


def test_an_empty_range_has_one_value():
    end = np.array([2.0])
    for into_range in (wrap, reflect):
        assert into_range(np.array([5.0]), end, end) == 2.0
