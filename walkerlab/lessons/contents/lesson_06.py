"""Exercises and quiz of lesson 06, evolve and watch."""

import math
from typing import Any

from walkerlab.analysis.price import price_equation
from walkerlab.lessons.exercises import Exercise, Question

TOLERANCE = 0.01  # m


def _check_walks(answer: Any) -> bool | str:
    run, number = answer
    algorithm = run.settings.algorithm
    n_rows = algorithm.population_size * run.n_generations
    if number == n_rows:
        return "That counts the elites again in each generation, but they do not walk again."
    if number == (algorithm.population_size - algorithm.n_elites) * run.n_generations:
        return "There are no elites in generation 0: all 24 robots walk."
    return bool(number == len(run.records.drop_duplicates("individual")))


def _check_generation(answer: Any) -> bool | str:
    run, number = answer
    split = price_equation(run)
    if number == split.generation[split.selection.idxmax()] != split.generation[split.change.idxmax()]:
        return "In that generation, the term of selection is largest. The question is about the change of the mean."
    if number == split.change.idxmax():
        return "That is the number of the row. The column `generation` has the number of the generation in that row."
    return bool(number == split.generation[split.change.idxmax()])


def _check_distance(answer: Any) -> bool | str:
    run, distance = answer
    if isinstance(distance, str):
        return "That is a text. `wl.simulate` returns an object with the attribute `distance`, a number."
    if hasattr(distance, "distance"):
        return "That is the whole walk. Its attribute `distance` is the number that is asked for."
    return math.isclose(float(distance), run.champion.fitness, abs_tol=TOLERANCE)


EXERCISES: dict[str, Exercise] = {
    "06.2": Exercise(
        check=_check_walks,
        hints=(
            "In generation 0, all 24 robots walk. How many new robots are there in each later generation?",
            "How many generations are there after the first one?",
        ),
        right="The table has more rows than that, because an elite has a row in each generation in which it lives.",
    ),
    "06.7": Exercise(
        check=_check_generation,
        hints=(
            "split.change.idxmax() gives the row; what does the column generation contain in this row?",
            "Compare with the highest point of the black line in the picture above.",
        ),
        right="There the parents were good, and little was lost by crossover and mutation.",
    ),
    "06.8": Exercise(
        check=_check_distance,
        hints=(
            '(folder / "champion.txt").read_text() is the text. Put it into wl.Genome.parse.',
            "Use the same settings, s, as in the run: another duration gives another distance.",
        ),
        right="Exactly the distance of the run: the text holds the whole robot, and a walk has no random part.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        "Crossover and mutation lower the mean in nearly every generation. Would a run without them be better?",
        {
            "No": "Right. It would select the best of the first robots, and then stop.",
            "Yes": "Its mean would rise at first. Soon all robots are copies of one, and nothing is left to select.",
            "It would be the same": "Then no child could ever be better than the best robot of generation 0.",
        },
        "No",
    ),
    Question(
        "Why does the line of the best robot never fall in this run?",
        {
            "The elites": "Right. The two best robots stay unchanged, so the best cannot be lost.",
            "Selection": "Selection chooses parents; but a child can be worse than its parents.",
            "Mutation": "Mutation changes robots at random, for better or worse.",
        },
        "The elites",
    ),
    Question(
        "A classmate has the same settings and the same seed. What does the run look like?",
        {
            "The same, robot by robot": "Right. All random numbers come from the seed.",
            "Similar, but not the same": "The random numbers of a computer are calculated, from the seed.",
            "Quite different": "That would be so with another seed.",
        },
        "The same, robot by robot",
    ),
)
