"""What each operator does, in one clause, for captions."""

import re
from collections.abc import Iterable
from inspect import signature

from walkerlab.ga.selection import tournament
from walkerlab.settings.choices import Choice, Selection

_SIZE = re.compile(r"\bsize=(\d+)")
_DEFAULT_SIZE = signature(tournament).parameters["size"].default


def explain_operator(name: str, *kinds: type[Choice]) -> str:
    """Return one clause about an operator: ``the best of 3 drawn at random``; "" for a user's operator.

    Args:
        name: Name as tables show it, with the arguments of a partial: ``tournament(size=3)``.
        kinds: Kinds of operators; the first that has an operator of this name is used.
    """
    choice = next((kind[key] for kind in kinds if (key := name.partition("(")[0]) in kind.__members__), None)
    if choice is None:
        return ""
    if choice is Selection.tournament:
        size = _SIZE.search(name)
        return choice.about.replace("a few", size[1] if size else str(_DEFAULT_SIZE))
    return choice.about


def explain_operators(names: Iterable[str], kind: type[Choice]) -> list[str]:
    """Return ``name: clause`` for each operator, except for operators of the user."""
    return [f"{name}: {clause}" for name in names if (clause := explain_operator(name, kind))]
