"""Exercises and quiz of lesson 00, meet a walker."""

from typing import Any

from walkerlab.lessons.exercises import Exercise, Question
from walkerlab.settings.settings import Settings

N_ROBOTS = 10
DURATION = 3.0  # s


def _check_settings(answer: Any) -> bool | str:
    if not isinstance(answer, Settings):
        return "The answer must be settings: s.with_(…), with the two changes between the parentheses."
    if answer.algorithm.population_size != N_ROBOTS:
        return f"These settings have {answer.algorithm.population_size} robots in each generation."
    if answer.simulation.duration != DURATION:
        return f"These settings have walks of {answer.simulation.duration:g} s."
    return True


def _check_furthest(answer: Any) -> bool | str:
    letter = str(answer).strip().upper()
    if letter not in ("A", "B", "C"):
        return 'Answer with one letter in quotes, such as "A".'
    return letter == "C"


EXERCISES: dict[str, Exercise] = {
    "00.2": Exercise(
        check=_check_furthest,
        hints=(
            "Only the place where the robot ends counts. How far ahead of the start is that, for each robot?",
            "Forward is the direction in which the robot faces at the start; a way to the side does not count.",
        ),
        right="Fitness is the net forward travel: A ends 2 m ahead, B 0 m, and C 2.5 m.",
    ),
    "00.4": Exercise(
        check=_check_settings,
        hints=(
            "The first cell of the notebook makes s with such a line. Which two of its numbers must change?",
            "The two names are population_size and duration.",
        ),
        right="with_ returns new settings in which only the named ones differ; s itself is unchanged.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        "Who decides how a robot moves its legs?",
        {
            "A programmer": "Nobody wrote this walk: its numbers were random at first.",
            "The numbers in its genome": "Right. They are inherited, combined and changed at random.",
            "The robot, while it walks": "It does not learn or see; its genome fixes the rhythm before the walk.",
        },
        "The numbers in its genome",
    ),
    Question(
        "Why does the best fitness never fall from one generation to the next?",
        {
            "The elites survive unchanged": "Right. The two best robots are copied, and walk the same.",
            "Children are never worse than their parents": "Most children are worse: look at the median.",
            "The ground becomes easier": "The ground is the same for all robots of a run.",
        },
        "The elites survive unchanged",
    ),
)
