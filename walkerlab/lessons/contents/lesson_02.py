"""Exercises and quiz of lesson 02, the ground."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

from walkerlab.lessons.exercises import Exercise, Question
from walkerlab.lessons.saved_runs import saved_champion
from walkerlab.settings.choices import Structure
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import Terrain
from walkerlab.simulation.evaluation import evaluate

BASE = Settings().with_(duration=6)


def _distances(*worlds: Settings) -> list[float]:
    """Return the distance of the lesson's walker in each world, m."""
    genome = saved_champion("flat").genome
    with ThreadPoolExecutor(1) as executor:
        return [evaluate([genome], world, executor)[0].distance for world in worlds]


def _check_hard_world(answer: Any) -> bool | str:
    if not isinstance(answer, Settings):
        return "The answer must be settings: s.with_(…)."
    if answer.simulation.duration < BASE.simulation.duration or answer.robot != BASE.robot:
        return "Change the terrain only: the walker and its six seconds stay the same."
    (distance,) = _distances(answer)
    return True if distance < 1 else f"In this world, it still walks {distance:.2f} m."


def _check_load(answer: Any) -> bool | str:
    if not isinstance(answer, Settings):
        return "The answer must be settings: s.with_(…)."
    if answer.terrain != Terrain() or answer.simulation.duration != BASE.simulation.duration:
        return "The ground, the air and the six seconds must stay as they are in s."
    loaded, free = _distances(answer, BASE)
    return True if loaded < free / 2 else f"With this load, it walks {loaded:.2f} m; without, {free:.2f} m."


def _check_structure(answer: Any) -> bool | str:
    settings = answer if isinstance(answer, Settings) else None
    if settings is None:
        return "The answer must be settings: s.with_(…)."
    if settings.terrain.structure != Structure.incline:
        return f"The structure of this ground is {settings.terrain.structure.name}."
    return True if settings.terrain.incline < 0 else f"With incline {settings.terrain.incline:g}, the ground rises."


EXERCISES: dict[str, Exercise] = {
    "02.2": Exercise(
        check=_check_structure,
        hints=(
            "Two settings of the terrain are needed: one for the shape, one for the slope.",
            "Uphill is positive. Which sign is downhill?",
        ),
        right="structure chooses the shape of the ground, and incline is the slope of that shape in degrees.",
    ),
    "02.5": Exercise(
        check=_check_hard_world,
        hints=(
            "Steps begin 1 m ahead of the start. Which settings of the ground or the air act sooner?",
            "Uphill and against the wind, it comes less far. How steep is too steep, how strong too strong?",
        ),
        right="The same genome that is fit on the floor is unfit here: fitness depends on the world.",
    ),
    "02.6": Exercise(
        check=_check_load,
        hints=(
            "The two loads are carry_weight and drag_weight, in kg.",
            "A sledge brakes at every step. How heavy must it be?",
        ),
        right="A robot that evolved without a load has legs and a rhythm for its own weight only.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        "The walker comes less far on ice. What does that show?",
        {
            "It is a poor robot": "On rubber, the same robot is the best of its run.",
            "Its gait relies on grip": "Right. It evolved on the rubber floor only.",
            "Ice is impossible to walk on": "It does walk on ice, only less far.",
        },
        "Its gait relies on grip",
    ),
    Question(
        "Why does the notebook repeat each walk from five slightly different starts?",
        {
            "To make it last longer": "The walks are as long as before.",
            "To see how much is luck": "Right. One walk can stumble; the median of five is more reliable.",
            "To let the robot learn": "A robot does not change while it walks.",
        },
        "To see how much is luck",
    ),
)
