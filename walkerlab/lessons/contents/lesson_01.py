"""Exercises and quiz of lesson 01, bodies and genes."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

from walkerlab.genome.genome import Genome
from walkerlab.genome.phenotype import express
from walkerlab.lessons.exercises import Exercise, Question
from walkerlab.settings.settings import Settings
from walkerlab.simulation.evaluation import evaluate

HAND_WRITTEN = """wl2 segments=2
| seg length=0.35 mass=3 legs own length=0.3 force=15
| seg length=0.3 mass=3 legs repeat length=0.3 force=15
| gait frequency=2 lag=3.14 duty=0.5
| step hip amplitude=0.4 phase=0 offset=0.3 knee amplitude=0.3 phase=4.7 offset=-0.6 stride=3.14
| step hip amplitude=0.4 phase=0 offset=0.3 knee amplitude=0.3 phase=4.7 offset=-0.6 stride=3.14"""
"""Genome of the robot in the notebook."""

N_UNUSED = 9  # length and force of the repeated legs, and the seven numbers of their step
N_SEGMENTS = 3
N_LEGS = 4
GAIN = 0.5  # m by which an edited robot must walk further
SETTINGS = Settings().with_(duration=5)


def _check_unused(answer: Any) -> bool | str:
    if isinstance(answer, str):
        return "Write the number in digits, without quotes."
    number = float(answer)
    if number == 2:
        return "The length and the force of the repeated legs are two. Do they also have a step that is never used?"
    if number == 7:
        return "The last line has seven. Which numbers in the line of the second segment belong to its legs?"
    return number == N_UNUSED


def _check_body(answer: Any) -> bool | str:
    robot = express(Genome.of(answer).within(SETTINGS.robot))
    if len(robot.segments) != N_SEGMENTS:
        return f"This robot has {len(robot.segments)} segments."
    n_legs = 2 * sum(segment.legs is not None for segment in robot.segments)
    return True if n_legs == N_LEGS else f"This robot has {n_legs} legs."


def _check_faster(answer: Any) -> bool | str:
    with ThreadPoolExecutor(1) as executor:
        before, after = evaluate([HAND_WRITTEN, Genome.of(answer)], SETTINGS, executor)
    if after.verdict != "ok":
        return f"This walk does not count: {after.reason}."
    if after.distance < before.distance + GAIN:
        return f"It walks {after.distance:.2f} m; the original walks {before.distance:.2f} m."
    return True


EXERCISES: dict[str, Exercise] = {
    "01.3": Exercise(
        check=_check_unused,
        hints=(
            "The second segment repeats the legs in front of it. Which of its own numbers are then not used?",
            "Count the numbers of its legs in its own line, and all numbers of its step in the last line.",
        ),
        right="Length and force of the repeated legs, and the seven numbers of their step, have no effect.",
    ),
    "01.4": Exercise(
        check=_check_body,
        hints=(
            "Change segments=2 to segments=3, and add one line that starts with | seg and one that starts with | step.",
            "A segment without legs has the word nolegs in place of legs; its numbers stay in the text.",
        ),
        right="Each segment has a line for its body and a line for its step, whether or not it has legs.",
    ),
    "01.5": Exercise(
        check=_check_faster,
        hints=(
            "Change one number at a time. Which number says how many strides there are in a second?",
            "If the robot falls or walks backward, undo the change and try a smaller one.",
        ),
        right="You did by hand what mutation does at random: change a number, and keep it if the robot walks further.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        "What is a genome?",
        {
            "One number that is inherited": "That is a gene. A genome has many.",
            "All the numbers that a robot inherits": "Right. Each of them is a gene.",
            "The body of the robot": "The body is built from the genome; the gait is, too.",
        },
        "All the numbers that a robot inherits",
    ),
    Question(
        "Mutation makes a leg longer than the limits allow. What happens to the robot?",
        {
            "It is removed": "Then mutation near a limit would waste many robots.",
            "The gene is set back to the limit": "Right. This is called repair, and the robot walks.",
            "It walks with the longer leg": "No robot is ever outside the limits.",
        },
        "The gene is set back to the limit",
    ),
)
