"""Exercises and quiz of lesson 11, class tournament."""

import hashlib
from typing import Any

from walkerlab.lessons.exercises import Exercise, Question
from walkerlab.lessons.saved_runs import mystery_terrain

SCORE = 0.4  # m, the median of 0, 0, 0.4, 2.1 and 2.3
TIED = [1, 2, 2, 4]
WINNERS = {"best": "lucky", "median": "steady"}
N_DIGITS = 8


def _check_score(answer: Any) -> bool | str:
    if answer == 2.1:
        return "2.1 m would be right if only the walks that count were used. The others score 0."
    if answer == -0.5 or answer == 0.0:
        return "Sort all five scores and take the third. How many of them are 0?"
    return not isinstance(answer, bool) and abs(answer - SCORE) < 1e-9


def _check_ties(answer: Any) -> bool | str:
    ranks = [int(rank) for rank in answer]
    if len(ranks) != len(TIED):
        return f"There are four robots, so that the list needs four ranks; it has {len(ranks)}."
    if ranks == [1, 2, 2, 3]:
        return "Three robots are better than the last one. Which rank has a robot with three better ones?"
    return ranks == TIED


def _check_luck(answer: Any) -> bool | str:
    if not all(isinstance(winner, str) for winner in answer.values()):
        return 'Write the name of the winner in quotes, "steady" or "lucky", for each rule.'
    wrong = [rule for rule, winner in WINNERS.items() if str(answer[rule]).strip().lower() != winner]
    if not wrong:
        return True
    advice = {
        "best": "Find the largest number of each list, and compare the two.",
        "median": "Sort each list, take the number in the middle, and compare the two.",
    }
    return advice[wrong[0]]


def _check_digits(answer: Any) -> bool | str:
    sealed = mystery_terrain()
    changed = hashlib.sha256(sealed.text.replace("s", "S", 1).encode()).hexdigest()
    n_equal = sum(one == other for one, other in zip(changed[:N_DIGITS], sealed.digest, strict=False))
    if isinstance(answer, str) and len(answer.strip()) == N_DIGITS:
        return "These are the digits. How many of them are equal to the original ones, at the same place?"
    return not isinstance(answer, bool) and answer == n_equal


EXERCISES: dict[str, Exercise] = {
    "11.2": Exercise(
        check=_check_score,
        hints=(
            "Write down five scores first: two of the walks score 0.",
            "Sort the five scores from the smallest to the largest, and take the third.",
        ),
        right="A single good walk does not help, and a single bad one does not hurt.",
    ),
    "11.3": Exercise(
        check=_check_ties,
        hints=(
            "Write a list of four numbers, in the order of the scores.",
            "The rank is 1 plus the number of robots with a higher score.",
        ),
        right="Nobody profits from a difference that is smaller than the precision of the score.",
    ),
    "11.4": Exercise(
        check=_check_luck,
        hints=(
            'Write "steady" or "lucky" for each of "best" and "median".',
            "The best of a list is max(list); the median is sorted(list)[2] for five numbers.",
        ),
        right="Who makes the rule also decides who wins. It must be fixed before anybody walks.",
    ),
    "11.6": Exercise(
        check=_check_digits,
        hints=(
            "Write the two rows of digits one below the other, and count the columns in which both are equal.",
            "Each digit has 16 values, so that two random digits are rarely equal.",
        ),
        right="A small change of the text changes almost all digits: nobody can adjust the ground secretly.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        text="Why does the score not use the walk from the exact start?",
        choices={
            "It may be lucky: evolution selected the robot for exactly this walk.": "Right: the other starts are new.",
            "It takes longer to simulate.": "All walks take about the same time.",
            "The exact start is on other ground.": "The ground is the same; only the pose differs.",
        },
        right="It may be lucky: evolution selected the robot for exactly this walk.",
    ),
    Question(
        text="What can somebody do who knows the digest, but not the sealed settings?",
        choices={
            "find out the ground before the tournament": "The digest shows nothing; there is no way back to the text.",
            "notice afterwards whether the ground was changed": "Right: another ground has another digest.",
            "change the ground": "Then the digest would not fit any more, and everybody could see it.",
        },
        right="notice afterwards whether the ground was changed",
    ),
    Question(
        text="A robot wins on flat ground and comes last on the mystery terrain. What does that show?",
        choices={
            "It adapted to flat ground.": "Right: evolution improves what it is measured on, and nothing else.",
            "The league made a mistake.": "The judge and the rules were the same.",
            "Evolution did not work.": "It did: on the ground on which it was measured.",
        },
        right="It adapted to flat ground.",
    ),
)
