"""Limits are accepted exactly when a robot can obey them; conflicts are reported with the fields."""

import re

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from tests.settings.cases import (
    error_message,
)
from walkerlab.settings.robot import Robot


def whole_pairs(low, high):
    return st.tuples(st.integers(low, high), st.integers(low, high)).map(sorted).map(tuple)


@st.composite
def limits(draw):
    """Draw any limits, with lengths in twentieths of a metre to avoid rounding errors."""
    return {
        "segments": draw(whole_pairs(1, 8)),
        "legs": draw(whole_pairs(2, 16)),
        "segment_length": draw(whole_pairs(1, 40)),
        "body_length": draw(whole_pairs(1, 160)),
    }


def some_robot_obeys(segments, legs, segment_length, body_length):
    return any(
        legs[0] <= 2 * n_pairs <= legs[1]
        and n * segment_length[0] <= body_length[1]
        and n * segment_length[1] >= body_length[0]
        for n in range(segments[0], segments[1] + 1)
        for n_pairs in range(n + 1)
    )


def in_metres(limits):
    drawn = {
        name: tuple(end / 20 for end in pair) if name.endswith("length") else pair for name, pair in limits.items()
    }
    return drawn | {"weight": WIDEST["weight"]}


WIDEST = {name: (declared.low, declared.high) for name, declared in Robot.declared().items()}


@hypothesis_settings(max_examples=600)
@given(limits())
def test_limits_are_accepted_exactly_when_some_robot_obeys_them(drawn):
    if some_robot_obeys(**drawn):
        Robot(**in_metres(drawn))
        return
    message = error_message(Robot, **in_metres(drawn))
    for line in message.splitlines():
        named = {name: in_metres(drawn)[name] for name in re.findall(r"Robot\.(\w+)", line)}
        assert len(named) >= 2 or set(named) == {"legs"}
        error_message(Robot, **WIDEST | named)  # the named fields conflict even if the others allow everything


@pytest.mark.parametrize(
    ("limits", "end", "message"),
    [
        (
            {"weight": (60.0, 80.0), "body_length": (0.4, 0.4), "segments": (1, 4), "legs": (2, 8)},
            0,
            r"requires 60 kg or more, .* weigh 57\.7 kg at most",
        ),
        ({"weight": (200.0, 200.0), "segments": (4, 4)}, 0, r"requires 200 kg or more, .* weigh 97\.5 kg at most"),
        (
            {"weight": (0.1, 1.0), "body_length": (4, 5), "segment_length": (1, 2)},
            1,
            r"allows 1 kg .* 9\.99 kg or more",
        ),
        ({"weight": (0.1, 0.1), "body_length": (1.0, 1.0)}, 1, r"allows 0\.1 kg at most, .* weigh 0\.157 kg or more"),
    ],
)
def test_weights_that_no_body_of_plausible_density_can_have_are_rejected_with_the_fix(limits, end, message):
    text = error_message(Robot, **limits)
    assert re.search(message, text), text
    fixed = list(limits["weight"])
    fixed[end] = float(re.search(r"Robot\.weight to ([\d.]+) kg", text).group(1))
    assert Robot(**limits | {"weight": tuple(fixed)}).weight == tuple(fixed)
    named = {name: limits.get(name, getattr(Robot(), name)) for name in set(re.findall(r"Robot\.(\w+)", text))}
    error_message(Robot, **WIDEST | named)


def test_each_conflict_names_its_fields():
    for clash, named in (
        ({"legs": (3, 3)}, ["legs"]),
        ({"legs": (6, 8), "segments": (1, 2)}, ["legs", "segments"]),
        ({"segments": (4, 6), "segment_length": (0.5, 0.6)}, ["segments", "segment_length", "body_length"]),
        ({"segments": (1, 2), "body_length": (3.0, 4.0)}, ["segments", "segment_length", "body_length"]),
        ({"segment_length": (0.4, 0.41), "body_length": (0.5, 0.7)}, ["segment_length", "body_length"]),
        ({"legs": (6, 8), "segment_length": (0.5, 0.6)}, ["legs", "segment_length", "body_length"]),
    ):
        message = error_message(Robot, **clash)
        assert all(f"Robot.{name}" in message for name in named), message
