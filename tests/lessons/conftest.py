"""A lesson that only the tests have."""

import sys
from types import ModuleType

import pytest

from walkerlab.lessons import checking, exercises, predictions
from walkerlab.lessons.exercises import Exercise, Question


@pytest.fixture(autouse=True)
def lesson(monkeypatch):
    """Add lesson 99 with exercise 99.1, whose answer is 3, and a quiz of two questions; forget all earlier answers."""
    module = ModuleType("walkerlab.lessons.contents.lesson_99")
    hints = ("It is a number.", "It is odd.")
    module.EXERCISES = {"99.1": Exercise(lambda answer: answer == 3 or (answer > 9 and "Too large."), hints, "Odd.")}
    question = Question("Which?", {"a": "Yes, a.", "b": "No, not b."}, "a")
    module.QUIZ = (question, question)
    monkeypatch.setitem(sys.modules, module.__name__, module)
    numbers = [*exercises.lesson_numbers(), "99"]
    monkeypatch.setattr(exercises, "lesson_numbers", lambda: numbers)
    monkeypatch.setattr(checking, "_n_wrong_answers", {})
    monkeypatch.setattr(predictions, "_predictions", {})
