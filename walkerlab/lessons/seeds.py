"""A seed for each student, so that a class collects many independent runs."""

from hashlib import sha256
from typing import Any
from unicodedata import normalize

from walkerlab.lessons.exercises import LessonError
from walkerlab.settings.values import short_repr

N_SEEDS = 1_000_000  # so many that two students of a class rarely share one


def my_seed(name: Any) -> int:
    """Return a seed made from a name: the same name gives the same seed on every computer.

    Upper and lower case, and spaces around the name, make no difference.

    Args:
        name: Name of a student or a group, not empty.

    Raises:
        LessonError: If ``name`` is empty or not a text.
    """
    if not isinstance(name, str) or not name.strip():
        raise LessonError(f'the name is {short_repr(name)}; write your name in quotes, as in my_seed("Ada").')
    text = normalize("NFKC", " ".join(name.split())).casefold()
    return int.from_bytes(sha256(text.encode()).digest()[:8], "big") % N_SEEDS
