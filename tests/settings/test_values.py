"""Numbers are written without loss."""

from math import nextafter

from hypothesis import given

from tests.settings.cases import (
    error_message,
)
from tests.strategies import finite
from walkerlab.settings.robot import MIN_LOAD_MASS, Robot
from walkerlab.settings.terrain import Terrain
from walkerlab.settings.values import number_text, vector_text


@given(finite)
def test_a_number_reads_back_as_it_was_written(number):
    assert float(number_text(number)) == number
    assert eval(vector_text((number, 1.0, 0.0))) == (number, 1.0, 0.0)


def test_a_rejected_value_is_not_rounded_to_an_allowed_one():
    light, narrow = nextafter(MIN_LOAD_MASS, 0.0), nextafter(1.0, 0.0)
    assert f"carry_weight is {light!r} kg" in error_message(Robot, carry_weight=light)
    assert f"is (1, {narrow!r}) m" in error_message(Robot, segment_length=(1.0, narrow))
    pieces = {"structure": "gaps", "gap_distance": 0.2, "texture_density": 0.1}
    assert "texture_size is 0.1600000000000001 m" in error_message(Terrain, texture_size=0.1600000000000001, **pieces)
