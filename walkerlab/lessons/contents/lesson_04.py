"""Exercises and quiz of lesson 04, crossover."""

import math
from typing import Any

from walkerlab.lessons.exercises import Exercise, Question

N_SEGMENTS_OF_PARENTS = (4, 3)
POOL = (1.0, 2.0, 3.0, 5.0)  # fitness of the selected parents in exercise 04.4, in m
COUPLE = (2.0, 5.0)
BLENDED_RANGE = (0.2, 0.5)  # lowest and highest value of the gene in exercise 04.6
OFFERED_VALUES = (0.1, 0.25, 0.4, 0.6)
TOLERANCE = 0.01


def _check_second_child(answer: Any) -> bool | str:
    n_front_parent, n_rear_parent = N_SEGMENTS_OF_PARENTS[1], N_SEGMENTS_OF_PARENTS[0]
    right = math.ceil(n_front_parent / 2) + n_rear_parent // 2
    number = float(answer)
    if number == 3:
        return "That is the first child. For the second one, the front half is that of B: 3 segments, an odd number."
    if not number.is_integer():
        return "Bodies are cut between segments, so the number is whole. An odd number gives a larger front half."
    return number == right


def _check_fraction(answer: Any) -> bool | str:
    fraction = float(answer)
    right = (COUPLE[1] - COUPLE[0]) / (max(POOL) - min(POOL))
    if math.isclose(fraction, 1, abs_tol=TOLERANCE):
        return "The denominator is the range of all four parents, not only of this couple."
    if fraction > 1 or fraction < 0:
        return "The fraction is between 0 and 1: the child lies between its parents."
    return math.isclose(fraction, right, abs_tol=TOLERANCE)


def _check_possible(answer: Any) -> bool | str:
    if isinstance(answer, str | int | float):
        return "Answer with a list, in square brackets and without quotes, such as [0.1, 0.6]."
    given = {round(float(each), 6) for each in answer}
    if not given:
        return "The list is empty. A child of weighted crossover lies between its two parents."
    if unknown := sorted(given.difference(OFFERED_VALUES)):
        return f"{unknown[0]:g} is not one of the four values. Answer with a list of some of them, such as [0.1, 0.6]."
    low, high = BLENDED_RANGE
    if any(not low <= each <= high for each in given):
        return "One of your values lies outside the values of all parents. Can a step *towards* a parent end there?"
    return given == {each for each in OFFERED_VALUES if low <= each <= high}


EXERCISES: dict[str, Exercise] = {
    "04.2": Exercise(
        check=_check_second_child,
        hints=(
            "Count the two halves separately: the front half of B, and the rear half of A.",
            "B has 3 segments, and its front half is the larger one. A has 4, which halve evenly.",
        ),
        right="Two segments from the front of B, and two from the rear of A. Together, the two children have the seven "
        "segments of their parents.",
    ),
    "04.4": Exercise(
        check=_check_fraction,
        hints=(
            "Numerator: the difference of the couple, 5 m − 2 m.",
            "Denominator: the highest minus the lowest fitness of all four parents, 5 m − 1 m.",
        ),
        right="The gap of the couple is three quarters of the range of the pool, and so is the child's way.",
    ),
    "04.6": Exercise(
        check=_check_possible,
        hints=(
            "The child is on the way from one parent to the other, never beyond either of them.",
            "Which of the four values lie between the lowest and the highest value of the parents?",
        ),
        right="A blend creates new values, but only between those of the parents: it can narrow the range of a "
        "gene, and never widen it.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        "All robots of a population have the same genome. How many different children can uniform crossover make?",
        {
            "one": "Right. Every coin chooses between two equal values.",
            "two": "The second child gets what is left, but the two parents are equal, so that is the same genome.",
            "2 to the power of 56": "That is the number of ways in which 56 coins can fall; but each coin "
            "chooses between two equal values.",
        },
        "one",
    ),
    Question(
        "Which crossover can never separate the genes of one segment?",
        {
            "paired": "Right. It cuts only between segments, so that a segment moves as a whole.",
            "uniform": "It tosses a coin for each gene, so the genes of a segment come from both parents.",
            "one_point": "It cuts the list of genes at any place, often in the middle of a segment.",
        },
        "paired",
    ),
    Question(
        "Weighted crossover is used without mutation. What happens to the values of a gene in the population?",
        {
            "They move closer together": "Right. Every child lies between its parents, so the range can only shrink.",
            "They stay the same": "Exchanging genes keeps the values; weighted crossover blends them.",
            "They spread out": "A step towards the fitter parent never goes beyond it.",
        },
        "They move closer together",
    ),
)
