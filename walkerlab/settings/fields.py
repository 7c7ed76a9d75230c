"""How a setting is declared: once, with its range, unit and meaning; the check, the message and the form follow.

Written in a model's class:

    step_height: float = quantity(0.08, low=0.01, high=0.4, unit="m", about="the rise of each stair")

Read by whoever asks for 0.9:

    Terrain.step_height is 0.9 m; it must be 0.01 to 0.4 m. It is the rise of each stair.
"""

import math
from collections.abc import Generator, Iterable, Mapping, Sequence, Set
from contextlib import contextmanager
from dataclasses import dataclass, field
from difflib import get_close_matches
from enum import IntEnum
from functools import partial
from itertools import islice
from numbers import Integral
from reprlib import Repr
from typing import Any, Self, cast

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, field_serializer, field_validator

from walkerlab.errors import Fault
from walkerlab.settings.binding import BoundFunction, arguments_as_python, written_arguments
from walkerlab.text import strict_json

STORED_MODULES = {"walkerlab.simulation.fitness": "walkerlab.fitness"}
"""Names of our modules in run files where they differ from the modules' own: they never change."""

_LINE = 80  # characters of a value that a message shows
_MOST_FAULTS = 100  # that a message tells
_MOST_IN_TURN = 100  # choices in a list
MAX_JSON = 100_000  # characters; settings take some two thousand


class SettingsError(Fault, ValueError):
    """Settings that cannot be: every fault of one call, a line each."""


@contextmanager
def told_with(faults: Sequence[str]) -> Generator[None]:
    """Tell faults found beforehand, and those of the settings made within, at once.

    Raises:
        SettingsError: if there is any fault.
    """
    try:
        yield
    except SettingsError as error:
        raise SettingsError("\n".join([*faults, str(error)])) from None
    if faults:
        raise SettingsError("\n".join(faults))


class Choice(IntEnum):
    """One of a few named kinds; each member has an integer code and a sentence ``about`` it."""

    about: str

    def __new__(cls, code: int, about: str) -> Self:
        """Make the member of this integer code."""
        member = int.__new__(cls, code)
        member._value_ = code
        member.about = about
        return member


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


class SettingsModel(BaseModel, frozen=True):
    """Settings: frozen, checked as a whole when made, all their faults told at once."""

    model_config = ConfigDict(extra="forbid", arbitrary_types_allowed=True)

    def __init__(self, *unnamed: object, **values: Any) -> None:
        """Check the values.

        Raises:
            TypeError: If a value is given without a name.
            SettingsError: naming each field, its value, unit, range and what it is for.
        """
        if unnamed:
            name = type(self).__name__
            raise TypeError(f"{name} takes settings by name, as in {name}(name=value); got {brief(unnamed[0])}")
        with _in_our_words(type(self)):
            super().__init__(**values)

    @classmethod
    def model_validate(cls, obj: Any, **how: Any) -> Self:
        """Make settings from plain data; raises what ``__init__`` does."""
        with _in_our_words(cls):
            return super().model_validate(obj, **how)

    @classmethod
    def model_validate_json(cls, json_data: str | bytes | bytearray, **how: Any) -> Self:
        """Make settings from a JSON text; raises what ``__init__`` does."""
        is_text = isinstance(json_data, str | bytes | bytearray)  # pyright: ignore[reportUnnecessaryIsInstance]
        if is_text and len(json_data) > MAX_JSON:
            raise SettingsError(
                f"settings as JSON have at most {MAX_JSON} characters; this text has {len(json_data)}, and is not read"
            )
        try:
            strict_json.loads(json_data)
        except strict_json.DuplicateKeyError as error:
            raise SettingsError(f"in these settings as JSON, {error}; each setting must be given once.") from None
        except (ValueError, TypeError, RecursionError):
            pass  # pydantic reports what is wrong
        with _in_our_words(cls):
            return super().model_validate_json(json_data, **how)

    def __setattr__(self, name: str, value: object) -> None:
        """Refuse, and name the mend.

        Raises:
            SettingsError: always.
        """
        raise SettingsError(
            f"{type(self).__name__}.{name} stays as it is: settings never change, so that a run is always of those it "
            f"was made with. Make new ones from the whole Settings s: s = s.with_({name}={pasted(value)})"
        )

    @classmethod
    def advice(cls, name: str) -> str:
        """Say what might have been meant by a name that there is not."""
        return did_you_mean(name, cls.model_fields) or f" It has {', '.join(cls.model_fields)}."

    def __repr__(self) -> str:
        """Show what can be pasted back: only what differs from the default."""
        changed = [(name, value) for name, value in self if value != type(self).model_fields[name].default]
        return f"{type(self).__name__}({', '.join(f'{name}={pasted(value)}' for name, value in changed)})"

    __str__ = __repr__


