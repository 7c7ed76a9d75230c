"""Functions with bound arguments: the arguments are plain values, compared by value, and written without loss.

A run file and the code that repeats a run hold these arguments as data, so only kinds that can be read back exactly
are accepted. In JSON, what JSON cannot tell apart has a tag:

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

MAX_ITEMS = 1000  # of one list, tuple, dict or array
MAX_DEPTH = 8  # of values within values
MAX_BITS = 1024  # of a whole number
MAX_JSON = 10_000  # characters that the arguments of one function take

KINDS = (
    f"None, bool, int, float, str, a list, tuple or dict of these with text keys, an array of up to {MAX_ITEMS} "
    "numbers, or one of walkerlab's choices such as wl.Feature.length"
)
_DTYPES = {
    "bool", "float16", "float32", "float64", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"
}  # fmt: skip
_OBVIOUS = {"bool", "float64", "int64"}  # dtypes that np.array gives to Python's numbers
_CHOICES = "walkerlab.settings.choices"


class UnboundableError(ValueError):
    """A value that cannot be bound; the message is a clause, as in "a set"."""


class BoundFunction(partial[Any]):
    """A ``functools.partial`` that holds copies of plain values, and equals another of the same function and values."""

    def __new__(cls, function: Any, /, *args: Any, **keywords: Any) -> "BoundFunction":
        """Bind arguments to a function.

        Raises:
            ValueError: If an argument is not of ``KINDS``; the message is a clause that names it.
        """
        if not (args or keywords):  # to be filled by copy or pickle
            return super().__new__(cls, function)
        places = [*range(1, len(args) + 1), *keywords]
        plain = [_copy_as(place, value) for place, value in zip(places, (*args, *keywords.values()), strict=True)]
        made = super().__new__(
            cls, function, *plain[: len(args)], **dict(zip(keywords, plain[len(args) :], strict=True))
        )
        if (length := len(identity(made))) > MAX_JSON:
            raise ValueError(
                f" binds arguments that take {length} characters to write; they may take {MAX_JSON}. Define a function "
                "with def that makes or reads such data itself."
            )
        return made

    @property
    def keywords(self) -> dict[str, Any]:
        """A copy of the keyword arguments."""
        return dict(super().keywords)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, partial) and self.func == other.func and identity(self) == _identity_if_plain(other)

    def __hash__(self) -> int:
        return hash((self.func, identity(self)))


def identity(function: "partial[Any]") -> str:
    """Return the bound arguments as a text that is the same for the same values; it does not name the function."""
    return json.dumps(written_arguments(function), sort_keys=True)


def written_arguments(function: "partial[Any]") -> dict[str, Any]:
    """Write bound arguments as JSON data: ``with`` for keywords, and ``args`` if there are positional ones."""
    keywords = {name: written(value) for name, value in function.keywords.items()}
    return {"with": keywords} | ({"args": list(map(written, function.args))} if function.args else {})


def plain_copy(value: object, depth: int = 0) -> object:
    """Copy a value of one of ``KINDS``; numpy's scalars become Python's, and arrays read-only.

    Raises:
        UnboundableError: If it is of another kind, or too large.
    """
    if depth > MAX_DEPTH:
        raise UnboundableError(f"values nested more than {MAX_DEPTH} deep")
    if isinstance(value, np.generic) or (isinstance(value, np.ndarray) and value.ndim == 0):
        value = value.item()
    kind, given = type(value), cast(Any, value)
    if (
        kind in (list, tuple, dict, np.ndarray)
        and (n_items := np.size(given) if kind is np.ndarray else len(given)) > MAX_ITEMS
    ):
        raise UnboundableError(f"{_a(kind.__name__)} of {n_items} items, where {MAX_ITEMS} is the most")
    if kind is int and given.bit_length() > MAX_BITS:
        raise UnboundableError(f"an int of {given.bit_length()} bits, where {MAX_BITS} is the most")
    if kind is str:
        _require_text(given)
    if kind in (type(None), bool, int, float, str) or _is_choice(value):
        return value
    if kind in (list, tuple):
        return kind(plain_copy(item, depth + 1) for item in given)
    if kind is dict:
        for key in given:
            if type(key) is not str:
                raise UnboundableError(f"a dict with {_a(type(key).__name__)} as key")
            _require_text(key)
        return {key: plain_copy(item, depth + 1) for key, item in given.items()}
    if kind is not np.ndarray:
        raise UnboundableError(_a(kind.__name__))
    if given.dtype.name not in _DTYPES:
        raise UnboundableError(f"an array of dtype {given.dtype}")
    array = np.array(given, dtype=given.dtype.newbyteorder("="))
    array.setflags(write=False)
    return array


def written(value: object) -> Any:
    """Write a value of one of ``KINDS`` as JSON data."""
    match value:
        case IntEnum():
            return {"choice": f"{type(value).__name__}.{value.name}"}
        case float() if not math.isfinite(value):
            return {"float": str(value)}
        case list():
            return list(map(written, cast(list[object], value)))
        case tuple():
            return {"tuple": list(map(written, cast(tuple[object, ...], value)))}
        case dict():
            return {"dict": {key: written(item) for key, item in cast(dict[str, object], value).items()}}
        case np.ndarray():
            array = cast("np.ndarray[Any, Any]", value)
            return {"array": written(array.tolist()), "shape": list(array.shape), "dtype": array.dtype.name}
        case _:
            return value


def restored(plain: Any, choices: Mapping[str, type[IntEnum]]) -> object:
    """Read a value back from JSON data: the inverse of ``written``.

    Args:
        plain: JSON data, of any origin.
        choices: The classes that a choice may be of, by name.

    Raises:
        ValueError: If the data has an unknown tag, or does not fit its tag.
    """
    try:
        match plain:
            case None | bool() | int() | float() | str():
                return plain
            case list():
                return [restored(item, choices) for item in cast(list[Any], plain)]
            case {"tuple": list(items), **rest} if not rest:
                return tuple(restored(item, choices) for item in cast(list[Any], items))
            case {"dict": dict(items), **rest} if not rest:
                return {key: restored(item, choices) for key, item in cast(dict[str, Any], items).items()}
            case {"float": "inf" | "-inf" | "nan" as text, **rest} if not rest:
                return float(text)
            case {"choice": str(text), **rest} if not rest:
                kind, _, name = text.partition(".")
                return choices[kind][name]
            case {"array": list(items), "shape": list(shape), "dtype": str(dtype), **rest} if not rest:
                if dtype in _DTYPES and all(type(size) is int and size >= 0 for size in cast(list[Any], shape)):
                    return np.array(restored(items, choices), dtype=dtype).reshape(cast(list[int], shape))
            case _:
                pass
    except (KeyError, TypeError, OverflowError) as error:
        raise ValueError(f"an argument of a function cannot be read: {error}") from error
    raise ValueError(f"an argument of a function cannot be read: {plain!r:.60}")


def as_python(value: object) -> str:
    """Write a value of one of ``KINDS`` as Python code, given ``import numpy as np`` and ``import walkerlab as wl``."""
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
            dtype = "" if array.dtype.name in _OBVIOUS and array.size else f", dtype={array.dtype.name!r}"
            return f"np.array({as_python(array.tolist())}{dtype})" if array.size else f"np.zeros({array.shape}{dtype})"
        case _:
            return repr(value)


def arguments_as_python(function: "partial[Any]") -> list[str]:
    """Write each bound argument as it stands in a call."""
    keywords = (f"{name}={as_python(value)}" for name, value in function.keywords.items())
    return [*map(as_python, function.args), *keywords]


def _copy_as(place: int | str, value: object) -> object:
    """Copy a bound argument; in the error, name it by its keyword or its number."""
    try:
        return plain_copy(value)
    except UnboundableError as error:
        name = repr(place) if isinstance(place, str) else f"number {place}"
        raise ValueError(
            f" binds the argument {name} to {error}, which a run file cannot hold. A bound argument is {KINDS}. For "
            "anything else, define a function with def that uses it, and give that function."
        ) from None


def _identity_if_plain(function: "partial[Any]") -> str | None:
    try:
        return identity(function) if isinstance(function, BoundFunction) else identity(_bound(function))
    except ValueError:
        return None


def _bound(function: "partial[Any]") -> BoundFunction:
    return BoundFunction(function.func, *function.args, **function.keywords)


def _is_choice(value: object) -> bool:
    return isinstance(value, IntEnum) and type(value).__module__ == _CHOICES


def _require_text(text: str) -> None:
    """Refuse a text that is too long, or cannot be written as UTF-8."""
    if len(text) > MAX_JSON:
        raise UnboundableError(f"a str of {len(text)} characters, where {MAX_JSON} is the most")
    try:
        text.encode()
    except UnicodeEncodeError:
        raise UnboundableError("a str with half a surrogate pair, which is no character") from None


def _a(noun: str) -> str:
    return f"{'an' if noun[0] in 'aeiouAEIOU' else 'a'} {noun}"
