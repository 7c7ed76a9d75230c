"""Exercises and quiz of lesson 05, mutation."""

import math
from typing import Any

from walkerlab.lessons.exercises import Exercise, Question

N_GENES = 56  # of the default limits of the robots
DEFAULT_RATE = 0.04
FAVORED_FACTOR = 10
COPIES_WANTED = (0.4, 0.6)  # share of exact copies that counts as about half


def _check_rate(answer: Any) -> bool | str:
    rate = float(answer)
    if not 0 <= rate <= 1:
        return "A rate is a probability: it is between 0 and 1."
    copies = (1 - rate) ** N_GENES
    low, high = COPIES_WANTED
    if copies < low:
        return f"With {rate:g}, only about {copies:.0%} of the mutants are exact copies. Too many changes, or too few?"
    if copies > high:
        return f"With {rate:g}, about {copies:.0%} of the mutants are exact copies. Too many changes, or too few?"
    return True


def _check_favored(answer: Any) -> bool | str:
    probability = float(answer)
    if math.isclose(probability, DEFAULT_RATE):
        return "That is the probability for all the other genes."
    if probability > 1:
        return "A probability is at most 1."
    return math.isclose(probability, FAVORED_FACTOR * DEFAULT_RATE, abs_tol=1e-6)


def _check_reach(answer: Any) -> bool | str:
    table, reach = answer
    points = table[~table.is_centre].sort_values("frequency")
    fitness: list[float] = points.fitness.to_list()
    if int(reach) != reach or not 1 <= reach <= len(fitness):
        return f"The reach is a number of points: whole, and between 1 and {len(fitness)}."
    n_successes = _count_climbs_to_top(fitness, int(reach))
    if n_successes < len(fitness):
        return f"With a reach of {reach:g}, {n_successes} of {len(fitness)} starts lead to the highest hill."
    if any(_count_climbs_to_top(fitness, smaller) == len(fitness) for smaller in range(1, int(reach))):
        return "All starts lead to the top, but with a smaller reach they do, too. Which one is the smallest?"
    return True


def _count_climbs_to_top(fitness: list[float], reach: int) -> int:
    """Return from how many starts a climber that sees ``reach`` points to either side reaches the maximum."""
    top = fitness.index(max(fitness))
    n_successes = 0
    for start in range(len(fitness)):
        here = start
        while True:
            best = max(range(max(0, here - reach), min(len(fitness), here + reach + 1)), key=fitness.__getitem__)
            if fitness[best] <= fitness[here]:
                break
            here = best
        n_successes += here == top
    return n_successes


EXERCISES: dict[str, Exercise] = {
    "05.2": Exercise(
        check=_check_rate,
        hints=(
            "A mutant is an exact copy if all of its 56 genes stay the same.",
            "All stay the same with the probability (1 − rate) to the power of 56. When is that one half?",
        ),
        right="With 56 genes, even a change in one of eighty genes leaves only half of the children unchanged.",
    ),
    "05.3": Exercise(
        check=_check_favored,
        hints=(
            "The table above says how much more often the favoured feature changes.",
            "The other features change with the probability 0.04. How often is ten times as often?",
        ),
        right="Ten times 0.04. Favoured mutation searches one feature thoroughly, and all others as usual.",
    ),
    "05.6": Exercise(
        check=_check_reach,
        hints=(
            "Call count_successes(2), count_successes(3) and so on, until it returns the number of points.",
            "A for loop over range(1, 41) can print count_successes for all of them.",
        ),
        right="A step must be as wide as the widest valley on the way. With small steps alone, it stays on its hill.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        "A robot is the best of 10,000. Compared with a random robot, how likely is a mutation to improve it?",
        {
            "Less likely": "Right. Most ways lead downhill from a place near the top.",
            "Equally likely": "The better a robot is, the fewer better ones there are near it.",
            "More likely": "Most changes of a good robot spoil something.",
        },
        "Less likely",
    ),
    Question(
        "Why does mutation not simply change all genes a little in every child?",
        {
            "Good and bad changes come together": "Right. Among many changes, bad ones usually spoil a good one.",
            "Small changes have no effect": "They do: even a small change of a phase can decide whether a robot falls.",
            "The genome would become longer": "The number of genes stays the same; only values change.",
        },
        "Good and bad changes come together",
    ),
    Question(
        "All robots of a population stand on the same hill, which is not the highest. What can reach another hill?",
        {
            "A large mutation": "Right. It can land on the other side of the valley, in one step.",
            "Uniform crossover": "Crossover of nearly equal robots makes nearly equal children: they stay on the hill.",
            "A stronger selection": "Selection only chooses among robots that exist, and they are all on this hill.",
        },
        "A large mutation",
    ),
)
