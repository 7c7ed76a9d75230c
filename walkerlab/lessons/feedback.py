"""Feedback that a cell displays: on an answer, on a prediction, or on their comparison with a result."""

from dataclasses import dataclass

from walkerlab.text.templates import Markup, render

RIGHT = "right"
NOT_YET = "not yet"
EMPTY = "empty"
PREDICTED = "predicted"
COMPARED = "compared"
SIGNS = {RIGHT: "✓", NOT_YET: "→", EMPTY: "…", PREDICTED: "?", COMPARED: "="}
TITLES = {
    RIGHT: "Right.",
    NOT_YET: "Not yet.",
    EMPTY: "Empty.",
    PREDICTED: "Your prediction:",
    COMPARED: "Compared:",
}
"""First words, by state."""


@dataclass(frozen=True)
class Bar:
    """A value drawn as a bar.

    Attributes:
        label: Name of the value.
        text: Value with its unit.
        percent: Length of the bar, in percent of the longest.
    """

    label: str
    text: str
    percent: float


@dataclass(frozen=True)
class Feedback:
    """Feedback, displayed by a notebook as a coloured box.

    Attributes:
        state: "right", "not yet" or "empty" for an answer; "predicted" or "compared" for a prediction.
        text: One or two sentences.
        note: Smaller line below, such as the number of the hint; may be empty.
        bars: Prediction and result as bars; may be empty.
    """

    state: str
    text: str
    note: str = ""
    bars: tuple[Bar, ...] = ()

    def __repr__(self) -> str:
        """Return the feedback as text."""
        return " ".join(filter(None, [TITLES[self.state], self.text, self.note]))

    def _repr_html_(self) -> Markup:
        return render("lessons/feedback.html", feedback=self, sign=SIGNS[self.state], title=TITLES[self.state])
