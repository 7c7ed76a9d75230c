"""Declarations of settings: range, unit and meaning, written once in the annotation of a field.

    step_height: Annotated[float, Quantity(low=0.01, high=0.4, unit="m", about="the rise of each stair")] = 0.08

Validation, error messages, the JSON schema, help, sliders, command-line flags and the glossary are derived from it:

    Terrain.step_height is 0.9 m; it must be between 0.01 and 0.4 m. It is the rise of each stair.
"""

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from numbers import Integral
from typing import Any, cast

import numpy as np

from walkerlab.settings.binding import BoundFunction, to_bound
from walkerlab.settings.choices import Choice
from walkerlab.settings.values import did_you_mean, number_text, short_repr, vector_text

MIN_MAX = ("min", "max")
"""Components of a range that each robot must stay within."""

XYZ = ("x", "y", "z")
"""Components of a vector: x forward, y left, z up."""

MAX_CHOICES_IN_TURN = 100


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A number, or a fixed count of numbers, with a unit and a range.

    Attributes:
        low: Lowest value allowed, in ``unit``.
        high: Highest value allowed.
        unit: Unit as printed; "" for a dimensionless number.
        about: Meaning, as a noun phrase: "the rise of each stair".
        whole: Whether only whole numbers are allowed.
        components: Names of the numbers, ``MIN_MAX`` or ``XYZ``; empty for a single number.
        presets: Values that can be given by name, such as ``"moon"`` for its gravity.
    """

    low: float
    high: float
    unit: str = ""
    about: str
    whole: bool = False
    components: tuple[str, ...] = ()
    presets: Mapping[str, tuple[float, ...]] = field(default_factory=dict[str, tuple[float, ...]])

    def __call__(self, value: object) -> float | tuple[float, ...]:
        """Return the value as plain Python numbers.

        Raises:
            ValueError: If the value is not allowed; each argument is a clause that continues the name of the field.
        """
        if not self.components:
            return self._to_number(value, "")
        if isinstance(value, str) and value in self.presets:
            return self.presets[value]
        items = self._items(value)
        numbers: list[float] = []
        clauses: list[str] = []
        for item, component in zip(items, self.components, strict=True):
            try:
                numbers.append(self._to_number(item, f"'s {component}"))
            except ValueError as error:
                clauses.append(str(error))
        if clauses:
            raise ValueError(*clauses)
        if self.components == MIN_MAX and numbers[0] > numbers[1]:
            low, high = numbers
            order = f"the minimum, {low:g}, must not exceed the maximum, {high:g}"
            raise ValueError(f" is {vector_text(tuple(numbers))}{self.unit_suffix}; {order}.")
        return tuple(numbers)

    @property
    def unit_suffix(self) -> str:
        """The unit with a leading space, to follow a number; "" for a dimensionless number."""
        return f" {self.unit}" if self.unit else ""

    @property
    def range(self) -> str:
        """The allowed range, for help texts."""
        return f"{number_text(self.low)} to {number_text(self.high)}{self.unit_suffix}"

    @property
    def json_schema(self) -> dict[str, Any]:
        """Meaning, range and unit for the JSON schema of the field."""
        return {"description": self.about, "minimum": self.low, "maximum": self.high, "unit": self.unit}

    def _items(self, value: object) -> list[object]:
        """Return the items of a sequence, one for each component."""
        try:
            items: list[object] = list(islice(cast(Iterable[object], value), len(self.components) + 1))
        except TypeError:
            items = []
        if isinstance(value, str | bytes | bytearray | Mapping | Set) or len(items) != len(self.components):
            names = f", or the name of a preset: {', '.join(self.presets)}" if self.presets else ""
            guess = did_you_mean(value, self.presets) if isinstance(value, str) else ""
            raise ValueError(
                f" is {short_repr(value)}; it must be {len(self.components)} numbers: "
                f"{', '.join(self.components)}{names}.{guess}"
            )
        return items

    def _to_number(self, value: object, component: str) -> float:
        if isinstance(value, np.generic):
            value = value.item()
        kind = "a whole number" if self.whole else "a number"
        interval = f"between {number_text(self.low)} and {number_text(self.high)}{self.unit_suffix}"
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"{component} is {short_repr(value)}; it must be {kind} {interval}.")
        if not self.low <= value <= self.high:
            raise ValueError(f"{component} is {short_repr(value)}{self.unit_suffix}; it must be {interval}.")
        if self.whole and value != int(value):
            raise ValueError(f"{component} is {value}{self.unit_suffix}; it must be {kind} {interval}.")
        return int(value) if self.whole else float(value)


@dataclass(frozen=True)
class OneOf:
    """One member of a ``Choice``, given as a member, a name or an integer code.

    Attributes:
        choices: Class of the members.
        about: Meaning, as a noun phrase: "the shape of the ground".
        functions: Whether a user function is allowed as well.
        several: Whether a list of choices is allowed, to be applied in turn.
    """

    choices: type[Choice]
    about: str
    functions: bool = False
    several: bool = False

    def __call__(self, value: object) -> object:
        """Return the member or function, or a tuple of them.

        Raises:
            ValueError: If the value is not allowed; the message is a clause that continues the name of the field.
        """
        if not self.several or not isinstance(value, list | tuple):
            return self._to_choice(value)
        items = cast(Sequence[object], value)
        if not items:
            raise ValueError(f" is empty; it must name at least one of {self.range}.")
        if len(items) > MAX_CHOICES_IN_TURN:
            raise ValueError(f" is a list of {len(items)} items; it must have at most {MAX_CHOICES_IN_TURN}.")
        members = tuple(map(self._to_choice, items))
        return members[0] if len(members) == 1 else members

    @property
    def range(self) -> str:
        """The choices with their integer codes, for messages and help texts."""
        return ", ".join(f"{choice.name} ({choice.value})" for choice in self.choices)

    @property
    def json_schema(self) -> dict[str, Any]:
        """Meaning for the JSON schema of the field."""
        return {"description": self.about}

    def _to_choice(self, value: object) -> object:
        value = _to_bound_function(value)
        if self.functions and callable(value) and not isinstance(value, type):
            return value
        if isinstance(value, str) and value in self.choices.__members__:
            return self.choices[value]
        is_other_kind = isinstance(value, bool | Choice) and not isinstance(value, self.choices)
        if isinstance(value, Integral) and not is_other_kind and value in list(self.choices):
            return self.choices(value)
        guess = did_you_mean(value, self.choices.__members__)
        or_function = ", or your own function" if self.functions else ""
        raise ValueError(f" is {short_repr(value)}; it must be one of {self.range}{or_function}.{guess}")


FieldDeclaration = Quantity | OneOf


def _to_bound_function(value: object) -> object:
    """Convert a partial to a ``BoundFunction``, as run files return it, or to its function if it binds no arguments."""
    if not isinstance(value, partial) or isinstance(value, BoundFunction):
        return value
    return to_bound(value) if value.args or value.keywords else value.func
