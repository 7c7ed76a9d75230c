"""An answer is right, not yet right, or empty; no answer raises an error, and no hint appears before a wrong answer."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

import walkerlab as wl
from walkerlab.lessons import checking
from walkerlab.lessons.exercises import find_exercise, find_quiz, lesson_numbers


def unwritten(genomes, *, rng):
    return ...


def empty(genomes, *, rng): ...


@pytest.mark.parametrize("answer", [..., None, "", " ... ", [], [1, ...], {"a": ...}, unwritten, empty])
def test_a_missing_answer_is_empty_and_costs_no_hint(answer):
    assert wl.lessons.check("99.1", answer).state == "empty"
    assert wl.lessons.check("99.1", 1).text == "It is a number."


def test_each_wrong_answer_shows_the_next_hint_and_the_last_one_again():
    texts = [wl.lessons.check("99.1", wrong).text for wrong in (1, 1, 2)]
    assert texts == ["It is a number.", "It is odd.", "It is odd."]


def test_a_hint_that_fits_the_answer_is_shown_above_the_next_general_one():
    feedbacks = [wl.lessons.check("99.1", 10) for _ in range(3)]
    assert [feedback.text for feedback in feedbacks] == ["Too large."] * 3
    notes = ["", "Hint 1 of 2: It is a number.", "Hint 2 of 2: It is odd."]
    assert [feedback.note for feedback in feedbacks] == notes


def test_a_right_answer_is_right_after_wrong_ones():
    wl.lessons.check("99.1", 1)
    feedback = wl.lessons.check("99.1", np.int64(3))
    assert (feedback.state, feedback.text) == ("right", "Odd.")


@given(st.one_of(st.text(), st.binary(), st.floats(), st.lists(st.integers()), st.dictionaries(st.text(), st.none())))
def test_no_answer_raises_an_error(answer):
    assert wl.lessons.check("99.1", answer).state in ("right", "not yet", "empty")


@pytest.mark.parametrize("answer", [np.arange(3), pd.DataFrame({"a": [1, 2]}), print, wl.Settings, object()])
def test_an_answer_of_another_type_gets_a_hint_that_names_its_type(answer):
    feedback = wl.lessons.check("99.1", answer)
    assert feedback.state == "not yet"
    assert type(answer).__name__ in feedback.note
    assert "It is a number." in feedback._repr_html_()


def test_a_text_that_is_no_genome_gets_a_hint_and_the_place_of_the_error():
    feedback = wl.lessons.check("01.4", "wl2 segments=3 | seg length=0.35 mass=3 lags own")
    assert "got 'lags'" in feedback.note
    assert "mass=3 lags" in feedback.note
    assert "type" not in feedback.note


@pytest.mark.parametrize("answer", ["3", " 3.0 ", "-1e3", ("run", "3")])
def test_a_number_in_quotes_gets_a_hint_about_the_quotes(answer):
    feedback = wl.lessons.check("99.1", answer)
    assert feedback.state == "not yet"
    assert "without quotes" in feedback.text
    assert "Hint 1 of 2" in wl.lessons.check("99.1", 4).note, "the quotes are not counted as a wrong answer"


def test_the_hint_about_the_type_is_about_the_last_item_of_a_tuple():
    assert "of the type object." in wl.lessons.check("99.1", ("run", object())).note
    assert "a text, in quotes." in wl.lessons.check("99.1", "three").note


def test_an_unknown_number_is_reported_with_the_known_ones():
    with pytest.raises(wl.lessons.LessonError, match=r"no exercise '99\.7'; .* '99\.1'"):
        wl.lessons.check("99.7", 3)
    for number in ("x", 99.1, None, ""):
        with pytest.raises(wl.lessons.LessonError, match="there is no lesson"):
            wl.lessons.check(number, 3)


def test_feedback_is_escaped():
    assert "<b>x" not in checking.Feedback("right", "<b>x")._repr_html_()


@pytest.mark.parametrize("lesson", [*lesson_numbers()])
def test_the_contents_of_each_lesson_are_complete(lesson):
    questions = find_quiz(lesson)
    assert 2 <= len(questions) <= 3
    for question in questions:
        assert question.right in question.choices
        assert len(question.choices) >= 2
        assert all(text.endswith((".", "!")) for text in question.choices.values())
    module = __import__(f"walkerlab.lessons.contents.lesson_{lesson}", fromlist=["EXERCISES"])
    for number in module.EXERCISES:
        exercise = find_exercise(number)
        assert number.startswith(f"{lesson}.")
        assert exercise.hints
        assert wl.lessons.check(number, ...).state == "empty"
        for nonsense in ("nonsense", -1e9, object(), [object()], {"a": 1}, pd.DataFrame(), lambda: None):
            assert wl.lessons.check(number, nonsense).state != "right"
