"""Values as texts: in messages, as Python code, and as people know them."""

import math
from collections.abc import Iterable
from difflib import get_close_matches
from functools import partial
from reprlib import Repr
from typing import cast

from walkerlab.settings.binding import arguments_as_python
from walkerlab.settings.choices import Choice

_LINE = 80  # characters of a value that a message shows


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
