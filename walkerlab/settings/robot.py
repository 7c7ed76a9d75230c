"""The limits on the bodies of all robots."""

import math
from typing import Annotated, Self

from pydantic import model_validator

from walkerlab.settings.fields import MIN_MAX, Quantity
from walkerlab.settings.glossary import DisplayedDomain
from walkerlab.settings.proportions import DENSITY_RANGE, MAX_TRUNK_MASS, MIN_LEGS_MASS, MIN_TRUNK_MASS
from walkerlab.settings.values import number_text

MIN_LOAD_MASS = 0.01  # kg, the smallest mass of a load
MASS_MARGIN = 0.98  # highest mass that limits may require, as a share of a trunk's maximum; leaves room for rounding
LIGHT_SHARE = 0.2  # share of the maximum weight that all trunks at their lightest may have; also that of all legs
MAX_LEG_RATIO = 1.2  # maximum ratio of leg length to the length of the longest segment
MIN_LEG_RATIO = 0.5  # minimum ratio of leg length to the length of the shortest segment
_LENGTH_TOLERANCE = 1e-12  # m, for rounding errors: 3 × 0.1 is more than 0.3


class Robot(DisplayedDomain, frozen=True):
    """Limits on the bodies of all robots; children that exceed them are repaired."""

    weight: Annotated[
        tuple[float, float],
        Quantity(low=0.1, high=200.0, unit="kg", about="the total mass of the robot", components=MIN_MAX),
    ] = (3.0, 12.0)
    body_length: Annotated[
        tuple[float, float],
        Quantity(
            low=0.05,
            high=8.0,
            unit="m",
            about="the distance from the front of the first segment to the end of the last",
            components=MIN_MAX,
        ),
    ] = (0.4, 1.2)
    segments: Annotated[
        tuple[int, int], Quantity(low=1, high=8, about="the number of body segments", whole=True, components=MIN_MAX)
    ] = (2, 4)
    segment_length: Annotated[
        tuple[float, float],
        Quantity(low=0.05, high=2.0, unit="m", about="the length of each body segment", components=MIN_MAX),
    ] = (0.2, 0.5)
    legs: Annotated[
        tuple[int, int],
        Quantity(low=2, high=16, about="the number of legs, which come in pairs", whole=True, components=MIN_MAX),
    ] = (4, 8)
    leg_force: Annotated[
        tuple[float, float],
        Quantity(low=0.1, high=500.0, unit="N·m", about="the greatest torque at each leg joint", components=MIN_MAX),
    ] = (2.0, 20.0)
    carry_weight: Annotated[
        float,
        Quantity(
            low=0.0,
            high=100.0,
            unit="kg",
            about="the mass of a pack on the back, not counted in any limit; 0 is no pack",
        ),
    ] = 0.0
    drag_weight: Annotated[
        float,
        Quantity(
            low=0.0,
            high=100.0,
            unit="kg",
            about="the mass of a sledge pulled on a rope, not counted in any limit; 0 is no sledge",
        ),
    ] = 0.0

    @property
    def leg_pairs(self) -> tuple[int, int]:
        """Lowest and highest number of pairs of legs within ``legs``."""
        return -(-self.legs[0] // 2), self.legs[1] // 2

    @property
    def leg_length_range(self) -> tuple[float, float]:
        """Lowest and highest length of a leg, in m; shorter than usual if that many legs would be too heavy."""
        shortest, longest = self.segment_length
        n_pairs = min(self.leg_pairs[1], self.segments[1])
        max_for_weight = math.cbrt(LIGHT_SHARE * self.weight[1] / (MIN_LEGS_MASS * n_pairs))
        high = min(MAX_LEG_RATIO * longest, max_for_weight)
        return min(MIN_LEG_RATIO * shortest, high), high

    @property
    def segment_range(self) -> tuple[int, int]:
        """Lowest and highest number of segments with which all limits can be satisfied."""
        fewest, most = self._segments_for_length
        fitting = [n for n in range(fewest, most + 1) if self._is_weight_possible(n)]
        return (fitting[0], fitting[-1]) if fitting else (fewest, fewest - 1)

    @property
    def _segments_for_length(self) -> tuple[int, int]:
        """Lowest and highest number of segments with which the limits on lengths and legs can be satisfied."""
        shortest, longest = self.segment_length
        n_for_length = int(-(-(self.body_length[0] - _LENGTH_TOLERANCE) // longest))
        n_that_fit = int((self.body_length[1] + _LENGTH_TOLERANCE) // shortest)
        return max(self.segments[0], self.leg_pairs[0], n_for_length), min(self.segments[1], n_that_fit)

    def length_for_weight(self, n_segments: int) -> tuple[float, float]:
        """Return the lowest and highest body length [m] at which the limits on the weight can be satisfied.

        Bodies of this length have such a weight at a density within ``DENSITY_RANGE``, however the length is divided
        into segments: the sum of the cubes of n lengths is least if they are equal.

        Args:
            n_segments: Number of segments.
        """
        min_weight, max_weight = self.weight
        longest = self.segment_length[1]
        shortest_body = math.cbrt(n_segments**2 * min_weight / (MASS_MARGIN * MAX_TRUNK_MASS))
        max_cubes = LIGHT_SHARE * max_weight / MIN_TRUNK_MASS  # largest sum of the cubes of the segments' lengths
        longest_body = max(max_cubes / longest**2, min(math.cbrt(max_cubes), longest))
        return max(self.body_length[0], shortest_body), min(self.body_length[1], longest_body)

    def _is_weight_possible(self, n_segments: int) -> bool:
        shortest, longest = self.segment_length
        low, high = self.length_for_weight(n_segments)
        return max(low, n_segments * shortest) <= min(high, n_segments * longest) + _LENGTH_TOLERANCE

    @model_validator(mode="after")
    def _validate_limits(self) -> Self:
        """Reject limits that no robot can satisfy; the message names the fields in conflict."""
        errors = self._load_errors() + self._conflicts()
        fewest, most = self._segments_for_length
        if not errors and fewest > most:
            short, long = self.body_length
            shortest, longest = self.segment_length
            errors.append(
                f"Robot.segments, Robot.legs, Robot.body_length and Robot.segment_length cannot all be satisfied: a "
                f"body of {number_text(short)} to {number_text(long)} m from segments of {number_text(shortest)} to "
                f"{number_text(longest)} m with {self.legs[0]} legs or more needs at least "
                f"{fewest} segments, and at most {most} fit."
            )
        if not errors and self.segment_range[0] > self.segment_range[1]:
            errors.append(self._weight_conflict())
        if errors:
            raise ValueError("\n".join(errors))
        return self

    def _load_errors(self) -> list[str]:
        return [
            f"Robot.{load} is {number_text(weight)} kg; it must be 0, for no load, or "
            f"between {MIN_LOAD_MASS:g} and 100 kg."
            for load, weight in (("carry_weight", self.carry_weight), ("drag_weight", self.drag_weight))
            if 0 < weight < MIN_LOAD_MASS
        ]

    def _conflicts(self) -> list[str]:
        """Return a sentence for each conflict between two limits."""
        fewest, most = self.segments
        shortest, longest = self.segment_length
        short, long = self.body_length
        errors: list[str] = []
        if self.leg_pairs[0] > self.leg_pairs[1]:
            errors.append(f"Robot.legs is {self.legs}; legs come in pairs, so the range must include an even number.")
        if self.leg_pairs[0] > most:
            errors.append(
                f"Robot.legs requires {self.legs[0]} legs or more, but Robot.segments allows {most} segments, "
                f"each with one pair: {2 * most} legs at most."
            )
        if fewest * shortest > long + _LENGTH_TOLERANCE:
            errors.append(
                f"Robot.segments and Robot.segment_length require {fewest} × {number_text(shortest)} = "
                f"{fewest * shortest:g} m or more, but Robot.body_length allows {number_text(long)} m."
            )
        if most * longest < short - _LENGTH_TOLERANCE:
            errors.append(
                f"Robot.segments and Robot.segment_length allow {most} × {number_text(longest)} = "
                f"{most * longest:g} m at most, but Robot.body_length requires {number_text(short)} m or more."
            )
        return errors

    def _weight_conflict(self) -> str:
        """Return a sentence that states the possible weights, for limits on the weight that no body can satisfy."""
        shortest, longest = self.segment_length
        fewest, most = self._segments_for_length
        heaviest = max(
            MASS_MARGIN * MAX_TRUNK_MASS * min(self.body_length[1], n * longest) ** 3 / n**2
            for n in range(fewest, most + 1)
        )
        others = "Robot.body_length, Robot.segment_length, Robot.segments and Robot.legs"
        if heaviest < self.weight[0]:
            possible = _round_down(heaviest)
            return (
                f"Robot.weight requires {number_text(self.weight[0])} kg or more, but bodies within {others} weigh "
                f"{possible:g} kg at most, at a density of {DENSITY_RANGE[1]:g} kg/m³. Lower the minimum of "
                f"Robot.weight to {possible:g} kg, or allow a longer body or fewer segments."
            )
        shortest_body = max(self.body_length[0], fewest * shortest)
        possible = -_round_down(-shortest_body * min(longest, shortest_body) ** 2 * MIN_TRUNK_MASS / LIGHT_SHARE)
        return (
            f"Robot.weight allows {number_text(self.weight[1])} kg at most, but bodies within {others} weigh "
            f"{possible:g} kg or more, at a density of {DENSITY_RANGE[0]:g} kg/m³. Raise the maximum of Robot.weight "
            f"to {possible:g} kg, or allow a shorter body or shorter segments."
        )


def _round_down(mass: float) -> float:
    """Round a mass [kg] down to three significant digits."""
    unit = 10.0 ** (math.floor(math.log10(abs(mass))) - 2)
    return math.floor(mass / unit) * unit
