"""What each operator does, in one clause, for captions."""

import re
from collections.abc import Iterable
from inspect import signature

from walkerlab.ga.selection import tournament
from walkerlab.settings.choices import Choice, Selection

_SIZE = re.compile(r"\bsize=(\d+)")
_DEFAULT_SIZE = signature(tournament).parameters["size"].default


def explain_operator(name: str, *kinds: type[Choice]) -> str:
    """Return one clause about an operator: ``the best of 3 drawn at random``; "" for an operator of the user.

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


def explain_operators(names: Iterable[str], kind: type[Choice]) -> str:
    """Return a sentence with a clause about each operator, with a space in front; "" for operators of the user."""
    clauses = {name: explain_operator(name, kind) for name in names}
    known = "; ".join(f"{name}: {clause}" for name, clause in clauses.items() if clause)
    return f" {known[0].upper()}{known[1:]}." if known else ""
