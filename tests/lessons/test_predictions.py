"""A prediction is remembered, and compared with the result."""

import pytest

import walkerlab as wl
from walkerlab.lessons import choose, compare, predict


def test_a_number_is_compared_with_its_difference_and_unit():
    predict("99.1", 4, unit="m")
    assert compare("99.1", 6.2).text == "You predicted 4 m; the run gave 6.2 m (2.2 m more)."
    assert compare("99.1", 4.0).text == "You predicted 4 m; the run gave 4 m (exactly as predicted)."
    assert compare("99.1", -1).text == "You predicted 4 m; the run gave −1 m (5 m less)."
    assert [bar.percent for bar in compare("99.1", 8.0).bars] == [50, 100]
    predict("99.1", 6, unit="robots")
    assert compare("99.1", 5).text == "You predicted 6 robots; the run gave 5 robots (1 robot less)."
    predict("99.1", 1, unit="s")
    assert compare("99.1", 2).text == "You predicted 1 s; the run gave 2 s (1 s more)."


@pytest.mark.parametrize(
    ("value", "state"), [(..., "empty"), (None, "empty"), ("", "empty"), ("4 m", "not yet"), ([4], "not yet")]
)
def test_what_is_no_prediction_is_not_compared(value, state):
    predict("99.1", 4, unit="m")
    assert predict("99.1", value, unit="m").state == state
    text = compare("99.1", 6.2).text
    assert "6.2 m" in text
    assert "no prediction" in text


def test_a_missing_result_is_reported():
    predict("99.1", 4)
    assert compare("99.1", ...).state == "empty"


def test_a_choice_is_remembered_by_its_cell_and_compared():
    widget = choose("99.2", ["tournament", "uniform"])
    assert "choose" in compare("99.2", "uniform").text
    widget.answers = ["uniform"]
    assert "as you predicted" in compare("99.2", "uniform").text
    assert "not what you predicted" in compare("99.2", "tournament").text
    assert choose("99.2", ["tournament", "uniform"]).answers == ["uniform"]
    assert choose("99.2", ["other", "options"]).answers == [""]


@pytest.mark.parametrize("options", ["ab", ["one"], [1, 2], []])
def test_options_are_at_least_two_texts(options):
    with pytest.raises(wl.lessons.LessonError, match="at least 2 texts"):
        choose("99.2", options)


def test_a_quiz_gives_feedback_on_each_choice_and_ignores_what_is_no_choice():
    quiz = wl.lessons.quiz("99")
    for answers in (["z", 3], [], [None, {"a": 1}, "a", "a"]):
        quiz.answers = answers
        assert [reply["state"] for reply in quiz.replies] == ["", ""]
        assert "Which?" in quiz.snapshot()
    quiz.answers = ["b", "a"]
    assert [reply["text"] for reply in quiz.replies] == ["No, not b.", "Yes, a."]
    assert quiz.score == (1, 2)
    assert "No, not b." in quiz.snapshot()


def test_a_seed_depends_on_the_name_alone():
    assert wl.lessons.my_seed("Ada") == wl.lessons.my_seed(" aDA ") == 690398
    assert wl.lessons.my_seed("Zoë Müller") == wl.lessons.my_seed("Zoe\u0308 Mu\u0308ller")
    seeds = {wl.lessons.my_seed(f"student {number}") for number in range(100)}
    assert len(seeds) == 100
    wl.Settings().with_(seed=max(seeds))
    for name in ("", " ", 3, None):
        with pytest.raises(wl.lessons.LessonError, match="write your name in quotes"):
            wl.lessons.my_seed(name)
