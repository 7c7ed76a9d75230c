"""The radius has the density of the material; trunk and legs share the mass of a segment within their limits."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from walkerlab.settings.proportions import (
    DENSITY,
    LEG_RADIUS_RANGE,
    MAX_LEGS_MASS,
    MAX_TRUNK_MASS,
    MIN_LEGS_MASS,
    MIN_TRUNK_MASS,
    SHANK_RADIUS_RATIO,
    TRUNK_RADIUS_RANGE,
    compute_legs_mass,
    compute_thigh_radius,
    compute_trunk_radius,
)

lengths = st.floats(0.05, 2.0)


def capsule_mass(radius, axis_length):
    return DENSITY * math.pi * radius**2 * (axis_length + 4 / 3 * radius)


@given(lengths, st.floats(*TRUNK_RADIUS_RANGE), st.floats(*LEG_RADIUS_RANGE))
def test_a_radius_gives_the_mass_at_the_density_of_the_material(length, trunk_ratio, leg_ratio):
    radius = trunk_ratio * length
    assert compute_trunk_radius(capsule_mass(radius, length - 2 * radius), length) == pytest.approx(radius, rel=1e-9)
    radius = leg_ratio * length
    mass = sum(capsule_mass(bone, length / 2) for bone in (radius, SHANK_RADIUS_RATIO * radius))
    assert compute_thigh_radius(mass, length) == pytest.approx(radius, rel=1e-9)


@given(lengths, lengths, st.floats(0, 1))
def test_trunk_and_legs_of_every_possible_mass_are_within_their_limits(length, leg_length, share):
    limits = [
        trunk * length**3 + legs * leg_length**3
        for trunk, legs in ((MIN_TRUNK_MASS, MIN_LEGS_MASS), (MAX_TRUNK_MASS, MAX_LEGS_MASS))
    ]
    mass = limits[0] + share * (limits[1] - limits[0])
    legs = compute_legs_mass(mass, length, leg_length)
    tolerance = 1e-9 * mass
    assert MIN_LEGS_MASS * leg_length**3 - tolerance <= legs <= MAX_LEGS_MASS * leg_length**3 + tolerance
    assert MIN_TRUNK_MASS * length**3 - tolerance <= mass - legs <= MAX_TRUNK_MASS * length**3 + tolerance
