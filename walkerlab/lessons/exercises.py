"""Exercises and quiz questions of the lessons: how they are declared, and where they are found.

The module ``walkerlab/lessons/contents/lesson_03.py`` contains those of lesson 03: ``EXERCISES``, a dict from numbers
such as "03.1" to ``Exercise``, and ``QUIZ``, a tuple of ``Question``.
"""

import pkgutil
import re
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from walkerlab.lessons import contents
from walkerlab.settings.values import did_you_mean
from walkerlab.system.errors import WalkerlabError

MODULE_PREFIX = "lesson_"
LESSON_NUMBER = re.compile(r"\d\d")


class LessonError(WalkerlabError, ValueError):
    """Wrong use of a function of the lessons."""


@dataclass(frozen=True)
class Exercise:
    """An exercise that checks itself.

    Attributes:
        check: Function that examines an answer: True if it is right, False for the next hint, or a hint that fits this
            answer. It takes less than 3 s, and may raise any error if the answer has the wrong type.
        hints: Hints, shown one after the other; none of them is the answer.
        right: Sentence shown for a right answer: why it is right.
    """

    check: Callable[[Any], bool | str]
    hints: tuple[str, ...]
    right: str


@dataclass(frozen=True)
class Question:
    """A question with several choices.

    Attributes:
        text: The question.
        choices: Feedback on each choice, a sentence, by the text of the choice.
        right: The right choice.
    """

    text: str
    choices: dict[str, str]
    right: str


def lesson_numbers() -> list[str]:
    """Return the numbers of the lessons with contents, such as "03", in order."""
    names = sorted(module.name for module in pkgutil.iter_modules(contents.__path__))
    return [name.removeprefix(MODULE_PREFIX) for name in names if name.startswith(MODULE_PREFIX)]


def find_exercise(number: str) -> Exercise:
    """Return an exercise.

    Args:
        number: Number of the exercise, such as "03.2".

    Raises:
        LessonError: If there is no exercise with this number.
    """
    exercises: dict[str, Exercise] = _lesson(number).EXERCISES
    if number not in exercises:
        known = ", ".join(map(repr, exercises)) or "none"
        raise LessonError(f"there is no exercise {number!r}; the exercises of this lesson are {known}.")
    return exercises[number]


def find_quiz(lesson: str) -> tuple[Question, ...]:
    """Return the quiz questions of a lesson.

    Args:
        lesson: Number of the lesson, such as "03".

    Raises:
        LessonError: If there is no lesson with this number.
    """
    return _lesson(lesson).QUIZ


def _lesson(number: Any) -> Any:
    """Return the module of a lesson, from its number or the number of one of its exercises."""
    lesson = number.partition(".")[0] if isinstance(number, str) else ""
    known = lesson_numbers()
    if lesson not in known:
        names = ", ".join(map(repr, known))
        raise LessonError(f"there is no lesson {number!r}; the lessons are {names}.{did_you_mean(number, known)}")
    return import_module(f"{contents.__name__}.{MODULE_PREFIX}{lesson}")
