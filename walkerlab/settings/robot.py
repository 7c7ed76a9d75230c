"""The limits that every robot obeys."""

from typing import Annotated, Self

from pydantic import model_validator

from walkerlab.settings.fields import MIN_MAX, Quantity
from walkerlab.settings.glossary import DisplayedDomain
from walkerlab.settings.values import number_text

MIN_LOAD_MASS = 0.01  # kg, the smallest mass of a load
_LENGTH_TOLERANCE = 1e-12  # m, for rounding errors: 3 × 0.1 is more than 0.3


class Robot(DisplayedDomain, frozen=True):
    """Limits that every robot obeys, whatever the operators do."""

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
    def segment_range(self) -> tuple[int, int]:
        """Lowest and highest number of segments with which all limits can be met."""
        shortest, longest = self.segment_length
        n_for_length = int(-(-(self.body_length[0] - _LENGTH_TOLERANCE) // longest))
        n_that_fit = int((self.body_length[1] + _LENGTH_TOLERANCE) // shortest)
        return max(self.segments[0], self.leg_pairs[0], n_for_length), min(self.segments[1], n_that_fit)

    @model_validator(mode="after")
    def _validate_limits(self) -> Self:
        """Reject limits that no robot can obey; the message names the fields in conflict."""
        errors = self._load_errors() + self._conflicts()
        if not errors and self.segment_range[0] > self.segment_range[1]:
            short, long = self.body_length
            shortest, longest = self.segment_length
            errors.append(
                f"Robot.segments, Robot.legs, Robot.body_length and Robot.segment_length cannot all be met: a body "
                f"of {number_text(short)} to {number_text(long)} m from segments of {number_text(shortest)} to "
                f"{number_text(longest)} m with {self.legs[0]} legs or more needs at least "
                f"{self.segment_range[0]} segments, and at most {self.segment_range[1]} fit."
            )
        if errors:
            raise ValueError("\n".join(errors))
        return self

    def _load_errors(self) -> list[str]:
        return [
            f"Robot.{load} is {number_text(weight)} kg; it must be 0, for no load, or {MIN_LOAD_MASS:g} to 100 kg."
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
                f"Robot.legs asks for {self.legs[0]} legs or more, but Robot.segments allows {most} segments, "
                f"each with one pair: {2 * most} legs at most."
            )
        if fewest * shortest > long + _LENGTH_TOLERANCE:
            errors.append(
                f"Robot.segments and Robot.segment_length ask for {fewest} × {number_text(shortest)} = "
                f"{fewest * shortest:g} m or more, but Robot.body_length allows {number_text(long)} m."
            )
        if most * longest < short - _LENGTH_TOLERANCE:
            errors.append(
                f"Robot.segments and Robot.segment_length allow {most} × {number_text(longest)} = "
                f"{most * longest:g} m at most, but Robot.body_length asks for {number_text(short)} m or more."
            )
        return errors
