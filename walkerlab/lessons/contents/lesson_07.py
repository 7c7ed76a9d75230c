"""Exercises and quiz of lesson 07, is it better?"""

from typing import Any

from walkerlab.lessons.exercises import Exercise, Question

N_ROBOTS = 24
N_GENERATIONS = 24
N_ELITES = 2
FEWEST_SEEDS = 6  # 2 of the 2⁶ sign patterns are as clear as "all better": p = 0.031; with 5 seeds, p = 0.0625


def _check_budget(answer: Any) -> bool | str:
    number = float(answer)
    if number == N_ROBOTS * N_GENERATIONS:
        return "Elites do not walk again: only 22 new robots walk in each generation after the first."
    if number == (N_ROBOTS - N_ELITES) * N_GENERATIONS:
        return "In the first generation there are no elites, and all 24 robots walk."
    return number == N_ROBOTS + (N_ROBOTS - N_ELITES) * (N_GENERATIONS - 1)


def _check_seeds(answer: Any) -> bool | str:
    number = float(answer)
    if not number.is_integer() or number < 1:
        return "A number of seeds is a whole number."
    if 2 < number < FEWEST_SEEDS:
        return f"With {number:g} coins, all fall alike in 2 of {2 ** int(number)} cases. Is that below 0.05?"
    if number > FEWEST_SEEDS:
        return "The p-value is below 0.05 there, but is it the smallest number of seeds for which it is?"
    return number == FEWEST_SEEDS


EXERCISES: dict[str, Exercise] = {
    "07.2": Exercise(
        check=_check_budget,
        hints=(
            "Count the first generation and the 23 later ones separately.",
            "24 robots walk in the first generation, and 24 − 2 in each later one.",
        ),
        right="Each run of random search has as many random robots, so that only the method differs.",
    ),
    "07.4": Exercise(
        check=_check_seeds,
        hints=(
            "Print p_value(n) for n from 3 to 12.",
            "All heads or all tails happen in 2 of 2 to the power of n cases. For which n is that below 0.05?",
        ),
        right="Even a method that always wins needs six seeds: 2 of 64 cases are fewer than 5 %, but 2 of 32 are more.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        "You compare two methods with ten seeds: p = 0.3. What have you shown?",
        {
            "Nothing in either direction": "Right. The difference may be luck; but the methods may still differ.",
            "The methods are equal": "A small difference could have been missed: ten seeds only find large ones.",
            "The first is better in 30 % of runs": "A p-value is not about how often one wins; that is A12.",
        },
        "Nothing in either direction",
    ),
    Question(
        "Method A found a robot with 8 m in 1,000 walks; method B found one with 7 m in 500 walks. Which is better?",
        {
            "One cannot say": "Right. More walks find better robots; the budget must be the same. And it is one seed.",
            "A": "It had twice as many chances; nobody knows what B would have found with 1,000 walks.",
            "B": "It is more economical so far, but nobody knows how it would continue, or with another seed.",
        },
        "One cannot say",
    ),
    Question(
        "Why do both conditions of an experiment use the same seeds?",
        {
            "Both start from the same robots": "Right. The luck of the first generation is then the same for both: "
            "the runs of a pair differ only by the method.",
            "The result is then always clear": "It is only easier to see a difference, if there is one.",
            "The runs are faster": "Each run has as many walks as before.",
        },
        "Both start from the same robots",
    ),
)
