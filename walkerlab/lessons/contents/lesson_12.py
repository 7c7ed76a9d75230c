"""Exercises and quiz of lesson 12, a bigger computer."""

import math
from collections.abc import Callable
from typing import Any

from walkerlab.lessons.exercises import Exercise, Question

TOLERANCE = 0.02  # of a share, so that it may be rounded to a percent
MISTAKE_TOLERANCE = 0.01  # relative, so that a wrong number may be rounded


def _check_number(right: float, wrong: dict[float, str], tolerance: float = 0.0) -> Callable[[Any], bool | str]:
    """Return the check of a number.

    Args:
        right: Right number.
        wrong: Hints for particular wrong numbers.
        tolerance: Maximum difference from the right number.
    """

    def check(answer: Any) -> bool | str:
        if isinstance(answer, str):
            return "Write the number without quotes."
        number = float(answer)
        for mistake, hint in wrong.items():
            if math.isclose(number, mistake, rel_tol=MISTAKE_TOLERANCE):
                return hint
        return abs(number - right) <= tolerance

    return check


EXERCISES: dict[str, Exercise] = {
    "12.5": Exercise(
        check=_check_number(
            500 / 4 / 160,
            {
                500 / 160: "More than one: that many robots wait for each worker. How many rounds of walks are needed?",
                100 * 500 / 4 / 160: "Write the share as a number from 0 to 1.",
            },
            TOLERANCE,
        ),
        hints=(
            "500 robots on 160 workers: how many rounds, if the last one need not be full?",
            "The share is the number of walks divided by the number of rounds times the number of workers.",
        ),
        right="Four rounds have room for 640 walks, and 500 of these places are used.",
    ),
    "12.6": Exercise(
        check=_check_number(
            2,
            {
                32: "That is the memory of the whole job. How many workers share it?",
                30 / 16: "That is its memory in gibibytes, the unit of the request. Use the gigabytes of memory=.",
            },
        ),
        hints=(
            "Read --mem and --cpus-per-task in the request.",
            "The memory of the job is divided equally among its workers, one for each core.",
        ),
        right="Sixteen workers share 32 GB. A walk needs far less, so there is room for larger grounds.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        text="What does a worker receive, and what does it send back?",
        choices={
            "a genome; the recorded walk": "Right: fitness and all other steps are computed in the notebook.",
            "two parents; a child": "Breeding takes so little time that it stays in the notebook.",
            "the whole run; its champion": "Then one worker would do everything, and the others would wait.",
        },
        right="a genome; the recorded walk",
    ),
    Question(
        text="You have 160 workers. Which run uses them best?",
        choices={
            "16 robots, 1000 generations": "At most 16 workers are busy, because a generation waits for the last.",
            "1600 robots, 10 generations": "Right: ten full rounds of walks in every generation.",
        },
        right="1600 robots, 10 generations",
    ),
    Question(
        text="Why is the table the same, whatever computes the walks?",
        choices={
            "because all computers are equally fast": "Speed has no influence on the table, and computers differ.",
            "because every random number belongs to a place in the run, not to a worker": "Right: the seed, the "
            "generation and the robot determine it.",
            "because the workers wait for each other": "They finish in any order; the table does not depend on it.",
        },
        right="because every random number belongs to a place in the run, not to a worker",
    ),
)
