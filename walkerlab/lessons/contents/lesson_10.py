"""Exercises and quiz of lesson 10, when evolution cheats."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from walkerlab.lessons.exercises import Exercise, Question

DURATION = 4.0  # s
N_SAMPLES = 201
HEIGHT = 0.3  # m
LOOPHOLES = {"far": 1, "steps": 2, "calm": 3, "sprint": 4}
LOOPHOLE_HINTS = {
    "far": "A distance has no direction. Which of the robots gets far from its start?",
    "steps": "Which robot touches the ground very often without getting anywhere?",
    "calm": "Which robot has the least movement of all?",
    "sprint": "Half a second is too short for several steps. What moves a body forward without any step?",
}


def _example_walk(distance: float, work: float) -> SimpleNamespace:
    """Return a recorded walk at constant speed, with the parts that the lesson lists."""
    share = np.linspace(0, 1, N_SAMPLES)
    com = np.stack([distance * share, np.zeros(N_SAMPLES), np.full(N_SAMPLES, HEIGHT)], axis=1)
    return SimpleNamespace(
        distance=distance, velocity=distance / DURATION, time=DURATION * share, com=com, work=work * share,
        on_ground=np.ones(N_SAMPLES, dtype=bool), up=np.tile([0.0, 0.0, 1.0], (N_SAMPLES, 1)),
    )  # fmt: skip


def _check_fitness(fitness: Any) -> bool | str:
    economical = float(fitness(_example_walk(3.0, 150.0)))
    wasteful = float(fitness(_example_walk(3.0, 400.0)))
    still = float(fitness(_example_walk(0.0, 2.0)))
    backward = float(fitness(_example_walk(-3.0, 150.0)))
    if not np.isfinite([economical, wasteful, still, backward]).all():
        return "For one of four example walks, your fitness is not a finite number. Is there a division by zero?"
    if economical <= still:
        return (
            f"A robot that walks 3 m with 150 J gets {economical:.3g}, and one that stays still {still:.3g}. Evolution "
            "would prefer staying still. Make the distance count more, or the work less."
        )
    if backward >= still:
        return f"A robot that walks 3 m backward gets {backward:.3g}, and one that stays still only {still:.3g}."
    if economical <= wasteful:
        return (
            f"Two robots walk 3 m, with 150 J and with 400 J. They get {economical:.3g} and {wasteful:.3g}; the first "
            "must get more, because it saves energy."
        )
    return wasteful > still or (
        f"A robot that walks 3 m with 400 J gets {wasteful:.3g}, one that stays still {still:.3g}. Walking must pay."
    )


def _check_loopholes(answer: Any) -> bool | str:
    if not isinstance(answer, dict):
        return "The answer must keep its form: each goal, a colon and a number, in braces { }."
    answer = cast(dict[str, Any], answer)
    for goal in LOOPHOLES:
        if answer.get(goal) not in LOOPHOLES.values():
            return f'The answer for "{goal}" must be the number of a robot, 1 to 4, without quotes.'
    wrong = [goal for goal, robot in LOOPHOLES.items() if answer[goal] != robot]
    if not wrong:
        return True
    return f"{len(LOOPHOLES) - len(wrong)} of {len(LOOPHOLES)} are right. {LOOPHOLE_HINTS[wrong[0]]}"


EXERCISES: dict[str, Exercise] = {
    "10.5": Exercise(
        check=_check_fitness,
        hints=(
            "Start with walk.distance, and subtract a small part of the work, walk.work[-1].",
            "A walk of 3 m takes some hundred joules. Which factor makes joules comparable with metres?",
        ),
        right="All four example walks are in the order that the goal demands. Whether evolution finds another "
        "loophole, only a run can show.",
    ),
    "10.6": Exercise(
        check=_check_loopholes,
        hints=(
            'Write one number from 1 to 4 for each of "far", "steps", "calm" and "sprint".',
            "Each robot belongs to one goal. Begin with the goal that you are surest of.",
        ),
        right="Each of these goals measures something that walkers do, but that others do, too.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        text="Why did the champion on the windy ice come so far?",
        choices={
            "It found an especially good gait.": "Its legs contributed almost nothing: the verdict is restless.",
            "The wind blew it along.": "Right: it moved before it made a step, and only a guard shows the difference.",
        },
        right="The wind blew it along.",
    ),
    Question(
        text="With all guards off on flat ground, the champion walked all the same. Why?",
        choices={
            "There, walking was the easiest way to a large distance.": "Right: nothing else carried a robot that far.",
            "Evolution is honest if nobody interferes.": "Evolution has no intention at all; it increases a number.",
        },
        right="There, walking was the easiest way to a large distance.",
    ),
    Question(
        text="A machine reaches a very high score by cheating. Who made the mistake?",
        choices={
            "the machine": "It did exactly what the number asked for.",
            "the person who wrote down the goal and did not look at the result": "Right: both can be done better.",
        },
        right="the person who wrote down the goal and did not look at the result",
    ),
)
