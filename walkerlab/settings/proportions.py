"""Proportions of a body: how mass and length determine girth, and which masses a trunk or leg of given length can have.

Trunks and legs are capsules of one material. Their density is ``DENSITY`` as long as their radius stays within a range
of their length, and differs from it only for segments that are heavier or lighter than that.
"""

import math
from typing import Final

DENSITY: Final = 1000.0
"""Density of the material [kg/m³]: that of water, and nearly that of animals."""

DENSITY_RANGE: Final = (400.0, 2500.0)
"""Density [kg/m³] of bodies too light or too heavy for their length: between wood and aluminium."""

TRUNK_RADIUS_RANGE: Final = (0.01, 0.4)
"""Radius of a trunk over its length."""

LEG_RADIUS_RANGE: Final = (0.01, 0.12)
"""Radius of a thigh over the length of the leg."""

SHANK_RADIUS_RATIO: Final = 0.8
"""Ratio of a shank's radius to the thigh's radius."""

LEG_MASS_SHARE: Final = 0.3
"""Share of a segment's mass that is in its pair of legs, if the legs have room for it."""

_TRUNK: Final = (1.0, -2 / 3)
"""Volume over π of a capsule 1 m long, caps included: coefficients of the square and the cube of its radius."""

_LEG: Final = ((1 + SHANK_RADIUS_RATIO**2) / 2, 4 / 3 * (1 + SHANK_RADIUS_RATIO**3))
"""The same for a leg and its thigh's radius; each bone is a capsule half as long as the leg, plus its two caps."""


def _volume(form: tuple[float, float], radius: float) -> float:
    """Return the volume of a trunk or a leg of length 1, for a radius over length."""
    square, cube = form
    return math.pi * (square * radius**2 + cube * radius**3)


_MIN_TRUNK, _MAX_TRUNK = (_volume(_TRUNK, ratio) for ratio in TRUNK_RADIUS_RANGE)
_MIN_LEG, _MAX_LEG = (_volume(_LEG, ratio) for ratio in LEG_RADIUS_RANGE)

# Masses of a trunk and of a pair of legs of length 1 m [kg]; they grow with the cube of the length.
MIN_TRUNK_MASS: Final = DENSITY_RANGE[0] * _MIN_TRUNK
MAX_TRUNK_MASS: Final = DENSITY_RANGE[1] * _MAX_TRUNK
MIN_LEGS_MASS: Final = 2 * DENSITY_RANGE[0] * _MIN_LEG
MAX_LEGS_MASS: Final = 2 * DENSITY_RANGE[1] * _MAX_LEG


def compute_legs_mass(segment_mass: float, segment_length: float, leg_length: float) -> float:
    """Return the mass of a segment's pair of legs [kg]; the rest of the mass is in the trunk.

    Args:
        segment_mass: Mass of the segment including its legs, kg.
        segment_length: Length of the segment, m.
        leg_length: Length of each leg, m.
    """
    trunk_cube, leg_cube = segment_length**3, leg_length**3
    preferred = LEG_MASS_SHARE * segment_mass
    preferred = min(max(preferred, 2 * DENSITY * _MIN_LEG * leg_cube), 2 * DENSITY * _MAX_LEG * leg_cube)
    lowest = max(MIN_LEGS_MASS * leg_cube, segment_mass - MAX_TRUNK_MASS * trunk_cube)
    highest = min(MAX_LEGS_MASS * leg_cube, segment_mass - MIN_TRUNK_MASS * trunk_cube)
    return min(max(preferred, lowest), highest)


def compute_trunk_radius(mass: float, length: float) -> float:
    """Return the radius of a trunk [m] from its mass [kg] and length [m]."""
    return length * _radius(_TRUNK, mass / length**3, TRUNK_RADIUS_RANGE)


def compute_thigh_radius(mass: float, length: float) -> float:
    """Return the radius of a leg's thigh [m] from the mass [kg] and length [m] of the leg."""
    return length * _radius(_LEG, mass / length**3, LEG_RADIUS_RANGE)


def compute_thigh_share(radius: float, length: float) -> float:
    """Return the share of a leg's mass that is in its thigh, for the thigh's radius [m] and the leg's length [m]."""
    ratio = radius / length
    return math.pi * (ratio**2 / 2 + 4 / 3 * ratio**3) / _volume(_LEG, ratio)


def _radius(form: tuple[float, float], mass: float, limits: tuple[float, float]) -> float:
    """Return the radius, within limits, of a trunk or leg of length 1 that has a mass [kg] at ``DENSITY``."""
    square, cube = form
    volume = mass / (math.pi * DENSITY)
    low, high = limits
    if volume >= square * high**2 + cube * high**3:
        return high
    radius = min(math.sqrt(volume / square), high)
    for _ in range(6):  # Newton's method; its error is below rounding for all radii in the limits
        radius -= (square * radius**2 + cube * radius**3 - volume) / (2 * square * radius + 3 * cube * radius**2)
    return min(max(radius, low), high)
