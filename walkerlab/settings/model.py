"""Base classes of the settings: immutable, validated as a whole, with all errors of one call in one message."""

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from functools import partial
from inspect import Signature, signature
from textwrap import fill, indent
from typing import TYPE_CHECKING, Any, Self, cast

from pydantic import BaseModel, ConfigDict, ValidationError, ValidationInfo, field_serializer, field_validator

from walkerlab.settings.binding import arguments_to_json
from walkerlab.settings.choices import Choice
from walkerlab.settings.fields import FieldDeclaration, OneOf, Quantity
from walkerlab.settings.values import code_text, did_you_mean, function_name, short_repr
from walkerlab.system.errors import WalkerlabError
from walkerlab.text import strict_json

STORED_MODULES = {"walkerlab.simulation.fitness": "walkerlab.fitness"}
"""Module names in run files that differ from the current ones; stored names never change."""

MAX_REPORTED_ERRORS = 100
MAX_JSON = 100_000  # characters; settings take about two thousand
HELP_WIDTH = 92  # characters


class SettingsError(WalkerlabError, ValueError):
    """Invalid settings; the message has a line for each error of the call."""


@contextmanager
def report_together(errors: Sequence[str]) -> Generator[None]:
    """Report errors found earlier together with the errors of settings created in the block.

    Args:
        errors: Messages of the errors found earlier.

    Raises:
        SettingsError: If there is any error.
    """
    try:
        yield
    except SettingsError as error:
        raise SettingsError("\n".join([*errors, str(error)])) from None
    if errors:
        raise SettingsError("\n".join(errors))


if TYPE_CHECKING:
    ConciseModel = BaseModel
else:

    class _ConciseMeta(type(BaseModel)):
        def __dir__(cls) -> list[str]:
            classes = cls.__mro__[: cls.__mro__.index(BaseModel)]
            return sorted({name for one in classes for name in vars(one) if name[0] != "_" and name != "model_config"})

    class ConciseModel(BaseModel, metaclass=_ConciseMeta):
        """Model whose class hides the attributes of ``BaseModel`` from ``help`` and completion."""


class SettingsModel(ConciseModel, frozen=True):
    """Immutable settings that are validated when created; all errors are reported together."""

    model_config = ConfigDict(extra="forbid", arbitrary_types_allowed=True)

    def __init__(self, *unnamed: object, **values: Any) -> None:
        """Validate the values.

        Raises:
            TypeError: If a value is given without a name.
            SettingsError: If a value is invalid; the message has field, value, unit, range and meaning of each.
        """
        if unnamed:
            name = type(self).__name__
            raise TypeError(f"{name} takes settings by name, as in {name}(name=value); got {short_repr(unnamed[0])}")
        with _as_settings_errors(type(self)):
            super().__init__(**values)

    @classmethod
    def model_validate(cls, obj: Any, **how: Any) -> Self:
        """Make settings from plain data; raise the errors of ``__init__``."""
        with _as_settings_errors(cls):
            return super().model_validate(obj, **how)

    @classmethod
    def model_validate_json(cls, json_data: str | bytes | bytearray, **how: Any) -> Self:
        """Make settings from JSON text; raise the errors of ``__init__``."""
        is_text = isinstance(json_data, str | bytes | bytearray)  # pyright: ignore[reportUnnecessaryIsInstance]
        if is_text and len(json_data) > MAX_JSON:
            raise SettingsError(
                f"settings as JSON have at most {MAX_JSON} characters; this text has {len(json_data)}, and was not read"
            )
        try:
            strict_json.loads(json_data)
        except strict_json.DuplicateKeyError as error:
            raise SettingsError(f"in these settings as JSON, {error}; each setting must be given once.") from None
        except (ValueError, TypeError, RecursionError):
            pass  # pydantic reports the error
        with _as_settings_errors(cls):
            return super().model_validate_json(json_data, **how)

    def __setattr__(self, name: str, value: object) -> None:
        """Reject the assignment and suggest ``with_``.

        Raises:
            SettingsError: Always.
        """
        raise SettingsError(
            f"{type(self).__name__}.{name} cannot be assigned: settings never change, so that a run always matches the "
            "settings it was made with. "
            f"Create a changed copy of the complete Settings s: s = s.with_({name}={code_text(value)})"
        )

    @classmethod
    def suggest_name(cls, name: str) -> str:
        """Return a sentence that suggests a valid name for an unknown one."""
        return did_you_mean(name, cls.model_fields) or f" It has {', '.join(cls.model_fields)}."

    def __repr__(self) -> str:
        """Return Python code that creates these settings; those at their defaults are left out."""
        changed = [(name, value) for name, value in self if value != type(self).model_fields[name].default]
        return f"{type(self).__name__}({', '.join(f'{name}={code_text(value)}' for name, value in changed)})"

    __str__ = __repr__


