"""Exercises that check themselves: right, not yet with a hint, or empty."""

import inspect
import math
from typing import Any, cast

from walkerlab.genome.text import GenomeError
from walkerlab.lessons.exercises import find_exercise
from walkerlab.lessons.feedback import EMPTY, NOT_YET, RIGHT, Feedback
from walkerlab.settings.values import truncate
from walkerlab.system.errors import WalkerlabError

_n_wrong_answers: dict[str, int] = {}
"""Number of wrong answers in this kernel, by exercise."""


def check(number: str, answer: Any) -> Feedback:
    """Check the answer to an exercise.

    Each wrong answer shows the next hint, below one that fits the answer if there is one; no hint contains the answer.

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
    given: Any = cast(tuple[Any, ...], answer)[-1] if isinstance(answer, tuple) else answer
    try:
        result = exercise.check(answer)
        result = result if isinstance(result, str) else bool(result)
    except Exception as error:  # the answer may be anything
        result = False
        note = _describe_error(error, given)
    if result is True:
        return Feedback(RIGHT, exercise.right)
    if _is_number_in_quotes(given):
        return Feedback(NOT_YET, "In quotes, the answer is a text. Write the number without quotes.")
    n_wrong = _n_wrong_answers[number] = _n_wrong_answers.get(number, 0) + 1
    n_hints = len(exercise.hints)
    if isinstance(result, str):
        shown = min(n_wrong - 1, n_hints)
        return Feedback(NOT_YET, result, f"Hint {shown} of {n_hints}: {exercise.hints[shown - 1]}" if shown else "")
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


def _describe_error(error: Exception, answer: Any) -> str:
    """Return a note on an answer that the check could not use; the user's own function raises errors of any kind."""
    message, *more = str(error).splitlines() or [""]
    if isinstance(error, GenomeError) and more:  # its second line shows the place of the error
        return f"The message is: {truncate(message)}, here: … {more[0].strip()} …"
    if isinstance(error, WalkerlabError):
        return f"The message is: {truncate(message)}"
    note = f"The check could not use this answer: it is {_describe_type(answer)}."
    return f"{note} {truncate(f'{type(error).__name__}: {message}')}" if callable(answer) else note


def _describe_type(answer: Any) -> str:
    return "a text, in quotes" if isinstance(answer, str) else f"of the type {type(answer).__name__}"


def _is_number_in_quotes(answer: Any) -> bool:
    try:
        return isinstance(answer, str) and math.isfinite(float(answer))
    except ValueError:
        return False


def _is_unwritten(function: Any) -> bool:
    """Return whether a function still contains ``...``, or does nothing."""
    code = function.__code__
    return ... in code.co_consts or code.co_code == _do_nothing.__code__.co_code


def _do_nothing() -> None: ...
