"""How a setting is declared: once, with its range, unit and meaning; the check, the message and the form follow.

Written in a model's class:

    step_height: float = quantity(0.08, low=0.01, high=0.4, unit="m", about="the rise of each stair")

Read by whoever asks for 0.9:

    Terrain.step_height is 0.9 m; it must be 0.01 to 0.4 m. It is the rise of each stair.
"""

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from numbers import Integral
from typing import Any, cast

import numpy as np
from pydantic import Field

from walkerlab.settings.binding import BoundFunction
from walkerlab.settings.choices import Choice
from walkerlab.settings.values import brief, did_you_mean, number_text, shown_numbers

_MOST_IN_TURN = 100  # choices in a list


@dataclass(frozen=True)
class Quantity:
    """A number, or a fixed count of them, with a unit and a range.

    Attributes:
        low: least value allowed, in ``unit``.
        high: greatest value allowed.
        unit: as printed; "" for a bare number.
        about: what it is, as a clause: "the rise of each stair".
        whole: whether only whole numbers will do.
        parts: what its numbers are called, ``("min", "max")`` or ``("x", "y", "z")``; none for a single number.
        presets: values that have a name, as ``"moon"`` for its gravity; the name will do for the value.
    """

    low: float
    high: float
    unit: str
    about: str
    whole: bool = False
    parts: tuple[str, ...] = ()
    presets: Mapping[str, tuple[float, ...]] = field(default_factory=dict[str, tuple[float, ...]])

    def __call__(self, value: object) -> float | tuple[float, ...]:
        """Return the value as plain Python numbers, or raise a ``ValueError`` with a clause for each fault."""
        if not self.parts:
            return self._number(value, "")
        if isinstance(value, str) and value in self.presets:
            return self.presets[value]
        try:
            items = list(islice(cast(Iterable[object], value), len(self.parts) + 1))
        except TypeError:
            items = []
        if isinstance(value, str | bytes | bytearray | Mapping | Set) or len(items) != len(self.parts):
            named = f" Or the name of one: {', '.join(self.presets)}." if self.presets else ""
            guess = did_you_mean(value, self.presets) if isinstance(value, str) else ""
            raise ValueError(
                f" is {brief(value)}; it must be {len(self.parts)} numbers: {', '.join(self.parts)}.{named}{guess}"
            )
        numbers, faults = tuple[float, ...](), list[str]()
        for item, part in zip(items, self.parts, strict=True):
            try:
                numbers += (self._number(item, f"'s {part}"),)
            except ValueError as fault:
                faults.append(str(fault))
        if faults:
            raise ValueError(*faults)
        if self.parts == PAIR and numbers[0] > numbers[1]:
            raise ValueError(f" is {shown_numbers(numbers)}{self.its_unit}; its min must not be over its max.")
        return numbers

    @property
    def its_unit(self) -> str:
        """The unit with a blank before it, to be put after a number; "" if there is none."""
        return f" {self.unit}" if self.unit else ""

    @property
    def range(self) -> str:
        """The range in words, for messages and help texts."""
        return f"{number_text(self.low)} to {number_text(self.high)}{self.its_unit}"

    def _number(self, value: object, part: str) -> float:
        if isinstance(value, np.generic):
            value = value.item()
        kind = "a whole number" if self.whole else "a number"
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"{part} is {brief(value)}; it must be {kind}, {self.range}.")
        if not self.low <= value <= self.high:
            raise ValueError(f"{part} is {brief(value)}{self.its_unit}; it must be {self.range}.")
        if self.whole and value != int(value):
            raise ValueError(f"{part} is {value}{self.its_unit}; it must be {kind}, {self.range}.")
        return int(value) if self.whole else float(value)


PAIR = ("min", "max")


@dataclass(frozen=True)
class OneOf:
    """One member of a ``Choice``, given as member, name or integer code.

    Attributes:
        choices: the members there are.
        about: what is chosen.
        functions: whether a function of the user's own will do as well.
        several: whether a list of choices will do, applied in turn.
    """

    choices: type[Choice]
    about: str
    functions: bool = False
    several: bool = False

    def __call__(self, value: object) -> object:
        """Return the member (or function, or tuple of them), or say in a ``ValueError`` what there is to choose."""
        if not self.several or not isinstance(value, list | tuple):
            return self._one(value)
        several = cast(Sequence[object], value)
        if not several:
            raise ValueError(f" is empty; it must name at least one of {self.range}.")
        if len(several) > _MOST_IN_TURN:
            raise ValueError(f" is a list of {len(several)}; it must be one of at most {_MOST_IN_TURN}.")
        members = tuple(map(self._one, several))
        return members[0] if len(members) == 1 else members

    @property
    def range(self) -> str:
        """The choices in words, for messages and help texts."""
        return ", ".join(f"{choice.name} ({choice.value})" for choice in self.choices)

    def _one(self, value: object) -> object:
        value = _as_from_a_file(value)
        if self.functions and callable(value) and not isinstance(value, type):
            return value
        if isinstance(value, str) and value in self.choices.__members__:
            return self.choices[value]
        of_another_kind = isinstance(value, bool | Choice) and not isinstance(value, self.choices)
        if isinstance(value, Integral) and not of_another_kind and value in list(self.choices):
            return self.choices(value)
        guess = did_you_mean(value, self.choices.__members__)
        own = ", or a function of your own" if self.functions else ""
        raise ValueError(f" is {brief(value)}; it must be one of {self.range}{own}.{guess}")


Declared = Quantity | OneOf


def quantity(default: float, *, low: float, high: float, unit: str = "", about: str) -> Any:
    """Declare a number; an ``int`` default asks for whole numbers."""
    return _declare(default, Quantity(low, high, unit, about, whole=isinstance(default, int)))


def limits(default: tuple[float, float], *, low: float, high: float, unit: str = "", about: str) -> Any:
    """Declare a (min, max) pair that holds each robot between two numbers."""
    return _declare(default, Quantity(low, high, unit, about, whole=isinstance(default[0], int), parts=PAIR))


def vector(
    default: tuple[float, float, float],
    *,
    low: float,
    high: float,
    unit: str = "",
    about: str,
    presets: Mapping[str, tuple[float, float, float]] = {},
) -> Any:
    """Declare an (x, y, z) vector: x forward, y left, z up; a preset is a vector with a name."""
    return _declare(default, Quantity(low, high, unit, about, parts=("x", "y", "z"), presets=presets))


def one_of(default: Choice, *, about: str, functions: bool = False, several: bool = False) -> Any:
    """Declare a choice among the members of the default's kind."""
    return _declare(default, OneOf(type(default), about, functions, several))


def _declare(default: Any, declared: Declared) -> Any:
    return Field(default, description=declared.about, json_schema_extra=partial(_schema, declared))


def _schema(declared: Declared, schema: dict[str, Any]) -> None:
    """Carry a declaration on its pydantic field, and its range into the JSON schema."""
    if isinstance(declared, Quantity):
        schema |= {"minimum": declared.low, "maximum": declared.high, "unit": declared.unit}


def _as_from_a_file(value: object) -> object:
    """Make a partial what it will be when read from a file; without arguments, it becomes its function."""
    if not isinstance(value, partial) or isinstance(value, BoundFunction):
        return value
    return BoundFunction(value.func, *value.args, **value.keywords) if value.args or value.keywords else value.func