def _complete_schema(schema: dict[str, Any], model: "type[Domain]") -> None:
    """Add the declarations to the JSON schema of a domain, and keep only the summary of its docstring."""
    schema["description"] = model.summary()
    for name, declared in model.declared().items():
        schema["properties"][name] |= declared.json_schema


class Domain(SettingsModel, frozen=True):
    """Settings of one subject, each field annotated with a ``Quantity`` or ``OneOf``."""

    model_config = ConfigDict(json_schema_extra=_complete_schema)

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Write docstring and signature for ``help``: each field with its default, meaning and range."""
        fields = cls.model_fields
        entries = [
            f"    {name} = {code_text(fields[name].default)}\n{_help_text(declared)}"
            for name, declared in cls.declared().items()
        ]
        if entries:
            cls.__doc__ = "\n".join([cls.summary(), "", "Settings and their defaults:", *entries])
        parameters = signature(cls).parameters.values()
        cls.__signature__ = Signature(
            [item.replace(annotation=fields[item.name].annotation) for item in parameters if item.name in fields]
        )

    @classmethod
    def summary(cls) -> str:
        """Return the first line of the docstring."""
        return (cls.__doc__ or "").partition("\n")[0]

    @classmethod
    def declared(cls) -> dict[str, FieldDeclaration]:
        """Return the declaration of each field, in order: the source of forms, flags and glossaries."""
        return {
            name: item
            for name, field in cls.model_fields.items()
            for item in field.metadata
            if isinstance(item, Quantity | OneOf)
        }

    @field_validator("*", mode="plain", check_fields=False)
    @classmethod
    def _validate(cls, value: object, info: ValidationInfo) -> object:
        name = info.field_name or ""
        declared = cls.declared()[name]
        try:
            return declared(value)
        except ValueError as error:
            messages = (f"{cls.__name__}.{name}{clause} It is {declared.about}." for clause in error.args)
            raise ValueError("\n".join(messages)) from None

    @field_serializer("*", check_fields=False)
    def _serialize(self, value: object) -> object:
        """Write a choice by its name, and a function by its module, name and arguments."""
        match value:
            case Choice():
                return value.name
            case tuple():
                return [self._serialize(item) for item in cast(tuple[object, ...], value)]
            case int() | float():
                return value
            case partial():
                return {"function": _qualified_name(value.func)} | arguments_to_json(value)
            case _:
                return {"function": _qualified_name(value), "with": {}}


def _help_text(declared: FieldDeclaration) -> str:
    """Write meaning and range as an indented paragraph."""
    sentences = f"{declared.about[0].upper()}{declared.about[1:]}. Allowed: {declared.range}"
    if isinstance(declared, OneOf):
        sentences += ", or your own function" if declared.functions else ""
        sentences += f"; see help(wl.{declared.choices.__name__})"
    return indent(fill(f"{sentences}.", HELP_WIDTH), " " * 8)


def _qualified_name(function: object) -> str:
    module = getattr(function, "__module__", "")
    return f"{STORED_MODULES.get(module, module)}.{function_name(function)}"


@contextmanager
def _as_settings_errors(model: type[SettingsModel]) -> Generator[None]:
    """Convert a ``ValidationError`` of pydantic to a ``SettingsError``."""
    try:
        yield
    except ValidationError as error:
        raise SettingsError("\n".join(_messages(model, error))) from None


def _messages(model: type[SettingsModel], error: ValidationError) -> list[str]:
    """Write a sentence for each error that pydantic found."""
    messages: list[str] = []
    for details in error.errors(include_url=False)[:MAX_REPORTED_ERRORS]:
        if details["type"] == "extra_forbidden":
            *_, name = details["loc"]
            messages.append(f"{model.__name__} has no setting {short_repr(name)}.{model.suggest_name(str(name))}")
        elif details["type"] == "value_error":
            messages.append(str(details.get("ctx", {})["error"]))
        else:
            where = ".".join([model.__name__, *map(str, details["loc"])])
            messages.append(f"{where} is {short_repr(details['input'])}; {details['msg']}.")
    n_omitted = error.error_count() - MAX_REPORTED_ERRORS
    return [*messages, f"… and {n_omitted} more."] if n_omitted > 0 else messages
