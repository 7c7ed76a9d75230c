"""A seed for each student, so that a class collects many independent runs."""

from typing import Any

from walkerlab.lessons.exercises import LessonError
from walkerlab.settings.values import short_repr
from walkerlab.system.randomness import seed_of_name


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
    return seed_of_name(name)
