"""Questions with a button for each choice, and a reply to each choice: predictions and quizzes of the lessons."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import traitlets

from walkerlab.text.templates import Markup, render
from walkerlab.widgets.component import Component, load_script, load_style

REPLY_SIGNS = {"right": "✓", "not yet": "→", "chosen": "●"}


@dataclass(frozen=True)
class Item:
    """A question.

    Attributes:
        text: The question.
        choices: Texts of the buttons.
    """

    text: str
    choices: tuple[str, ...]


@dataclass(frozen=True)
class Reply:
    """What is shown for a choice.

    Attributes:
        state: "right", "not yet" or "chosen".
        text: A sentence.
    """

    state: str
    text: str


class Questions(Component):
    """Questions, one below the other, each with its choices as buttons.

    Attributes:
        items: Text and choices of each question.
        answers: The chosen text for each question; "" if there is none yet.
        replies: State and text of the reply to each answer; empty texts without an answer.
    """

    _esm = load_script("questions")
    _css = load_style("questions")
    heading = traitlets.Unicode("").tag(sync=True)
    items = traitlets.List().tag(sync=True)
    is_row = traitlets.Bool(False).tag(sync=True)
    answers = traitlets.List().tag(sync=True)
    replies = traitlets.List().tag(sync=True)

    def __init__(
        self, items: Sequence[Item], reply: Callable[[int, str], Reply], *, title: str, is_row: bool = False
    ) -> None:
        """Create the widget.

        Args:
            items: The questions.
            reply: Function of the position of a question and a choice that returns the reply.
            title: Name of the widget, such as "quiz".
            is_row: Whether the buttons are side by side.
        """
        self.title = title
        self._questions = tuple(items)
        self._reply = reply
        unanswered = [""] * len(self._questions)
        super().__init__(
            heading="" if is_row else title.capitalize(),
            items=[asdict(item) for item in self._questions],
            is_row=is_row,
            answers=unanswered,
            replies=self._replies(unanswered),
        )
        self.observe(self._answer, "answers")

    @property
    def score(self) -> tuple[int, int]:
        """Number of right answers, and number of questions."""
        return sum(reply["state"] == "right" for reply in self.replies), len(self._questions)

    def snapshot(self) -> Markup:
        """Return the questions with the chosen answers and replies as static HTML."""
        chosen = [*self.answers, *[""] * len(self._questions)]  # a browser may send too few answers, or too many
        return render("widgets/questions.html", rows=list(zip(self._questions, chosen, self.replies, strict=False)))

    def _answer(self, _: object) -> None:
        self.replies = self._replies(self.answers)

    def _replies(self, answers: Sequence[Any]) -> list[dict[str, str]]:
        """Return the reply to each answer; a browser may send anything, which is ignored unless it is a choice."""
        replies: list[dict[str, str]] = []
        for position, question in enumerate(self._questions):
            answer = answers[position] if position < len(answers) else ""
            reply = (
                self._reply(position, answer)
                if isinstance(answer, str) and answer in question.choices
                else Reply("", "")
            )
            replies.append({"state": reply.state, "text": reply.text, "sign": REPLY_SIGNS.get(reply.state, "")})
        return replies
