"""The quiz at the end of a lesson, as a widget."""

from walkerlab.lessons.exercises import find_quiz
from walkerlab.widgets.questions import Item, Questions, Reply


def quiz(lesson: str) -> Questions:
    """Return the quiz of a lesson: questions with several choices, and feedback on each choice.

    Args:
        lesson: Number of the lesson, such as "03".

    Raises:
        LessonError: If there is no lesson with this number.
    """
    questions = find_quiz(lesson)

    def reply(position: int, choice: str) -> Reply:
        question = questions[position]
        return Reply("right" if choice == question.right else "not yet", question.choices[choice])

    items = [Item(question.text, tuple(question.choices)) for question in questions]
    return Questions(items, reply, title=f"quiz of lesson {lesson}")
