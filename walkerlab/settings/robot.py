"""The limits that every robot obeys."""

from typing import Self

from pydantic import model_validator

from walkerlab.settings.fields import limits, quantity
from walkerlab.settings.glossary import ShownDomain
from walkerlab.settings.values import number_text

LIGHTEST = 0.01  # kg that a load weighs, if there is one
_TINY = 1e-12  # m; room for the rounding of floats, as 3 × 0.1 is more than 0.3


class Robot(ShownDomain, frozen=True):
    """Limits that every robot obeys, whatever the operators do."""

    weight: tuple[float, float] = limits((3.0, 12.0), low=0.1, high=200.0, unit="kg", about="the robot's whole mass")
    body_length: tuple[float, float] = limits(
        (0.4, 1.2), low=0.05, high=8.0, unit="m", about="the front of the first to the end of the last segment"
    )
    segments: tuple[int, int] = limits((1, 4), low=1, high=8, about="the number of body segments")
    segment_length: tuple[float, float] = limits(
        (0.2, 0.5), low=0.05, high=2.0, unit="m", about="the length of each body segment"
    )
    legs: tuple[int, int] = limits((2, 8), low=2, high=16, about="the number of legs, which come in pairs")
    leg_force: tuple[float, float] = limits(
        (2.0, 20.0), low=0.1, high=500.0, unit="N·m", about="the greatest torque at each leg joint"
    )
    carry_weight: float = quantity(
        0.0, low=0.0, high=100.0, unit="kg", about="a pack fixed on the back, part of no limit; 0 is none"
    )
    drag_weight: float = quantity(
        0.0, low=0.0, high=100.0, unit="kg", about="a sledge on a rope behind, part of no limit; 0 is none"
    )

    @property
    def leg_pairs(self) -> tuple[int, int]:
        """The fewest and most pairs of legs within ``legs``."""
        return -(-self.legs[0] // 2), self.legs[1] // 2

    @property
    def segment_range(self) -> tuple[int, int]:
        """The fewest and most segments with which every limit can be held."""
        shortest, longest = self.segment_length
        need = (self.segments[0], self.leg_pairs[0], int(-(-(self.body_length[0] - _TINY) // longest)))
        room = (self.segments[1], int((self.body_length[1] + _TINY) // shortest))
        return max(need), min(room)

    @model_validator(mode="after")
    def _hold_together(self) -> Self:
        """Refuse limits that no robot can obey, naming the fields that clash."""
        (fewest, most), (shortest, longest), (short, long) = self.segments, self.segment_length, self.body_length
        faults: list[str] = []
        faults += [
            f"Robot.{load} is {number_text(weight)} kg; it must be 0, for none, or {LIGHTEST:g} to 100 kg."
            for load, weight in (("carry_weight", self.carry_weight), ("drag_weight", self.drag_weight))
            if 0 < weight < LIGHTEST
        ]
        if self.leg_pairs[0] > self.leg_pairs[1]:
            faults.append(f"Robot.legs is {self.legs}; legs come in pairs, so it must hold an even number between.")
        if self.leg_pairs[0] > most:
            faults.append(
                f"Robot.legs asks for {self.legs[0]} legs or more, but Robot.segments allows {most} segments, "
                f"each with one pair: {2 * most} legs at most."
            )
        if fewest * shortest > long + _TINY:
            faults.append(
                f"Robot.segments and Robot.segment_length ask for {fewest} × {number_text(shortest)} = "
                f"{fewest * shortest:g} m or more, but Robot.body_length allows {number_text(long)} m."
            )
        if most * longest < short - _TINY:
            faults.append(
                f"Robot.segments and Robot.segment_length allow {most} × {number_text(longest)} = "
                f"{most * longest:g} m at most, but Robot.body_length asks for {number_text(short)} m or more."
            )
        if not faults and self.segment_range[0] > self.segment_range[1]:
            faults.append(
                f"Robot.segments, Robot.legs, Robot.body_length and Robot.segment_length cannot hold together: a body "
                f"of {number_text(short)} to {number_text(long)} m from segments of {number_text(shortest)} to "
                f"{number_text(longest)} m with {self.legs[0]} legs or more needs at least "
                f"{self.segment_range[0]} segments, and at most {self.segment_range[1]} fit."
            )
        if faults:
            raise ValueError("\n".join(faults))
        return self
