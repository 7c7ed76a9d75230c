"""Exercises and quiz of lesson 03, selection."""

import math
from typing import Any

from walkerlab.lessons.exercises import Exercise, Question
from walkerlab.settings.choices import Selection
from walkerlab.settings.settings import Settings

BEST_OF_TWO = 7 / 16  # chance that the fittest of four is in at least one of two draws: 1 − (3/4)²
OPERATORS = {"A": "uniform", "B": "top_half", "C": "tournament"}


def _check_operators(answer: Any) -> bool | str:
    names = {str(letter).upper(): str(name).strip().lower().replace(" ", "_") for letter, name in answer.items()}
    if set(names) != set(OPERATORS):
        return "The answer needs one name for each of A, B and C."
    if set(names.values()) != set(OPERATORS.values()):
        return "Each of the three names top_half, tournament and uniform belongs to one letter."
    return names == OPERATORS


def _check_probability(answer: Any) -> bool | str:
    if isinstance(answer, str):
        return "Write the fraction without quotes, such as 2 / 3."
    number = float(answer)
    if math.isclose(number, 0.5, abs_tol=0.005):
        return "The same robot can be drawn twice, so that it is a little less than one half."
    if math.isclose(number, 9 / 16, abs_tol=0.005):
        return "This is the chance that the fittest is in neither draw."
    return math.isclose(number, BEST_OF_TWO, abs_tol=0.005)


def _check_no_elites(answer: Any) -> bool | str:
    if not isinstance(answer, Settings):
        return "The answer must be settings: wl.Settings().with_(…)."
    if answer.algorithm.selection != Selection.uniform:
        return "These settings select parents with another operator than uniform."
    return True if answer.algorithm.n_elites == 0 else "With elites, the best robots survive under any selection."


EXERCISES: dict[str, Exercise] = {
    "03.2": Exercise(
        check=_check_operators,
        hints=(
            "Which row gives every robot the same chance? And in which do some robots have no chance at all?",
            "Top half treats all robots of the better half alike; a tournament prefers the best of them.",
        ),
        right="The shape of the chances shows the operator: flat, a step, or falling with the rank.",
    ),
    "03.3": Exercise(
        check=_check_probability,
        hints=(
            "First find the chance that the fittest is drawn neither the first nor the second time.",
            "One draw misses it in 3 of 4 cases. Both draws miss it with the product; the answer is 1 minus that.",
        ),
        right="1 − (3/4)² = 7/16: the fittest becomes a parent nearly twice as often as one of four by chance.",
    ),
    "03.6": Exercise(
        check=_check_no_elites,
        hints=(
            "Two settings must change: selection and n_elites.",
            "How many best robots may survive unchanged if nothing protects the best?",
        ),
        right="Without elites and without selection pressure, nothing keeps the best robot.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        "What does a larger tournament do?",
        {
            "It raises the selection pressure": "Right. The best of many is fitter than the best of a few.",
            "It makes mutation larger": "Selection only chooses parents; mutation changes genes.",
            "It protects poor robots": "A poor robot wins only if all others in its tournament are poorer.",
        },
        "It raises the selection pressure",
    ),
    Question(
        "What is the price of a strong selection pressure?",
        {
            "Each walk takes longer": "The walks are the same under any selection.",
            "Diversity is lost sooner": "Right. Soon nearly all robots descend from a few ancestors.",
            "The best robot is lost": "Strong selection keeps the best more surely than weak selection.",
        },
        "Diversity is lost sooner",
    ),
)
