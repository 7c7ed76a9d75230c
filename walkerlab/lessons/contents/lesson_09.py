"""Exercises and quiz of lesson 09, broken operators."""

from collections.abc import Callable, Mapping
from typing import Any, cast

import numpy as np

from walkerlab.lessons.exercises import Exercise, Question
from walkerlab.system.randomness import random_stream

SELECTION: Mapping[str, tuple[int, str]] = {
    "a": (3, "Look at the bars of operator_a from left to right: where do they rise again?"),
    "d": (1, "Compare the bars of operator_d with what its docstring promises, rank by rank."),
    "f": (2, "Read the first bar of operator_f, and its row in the plot of lost best individuals."),
}
CROSSOVER: Mapping[str, tuple[int, str]] = {
    "c": (6, "Count the letters in the microscope: how many genes of the child come from A, and how many from B?"),
}
MUTATION: Mapping[str, tuple[int, str]] = {
    "b": (4, "Thirty copies of one robot were mutated by operator_b. How many different robots are there now?"),
    "e": (5, "Where in their ranges are most genes after operator_e was applied many times?"),
}
N_DRAWS = 2000
MIN_SHARE_OF_FITTEST = 0.25  # of the parents, in tournaments of three among eight; 0.33 on average


def _diagnosis_check(right: Mapping[str, tuple[int, str]]) -> Callable[[Any], bool | str]:
    """Return the check of a diagnosis.

    Args:
        right: For each operator, the number of its symptom and a hint.
    """

    def check(answer: Any) -> bool | str:
        if not isinstance(answer, dict):
            return "The diagnosis must keep its form: each letter, a colon and a number, in braces { }."
        answer = cast(dict[str, Any], answer)
        given: dict[str, Any] = {name: answer.get(name, ...) for name in right}
        for name, number in given.items():
            if number is ...:
                return f"The diagnosis of operator_{name} is still empty. Write the number of a symptom."
            if number not in range(1, 9):
                return f"The diagnosis of operator_{name} is {number!r}; it must be the number of a symptom, 1 to 8."
        wrong = [name for name, number in given.items() if number != right[name][0]]
        if not wrong:
            return True
        n_right = len(right) - len(wrong)
        count = f"{n_right} of {len(right)} are right. " if len(right) > 1 else ""
        return count + right[wrong[0]][1]

    return check


def _check_repair(select: Any) -> bool | str:
    fitness = np.array([0.4, -1.2, 2.5, 0.9, 3.1, -0.3, 1.7, 0.2])
    selected = np.asarray(select(fitness, N_DRAWS, rng=random_stream(0, "check")))
    if selected.shape != (N_DRAWS,):
        return f"The function must return {N_DRAWS} indices; it returned an array of shape {selected.shape}."
    counts = np.bincount(selected, minlength=len(fitness))
    if not counts.all():
        return f"Robot {int(np.argmin(counts))} with the fitness {fitness[np.argmin(counts)]} m is never selected."
    if counts[4] < MIN_SHARE_OF_FITTEST * N_DRAWS:
        return "The fittest robot is selected too rarely for a tournament of three. Leave the last line as it was."
    return bool((np.diff(counts[np.argsort(fitness)]) > 0).all()) or "A fitter robot must win more often."


EXERCISES: dict[str, Exercise] = {
    "09.2": Exercise(
        check=_diagnosis_check(SELECTION),
        hints=(
            "The numbers are those of the list of symptoms at the top of the lesson.",
            "Compare the two plots of each operator with its description, one after the other.",
        ),
        right="A wheel cannot handle negative fitness: users of DEAP (issue 211, 2017) and eaopt (issue 39, 2019) "
        "found this out. A tournament that draws from one robot too few was in DESDEO-EMO (pull request 44, 2021). One "
        "spin with many pointers is unusual, but sound: Baker published it in 1987.",
    ),
    "09.4": Exercise(
        check=_diagnosis_check(CROSSOVER),
        hints=(
            "The number is that of the list of symptoms at the top of the lesson.",
            "Compare a child of operator_c with a child of weighted, gene by gene.",
        ),
        right="walkerlab's own weighted crossover did this in a lesson with only two parents: their difference was "
        "divided by itself, so that the child always moved the whole way (2026).",
    ),
    "09.6": Exercise(
        check=_diagnosis_check(MUTATION),
        hints=(
            "The numbers are those of the list of symptoms at the top of the lesson.",
            "Compare the two plots of each operator with its description, one after the other.",
        ),
        right="In TPOT, one mutation changed the whole population at once (issue 362, 2017), and in "
        "GeneticAlgorithmPython the same genes mutated each time (issue 2, 2019). Values that gather at a limit are "
        "walkerlab's own history: 57 % of its random robots weighed exactly the maximum (2026).",
    ),
    "09.7": Exercise(
        check=_check_repair,
        hints=(
            "rng.integers(n) returns a number from 0 to n - 1. Which ranks are drawn for 8 robots?",
            "The fittest of n robots has the rank n - 1, because ranks are counted from 0.",
        ),
        right="Every rank from 0 to n - 1 can now be drawn, and every robot can become a parent.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        text="The fitness curve of a run rises. Are all its operators sound?",
        choices={
            "yes": "The curve of operator_a rose, and operator_a is broken.",
            "no, it can rise despite a bug": "Right: elites keep the best robot, and the other operators still work.",
        },
        right="no, it can rise despite a bug",
    ),
    Question(
        text="walkerlab checks every operator before a run. Why did it not find these bugs?",
        choices={
            "It checks the form of the result: shapes, ranges, repeatability.": "Right: no check knows what you meant.",
            "It checks only its own operators.": "It checks yours, too; lesson 08 shows the messages.",
        },
        right="It checks the form of the result: shapes, ranges, repeatability.",
    ),
    Question(
        text="An operator passes all tools of this lesson. What does that show?",
        choices={
            "It has no bug.": "A bug of a kind that no tool looks at would not be seen.",
            "It does not have the bugs that these tools can find.": "Right: a test shows a bug, but not its absence.",
        },
        right="It does not have the bugs that these tools can find.",
    ),
)
