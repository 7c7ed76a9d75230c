"""Exercises that check themselves: right, not yet with a hint, or empty."""

import inspect
from typing import Any, cast

from walkerlab.lessons.exercises import find_exercise
from walkerlab.lessons.feedback import EMPTY, NOT_YET, RIGHT, Feedback
from walkerlab.settings.values import truncate

_n_wrong_answers: dict[str, int] = {}
"""Number of wrong answers in this kernel, by exercise."""


def check(number: str, answer: Any) -> Feedback:
    """Check the answer to an exercise.

    Each wrong answer shows the next hint; no hint contains the answer.

    Args:
        number: Number of the exercise, such as "03.2".
        answer: The answer; ``...`` or None if there is none yet.

    Returns:
        Feedback with the state "right", "not yet" or "empty".

    Raises:
        LessonError: If there is no exercise with this number.
    """
    exercise = find_exercise(number)
    if is_empty(answer):
        return Feedback(EMPTY, "Replace ... by your answer and run the cell again.")
    note = ""
    try:
        result = exercise.check(answer)
        result = result if isinstance(result, str) else bool(result)
    except Exception as error:  # the answer may be anything
        result = False
        problem = truncate(f"{type(error).__name__}: {error}".partition("\n")[0])
        note = f"The answer is of the type {type(answer).__name__}, which the check could not use ({problem})."
    if result is True:
        return Feedback(RIGHT, exercise.right)
    n_wrong = _n_wrong_answers[number] = _n_wrong_answers.get(number, 0) + 1
    if isinstance(result, str):
        return Feedback(NOT_YET, result)
    n_hints = len(exercise.hints)
    if not n_hints:
        return Feedback(NOT_YET, "Try another answer.", note)
    shown = min(n_wrong, n_hints)
    return Feedback(NOT_YET, exercise.hints[shown - 1], f"{note} Hint {shown} of {n_hints}.".strip())


def is_empty(answer: Any) -> bool:
    """Return whether an answer is missing: ``...``, None, an empty text or collection, or one with ``...`` in it.

    Args:
        answer: Any object.
    """
    if answer is None or answer is ...:
        return True
    if isinstance(answer, str):
        return answer.strip() in ("", "...", "…")
    if isinstance(answer, dict):
        answer = list(cast(dict[Any, Any], answer).values())
    if isinstance(answer, list | tuple | set):
        items = list(cast(list[Any], answer))
        return not items or any(item is ... for item in items)
    return inspect.isfunction(answer) and _is_unwritten(answer)


def _is_unwritten(function: Any) -> bool:
    """Return whether a function still contains ``...``, or does nothing."""
    code = function.__code__
    return ... in code.co_consts or code.co_code == _do_nothing.__code__.co_code


def _do_nothing() -> None: ...
