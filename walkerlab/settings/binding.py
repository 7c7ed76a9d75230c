"""Functions with bound arguments that are plain values: compared by value and written without loss.

Run files and the code that repeats a run contain these arguments as data, so only types that can be read back exactly
are accepted. Values that plain JSON cannot distinguish have a tag:

    2.0    [1, 2]    {"tuple": [1, 2]}    {"dict": {"k": 1}}    {"float": "inf"}    {"choice": "Feature.length"}
    {"array": [[1.0, 2.0]], "shape": [1, 2], "dtype": "float64"}
"""

import json
import math
from collections.abc import Mapping
from enum import IntEnum
from functools import partial
from typing import Any, cast

import numpy as np

from walkerlab.settings.choices import Choice

MAX_ITEMS = 1000  # maximum number of items in a list, tuple, dict or array
MAX_DEPTH = 8  # maximum nesting of values
MAX_BITS = 1024  # maximum size of a whole number
MAX_JSON = 10_000  # maximum length of the arguments of one function, in characters

BINDABLE_VALUES = (
    f"None, bool, int, float, str, a list, tuple or dict of these with string keys, an array of up to {MAX_ITEMS} "
    "numbers, or one of walkerlab's choices such as wl.Feature.length"
)
_BINDABLE_DTYPES = {
    "bool", "float16", "float32", "float64", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"
}  # fmt: skip
_DEFAULT_DTYPES = {"bool", "float64", "int64"}  # dtypes of arrays that np.array makes from Python numbers


class UnboundableError(ValueError):
    """A value that cannot be bound; the message is a noun phrase, such as "a set"."""


class BoundFunction(partial[Any]):
    """A ``functools.partial`` of copied plain values; equal to another one with the same function and values."""

    def __new__(cls, function: Any, /, *args: Any, **keywords: Any) -> "BoundFunction":
        """Bind arguments to a function.

        Raises:
            ValueError: If an argument is not of ``BINDABLE_VALUES``, or all are too long; the message is a clause
                that names it.
        """
        if not (args or keywords):  # copy and pickle add the arguments later
            return super().__new__(cls, function)
        plain_args = [_copy_argument(number, value) for number, value in enumerate(args, start=1)]
        plain_keywords = {name: _copy_argument(name, value) for name, value in keywords.items()}
        bound = super().__new__(cls, function, *plain_args, **plain_keywords)
        if (length := len(arguments_key(bound))) > MAX_JSON:
            raise ValueError(
                f" binds arguments that take {length} characters to write; at most {MAX_JSON} are allowed. Define a "
                "function with def that makes or reads such data itself."
            )
        return bound

    @property
    def keywords(self) -> dict[str, Any]:
        """A copy of the keyword arguments."""
        return dict(super().keywords)

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, partial) and self.func == other.func and arguments_key(self) == _identity_if_plain(other)
        )

    def __hash__(self) -> int:
        return hash((self.func, arguments_key(self)))


def arguments_key(function: "partial[Any]") -> str:
    """Return the bound arguments, without the function, as a string that is the same for equal values."""
    return json.dumps(arguments_to_json(function), sort_keys=True)


def arguments_to_json(function: "partial[Any]") -> dict[str, Any]:
    """Return bound arguments as JSON data: keywords in ``with``, positional arguments, if any, in ``args``."""
    keywords = {name: to_json_data(value) for name, value in function.keywords.items()}
    return {"with": keywords} | ({"args": list(map(to_json_data, function.args))} if function.args else {})


def plain_copy(value: object, depth: int = 0) -> object:
    """Copy one of ``BINDABLE_VALUES``; numpy scalars become Python numbers, and arrays become read-only.

    Args:
        value: Value to copy.
        depth: Number of values that enclose this one.

    Raises:
        UnboundableError: If the value is of another type or too large.
    """
    if depth > MAX_DEPTH:
        raise UnboundableError(f"values nested more than {MAX_DEPTH} deep")
    if isinstance(value, np.generic) or (isinstance(value, np.ndarray) and value.ndim == 0):
        value = value.item()
    kind = type(value)
    given = cast(Any, value)
    if (
        kind in (list, tuple, dict, np.ndarray)
        and (n_items := np.size(given) if kind is np.ndarray else len(given)) > MAX_ITEMS
    ):
        raise UnboundableError(f"{_with_article(kind.__name__)} of {n_items} items, more than {MAX_ITEMS}")
    if kind is int and given.bit_length() > MAX_BITS:
        raise UnboundableError(f"an int of {given.bit_length()} bits, more than {MAX_BITS}")
    if kind is str:
        _require_text(given)
    if kind in (type(None), bool, int, float, str) or _is_choice(value):
        return value
    if kind in (list, tuple):
        return kind(plain_copy(item, depth + 1) for item in given)
    if kind is dict:
        for key in given:
            if type(key) is not str:
                raise UnboundableError(f"a dict with {_with_article(type(key).__name__)} as key")
            _require_text(key)
        return {key: plain_copy(item, depth + 1) for key, item in given.items()}
    if kind is not np.ndarray:
        raise UnboundableError(_with_article(kind.__name__))
    if given.dtype.name not in _BINDABLE_DTYPES:
        raise UnboundableError(f"an array of dtype {given.dtype}")
    array = np.array(given, dtype=given.dtype.newbyteorder("="))
    array.setflags(write=False)
    return array


