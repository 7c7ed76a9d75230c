"""Settings as frozen models, checked as a whole when made, with messages in our words instead of pydantic's."""

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any, Self, cast

from pydantic import BaseModel, ConfigDict, ValidationError, ValidationInfo, field_serializer, field_validator

from walkerlab.errors import Fault
from walkerlab.settings.binding import written_arguments
from walkerlab.settings.choices import Choice
from walkerlab.settings.fields import Declared
from walkerlab.settings.values import brief, did_you_mean, function_name, pasted
from walkerlab.text import strict_json

STORED_MODULES = {"walkerlab.simulation.fitness": "walkerlab.fitness"}
"""Names of our modules in run files where they differ from the modules' own: they never change."""

_MOST_FAULTS = 100  # that a message tells
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


def _address(function: object) -> str:
    module = getattr(function, "__module__", "")
    return f"{STORED_MODULES.get(module, module)}.{function_name(function)}"


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
