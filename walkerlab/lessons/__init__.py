"""Functions of the lessons: predictions, exercises that check themselves, quizzes, saved runs, and a pooled result.

Exercises and predictions have the number of their lesson in front:

    wl.lessons.predict("03.1", 4, unit="m")
    wl.lessons.compare("03.1", run.champion.fitness)
    wl.lessons.check("03.2", answer)
    wl.lessons.quiz("03")
"""

from walkerlab.lessons.checking import check as check
from walkerlab.lessons.exercises import Exercise as Exercise
from walkerlab.lessons.exercises import LessonError as LessonError
from walkerlab.lessons.exercises import Question as Question
from walkerlab.lessons.feedback import Feedback as Feedback
from walkerlab.lessons.pooling import pool as pool
from walkerlab.lessons.predictions import choose as choose
from walkerlab.lessons.predictions import compare as compare
from walkerlab.lessons.predictions import predict as predict
from walkerlab.lessons.quizzes import quiz as quiz
from walkerlab.lessons.saved_results import saved_results as saved_results
from walkerlab.lessons.saved_runs import mystery_terrain as mystery_terrain
from walkerlab.lessons.saved_runs import saved_champion as saved_champion
from walkerlab.lessons.saved_runs import saved_run as saved_run
from walkerlab.lessons.seeds import my_seed as my_seed

__all__ = [
    "Exercise",
    "Feedback",
    "LessonError",
    "Question",
    "check",
    "choose",
    "compare",
    "my_seed",
    "mystery_terrain",
    "pool",
    "predict",
    "quiz",
    "saved_champion",
    "saved_results",
    "saved_run",
]