class Domain(SettingsModel, frozen=True):
    """The settings of one thing, each field declared by one of the functions above."""

    @classmethod
    def declared(cls) -> dict[str, Declared]:
        """Say for each field what was declared of it: the source of forms, flags and glossaries."""
        extras = {name: field.json_schema_extra for name, field in cls.model_fields.items()}
        return {name: extra.args[0] for name, extra in extras.items() if isinstance(extra, partial)}

    @field_validator("*", mode="plain", check_fields=False)
    @classmethod
    def _check(cls, value: object, info: ValidationInfo) -> object:
        name = info.field_name or ""
        declared = cls.declared()[name]
        try:
            return declared(value)
        except ValueError as error:
            faults = (f"{cls.__name__}.{name}{fault} It is {declared.about}." for fault in error.args)
            raise ValueError("\n".join(faults)) from None

    @field_serializer("*", check_fields=False)
    def _plain(self, value: object) -> object:
        """Write a choice by its name, and a function as what ``load`` must be given back."""
        match value:
            case Choice():
                return value.name
            case tuple():
                return [self._plain(item) for item in cast(tuple[object, ...], value)]
            case int() | float():
                return value
            case partial():
                return {"function": _address(value.func)} | written_arguments(value)
            case _:
                return {"function": _address(value), "with": {}}


def _as_from_a_file(value: object) -> object:
    """Make a partial what it will be when read from a file; without arguments, it becomes its function."""
    if not isinstance(value, partial) or isinstance(value, BoundFunction):
        return value
    return BoundFunction(value.func, *value.args, **value.keywords) if value.args or value.keywords else value.func


def _address(function: object) -> str:
    module = getattr(function, "__module__", "")
    return f"{STORED_MODULES.get(module, module)}.{function_name(function)}"


def function_name(function: object) -> str:
    """Name a function as people know it; ``partial(tournament, size=7)`` is ``tournament(size=7)``."""
    if isinstance(function, partial):
        arguments = ", ".join(arguments_as_python(function))
        return f"{function_name(function.func)}({shortened(arguments)})"
    return getattr(function, "__name__", type(function).__name__)


def pasted(value: object) -> str:
    """Show a setting as it would be typed: a choice, or a function, by its name.

    A name that cannot be typed, as a lambda's or one made up in a hostile file, is given as a text, which does nothing.
    """
    match value:
        case Choice():
            return repr(value.name)
        case tuple():
            return f"({', '.join(map(pasted, cast(tuple[object, ...], value)))})"
        case partial() if all(name.isidentifier() for name in value.keywords):
            return f"partial({', '.join([pasted(value.func), *arguments_as_python(value)])})"
        case _ if callable(value):
            name = function_name(value)
            return name if name.isidentifier() else repr(name)
        case _:
            return repr(value)


@contextmanager
def _in_our_words(model: type[SettingsModel]) -> Generator[None]:
    """Turn pydantic's findings into a ``SettingsError``."""
    try:
        yield
    except ValidationError as error:
        raise SettingsError("\n".join(_sentences(model, error))) from None


def _sentences(model: type[SettingsModel], error: ValidationError) -> list[str]:
    """Turn each of pydantic's findings into a sentence of ours."""
    sentences: list[str] = []
    for fault in error.errors(include_url=False)[:_MOST_FAULTS]:
        if fault["type"] == "extra_forbidden":
            *_, name = fault["loc"]
            sentences.append(f"{model.__name__} has no setting {brief(name)}.{model.advice(str(name))}")
        elif fault["type"] == "value_error":
            sentences.append(str(fault.get("ctx", {})["error"]))
        else:
            where = ".".join([model.__name__, *map(str, fault["loc"])])
            sentences.append(f"{where} is {brief(fault['input'])}; {fault['msg']}.")
    untold = error.error_count() - _MOST_FAULTS
    return [*sentences, f"… and {untold} more."] if untold > 0 else sentences


def brief(value: object) -> str:
    """Show a value as Python does; of a long one, about as much as fits on a line."""
    return shortened(_BRIEF.repr(value))


def shortened(text: str) -> str:
    """Cut a text to what fits on a line."""
    return text if len(text) <= _LINE else f"{text[: _LINE - 1]}…"


class _Brief(Repr):
    """Looks at no more of a value than it shows, so that a huge or deep one takes no time."""

    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxother = _LINE - 10

    def repr_int(self, x: int, level: int) -> str:  # noqa: ARG002
        power = int(x.bit_length() * math.log10(2))
        return repr(x) if power < self.maxother else f"some {'-' if x < 0 else ''}1e{power}"


_BRIEF = _Brief()


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """Ask for the known name that is most like this one; say nothing if none is."""
    if not isinstance(name, str) or len(name) > _LINE:
        return ""
    close = get_close_matches(name.lower(), list(known), n=1, cutoff=0.6)
    return f" Did you mean {close[0]!r}?" if close else ""


def count(number: int, thing: str) -> str:
    """Count things in words: 1 leg, 2 legs."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def shown_numbers(numbers: tuple[float, ...]) -> str:
    """Show a vector, without needless zeros."""
    return f"({', '.join(map(number_text, numbers))})"


def number_text(number: float) -> str:
    """Write a number with the fewest digits that read back as the same number, and without a needless ``.0``."""
    return repr(number).removesuffix(".0")
