"""The contents of every lesson: unique numbers, tolerant checks, enough hints, and quizzes with feedback."""

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.lessons.exercises import _lesson as lesson_module
from walkerlab.lessons.exercises import find_exercise, find_quiz, lesson_numbers

LESSONS = [number for number in lesson_numbers() if number != "99"]
EXERCISES = [number for lesson in LESSONS for number in lesson_module(lesson).EXERCISES]
WRONG = ["no such answer", -12345, 1.5e9, b"x", object(), print, np.zeros((2, 3)), {"a": 1}, [1, 2], True, wl.Settings]


def test_lessons_with_exercises_are_found():
    assert EXERCISES


@pytest.mark.parametrize("number", EXERCISES)
def test_an_exercise_has_a_number_of_its_lesson_and_two_hints(number):
    exercise = find_exercise(number)
    assert EXERCISES.count(number) == 1
    assert number.partition(".")[0] in LESSONS
    assert len(exercise.hints) >= 2
    assert len(set(exercise.hints)) == len(exercise.hints)
    assert exercise.right


@pytest.mark.parametrize("number", EXERCISES)
@pytest.mark.parametrize("answer", [..., None, ""])
def test_a_missing_answer_is_not_right(number, answer):
    assert wl.lessons.check(number, answer).state == "empty"


@pytest.mark.parametrize("number", EXERCISES)
def test_a_wrong_answer_of_any_type_gets_a_hint(number):
    for answer in WRONG:
        feedback = wl.lessons.check(number, answer)
        assert feedback.state == "not yet", answer
        assert feedback.text


@pytest.mark.parametrize("lesson", LESSONS)
def test_a_quiz_has_two_or_three_questions_with_feedback_on_each_choice(lesson):
    questions = find_quiz(lesson)
    assert 2 <= len(questions) <= 3
    for question in questions:
        assert question.right in question.choices
        assert len(question.choices) >= 2
        assert all(question.choices.values())
