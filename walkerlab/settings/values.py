"""Values as text: shortened for messages, and as Python code; and names close to a misspelt one."""

import math
from collections.abc import Iterable
from difflib import get_close_matches
from functools import partial
from reprlib import Repr
from typing import cast

from walkerlab.settings.binding import arguments_as_python
from walkerlab.settings.choices import Choice

MAX_TEXT = 80  # maximum length of a value in a message, in characters


def function_name(function: object) -> str:
    """Return the name of a function, followed by the arguments of a partial: ``tournament(size=7)``."""
    if isinstance(function, partial):
        arguments = ", ".join(arguments_as_python(function))
        return f"{function_name(function.func)}({truncate(arguments)})"
    return getattr(function, "__name__", type(function).__name__)


def code_text(value: object) -> str:
    """Write a setting as Python code, with choices and functions by name.

    A function's name that is not an identifier, such as that of a lambda or one from an untrusted file, is written as a
    string literal, so that the code does nothing when it runs.
    """
    match value:
        case Choice():
            return repr(value.name)
        case tuple():
            return f"({', '.join(map(code_text, cast(tuple[object, ...], value)))})"
        case partial() if all(name.isidentifier() for name in value.keywords):
            return f"partial({', '.join([code_text(value.func), *arguments_as_python(value)])})"
        case _ if callable(value):
            name = function_name(value)
            return name if name.isidentifier() else repr(name)
        case _:
            return repr(value)


def short_repr(value: object) -> str:
    """Return the representation of a value, shortened to about a line."""
    return truncate(_SHORT_REPR.repr(value))


def truncate(text: str) -> str:
    """Truncate a string to one line."""
    return text if len(text) <= MAX_TEXT else f"{text[: MAX_TEXT - 1]}…"


class _ShortRepr(Repr):
    """Representation that examines only the shown part of a value, so that huge or deep values take no time."""

    def __init__(self) -> None:
        super().__init__()
        self.maxstring = MAX_TEXT - 10
        self.maxother = MAX_TEXT - 10

    def repr_int(self, x: int, level: int) -> str:  # noqa: ARG002
        power = int(x.bit_length() * math.log10(2))
        return repr(x) if power < self.maxother else f"about {'-' if x < 0 else ''}1e{power}"


_SHORT_REPR = _ShortRepr()


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """Return a question that suggests the known name closest to a misspelt one, or "" if no name is close."""
    if not isinstance(name, str) or len(name) > MAX_TEXT:
        return ""
    close = get_close_matches(name.lower(), list(known), n=1, cutoff=0.6)
    return f" Did you mean {close[0]!r}?" if close else ""


def pluralize(number: int, thing: str) -> str:
    """Write a number with its noun in the singular or plural: 1 leg, 2 legs."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def vector_text(numbers: tuple[float, ...]) -> str:
    """Write several numbers in parentheses, each as ``number_text`` does."""
    return f"({', '.join(map(number_text, numbers))})"


def number_text(number: float) -> str:
    """Write a number with the fewest digits that read back as the same number, without a trailing ``.0``."""
    return repr(number).removesuffix(".0")