def to_json_data(value: object) -> Any:
    """Return one of ``BINDABLE_VALUES`` as JSON data."""
    match value:
        case IntEnum():
            return {"choice": f"{type(value).__name__}.{value.name}"}
        case float() if not math.isfinite(value):
            return {"float": str(value)}
        case list():
            return list(map(to_json_data, cast(list[object], value)))
        case tuple():
            return {"tuple": list(map(to_json_data, cast(tuple[object, ...], value)))}
        case dict():
            return {"dict": {key: to_json_data(item) for key, item in cast(dict[str, object], value).items()}}
        case np.ndarray():
            array = cast("np.ndarray[Any, Any]", value)
            return {"array": to_json_data(array.tolist()), "shape": list(array.shape), "dtype": array.dtype.name}
        case _:
            return value


def from_json_data(plain: Any, choices: Mapping[str, type[IntEnum]]) -> object:
    """Return the value that JSON data represent: the inverse of ``to_json_data``.

    Args:
        plain: JSON data, possibly from an untrusted file.
        choices: Allowed classes of choices, keyed by name.

    Raises:
        ValueError: If a tag is unknown or its content invalid.
    """
    try:
        match plain:
            case None | bool() | int() | float() | str():
                return plain
            case list():
                return [from_json_data(item, choices) for item in cast(list[Any], plain)]
            case {"tuple": list(items), **rest} if not rest:
                return tuple(from_json_data(item, choices) for item in cast(list[Any], items))
            case {"dict": dict(items), **rest} if not rest:
                return {key: from_json_data(item, choices) for key, item in cast(dict[str, Any], items).items()}
            case {"float": "inf" | "-inf" | "nan" as text, **rest} if not rest:
                return float(text)
            case {"choice": str(text), **rest} if not rest:
                kind, _, name = text.partition(".")
                return choices[kind][name]
            case {"array": list(items), "shape": list(shape), "dtype": str(dtype), **rest} if not rest:
                if dtype in _BINDABLE_DTYPES and all(
                    type(size) is int and size >= 0 for size in cast(list[Any], shape)
                ):
                    return np.array(from_json_data(items, choices), dtype=dtype).reshape(cast(list[int], shape))
            case _:
                pass
    except (KeyError, TypeError, OverflowError) as error:
        raise ValueError(f"an argument of a function cannot be read: {error}") from error
    raise ValueError(f"an argument of a function cannot be read: {plain!r:.60}")


def as_python(value: object) -> str:
    """Return Python code for a bindable value, given ``import numpy as np`` and ``import walkerlab as wl``."""
    match value:
        case IntEnum():
            return f"wl.{type(value).__name__}.{value.name}"
        case float() if not math.isfinite(value):
            return f"float({str(value)!r})"
        case list():
            return f"[{', '.join(map(as_python, cast(list[object], value)))}]"
        case tuple():
            items = cast(tuple[object, ...], value)
            return f"({', '.join(map(as_python, items))}{',' if len(items) == 1 else ''})"
        case dict():
            pairs = (f"{key!r}: {as_python(item)}" for key, item in cast(dict[str, object], value).items())
            return f"{{{', '.join(pairs)}}}"
        case np.ndarray():
            array = cast("np.ndarray[Any, Any]", value)
            dtype = "" if array.dtype.name in _DEFAULT_DTYPES and array.size else f", dtype={array.dtype.name!r}"
            return f"np.array({as_python(array.tolist())}{dtype})" if array.size else f"np.zeros({array.shape}{dtype})"
        case _:
            return repr(value)


def arguments_as_python(function: "partial[Any]") -> list[str]:
    """Return Python code for each bound argument, as in a call."""
    keywords = (f"{name}={as_python(value)}" for name, value in function.keywords.items())
    return [*map(as_python, function.args), *keywords]


def _copy_argument(place: int | str, value: object) -> object:
    """Copy a bound argument; an error names it by its keyword or its number."""
    try:
        return plain_copy(value)
    except UnboundableError as error:
        name = repr(place) if isinstance(place, str) else f"number {place}"
        raise ValueError(
            f" binds the argument {name} to {error}, which a run file cannot store. A bound argument must be "
            f"{BINDABLE_VALUES}. For "
            "anything else, define a function with def that uses it, and pass that function."
        ) from None


def _identity_if_plain(function: "partial[Any]") -> str | None:
    try:
        return arguments_key(function if isinstance(function, BoundFunction) else to_bound(function))
    except ValueError:
        return None


def to_bound(function: "partial[Any]") -> BoundFunction:
    """Convert a partial to a ``BoundFunction``, whose constructor checks the bound values."""
    return BoundFunction(function.func, *function.args, **function.keywords)


def _is_choice(value: object) -> bool:
    """Return whether a value is one of walkerlab's choices, which run files store by name."""
    return isinstance(value, Choice) and type(value).__module__ == Choice.__module__


def _require_text(text: str) -> None:
    """Raise an error for a string that is too long or cannot be encoded as UTF-8."""
    if len(text) > MAX_JSON:
        raise UnboundableError(f"a str of {len(text)} characters, more than {MAX_JSON}")
    try:
        text.encode()
    except UnicodeEncodeError:
        raise UnboundableError("a str with half a surrogate pair, which is not a character") from None


def _with_article(noun: str) -> str:
    return f"{'an' if noun[0] in 'aeiouAEIOU' else 'a'} {noun}"
